//! A tick as an SVG document.
//!
//! One path for each body, with its id as a tooltip, and one path for all things of any other style: a picture of
//! 5000 boxes at rest stays at about two megabytes. Points are lines without length, and no stroke scales, so that
//! one can enlarge a picture in a browser and still see where exactly two shapes touch.

use alloc::string::String;
use alloc::vec::Vec;

use super::fit::fit;
use super::path::{add, push};
use super::primitives::{Proximity, Style, Subject, primitives};
use super::screen::{Pixel, Screen};
use super::view::{Frame, View};
use crate::body::BodyKind;
use crate::math::{Fx, widen};
use crate::world::World;

/// Height of the legend in pixels: two lines of text.
const LEGEND_HEIGHT: u32 = 42;

/// How to paint a style.
struct Paint {
    style: Style,
    /// In the legend.
    name: &'static str,
    /// Of strokes.
    colour: &'static str,
    /// Fill and opacity, as attributes.
    fill: &'static str,
    /// In hundredths of a pixel, when marks are largest.
    width: i64,
}

const fn paint(
    style: Style,
    name: &'static str,
    colour: &'static str,
    fill: &'static str,
    width: i64,
) -> Paint {
    Paint { style, name, colour, fill, width }
}

const HOLLOW: &str = "fill=\"none\"";

/// What lies below comes first: what is small and explains the rest lies on top.
const PAINTS: [Paint; 13] = [
    paint(Style::Outline(BodyKind::Fixed), "fixed", "#6d6d68", "fill=\"#dddcd6\"", 120),
    paint(Style::FatBox, "fat box", "#b9b9b0", HOLLOW, 70),
    paint(
        Style::Outline(BodyKind::Kinematic),
        "kinematic",
        "#00796b",
        "fill=\"#b2dfdb\" fill-opacity=\".75\"",
        120,
    ),
    paint(
        Style::Outline(BodyKind::Dynamic),
        "dynamic",
        "#1f5f9e",
        "fill=\"#c5ddf2\" fill-opacity=\".75\"",
        120,
    ),
    paint(Style::JointArm, "joint", "#8e24aa", HOLLOW, 120),
    paint(Style::Velocity, "velocity", "#2e7d32", HOLLOW, 180),
    paint(Style::CentreOfMass, "centre of mass", "#1a237e", HOLLOW, 380),
    paint(Style::JointAnchor, "anchor", "#8e24aa", HOLLOW, 700),
    paint(Style::JointGap, "gap", "#ff4081", HOLLOW, 300),
    paint(Style::ContactNormal(Proximity::Speculative), "", "#e69500", HOLLOW, 130),
    paint(Style::ContactPoint(Proximity::Speculative), "about to touch", "#e69500", HOLLOW, 500),
    paint(Style::ContactNormal(Proximity::Touching), "", "#c62828", HOLLOW, 130),
    paint(Style::ContactPoint(Proximity::Touching), "touching", "#c62828", HOLLOW, 500),
];

/// Draws the world as it is, with y upwards. The same world and view give the same text on every machine.
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
    let layers = sorted_by_paint(world, view, &screen, &marks);

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
    // An inner picture clips what it holds, without an id that could clash in a page with several pictures.
    push(
        &mut text,
        format_args!(
            "<svg y=\"{LEGEND_HEIGHT}\" width=\"{width}\" height=\"{scene_height}\">\n\
             <rect width=\"{width}\" height=\"{scene_height}\" fill=\"#fafaf7\"/>\n\
             <g stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
        ),
    );
    for (Paint { colour, fill, width, .. }, paths) in &layers {
        let width = marks.scaled(*width);
        push(
            &mut text,
            format_args!("<g stroke=\"{colour}\" {fill} stroke-width=\"{width}\">\n{paths}</g>\n"),
        );
    }
    text.push_str("</g>\n");
    add_scale_bar(&mut text, &screen, (width, scene_height));
    text.push_str("</svg>\n</svg>\n");
    text
}

/// How large marks are: as large as one likes to see them, but smaller than the bodies that they lie on.
struct Marks {
    /// The mean half extent of what moves on the screen.
    body: i64,
}

impl Marks {
    /// From this mean half extent on, in hundredths of a pixel, marks are largest.
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

/// The elements of every style that can be seen, in the order in which they are painted.
fn sorted_by_paint(world: &World, view: &View, screen: &Screen, marks: &Marks) -> Vec<(Paint, String)> {
    let mut layers: Vec<(Paint, String)> = PAINTS.into_iter().map(|paint| (paint, String::new())).collect();
    let normal_length = marks.scaled(1800);
    let mut path = String::new();
    let found = primitives(world, view.layers);
    for group in found.chunk_by(|a, b| a.style == b.style && a.subject == b.subject) {
        let first = &group[0];
        let layer = layers.iter_mut().find(|(paint, _)| paint.style == first.style);
        let Some((_, elements)) = layer else { unreachable!("every style has a paint") };
        let Subject::Body(id) = first.subject else {
            group.iter().for_each(|primitive| add(elements, &primitive.form, screen, normal_length));
            continue;
        };
        path.clear();
        group.iter().for_each(|primitive| add(&mut path, &primitive.form, screen, normal_length));
        match first.style {
            _ if path.is_empty() => {}
            Style::Outline(_) => {
                push(elements, format_args!("<path d=\"{path}\"><title>body {id}</title></path>\n"));
            }
            _ => elements.push_str(&path),
        }
    }
    layers.retain(|(_, elements)| !elements.is_empty());
    for (paint, elements) in &mut layers {
        if !matches!(paint.style, Style::Outline(_)) {
            *elements = alloc::format!("<path d=\"{elements}\"/>\n");
        }
    }
    layers
}

fn add_legend(text: &mut String, world: &World, view: &View, layers: &[(Paint, String)]) {
    text.push_str(
        "<g font-family=\"ui-monospace,monospace\" font-size=\"12\" fill=\"#222\">\n<text x=\"8\" y=\"16\">",
    );
    if !view.title.is_empty() {
        text.push_str("<tspan font-weight=\"bold\">");
        add_escaped(text, &view.title);
        text.push_str("</tspan> · ");
    }
    let overlaps =
        world.contacts().flat_map(|contact| contact.manifold.points()).map(|point| -point.separation);
    let overlap = millimetres(overlaps.max().map_or(Fx::ZERO, widen));
    let gaps = world.joints().filter_map(|(id, _)| world.joint_anchors(id)).map(|(a, b)| a.distance(b));
    let gap = millimetres(gaps.max().unwrap_or_default());
    let (tick, bodies, contacts) = (world.tick(), world.body_count(), world.contacts().count());
    let (faults, hash) = (world.faults(), world.state_hash());
    push(
        text,
        format_args!(
            "tick {tick} · {bodies} bodies · {contacts} contacts · deepest overlap {overlap:.1} mm · \
             widest joint gap {gap:.1} mm · {faults} faults</text>\n<text x=\"8\" y=\"33\">{hash}"
        ),
    );
    for (Paint { name, colour, .. }, _) in layers.iter().filter(|(paint, _)| !paint.name.is_empty()) {
        push(text, format_args!(" <tspan fill=\"{colour}\">{name}</tspan>"));
    }
    text.push_str("</text>\n</g>\n");
}

/// Of a length in metres; what does not reach anything is 0.
fn millimetres(length: Fx) -> Fx {
    length.max(Fx::ZERO).saturating_mul_int(1000)
}

/// A bar of 1, 2 or 5 times a power of ten metres, a tenth to a quarter of the picture wide.
fn add_scale_bar(text: &mut String, screen: &Screen, (width, height): (u32, u32)) {
    let lengths = (0u32..13).flat_map(|power| [1i64, 2, 5].map(|digit| digit * 10i64.pow(power)));
    let metres = |millimetres: i64| crate::math::ratio(millimetres, 1000);
    let fitting = lengths.take_while(|&length| screen.length(metres(length)).0 <= i64::from(width) * 25);
    let Some(length) = fitting.last() else { return };
    let (bar, y) = (screen.length(metres(length)), height - 10);
    let (number, unit) = if length < 1000 { (length, "mm") } else { (length / 1000, "m") };
    push(
        text,
        format_args!(
            "<path d=\"M10 {}v6m0 -3h{bar}m0 -3v6\" fill=\"none\" stroke=\"#222\"/>\n\
             <text x=\"14\" y=\"{}\" font-family=\"ui-monospace,monospace\" font-size=\"12\" fill=\"#222\">\
             {number} {unit}</text>\n",
            y - 3,
            y - 6
        ),
    );
}

/// Adds text in which nothing is markup. Characters that XML does not allow at all become U+FFFD.
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
