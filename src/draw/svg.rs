//! Draws a tick as an SVG document.
//!
//! The outlines of a body have its id and its name as a tooltip. In every other style, all lines and points share one
//! path, so that a picture of 5000 boxes at rest takes about two megabytes. Strokes do not scale, so that an enlarged
//! picture in a browser shows exactly where two shapes touch.

use alloc::collections::BTreeMap;
use alloc::string::String;

use super::bar::Bar;
use super::fit::fit;
use super::legend::Legend;
use super::paint::{Fill, PAPER, Paint};
use super::path::{add, push};
use super::primitive::{Style, Subject};
use super::primitives::primitives;
use super::screen::{Pixel, Screen};
use super::view::{Frame, View};
use crate::body::BodyKind;
use crate::world::World;

/// Height of the legend in pixels: two lines of text.
const LEGEND_HEIGHT: u32 = 42;

/// Draws a world as an SVG document, with y upwards. The same world and view give the same text on every machine.
#[must_use]
pub fn svg(world: &World, view: &View) -> String {
    let (width, height) = (view.width.clamp(64, 16384), view.height.clamp(64, 16384));
    let window = match view.frame {
        Frame::Fit => fit(world),
        Frame::Window(window) => window,
    };
    let scene_height = height.saturating_sub(LEGEND_HEIGHT);
    let screen = Screen::new(window, (width, scene_height));
    let marks = Marks::of(world, &screen);
    let layers = sorted_by_style(world, view, &screen, &marks);

    let mut text = String::new();
    push(
        &mut text,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"lockstep2d\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <style>.lockstep2d path{{vector-effect:non-scaling-stroke}}</style>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        ),
    );
    add_legend(&mut text, world, view, &layers);
    // A nested `svg` element clips its contents. A clip path would need an id, and ids could clash in a page with
    // several pictures.
    push(
        &mut text,
        format_args!(
            "<svg y=\"{LEGEND_HEIGHT}\" width=\"{width}\" height=\"{scene_height}\">\n\
             <rect width=\"{width}\" height=\"{scene_height}\" fill=\"#{PAPER:06x}\"/>\n\
             <g stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
        ),
    );
    for (style, paths) in &layers {
        add_layer(&mut text, *style, &marks, paths);
    }
    text.push_str("</g>\n");
    add_scale_bar(&mut text, &screen, (width, scene_height));
    text.push_str("</svg>\n</svg>\n");
    text
}

/// Size of marks, smaller for small bodies.
struct Marks {
    /// Mean half extent of the fat boxes of shapes that can move, in hundredths of a pixel, clamped to 400 to 2400.
    body: i64,
}

impl Marks {
    /// Half extent, in hundredths of a pixel, from which marks have their maximum size.
    const BODY_LARGE: i64 = 2400;

    fn of(world: &World, screen: &Screen) -> Self {
        let moving = world
            .shapes()
            .filter(|(_, shape)| world.body(shape.body()).is_some_and(|body| body.kind() != BodyKind::Fixed));
        let halves = moving.map(|(_, shape)| {
            let half = shape.fat_aabb().extents();
            screen.length(half.x.max(half.y)).0
        });
        let (count, sum) =
            halves.fold((0i64, 0i64), |(count, sum), half| (count + 1, sum.saturating_add(half)));
        let body = if count == 0 { Self::BODY_LARGE } else { sum / count };
        Marks { body: body.clamp(Self::BODY_LARGE / 6, Self::BODY_LARGE) }
    }

    fn scaled(&self, length: i64) -> Pixel {
        Pixel((length * self.body / Self::BODY_LARGE).max(length.min(40)))
    }
}

fn sorted_by_style(world: &World, view: &View, screen: &Screen, marks: &Marks) -> BTreeMap<Style, String> {
    let mut layers = BTreeMap::<Style, String>::new();
    let normal_length = marks.scaled(1800);
    let mut path = String::new();
    let found = primitives(world, view.layers);
    for group in found.chunk_by(|a, b| a.style == b.style && a.subject == b.subject) {
        let first = &group[0];
        path.clear();
        group.iter().for_each(|primitive| add(&mut path, &primitive.form, screen, normal_length));
        if path.is_empty() {
            continue;
        }
        let elements = layers.entry(first.style).or_default();
        match (has_tooltip(first.style), first.subject) {
            (true, Subject::Body(id)) => {
                let label = world.body_label(id);
                push(elements, format_args!("<path d=\"{path}\"><title>body {label}</title></path>\n"));
            }
            _ => elements.push_str(&path),
        }
    }
    for (style, elements) in &mut layers {
        if !has_tooltip(*style) && !is_text(*style) {
            *elements = alloc::format!("<path d=\"{elements}\"/>\n");
        }
    }
    layers
}

/// Whether primitives of the style are outlines, which have tooltips.
fn has_tooltip(style: Style) -> bool {
    matches!(
        style,
        Style::Sensor | Style::Fixed | Style::Kinematic | Style::Dynamic | Style::Asleep | Style::Island(_)
    )
}

fn is_text(style: Style) -> bool {
    matches!(style, Style::Id | Style::JointError)
}

fn add_layer(text: &mut String, style: Style, marks: &Marks, elements: &str) {
    let Paint { stroke, fill, width, .. } = style.paint();
    if is_text(style) {
        let font = "font-family=\"ui-monospace,monospace\" font-size=\"10\"";
        return push(text, format_args!("<g fill=\"#{stroke:06x}\" {font}>\n{elements}</g>\n"));
    }
    push(text, format_args!("<g stroke=\"#{stroke:06x}\" fill=\""));
    match fill {
        None => text.push_str("none\""),
        Some(Fill { colour, opacity: 100 }) => push(text, format_args!("#{colour:06x}\"")),
        Some(Fill { colour, opacity }) => {
            push(text, format_args!("#{colour:06x}\" fill-opacity=\".{opacity:02}\""))
        }
    }
    let width = marks.scaled(width.into());
    push(text, format_args!(" stroke-width=\"{width}\">\n{elements}</g>\n"));
}

fn add_legend(text: &mut String, world: &World, view: &View, layers: &BTreeMap<Style, String>) {
    text.push_str(
        "<g font-family=\"ui-monospace,monospace\" font-size=\"12\" fill=\"#222\">\n<text x=\"8\" y=\"16\">",
    );
    if !view.title.is_empty() {
        text.push_str("<tspan font-weight=\"bold\">");
        add_escaped(text, &view.title);
        text.push_str("</tspan> · ");
    }
    let Legend { figures, hash, names } = Legend::of(world, layers.keys().copied());
    push(text, format_args!("{figures}</text>\n<text x=\"8\" y=\"33\">{hash}"));
    for (name, colour) in names {
        push(text, format_args!(" <tspan fill=\"#{colour:06x}\">{name}</tspan>"));
    }
    text.push_str("</text>\n</g>\n");
}

/// Adds a scale bar, up to a quarter of the picture wide.
fn add_scale_bar(text: &mut String, screen: &Screen, (width, height): (u32, u32)) {
    let Some(Bar { length, label }) = Bar::up_to(|bar| screen.length(bar).0 <= i64::from(width) * 25) else {
        return;
    };
    let (bar, y) = (screen.length(length), height - 10);
    push(
        text,
        format_args!(
            "<path d=\"M10 {}v6m0 -3h{bar}m0 -3v6\" fill=\"none\" stroke=\"#222\"/>\n\
             <text x=\"14\" y=\"{}\" font-family=\"ui-monospace,monospace\" font-size=\"12\" fill=\"#222\">\
             {label}</text>\n",
            y - 3,
            y - 6
        ),
    );
}

/// Appends text with all markup escaped. U+FFFD replaces control characters below U+0020, U+FFFE and U+FFFF.
fn add_escaped(text: &mut String, raw: &str) {
    for character in raw.chars() {
        match character {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => text.push('\u{fffd}'),
            other => text.push(other),
        }
    }
}
