//! Paints the primitives of `lockstep2d::draw` into a draw list.

use std::f32::consts::TAU;

use lockstep2d::draw::{Fill, Form, Layers, Paint, Primitive, Style, each_primitive};
use lockstep2d::math::{Aabb, Fx, Unit, Vec2};
use lockstep2d::world::World;

use crate::camera::Camera;
use crate::colour::Colour;
use crate::list::DrawList;

/// Length of a direction mark at full size, in pixels.
const DIRECTION_LENGTH: f32 = 18.0;
/// Mean half size of shapes, in pixels, below which marks shrink so that they stay smaller than a typical body.
const LARGE: f32 = 24.0;
/// Smallest scale of marks.
const SCALE_MIN: f32 = 1.0 / 6.0;
/// Mean half size of shapes, in pixels, below which labels are left out, because they would overlap.
const TEXT_SIZE_MIN: f32 = 7.0;

/// Corners of a point mark of radius 1, which looks like a disc.
const OCTAGON: [[f32; 2]; 8] = {
    let (far, near) = (0.923_879_5, 0.382_683_43);
    [
        [far, near],
        [near, far],
        [-near, far],
        [-far, near],
        [-far, -near],
        [-near, -far],
        [near, -far],
        [far, -near],
    ]
};

/// Radius, in pixels, below which a point mark has only every other corner.
const TINY: f32 = 1.5;

/// Settings for painting a picture.
///
/// ```
/// use lockstep2d::draw::{Layers, fit};
/// use lockstep2d_render::{Brush, Camera, Colour, DrawList};
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
/// # let mut world = World::default();
/// # world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(0.5))?)])?;
/// # let predicted = world.clone();
/// let camera = Camera::new(fit(&world), [0.0, 0.0], [640.0, 480.0]);
/// let mut list = DrawList::default();
/// lockstep2d_render::world(&mut list, &world, Layers::default(), &camera, &Brush::default());
/// // A second world over the first, in one colour: the bodies at their predicted positions.
/// let ghost = Brush { tint: Some(Colour::hex(0x1f77b4)), ..Brush::suiting(&world, &camera) };
/// let solid = list.items().len();
/// lockstep2d_render::world(&mut list, &predicted, Layers::default(), &camera, &ghost);
/// assert_eq!(list.items().len(), 2 * solid);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brush {
    /// Scale of marks and line widths. [`Brush::suiting`] makes it smaller for smaller bodies, from 1 down to 1/6.
    pub marks: f32,
    /// Colour that replaces the colours of all styles, to draw a world over another one.
    pub tint: Option<Colour>,
}

impl Default for Brush {
    fn default() -> Self {
        Brush { marks: 1.0, tint: None }
    }
}

impl Brush {
    /// Returns a brush whose marks suit the mean size of the shapes of dynamic bodies.
    #[must_use]
    pub fn suiting(world: &World, camera: &Camera) -> Self {
        let moving = world.bodies().filter(|(_, body)| body.is_dynamic());
        let shapes = moving.flat_map(|(_, body)| body.shapes()).filter_map(|&id| world.shape(id));
        let halves = shapes.map(|shape| {
            let half = shape.fat_aabb().extents();
            camera.length(half.x.max(half.y))
        });
        let (count, sum) = halves.fold((0.0f32, 0.0f32), |(count, sum), half| (count + 1.0, sum + half));
        let size = if count == 0.0 { LARGE } else { sum / count };
        Brush { marks: (size / LARGE).clamp(SCALE_MIN, 1.0), tint: None }
    }
}

/// Draws layers of a world on top of each other.
pub fn world(list: &mut DrawList, world: &World, layers: Layers, camera: &Camera, brush: &Brush) {
    for layers in layers.stacked() {
        each_primitive(world, layers, &mut |primitive| paint(list, &primitive, camera, brush));
    }
}

/// Draws a primitive.
pub fn paint(list: &mut DrawList, primitive: &Primitive, camera: &Camera, brush: &Brush) {
    painted(list, primitive, camera, brush, Look::of(primitive.style, brush));
}

/// Draws a primitive in the given colours. `inside` is used if its style has a filled inside.
pub fn filled(list: &mut DrawList, primitive: &Primitive, camera: &Camera, inside: Colour, lines: Colour) {
    let brush = Brush::default();
    let look = Look::of(primitive.style, &brush);
    let fill = if look.fill.is_none() { Colour::NONE } else { inside };
    painted(list, primitive, camera, &brush, Look { stroke: lines, fill, ..look });
}

fn painted(list: &mut DrawList, primitive: &Primitive, camera: &Camera, brush: &Brush, look: Look) {
    let Look { stroke, fill, width } = look;
    match &primitive.form {
        Form::Point(place) => {
            let [x, y] = camera.place(*place);
            if camera.sees([x, y], width) {
                let radius = width / 2.0;
                let step = if radius < TINY { 2 } else { 1 };
                let corners = OCTAGON.iter().step_by(step);
                let corners = corners.map(|[cos, sin]| [x + radius * cos, y + radius * sin]);
                list.polygon(corners, stroke, Colour::NONE, 0.0);
            }
        }
        Form::Line { from, to } => {
            add_line(list, [camera.place(*from), camera.place(*to)], camera, stroke, width)
        }
        Form::Direction { from, direction } => {
            let [x, y] = camera.place(*from);
            let unit_length = DIRECTION_LENGTH * brush.marks.max(0.4) / Unit::ONE.to_bits() as f32;
            let part = |unit: Unit| unit.to_bits() as f32 * unit_length;
            let end = [x + part(direction.x), y - part(direction.y)];
            add_line(list, [[x, y], end], camera, stroke, width);
        }
        Form::Label { at, text } => {
            let [x, y] = camera.place(*at);
            if brush.marks * LARGE >= TEXT_SIZE_MIN && camera.sees([x, y], 100.0) {
                list.text([x + 3.0, y - 14.0], 0.75, stroke, text.clone());
            }
        }
        Form::Box(Aabb { lower, upper }) => {
            let ([left, bottom], [right, top]) = (camera.place(*lower), camera.place(*upper));
            let corners = [[left, top], [left, bottom], [right, bottom], [right, top]];
            add_polygon(list, corners, camera, (fill, stroke, width));
        }
        Form::Circle { centre, radius } => {
            let (place, radius) = (camera.place(*centre), camera.length(*radius));
            if camera.sees(place, radius + width) {
                list.polygon(disc(place, radius, sides_of(radius)), fill, stroke, width);
            }
        }
        Form::Polygon { vertices, radius } if *radius == Fx::ZERO => {
            add_polygon(
                list,
                vertices.iter().map(|&vertex| camera.place(vertex)),
                camera,
                (fill, stroke, width),
            );
        }
        Form::Polygon { vertices, radius } => {
            add_polygon(list, rounded(vertices, *radius, camera), camera, (fill, stroke, width));
        }
    }
}

/// A style, as painted by a brush.
struct Look {
    stroke: Colour,
    fill: Colour,
    width: f32,
}

impl Look {
    fn of(style: Style, brush: &Brush) -> Self {
        let Paint { stroke, fill, width, .. } = style.paint();
        let width = f32::from(width) / 100.0;
        // A small scale makes lines thinner, but not thinner than 0.4 pixels. For outlines of fixed shapes, this limit
        // is 1 pixel.
        let width_min = if style == Style::Fixed { 1.0 } else { 0.4 };
        let width = (width * brush.marks).max(width.min(width_min));
        let fill = fill.map_or(Colour::NONE, |Fill { colour, opacity }| {
            Colour::hex(colour).with_opacity(u8::try_from(u16::from(opacity) * 255 / 100).unwrap_or(255))
        });
        match brush.tint {
            None => Look { stroke: Colour::hex(stroke), fill, width },
            Some(tint) => Look { stroke: tint, fill: tint.with_opacity(fill.opacity / 4), width },
        }
    }
}

fn add_line(list: &mut DrawList, ends: [[f32; 2]; 2], camera: &Camera, stroke: Colour, width: f32) {
    if let Some(ends) = camera.clipped(ends) {
        list.line(ends, stroke, width);
    }
}

/// Adds a polygon if it is visible.
fn add_polygon(
    list: &mut DrawList,
    points: impl IntoIterator<Item = [f32; 2]>,
    camera: &Camera,
    (fill, stroke, width): (Colour, Colour, f32),
) {
    let count = list.items().len();
    list.polygon(points, fill, stroke, width);
    let Some(&item) = list.items().get(count) else { return };
    if !camera.sees_any(list.points(&item)) {
        list.undo();
    }
}

fn disc([x, y]: [f32; 2], radius: f32, sides: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..sides).map(move |side| {
        let (sin, cos) = (side as f32 / sides as f32 * TAU).sin_cos();
        [x + radius * cos, y - radius * sin]
    })
}

/// Number of sides of a polygon that looks like a circle. `radius` is in pixels. Up to a radius of 1000 pixels, the
/// sides are at most a third of a pixel away from the circle.
fn sides_of(radius: f32) -> u32 {
    (radius.max(0.0).sqrt() * 4.5).clamp(8.0, 128.0) as u32
}

/// Outline of a polygon or capsule with rounded corners.
fn rounded(vertices: &[Vec2<Fx>], radius: Fx, camera: &Camera) -> Vec<[f32; 2]> {
    let radius = camera.length(radius);
    let corners: Vec<[f32; 2]> = vertices.iter().map(|&vertex| camera.place(vertex)).collect();
    let count = corners.len();
    // Angles are measured with y up, as in the world, so that a counter-clockwise polygon stays counter-clockwise.
    let direction = |from: [f32; 2], to: [f32; 2]| (from[1] - to[1]).atan2(to[0] - from[0]);
    let sides = sides_of(radius) as f32;
    let mut outline = Vec::new();
    for i in 0..count {
        let (before, here, after) = (corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count]);
        let start = direction(before, here) - TAU / 4.0;
        let turn = (direction(here, after) - direction(before, here)).rem_euclid(TAU);
        let steps = (sides * turn / TAU).ceil().max(2.0) as u32;
        for step in 0..=steps {
            let (sin, cos) = (start + turn * step as f32 / steps as f32).sin_cos();
            outline.push([here[0] + radius * cos, here[1] - radius * sin]);
        }
    }
    outline
}

#[cfg(test)]
mod tests {
    use super::*;
    use lockstep2d::fx;

    fn camera() -> Camera {
        let window = Aabb::new(Vec2::new(fx!(-5), fx!(-5)), Vec2::new(fx!(5), fx!(5)));
        Camera::new(window, [0.0, 0.0], [1000.0, 1000.0])
    }

    fn extent(points: &[[f32; 2]]) -> [f32; 4] {
        points.iter().fold([f32::MAX, f32::MAX, f32::MIN, f32::MIN], |[left, top, right, bottom], &[x, y]| {
            [left.min(x), top.min(y), right.max(x), bottom.max(y)]
        })
    }

    #[test]
    fn a_rounded_square_reaches_as_far_as_its_radius_says_and_no_corner_does() {
        let half = fx!(1);
        let square =
            [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| Vec2::new(x, y));
        let outline = rounded(&square, fx!(0.5), &camera());
        let [left, top, right, bottom] = extent(&outline);
        for (found, expected) in [(left, 350.0), (top, 350.0), (right, 650.0), (bottom, 650.0)] {
            assert!((found - expected).abs() < 0.01, "{found} {expected}");
        }
        let far = outline.iter().map(|[x, y]| (x - 500.0).hypot(y - 500.0)).fold(0.0, f32::max);
        let corner = 100.0 * 2.0f32.sqrt() + 50.0;
        assert!((far - corner).abs() < 0.5, "{far} {corner}");
    }

    #[test]
    fn a_rod_has_two_round_ends() {
        let rod = [Vec2::new(fx!(-1), fx!(0)), Vec2::new(fx!(1), fx!(0))];
        let [left, top, right, bottom] = extent(&rounded(&rod, fx!(0.5), &camera()));
        for (found, expected) in [(left, 350.0), (top, 450.0), (right, 650.0), (bottom, 550.0)] {
            assert!((found - expected).abs() < 0.5, "{found} {expected}");
        }
    }

    #[test]
    fn what_cannot_be_seen_is_not_in_the_list() {
        let mut list = DrawList::default();
        let far = Vec2::new(fx!(100), fx!(0));
        let subject = lockstep2d::draw::Subject::World;
        let forms = [
            Form::Point(far),
            Form::Line { from: far, to: far + Vec2::new(fx!(1), fx!(1)) },
            Form::Circle { centre: far, radius: fx!(3) },
            Form::Box(Aabb::new(far, far + Vec2::new(fx!(1), fx!(1)))),
            Form::Label { at: far, text: "far".into() },
        ];
        for form in forms {
            paint(
                &mut list,
                &Primitive { style: Style::Dynamic, subject, form },
                &camera(),
                &Brush::default(),
            );
        }
        assert_eq!(list, DrawList::default());
        let huge = Form::Circle { centre: far, radius: fx!(98) };
        let primitive = Primitive { style: Style::Dynamic, subject, form: huge };
        paint(&mut list, &primitive, &camera(), &Brush::default());
        assert_eq!(list.items().len(), 1, "a circle with its border in the picture should be drawn");
    }
}
