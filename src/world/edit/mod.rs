//! Changes to a world between ticks. Each change either happens or returns an error and leaves the world as it was.

mod command;
mod create;
mod destroy;
mod explosion;
mod fault;
mod forces;
mod joints;
mod setters;
mod settings;

pub use command::{Command, Outcome};
pub use create::BodyPose;
pub use explosion::Explosion;
pub use fault::BodyField;

use super::World;
use super::derived::fat_box;
use super::state::State;
use crate::body::{Body, Handle, MassProperties, Pose, ShapeDef, WorldError};
use crate::math::{Fx, Vec2, fx_mul};

/// Number of contacts whose shapes are compared in one work unit.
const SCANNED_PER_WORK: usize = 64;

impl World {
    /// Counts the work of a search of all contacts, including sleeping ones.
    fn spend_scan(&mut self) {
        let count = self.state.contacts.len() + self.state.sleeping_contacts.len();
        self.scratch.meter.spend(u64::try_from(count / SCANNED_PER_WORK).unwrap_or(u64::MAX));
    }

    /// Counts the work of [`State::end_manifolds`], and calls it.
    fn end_manifolds(&mut self, body: u32) {
        if !self.state.bodies.at(body).shapes().is_empty() {
            self.spend_scan();
            self.state.end_manifolds(body);
        }
    }

    fn shape_defs<'a>(&'a self, body: &'a Body) -> impl Iterator<Item = &'a ShapeDef> + Clone {
        body.shapes.iter().map(|id| self.state.shapes.at(id.slot()).def())
    }

    /// Checks a velocity in m/s and an angular velocity in rad/s against the speed limit. The radius of gyration is in
    /// metres.
    fn check_velocity(&self, velocity: Vec2<Fx>, angular: Fx, gyration: Fx) -> Result<(), WorldError> {
        check_speeds([velocity.length(), fx_mul(angular.saturating_abs(), gyration)], self.speed_limit())
    }

    fn speed_limit(&self) -> Fx {
        self.state.config.solver.speed_limit(self.state.config.tick_rate)
    }

    /// Checks the angular velocity of a body against the speed limit, for the radius of gyration that the body will
    /// have.
    fn check_spin(&self, body: &Body, mass: &MassProperties) -> Result<(), WorldError> {
        if body.mass == *mass {
            return Ok(());
        }
        self.check_velocity(Vec2::ZERO, body.angular_velocity(), mass.gyration)
    }

    /// Gives new fat boxes to the shapes of a body after an edit, and updates the caches.
    fn refit_body(&mut self, slot: u32) {
        let State { bodies, shapes, config, .. } = &mut *self.state;
        let body = bodies.at(slot);
        for shape in &body.shapes {
            // `redefine`, not `at_mut`: the body may have been fixed until now, and snapshots store fat boxes of fixed
            // bodies in pages.
            let shape = shapes.redefine(shape.slot());
            shape.fat = fat_box(&shape.def, body, config);
        }
        self.scratch.update_body(&self.state, slot);
        self.scratch.pairs.changes.sleeping_contacts_changed();
    }
}

/// Checks speeds in m/s.
fn check_speeds(speeds: [Fx; 2], max: Fx) -> Result<(), WorldError> {
    let too_fast = speeds.into_iter().find(|&speed| speed > max);
    too_fast.map_or(Ok(()), |value| Err(WorldError::SpeedOutOfRange { value, max }))
}

/// The velocity in m/s and the angular velocity in rad/s with which a body reaches a pose in one tick.
fn velocity_to(body: &Body, target: &Pose, tick_rate: u32) -> (Vec2<Fx>, Fx) {
    let rate = i64::from(tick_rate);
    let (shift, turn) = (target.centre - body.centre, (target.angle - body.angle).to_radians());
    let velocity = Vec2::new(shift.x.saturating_mul_int(rate), shift.y.saturating_mul_int(rate));
    (velocity, if body.turns() { turn.saturating_mul_int(rate) } else { Fx::ZERO })
}
