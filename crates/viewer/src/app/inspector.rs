//! [`Inspector`]: panel with all fields of the selected body, its contacts and joints.

use lockstep2d::body::{BodyId, ShapeId};
use lockstep2d::inspect::{Value, fields};
use lockstep2d::math::{Vec2, widen};
use lockstep2d::world::{QueryFilter, World};
use lockstep2d_render::{CELL_HEIGHT, Camera, DrawList, width_of};

use super::theme;
use crate::source::Source;

/// Width of the panel, in characters.
const COLUMNS: usize = 58;
/// Largest distance from a click to the body that it selects, in pixels.
const REACH: f32 = 6.0;

#[derive(Debug, Default)]
pub(super) struct Inspector {
    pub(super) body: Option<BodyId>,
    pub(super) shows_state: bool,
    /// Number of lines that are scrolled off the top.
    scrolled: usize,
    /// Number of lines that were last drawn.
    drawn: usize,
}

/// Returns the body at a screen position. If no body is there, returns the closest body within [`REACH`]. Sensors are
/// ignored. If bodies overlap, takes the body whose shape is in the last slot. This body is usually drawn on top.
pub(super) fn body_at(world: &World, camera: &Camera, at: [f32; 2]) -> Option<BodyId> {
    let point = camera.point(at);
    let beside = {
        let [x, y] = at;
        let edge = camera.point([x + REACH, y]) - camera.point([x, y]);
        edge.x
    };
    let filter = QueryFilter::default();
    let hit = world.overlap_point(point, filter).into_iter().max();
    let near = || world.closest(point, beside, filter).map(|(shape, _)| shape);
    hit.or_else(near).and_then(|shape| world.body_of(shape))
}

impl Inspector {
    pub(super) fn select(&mut self, body: Option<BodyId>) {
        if self.body != body {
            *self = Inspector { body, scrolled: 0, ..*self };
        }
    }

    pub(super) fn toggle_state(&mut self) {
        (self.shows_state, self.scrolled) = (!self.shows_state, 0);
    }

    /// Upper left corner and maximum size of the panel, in pixels. `None` if there is nothing to show.
    fn area(&self, [width, height]: [f32; 2]) -> Option<([f32; 2], [f32; 2])> {
        let wide = width_of("x", 1.0) * COLUMNS as f32;
        let is_open = self.body.is_some() || self.shows_state;
        is_open.then(|| ([(width - wide - 12.0).max(0.0), 12.0], [wide, (height - 90.0).max(CELL_HEIGHT)]))
    }

    /// Whether a position is on the panel as it was last drawn.
    pub(super) fn holds(&self, at: [f32; 2], size: [f32; 2]) -> bool {
        let height = CELL_HEIGHT * self.drawn as f32;
        self.area(size).is_some_and(|([x, y], [width, _])| {
            (x..x + width).contains(&at[0]) && (y..y + height).contains(&at[1])
        })
    }

    pub(super) fn scroll(&mut self, notches: f32) {
        let lines = (notches.abs() * 3.0).ceil() as usize;
        self.scrolled = match notches > 0.0 {
            true => self.scrolled.saturating_sub(lines),
            false => self.scrolled.saturating_add(lines),
        };
    }

    pub(super) fn draw(&mut self, list: &mut DrawList, source: &mut dyn Source, size: [f32; 2]) {
        let Some((corner, [width, height])) = self.area(size) else { return };
        let mut lines = self.body.map(|id| describe(source.world(), id)).unwrap_or_default();
        if self.shows_state {
            let state = source.state();
            let heading =
                if state.is_empty() { "the game has no state of its own" } else { "state of the game" };
            lines.push((heading.into(), String::new()));
            lines.extend(state);
        }
        let rows = (height / CELL_HEIGHT) as usize;
        self.scrolled = self.scrolled.min(lines.len().saturating_sub(rows));
        let shown = lines.iter().skip(self.scrolled).take(rows);
        self.drawn = shown.len();
        theme::panel(list, corner, [width, CELL_HEIGHT * self.drawn as f32]);
        for (row, (name, value)) in shown.enumerate() {
            let y = corner[1] + row as f32 * CELL_HEIGHT;
            let colour = if value.is_empty() { theme::ACCENT } else { theme::FAINT };
            list.text([corner[0], y], 1.0, colour, clipped(name, COLUMNS));
            let left = name.chars().count() + 1;
            let value = clipped(value, COLUMNS.saturating_sub(left));
            list.text([corner[0] + width_of("x", 1.0) * left as f32, y], 1.0, theme::INK, value);
        }
    }
}

/// Lists the fields of a body and its shapes, then its contacts and joints. A heading has an empty value.
pub(super) fn describe(world: &World, id: BodyId) -> Vec<(String, String)> {
    let Some(body) = world.body(id) else {
        return vec![(format!("body {id} does not exist at this tick"), String::new())];
    };
    let mut lines = vec![(format!("body {}", world.body_label(id)), String::new())];
    add_fields(&mut lines, body);
    // The fields contain the angular velocity only as a scaled value, the speed at the radius of gyration.
    let bits = body.angular_velocity().to_bits().into();
    lines.push(("angular_velocity".into(), Value::Fixed { bits, fraction_bits: Some(32) }.to_string()));
    for &shape in body.shapes() {
        lines.push((format!("shape {shape}"), String::new()));
        world.shape(shape).into_iter().for_each(|shape| add_fields(&mut lines, shape));
    }
    let of_body = |shape: ShapeId| world.shape(shape).is_some_and(|shape| shape.body() == id);
    for contact in world.contacts().filter(|contact| of_body(contact.shape_a) || of_body(contact.shape_b)) {
        lines.push((format!("contact of shapes {} and {}", contact.shape_a, contact.shape_b), String::new()));
        for (point, force) in contact.forces() {
            let millimetres = widen(point.separation).saturating_mul_int(1000);
            let (normal, friction) = (force.normal, force.friction);
            let value = format!("{millimetres:.3} mm apart, {normal:.2} N, {friction:.2} N friction");
            lines.push(("point".into(), value));
        }
    }
    for (joint, known) in
        world.joints().filter(|(_, joint)| joint.def().bodies().0 == id || joint.def().bodies().1 == id)
    {
        lines.push((format!("joint {joint}"), String::new()));
        if let Some(error) = world.joint_error(joint) {
            let unit = if world.joint_error_is_angle(joint) == Some(true) { "mrad" } else { "mm" };
            lines.push(("error".into(), format!("{:.3} {unit}", error.saturating_mul_int(1000))));
        }
        if let Some((Vec2 { x, y }, torque)) = world.joint_force(joint) {
            lines.push(("force".into(), format!("({x:.2}, {y:.2}) N, {torque:.2} N m")));
        }
        add_fields(&mut lines, known);
    }
    lines
}

fn add_fields(lines: &mut Vec<(String, String)>, value: &impl serde::Serialize) {
    let found = fields(value).unwrap_or_default();
    lines.extend(found.iter().map(|field| (field.path().to_string(), field.value.to_string())));
}

fn clipped(text: &str, columns: usize) -> String {
    text.chars().take(columns).collect()
}

#[cfg(test)]
mod tests {
    use lockstep2d::body::{BodyDef, Geometry, ShapeDef, WorldError};
    use lockstep2d::fx;
    use lockstep2d::solver::{Gear, JointDef};

    use super::*;

    /// The value of the line "error" of a body with a gear.
    fn error_of(gear: Gear) -> Result<Option<String>, WorldError> {
        let mut world = World::default();
        let disc = ShapeDef::new(Geometry::circle(fx!(0.5))?);
        let a = world.spawn(&BodyDef::dynamic(), std::slice::from_ref(&disc))?;
        let b = world.spawn(&BodyDef::dynamic().position((fx!(3), fx!(0))), &[disc])?;
        world.add_joint(&JointDef::new(a, b, gear))?;
        Ok(describe(&world, a).into_iter().find(|(name, _)| name == "error").map(|(_, value)| value))
    }

    #[test]
    fn an_error_that_is_an_angle_is_in_radians() {
        let errors = [Gear::new(20, -20), Gear::new(20, 40)].map(|gear| error_of(gear).unwrap().unwrap());
        assert_eq!(errors, ["0.000 mrad", "0.000 mm"]);
    }
}
