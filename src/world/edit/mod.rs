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
use crate::body::{Body, Handle, MassProperties, ShapeDef, WorldError};
use crate::math::{Fx, Vec2, fx_mul};

impl World {
    fn shape_defs<'a>(&'a self, body: &'a Body) -> impl Iterator<Item = &'a ShapeDef> + Clone {
        body.shapes.iter().map(|id| self.state.shapes.at(id.slot()).def())
    }

    /// Checks speeds in m/s and rad/s against the limit. The radius of gyration is in metres.
    fn check_velocity(&self, velocity: Vec2<Fx>, angular: Fx, gyration: Fx) -> Result<(), WorldError> {
        let max = self.state.config.solver.speed_limit(self.state.config.tick_rate);
        for value in [velocity.length(), fx_mul(angular.saturating_abs(), gyration)] {
            if value > max {
                return Err(WorldError::SpeedOutOfRange { value, max });
            }
        }
        Ok(())
    }

    fn check_spin(&self, body: &Body, mass: &MassProperties) -> Result<(), WorldError> {
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
