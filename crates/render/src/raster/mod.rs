//! [`raster`]: renders a list into pixels in memory.

mod clip;
mod image;
mod text;

use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

use crate::colour::Colour;
use crate::list::{DrawList, Item};
use clip::Area;

pub use image::Image;

/// Maximum side length of an image, in pixels.
pub const SIDE_MAX: u32 = 16384;

/// Draws a list on a background, antialiased. The width and the height of the image are clamped to the range from 1 to
/// [`SIDE_MAX`] pixels.
#[must_use]
pub fn raster(list: &DrawList, (width, height): (u32, u32), background: Colour) -> Image {
    let (width, height) = (width.clamp(1, SIDE_MAX), height.clamp(1, SIDE_MAX));
    let mut pixels = Pixmap::new(width, height).expect("both sides are clamped to the valid range");
    pixels.fill(colour(background));
    let area = Area::of(width, height);
    let mut texts = list.texts().iter().peekable();
    for (before, item) in list.items().iter().enumerate() {
        while let Some(line) = texts.next_if(|line| line.after as usize <= before) {
            text::draw(&mut pixels, line);
        }
        draw(&mut pixels, item, list.points(item), &area);
    }
    for line in texts {
        text::draw(&mut pixels, line);
    }
    Image::of(&pixels)
}

fn draw(pixels: &mut Pixmap, item: &Item, points: &[[f32; 2]], area: &Area) {
    let has_stroke = !item.stroke.is_none() && item.width > 0.0;
    let margin = if has_stroke { item.width } else { 0.0 };
    if !area.is_touched(points, margin) {
        return;
    }
    let is_far = area.is_exceeded(points);
    if !item.fill.is_none() {
        let outline =
            if is_far { path(&area.polygon(points), Ends::Joined) } else { path(points, Ends::Joined) };
        if let Some(outline) = outline {
            let (paint, rule) = (paint(item.fill), FillRule::Winding);
            pixels.fill_path(&outline, &paint, rule, Transform::identity(), None);
        }
    }
    if !has_stroke {
        return;
    }
    let ends = if item.closed { Ends::Joined } else { Ends::Loose };
    let lines = if is_far { area.lines(points, ends == Ends::Joined) } else { path(points, ends) };
    if let Some(lines) = lines {
        let stroke = Stroke {
            width: item.width,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        pixels.stroke_path(&lines, &paint(item.stroke), &stroke, Transform::identity(), None);
    }
}

/// Whether the last point is connected with the first.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ends {
    Loose,
    Joined,
}

fn path(points: &[[f32; 2]], ends: Ends) -> Option<Path> {
    let (&[x, y], rest) = points.split_first()?;
    let mut path = PathBuilder::with_capacity(points.len() + 1, points.len());
    path.move_to(x, y);
    for &[x, y] in rest {
        path.line_to(x, y);
    }
    if ends == Ends::Joined {
        path.close();
    }
    path.finish()
}

fn paint(fill: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(colour(fill));
    paint
}

fn colour(Colour { rgb: [red, green, blue], opacity }: Colour) -> Color {
    Color::from_rgba8(red, green, blue, opacity)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Colour = Colour::hex(0xff0000);
    const BLUE: Colour = Colour::hex(0x0000ff);
    const WHITE: Colour = Colour::hex(0xffffff);

    #[test]
    fn a_rectangle_covers_its_pixels_and_no_others() {
        let mut list = DrawList::default();
        list.rectangle([2.0, 3.0], [4.0, 2.0], RED);
        let image = raster(&list, (10, 8), WHITE);
        for y in 0..8 {
            for x in 0..10 {
                let inside = (2..6).contains(&x) && (3..5).contains(&y);
                assert_eq!(image.pixel(x, y), Some(if inside { RED } else { WHITE }), "{x}, {y}");
            }
        }
        assert_eq!((image.pixel(10, 0), image.pixel(0, 8)), (None, None));
    }

    #[test]
    fn half_a_pixel_is_half_covered() {
        let mut list = DrawList::default();
        list.rectangle([2.5, 0.0], [4.0, 2.0], Colour::hex(0));
        let image = raster(&list, (10, 2), WHITE);
        let grey = image.pixel(2, 0).unwrap().rgb[0];
        assert!((120..=135).contains(&grey), "{grey}");
        assert_eq!(image.pixel(3, 0), Some(Colour::hex(0)));
    }

    #[test]
    fn what_is_last_lies_on_top_also_of_text() {
        let at = |x: u32, y: u32, image: &Image| image.pixel(x, y).unwrap();
        let mut list = DrawList::default();
        list.rectangle([0.0; 2], [20.0, 20.0], RED);
        list.text([0.0, 0.0], 1.0, WHITE, "\u{0}");
        let image = raster(&list, (20, 20), WHITE);
        assert_eq!(
            (at(1, 2, &image), at(3, 6, &image)),
            (WHITE, RED),
            "expected the white outline and the red inside of a glyph box"
        );
        list.rectangle([0.0; 2], [20.0, 20.0], BLUE);
        let image = raster(&list, (20, 20), WHITE);
        assert!((0..400).all(|i| at(i % 20, i / 20, &image) == BLUE));
    }

    #[test]
    fn colours_let_through_what_is_below() {
        let mut list = DrawList::default();
        list.rectangle([0.0; 2], [2.0, 2.0], Colour::hex(0).with_opacity(51));
        let image = raster(&list, (2, 2), WHITE);
        assert_eq!(image.pixel(0, 0), Some(Colour::hex(0xcccccc)));
        let clear = raster(&list, (2, 2), Colour::NONE);
        assert_eq!(clear.pixel(0, 0), Some(Colour::hex(0).with_opacity(51)));
        assert!(image.is_opaque() && !clear.is_opaque());
    }

    /// Shapes may be wider than a billion pixels. Their far corners must not change the visible pixels.
    #[test]
    fn far_corners_change_nothing_that_is_seen() {
        let wide = |reach: f32| {
            let mut list = DrawList::default();
            let corners = [[-reach, 10.0], [reach, 10.0], [reach, 30.0], [-reach, 30.0]];
            list.polygon(corners, RED, BLUE, 2.0);
            list.line([[20.0, -reach], [20.0, reach]], BLUE, 3.0);
            raster(&list, (40, 40), WHITE)
        };
        let near = wide(100.0);
        assert_eq!(near.pixel(5, 20), Some(RED));
        for reach in [1e5, 1e9, 1e30] {
            assert!(wide(reach) == near, "{reach}");
        }
    }

    #[test]
    fn nothing_is_no_reason_to_panic() {
        let bad = [f32::NAN, f32::INFINITY, f32::MAX, -0.0, 1e-30, 7.0];
        let mut list = DrawList::default();
        for &x in &bad {
            for &y in &bad {
                list.polygon([[x, y]], RED, BLUE, y);
                list.line([[x, y], [y, x]], RED, x);
                list.polygon([[x, y], [y, x], [0.0, 5.0]], RED, BLUE, x);
                list.text([x, y], y, RED, "text");
            }
        }
        list.line([], RED, 1.0);
        for size in [(0, 0), (1, 1), (20, 10)] {
            let image = raster(&list, size, WHITE);
            assert_eq!((image.width(), image.height()), (size.0.max(1), size.1.max(1)));
        }
    }
}
