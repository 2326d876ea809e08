//! Areas: the effects of sensors with an [`Area`] on the bodies inside them.
//!
//! Forces are computed once per tick, for the poses that the velocities predict for the time `h (s - 1) / (2 s)` after
//! the start of the tick, where `h` is the length of the tick in seconds. This is the mean of the times at which its
//! `s` sub-steps begin. If forces were computed for the poses at the start of the tick, a spring of angular frequency
//! `omega`, such as a floating box, would gain the fraction `h^2 omega^2 (s - 1) / (2 s)` of its energy in each tick.

use crate::body::{Area, Attraction, Body, Falloff, Geometry, Handle, Shape, area_of};
use crate::collision::{Pair, RelativePose, Ring};
use crate::math::{Angle, Fx, Rot, Vec2, fx_div, fx_mul};
use crate::solver::{AreaEffect, Tuning};
use crate::world::cache::{Scratch, is_awake};
use crate::world::state::State;

/// Slots of a body, an area and a shape of the body inside the area. Effects are summed in the sorted order of these
/// triples.
type Visitor = [u32; 3];

/// Passes the effects of areas on awake bodies with mass to the solver. Must be called after `Solver::prepare_bodies`.
pub(super) fn apply_areas(state: &mut State, scratch: &mut Scratch, tuning: &Tuning) {
    if !scratch.shapes.motion().may_have_sensors() {
        return;
    }
    let mut visitors = core::mem::take(&mut scratch.area_visitors);
    visitors.clear();
    for contact in &state.contacts {
        let (a, b) = contact.shapes;
        for (area, shape) in [(a, b), (b, a)] {
            let is_sensor = scratch.shapes.motion().shape(area).sensor;
            if is_sensor && state.shapes.at(area).acts_on(state.shapes.at(shape)) {
                let body = state.shapes.at(shape).body().slot();
                if is_awake(state.bodies.at(body)) && state.bodies.at(body).has_mass() {
                    visitors.push([body, area, shape]);
                }
            }
        }
    }
    visitors.sort_unstable();
    for of_body in visitors.chunk_by(|a, b| a[0] == b[0]) {
        let [slot, ..] = of_body[0];
        let body = state.bodies.at(slot);
        let mut sum = Sum::new(state, body, tuning.mean_time);
        of_body.chunk_by(|a, b| a[1] == b[1]).for_each(|shapes| sum.add_area(shapes));
        let Sum { effect, is_on_moving_ground, .. } = sum.finished();
        scratch.solver.apply_areas(slot, body, &effect, tuning);
        if is_on_moving_ground {
            state.bodies.at_mut(slot).rest_ticks.reset();
        }
    }
    scratch.area_visitors = visitors;
}

/// Whether one shape of a pair is an area that acts on the other one, the other one belongs to a sleeping body, and the
/// two overlap. The area then wakes the body.
pub(super) fn wakes(state: &State, scratch: &Scratch, pair: Pair) -> bool {
    let is_acted_on = |area: u32, shape: u32| {
        state.shapes.at(area).acts_on(state.shapes.at(shape)) && state.body_of(shape).is_asleep()
    };
    let (a, b) = pair;
    (is_acted_on(a, b) || is_acted_on(b, a)) && scratch.shapes.poses().are_within(pair, Fx::ZERO)
}

/// The sum of the effects on one body.
struct Sum<'a> {
    state: &'a State,
    body: &'a Body,
    /// Predicted pose of the body, in coordinates whose origin is its predicted centre of mass.
    pose: RelativePose,
    /// Predicted centre of mass of the body, in world coordinates.
    centre: Vec2<Fx>,
    ahead: Fx,
    /// Area of all solid shapes in m², or the length of lines in m if the body has no area.
    size: Fx,
    has_area: bool,
    /// Mass of the displaced medium in kg.
    displaced: Fx,
    /// First moment of the displaced mass about the body's centre of mass, in kg m.
    moment: Vec2<Fx>,
    effect: AreaEffect,
    /// Sum of the accelerations by gravity and areas in m/s². They act on the medium as well as on the body, so they
    /// cause buoyancy.
    field: Vec2<Fx>,
    /// Whether one of the areas belongs to a moving kinematic body. The body must then not fall asleep.
    is_on_moving_ground: bool,
}

impl<'a> Sum<'a> {
    fn new(state: &'a State, body: &'a Body, ahead: Fx) -> Self {
        let solid =
            body.shapes().iter().map(|id| state.shapes.at(id.slot())).filter(|shape| !shape.is_sensor());
        let area: Fx = solid.clone().fold(Fx::ZERO, |sum, shape| sum.saturating_add(area_of(shape.def())));
        let has_area = area > 0;
        let pose = pose_of(body, Vec2::ZERO, ahead);
        let length = |shape: &Shape| Ring::of(shape.def(), &pose).extent().map_or(Fx::ZERO, |line| line.size);
        let size = if has_area { area } else { solid.map(length).fold(Fx::ZERO, Fx::saturating_add) };
        Sum {
            state,
            body,
            pose,
            centre: body.centre + body.velocity().scale(ahead),
            ahead,
            size,
            has_area,
            displaced: Fx::ZERO,
            moment: Vec2::ZERO,
            effect: AreaEffect::default(),
            field: state.config.gravity,
            is_on_moving_ground: false,
        }
    }

    fn add_area(&mut self, shapes: &[Visitor]) {
        let [_, area, _] = shapes[0];
        let area_shape = self.state.shapes.at(area);
        let Some(area) = area_shape.area() else { return };
        let medium = self.state.bodies.at(area_shape.body().slot());
        let centre = medium.centre + medium.velocity().scale(self.ahead);
        let pose = pose_of(medium, centre - self.centre, self.ahead);
        let ring = Ring::of(area_shape.def(), &pose);
        let mut inside = Fx::ZERO;
        for &[.., shape] in shapes {
            let shape = self.state.shapes.at(shape);
            let whole = Ring::of(shape.def(), &self.pose);
            let Some(all) = whole.extent() else { continue };
            let Some(part) = whole.inside(&ring).extent() else { continue };
            let size = match shape.geometry() {
                Geometry::Segment { .. } | Geometry::Link { .. } => {
                    if self.has_area {
                        Fx::ZERO
                    } else {
                        part.size
                    }
                }
                // Round outlines are approximated by polygons. The share of the polygon that is inside is multiplied by
                // the exact area of the shape.
                _ => fx_mul(area_of(shape.def()), fx_div(part.size, all.size).unwrap_or(Fx::ZERO)),
            };
            inside = inside.saturating_add(size);
            if self.has_area {
                self.add_forces(area, &pose, size, part.centre);
            }
        }
        let share = fx_div(inside, self.size).unwrap_or(Fx::ZERO).min(Fx::ONE);
        if share > 0 {
            self.add_share(area, area_shape, medium, &pose, share);
        }
    }

    /// Adds the forces on a part of `size` m² whose centre is at `arm` from the body's centre.
    fn add_forces(&mut self, area: &Area, pose: &RelativePose, size: Fx, arm: Vec2<Fx>) {
        let mass = fx_mul(area.density, size);
        self.displaced = self.displaced.saturating_add(mass);
        self.moment += arm.scale(mass);
        let force = pose.rotation.apply_wide(area.force).scale(size);
        self.effect.force += force;
        self.effect.torque = self.effect.torque.saturating_add(arm.cross(force));
    }

    /// Adds the effects on the whole body, scaled by the share of the body that is in the area.
    fn add_share(&mut self, area: &Area, shape: &Shape, medium: &Body, pose: &RelativePose, share: Fx) {
        let mut field = pose.rotation.apply_wide(area.acceleration);
        if let Some(attraction) = &area.attraction {
            field += pull(attraction, pose.point(shape.offset()));
        }
        let field = field.scale(share);
        self.field += field;
        let linear_drag = fx_mul(area.linear_drag, share);
        let angular_drag = fx_mul(area.angular_drag, share);
        let flow = medium.velocity_at(self.centre) + pose.rotation.apply_wide(area.flow);
        let effect = &mut self.effect;
        effect.acceleration += field + flow.scale(linear_drag);
        let turning = if medium.turns() { medium.angular_velocity() } else { Fx::ZERO };
        let turned = fx_mul(turning, angular_drag);
        effect.angular_acceleration = effect.angular_acceleration.saturating_add(turned);
        effect.linear_drag = effect.linear_drag.saturating_add(linear_drag);
        effect.angular_drag = effect.angular_drag.saturating_add(angular_drag);
        self.is_on_moving_ground |= !medium.is_dynamic() && medium.is_moving();
    }

    /// Adds buoyancy. Must be called after all areas are added, because buoyancy depends on the sum of their fields.
    fn finished(mut self) -> Self {
        debug_assert!(is_awake(self.body), "areas act on awake bodies");
        self.effect.force -= self.field.scale(self.displaced);
        let torque = self.moment.cross(self.field);
        self.effect.torque = self.effect.torque.saturating_sub(torque);
        self
    }
}

/// Predicted pose of a body after `ahead` seconds. `centre` is its predicted centre of mass.
fn pose_of(body: &Body, centre: Vec2<Fx>, ahead: Fx) -> RelativePose {
    let turned = Angle::from_radians(fx_mul(body.angular_velocity(), ahead));
    RelativePose {
        centre,
        rotation: Rot::from_angle(body.angle() + turned),
        local_centre: body.local_centre_of_mass(),
    }
}

/// Acceleration in m/s² by an attraction to the point `to`, which is in metres relative to the body's centre of mass.
fn pull(attraction: &Attraction, to: Vec2<Fx>) -> Vec2<Fx> {
    let Attraction { acceleration, radius, falloff } = *attraction;
    let Some((direction, distance)) = to.normalized_with_length() else { return Vec2::ZERO };
    let over = |a: Fx, b: Fx| fx_div(a, b).unwrap_or(Fx::ZERO);
    let factor = if distance < radius {
        over(distance, radius)
    } else {
        let ratio = over(radius, distance);
        match falloff {
            Falloff::Constant => Fx::ONE,
            Falloff::Inverse => ratio,
            Falloff::InverseSquare => fx_mul(ratio, ratio),
        }
    };
    direction.widen().scale(fx_mul(acceleration, factor))
}
