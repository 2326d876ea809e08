//! A rendered world shows its bodies at their positions.
#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

use lockstep2d::draw::{Form, Frame, Layers, PAPER, Style, View, fit, primitives};
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d_render::{Brush, Camera, Colour, DrawList, Image, page, raster, world};
use lockstep2d_scenes::Scene;

const SIZE: (u32, u32) = (400, 300);

/// A scene after this number of ticks.
fn played(name: &str, ticks: u64) -> Sandbox {
    let scene = Scene::find(name).unwrap();
    let mut game = Sandbox::new(&scene.setup(1)).unwrap();
    for tick in 0..ticks {
        let commands = scene.commands(tick, &game);
        game.step(&[commands]);
    }
    game
}

/// Whether `found` is the colour `above`, blended by its opacity over `below`. The tolerance is 2 per channel.
fn is_mixed(found: Colour, above: Colour, below: Colour) -> bool {
    let share = f32::from(above.opacity) / 255.0;
    (0..3).all(|channel| {
        let mixed = f32::from(above.rgb[channel]) * share + f32::from(below.rgb[channel]) * (1.0 - share);
        (f32::from(found.rgb[channel]) - mixed).abs() <= 2.0
    })
}

/// Whether a point is inside a polygon by more than `margin` pixels.
fn is_inside(corners: &[[f32; 2]], [x, y]: [f32; 2], margin: f32) -> bool {
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let distances: Vec<f32> = sides
        .map(|(a, b)| {
            let (along, across) = ([b[0] - a[0], b[1] - a[1]], [x - a[0], y - a[1]]);
            (along[0] * across[1] - along[1] * across[0]) / along[0].hypot(along[1])
        })
        .collect();
    distances.iter().all(|&distance| distance > margin)
        || distances.iter().all(|&distance| distance < -margin)
}

/// Compares every third pixel in each direction with the primitives. A pixel inside of exactly one polygon or circle
/// must have its fill colour. A pixel outside of all of them must have the colour of the paper. Returns the numbers of
/// pixels outside and inside.
fn check(image: &Image, game: &Sandbox, camera: &Camera, paper: Colour, top: u32) -> [u32; 2] {
    let outlines = primitives(game.world(), Layers { outlines: true, ..Layers::NONE });
    let mut counts = [0, 0];
    for y in (top..image.height()).step_by(3) {
        for x in (0..image.width()).step_by(3) {
            let at = [x as f32 + 0.5, y as f32 + 0.5];
            let (mut inside, mut near): (Vec<Style>, u32) = (Vec::new(), 0);
            for primitive in &outlines {
                let mut cover = |is_within: &dyn Fn(f32) -> bool| {
                    if is_within(2.0) {
                        inside.push(primitive.style);
                    } else if is_within(-2.0) {
                        near += 1;
                    }
                };
                match &primitive.form {
                    Form::Polygon { vertices, radius } if *radius == Fx::ZERO => {
                        let corners: Vec<_> = vertices.iter().map(|&vertex| camera.place(vertex)).collect();
                        cover(&|margin| is_inside(&corners, at, margin));
                    }
                    Form::Circle { centre, radius } => {
                        let (centre, radius) = (camera.place(*centre), camera.length(*radius));
                        let distance = (at[0] - centre[0]).hypot(at[1] - centre[1]);
                        cover(&|margin| distance < radius - margin);
                    }
                    // Pixels near a line are not checked.
                    Form::Line { from, to } => {
                        let (from, to) = (camera.place(*from), camera.place(*to));
                        let along = [to[0] - from[0], to[1] - from[1]];
                        let length = along[0].hypot(along[1]).max(0.01);
                        let share =
                            (along[0] * (at[0] - from[0]) + along[1] * (at[1] - from[1])) / length.powi(2);
                        let share = share.clamp(0.0, 1.0);
                        let (dx, dy) =
                            (at[0] - from[0] - along[0] * share, at[1] - from[1] - along[1] * share);
                        near += u32::from(dx.hypot(dy) < 2.0);
                    }
                    other => panic!("these scenes should not contain {other:?}"),
                }
            }
            let found = image.pixel(x, y).unwrap();
            match (&inside[..], near) {
                ([], 0) => {
                    assert_eq!(found, paper, "the paper should be visible at {at:?}");
                    counts[0] += 1;
                }
                ([style], 0) => {
                    let fill = style.paint().fill.unwrap();
                    let opacity = u8::try_from(u16::from(fill.opacity) * 255 / 100).unwrap();
                    let fill = Colour::hex(fill.colour).with_opacity(opacity);
                    assert!(is_mixed(found, fill, paper), "{found:?} is not {style:?} at {at:?}");
                    counts[1] += 1;
                }
                _ => {}
            }
        }
    }
    counts
}

#[test]
fn bodies_are_where_they_are_and_nowhere_else() {
    for (scene, ticks) in [("pyramid", 60), ("bouncing_ball", 30), ("box_stack", 1), ("heavy_on_light", 20)] {
        let game = played(scene, ticks);
        let paper = Colour::hex(0x123456);
        let camera = Camera::new(fit(game.world()), [0.0; 2], [SIZE.0 as f32, SIZE.1 as f32]);
        let mut list = DrawList::default();
        let layers = Layers { outlines: true, ..Layers::NONE };
        world(&mut list, game.world(), layers, &camera, &Brush::suiting(game.world(), &camera));
        let [outside, inside] = check(&raster(&list, SIZE, paper), &game, &camera, paper, 0);
        assert!(
            outside > 500 && inside > 20,
            "{scene}: checked only {outside} pixels outside and {inside} inside"
        );
    }
}

#[test]
fn a_page_shows_the_same_below_its_legend() {
    let game = played("pyramid", 60);
    let layers = Layers { outlines: true, ..Layers::NONE };
    let window = fit(game.world());
    let view =
        View { width: 900, height: 400, frame: Frame::Window(window), layers, title: "pyramid".into() };
    let mut list = DrawList::default();
    page(&mut list, game.world(), &view);
    let image = raster(&list, (900, 400), Colour::hex(0));
    let top = (0..400).find(|&y| image.pixel(890, y) == Some(Colour::hex(PAPER))).unwrap();
    assert_eq!(top, 42, "the legend should be as high as in an SVG");
    let camera = Camera::new(window, [0.0, top as f32], [900.0, (400 - top) as f32]);
    let words: String = list.texts().iter().map(|text| text.text.as_str()).collect();
    let hash = game.world().state_hash().to_string();
    for word in ["pyramid", "tick 60 ", "deepest overlap", &hash, "fixed", "asleep"] {
        assert!(words.contains(word), "{word:?} should be in {words:?}");
    }
    // The scale bar is left out here, because it covers pixels that are compared.
    let mut bare = DrawList::default();
    for item in list.items().iter().filter(|item| item.stroke != Colour::hex(0x222222)) {
        bare.polygon(list.points(item).to_vec(), item.fill, item.stroke, item.width);
    }
    let image = raster(&bare, (900, 400), Colour::hex(0));
    let [outside, inside] = check(&image, &game, &camera, Colour::hex(PAPER), top);
    assert!(outside > 1000 && inside > 100, "checked only {outside} pixels outside and {inside} inside");
}

/// At the scale of this window, the shapes of the world are so wide in pixels that they could overflow the rasteriser.
#[test]
fn a_narrow_window_of_a_wide_world_is_drawn() {
    let game = played("box_stack", 1);
    let centre = Vec2::new(Fx::ZERO, Fx::ZERO);
    let window = lockstep2d::math::Aabb::new(centre, centre).expanded(lockstep2d::fx!(0.001));
    let view = View { frame: Frame::Window(window), ..View::default() };
    let mut list = DrawList::default();
    page(&mut list, game.world(), &view);
    let image = raster(&list, (960, 720), Colour::hex(0));
    assert!(image.is_opaque());
}
