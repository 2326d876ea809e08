//! Bodies.

use alloc::boxed::Box;

use serde::{Deserialize, Serialize};

use super::arena::{IslandId, ShapeId};
use super::body_def::{BodyDef, BodyKind};
use super::mass::{MassProperties, MassSource};
use super::name::Name;
use super::rest_ticks::RestTicks;
use super::settings::BodySettings;
use super::shape_list::{self, ShapeList};
use crate::math::{
    Angle, Fx, Rot, Speed, Transform, Vec2, div_round, fx_mul, narrow, saturate, saturate_wide, widen,
};

/// Limit in m/s of each velocity component and of `Body::spin`. The difference of two such values fits [`Speed`].
pub(crate) const SPEED_MAX: Speed = Speed::lit("511");

/// Centre of mass in the world, and rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Pose {
    pub(crate) centre: Vec2<Fx>,
    pub(crate) angle: Angle,
}

/// A body in the world.
///
/// ```
/// # use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
/// # use lockstep2d::world::World;
/// use lockstep2d::{body::Body, fx, math::Vec2};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let id = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(3))), &[square])?;
/// world.step();
/// let body: &Body = world.body(id).expect("it was just created");
/// assert!(body.position().y < fx!(3) && body.velocity().y < fx!(0));
/// assert_eq!(body.mass(), fx!(1));
/// // Bodies are changed through methods of the world, which validate their arguments.
/// world.set_velocity(id, Vec2::new(fx!(2), fx!(0)), fx!(0))?;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[doc(alias = "RigidBody")]
#[doc(alias = "rigid_body")]
pub struct Body {
    pub(crate) kind: BodyKind,
    /// Centre of mass in the world.
    #[serde(rename = "centre_of_mass")]
    pub(crate) centre: Vec2<Fx>,
    pub(crate) angle: Angle,
    pub(crate) velocity: Vec2<Speed>,
    /// The radius of gyration times the angular velocity, `u = k w`, in m/s.
    pub(crate) spin: Speed,
    /// Applied force in N. Cleared at the end of the next tick.
    pub(crate) force: Vec2<Fx>,
    /// Applied torque about the centre of mass in N m. Cleared at the end of the next tick.
    pub(crate) torque: Fx,
    /// Boxed, like `target`, so that the fields that every step reads lie close together.
    pub(crate) mass_source: Box<MassSource>,
    pub(crate) mass: MassProperties,
    pub(crate) settings: BodySettings,
    pub(crate) enabled: bool,
    pub(crate) rest_ticks: RestTicks,
    pub(crate) island: Option<IslandId>,
    /// Pose that a kinematic body reaches in the next tick, if one was set.
    pub(crate) target: Option<Box<Pose>>,
    #[serde(with = "shape_list")]
    pub(crate) shapes: ShapeList,
    pub(crate) user_data: u64,
    /// Boxed, because few bodies have one.
    pub(crate) name: Option<Box<Name>>,
}

impl Body {
    pub(crate) fn new(def: &BodyDef, mass: MassProperties) -> Self {
        let mut body = Body {
            kind: def.kind,
            centre: def.position,
            angle: def.angle,
            velocity: def.velocity.narrow(),
            spin: Speed::ZERO,
            force: Vec2::ZERO,
            torque: Fx::ZERO,
            mass_source: Box::new(def.mass),
            mass,
            settings: def.settings,
            enabled: def.enabled,
            rest_ticks: RestTicks::NONE,
            island: None,
            target: None,
            shapes: ShapeList::new(),
            user_data: def.user_data,
            name: def.name.map(Box::new),
        };
        body.set_angular_velocity(def.angular_velocity);
        body.hold_locked_axes();
        body.set_transform(def.position, def.angle);
        body
    }

    pub(crate) fn pose(&self) -> Pose {
        Pose { centre: self.centre, angle: self.angle }
    }

    /// Kind of motion of the body.
    #[must_use]
    pub const fn kind(&self) -> BodyKind {
        self.kind
    }

    /// Whether the body is dynamic.
    #[must_use]
    pub const fn is_dynamic(&self) -> bool {
        matches!(self.kind, BodyKind::Dynamic)
    }

    /// Origin of the body in the world, in metres.
    #[must_use]
    pub fn position(&self) -> Vec2<Fx> {
        // This common case needs no sine.
        if self.mass.centre == Vec2::ZERO {
            return self.centre;
        }
        self.centre - self.rotation().apply_wide(self.mass.centre)
    }

    /// Centre of mass in the world, in metres.
    #[must_use]
    pub const fn centre_of_mass(&self) -> Vec2<Fx> {
        self.centre
    }

    /// Centre of mass in the body's frame, in metres.
    #[must_use]
    pub const fn local_centre_of_mass(&self) -> Vec2<Fx> {
        self.mass.centre
    }

    /// Rotation of the body.
    #[must_use]
    pub const fn angle(&self) -> Angle {
        self.angle
    }

    /// Cosine and sine of the rotation.
    #[must_use]
    pub fn rotation(&self) -> Rot {
        Rot::from_angle(self.angle)
    }

    /// Transform from the body's frame to the world.
    #[must_use]
    pub fn transform(&self) -> Transform {
        Transform::new(self.position(), self.rotation())
    }

    /// Velocity of the centre of mass in m/s. Zero after a step in which `World::move_to` has moved the body.
    #[must_use]
    pub fn velocity(&self) -> Vec2<Fx> {
        self.velocity.widen()
    }

    /// Angular velocity in rad/s, counter-clockwise.
    #[must_use]
    pub fn angular_velocity(&self) -> Fx {
        divide(widen(self.spin), self.mass.gyration)
    }

    /// Velocity in m/s of the material at a world position. 0 after a step in which `World::move_to` moved the body.
    #[must_use]
    pub fn velocity_at(&self, point: Vec2<Fx>) -> Vec2<Fx> {
        self.velocity() + (point - self.centre).perp().scale(self.angular_velocity())
    }

    /// Mass in kg. 0 for bodies that are not dynamic, and for dynamic bodies [without mass](super::MassSource::Shapes).
    #[must_use]
    pub const fn mass(&self) -> Fx {
        self.mass.mass
    }

    /// Whether forces and impulses change the body's velocity.
    pub(crate) fn has_mass(&self) -> bool {
        self.mass.mass > 0
    }

    /// Moment of inertia about the centre of mass in kg m². 0 if the mass is 0.
    #[must_use]
    pub fn inertia(&self) -> Fx {
        self.mass.inertia()
    }

    /// Radius of gyration in metres, `sqrt(inertia / mass)`. 4 m if the mass is 0.
    #[must_use]
    pub const fn radius_of_gyration(&self) -> Fx {
        self.mass.gyration
    }

    /// Kinetic energy in J.
    #[must_use]
    pub fn kinetic_energy(&self) -> Fx {
        let v = self.velocity();
        let u = widen(self.spin);
        let squared = v.dot(v).saturating_add(fx_mul(u, u));
        let doubled = fx_mul(self.mass.mass, squared);
        if doubled == Fx::MAX { fx_mul(self.mass.mass, squared / 2) } else { doubled / 2 }
    }

    /// Shapes in order of attachment.
    #[must_use]
    pub fn shapes(&self) -> &[ShapeId] {
        &self.shapes
    }

    /// Settings of the body.
    #[must_use]
    pub const fn settings(&self) -> &BodySettings {
        &self.settings
    }

    /// Whether the body takes part in the simulation.
    #[must_use]
    pub const fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// Whether the body is asleep: at rest, and not simulated until something wakes it.
    #[must_use]
    pub const fn is_asleep(&self) -> bool {
        self.island.is_some()
    }

    /// Sleeping island of the body. `None` while it is awake.
    #[must_use]
    pub const fn island(&self) -> Option<IslandId> {
        self.island
    }

    /// Whether the body can start or change contacts. A kinematic body stays active for one tick after it has come to
    /// rest, so that its final pose is processed.
    pub(crate) fn is_active(&self) -> bool {
        match self.kind {
            BodyKind::Fixed => false,
            BodyKind::Kinematic => !self.rest_ticks.has_settled() || self.is_moving(),
            BodyKind::Dynamic => self.enabled && self.island.is_none(),
        }
    }

    pub(crate) fn is_moving(&self) -> bool {
        self.velocity != Vec2::ZERO || self.spin != 0
    }

    /// User data.
    #[must_use]
    pub const fn user_data(&self) -> u64 {
        self.user_data
    }

    /// Name for reports.
    #[must_use]
    pub fn name(&self) -> Option<Name> {
        self.name.as_deref().copied()
    }

    pub(crate) fn set_transform(&mut self, position: Vec2<Fx>, angle: Angle) {
        self.angle = angle;
        self.centre = position + self.rotation().apply_wide(self.mass.centre);
    }

    pub(crate) fn set_angular_velocity(&mut self, omega: Fx) {
        self.spin = if self.turns() { narrow(fx_mul(omega, self.mass.gyration)) } else { Speed::ZERO };
    }

    /// Changes the mass, but not the position, the motion or the lines of action of forces. Clamps the new velocity.
    pub(crate) fn set_mass(&mut self, mass: MassProperties) {
        let (position, angle, omega) = (self.position(), self.angle, self.angular_velocity());
        let old_centre = self.centre;
        self.mass = mass;
        self.set_transform(position, angle);
        self.set_angular_velocity(omega);
        let moved = self.centre - old_centre;
        self.torque = self.torque.saturating_sub(moved.cross(self.force));
        self.velocity = (self.velocity() + moved.perp().scale(omega)).narrow();
        self.clamp_velocity();
    }

    /// Clears the velocity along locked axes, and sets the kinematic target to the current pose along these axes.
    pub(crate) fn hold_locked_axes(&mut self) {
        let (turns, locks) = (self.turns(), self.settings.locks);
        if locks.x {
            self.velocity.x = Speed::ZERO;
        }
        if locks.y {
            self.velocity.y = Speed::ZERO;
        }
        let Some(target) = &mut self.target else { return };
        if locks.x {
            target.centre.x = self.centre.x;
        }
        if locks.y {
            target.centre.y = self.centre.y;
        }
        if !turns {
            target.angle = self.angle;
        }
    }

    /// Drops the target of [`World::move_to`](crate::world::World::move_to), and the velocity towards it.
    pub(crate) fn drop_target(&mut self) {
        if self.target.take().is_some() {
            self.stop();
        }
    }

    pub(crate) fn stop(&mut self) {
        self.velocity = Vec2::ZERO;
        self.spin = Speed::ZERO;
    }

    /// Clamps velocity components to ±[`SPEED_MAX`], and clears the velocity along locked axes.
    fn clamp_velocity(&mut self) {
        let clamp = |speed: Speed| speed.clamp(-SPEED_MAX, SPEED_MAX);
        self.velocity = Vec2::new(clamp(self.velocity.x), clamp(self.velocity.y));
        self.spin = clamp(self.spin);
        self.hold_locked_axes();
    }

    /// Adds a force in N at a world point for the next tick.
    pub(crate) fn apply_force(&mut self, force: Vec2<Fx>, point: Vec2<Fx>) {
        self.force += force;
        self.torque = self.torque.saturating_add((point - self.centre).cross(force));
    }

    /// Applies an impulse in N s at a world point: `dv = P / m`, `du = r x P / (m k)`. Shortens a velocity above
    /// [`SPEED_MAX`] and keeps its direction.
    pub(crate) fn apply_impulse(&mut self, impulse: Vec2<Fx>, point: Vec2<Fx>) {
        let dv = Vec2::new(divide(impulse.x, self.mass.mass), divide(impulse.y, self.mass.mass));
        self.velocity = (self.velocity() + dv).shortened(SPEED_MAX.into()).narrow();
        let arm = point - self.centre;
        let product = |a: Fx, b: Fx| i128::from(a.to_bits()) * i128::from(b.to_bits());
        self.turn_by(product(arm.x, impulse.y).saturating_sub(product(arm.y, impulse.x)));
    }

    /// Applies an angular impulse in N m s.
    pub(crate) fn apply_angular_impulse(&mut self, impulse: Fx) {
        self.turn_by(i128::from(impulse.to_bits()) << 32);
    }

    /// Applies an angular impulse in N m s, with 64 fraction bits, and clamps the velocity.
    fn turn_by(&mut self, impulse: i128) {
        if self.turns() && self.has_mass() {
            let over = i128::from(self.mass.mass.to_bits()) * i128::from(self.mass.gyration.to_bits());
            // `du` is in units of 2^-21. If `impulse << 21` would overflow, the divisor gives up the missing bits.
            let room = impulse.unsigned_abs().leading_zeros().saturating_sub(1).min(21);
            let du = saturate_wide(div_round(impulse << room, over >> (21 - room)));
            self.spin = self.spin.saturating_add(Speed::from_bits(saturate(du)));
        }
        self.clamp_velocity();
    }

    /// Changes of `v` and `u` in a sub-step of `1 / rate` s by the applied force and torque: `dv = F / (m rate)`,
    /// `du = torque / (m k rate)`. `dv` is in raw units of [`Speed`] and may exceed the range of that format.
    pub(crate) fn acceleration_step(&self, rate: u32) -> ([i64; 2], Speed) {
        self.step_by(self.force, self.torque, rate)
    }

    /// [`Self::acceleration_step`] with an additional force in N and an additional torque in N m.
    pub(crate) fn step_with(&self, force: Vec2<Fx>, torque: Fx, rate: u32) -> ([i64; 2], Speed) {
        self.step_by(self.force + force, self.torque.saturating_add(torque), rate)
    }

    fn step_by(&self, force: Vec2<Fx>, torque: Fx, rate: u32) -> ([i64; 2], Speed) {
        let is_turned = torque != Fx::ZERO && self.turns();
        let around = if is_turned { divide(torque, self.mass.gyration) } else { Fx::ZERO };
        let [x, y, du] = [force.x, force.y, around].map(|force| over_mass(force, self.mass.mass, rate));
        ([x, y], Speed::from_bits(saturate(du)))
    }
}

/// `a / b`, rounded to nearest and saturated. 0 if `b` is 0, as for a body without mass.
fn divide(a: Fx, b: Fx) -> Fx {
    crate::math::fx_div(a, b).unwrap_or(Fx::ZERO)
}

/// `force / (mass rate)` in raw units of [`Speed`], rounded to nearest. 0 if the mass is 0.
fn over_mass(force: Fx, mass: Fx, rate: u32) -> i64 {
    if force == Fx::ZERO || mass == Fx::ZERO {
        return 0;
    }
    let bits = div_round(i128::from(force.to_bits()) << 21, i128::from(mass.to_bits()) * i128::from(rate));
    saturate_wide(bits)
}
