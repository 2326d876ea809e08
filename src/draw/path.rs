//! Converts primitives to SVG path data and text elements.

use alloc::string::String;
use core::fmt::{Arguments, Write};

use super::primitive::Form;
use super::screen::{Pixel, Screen};
use crate::math::{Aabb, Fx, Unit, Vec2, round_shift, widen};

pub(super) fn push(text: &mut String, arguments: Arguments<'_>) {
    text.write_fmt(arguments).expect("a String takes any text");
}

/// Appends a form to path data, or the text element of a [`Form::Label`], if the form is visible. `direction_length` is
/// the drawn length of a [`Form::Direction`].
pub(super) fn add(path: &mut String, form: &Form, screen: &Screen, direction_length: Pixel) {
    match form {
        Form::Point(place) => add_point(path, *place, screen),
        Form::Line { from, to } => add_line(path, *from, *to, screen),
        Form::Direction { from, direction } => {
            add_direction(path, *from, *direction, screen, direction_length)
        }
        Form::Label { at, text } => add_label(path, *at, text, screen),
        Form::Box(aabb) => add_box(path, *aabb, screen),
        Form::Circle { centre, radius } => add_circle(path, *centre, *radius, screen),
        Form::Polygon { vertices, radius } => add_polygon(path, vertices, *radius, screen),
    }
}

/// Adds a line of zero length. With round caps it is a dot whose size does not change when the picture is enlarged.
fn add_point(path: &mut String, place: Vec2<Fx>, screen: &Screen) {
    if screen.seen.contains_point(place) {
        let (x, y) = screen.place(place);
        push(path, format_args!("M{x} {y}h0"));
    }
}

/// Adds a text element, slightly above and to the right of the position.
fn add_label(elements: &mut String, place: Vec2<Fx>, text: &str, screen: &Screen) {
    if screen.seen.contains_point(place) {
        let (x, y) = screen.place(place);
        push(elements, format_args!("<text x=\"{x}\" y=\"{y}\" dx=\"3\" dy=\"-3\">{text}</text>\n"));
    }
}

fn add_line(path: &mut String, from: Vec2<Fx>, to: Vec2<Fx>, screen: &Screen) {
    if let Some((from, to)) = screen.clipped(from, to) {
        let ((x, y), (end_x, end_y)) = (screen.place(from), screen.place(to));
        push(path, format_args!("M{x} {y}L{end_x} {end_y}"));
    }
}

fn add_direction(path: &mut String, from: Vec2<Fx>, direction: Vec2<Unit>, screen: &Screen, length: Pixel) {
    if screen.seen.contains_point(from) {
        let (x, y) = screen.place(from);
        let part = |unit: Unit| round_shift(i64::from(unit.to_bits()) * length.0, Unit::FRAC_NBITS);
        let (along_x, along_y) = (Pixel(part(direction.x)), Pixel(-part(direction.y)));
        push(path, format_args!("M{x} {y}l{along_x} {along_y}"));
    }
}

fn add_box(path: &mut String, aabb: Aabb, screen: &Screen) {
    if screen.seen.overlaps(aabb) {
        let Aabb { lower, upper } = screen.seen;
        let (left, bottom) = screen.place(aabb.lower.max(lower));
        let (right, top) = screen.place(aabb.upper.min(upper));
        push(path, format_args!("M{left} {top}H{right}V{bottom}H{left}z"));
    }
}

fn add_circle(path: &mut String, centre: Vec2<Fx>, radius: Fx, screen: &Screen) {
    if screen.seen.overlaps(Aabb::new(centre, centre).expanded(radius)) {
        let ((x, y), r) = (screen.place(centre), screen.length(radius));
        let (left, right) = (Pixel(x.0 - r.0), Pixel(x.0 + r.0));
        push(path, format_args!("M{left} {y}A{r} {r} 0 0 0 {right} {y}A{r} {r} 0 0 0 {left} {y}z"));
    }
}

fn add_polygon(path: &mut String, vertices: &[Vec2<Fx>], radius: Fx, screen: &Screen) {
    let bounds = Aabb::from_points(vertices.iter().copied());
    if !bounds.is_some_and(|bounds| screen.seen.overlaps(bounds.expanded(radius))) {
        return;
    }
    let r = screen.length(radius);
    let mut command = 'M';
    for (i, &from) in vertices.iter().enumerate() {
        let to = vertices[(i + 1) % vertices.len()];
        if r == Pixel(0) {
            let (x, y) = screen.place(from);
            push(path, format_args!("{command}{x} {y}"));
        } else {
            let out = outward(from, to, radius);
            let ((x, y), (end_x, end_y)) = (screen.place(from + out), screen.place(to + out));
            let after = vertices[(i + 2) % vertices.len()];
            let (next_x, next_y) = screen.place(to + outward(to, after, radius));
            push(path, format_args!("{command}{x} {y}L{end_x} {end_y}A{r} {r} 0 0 0 {next_x} {next_y}"));
        }
        command = 'L';
    }
    path.push('z');
}

/// Outward offset of an edge of a counter-clockwise polygon.
fn outward(from: Vec2<Fx>, to: Vec2<Fx>, radius: Fx) -> Vec2<Fx> {
    let Some(normal) = (from - to).perp().normalized() else { return Vec2::ZERO };
    let scale = |unit: Unit| crate::math::fx_mul(widen(unit), radius);
    Vec2::new(scale(normal.x), scale(normal.y))
}
