//! Pushing and moving bodies between ticks. Each of these wakes the body.

use alloc::boxed::Box;

use super::World;
use super::islands;
use crate::body::{Body, BodyId, BodyKind, Handle, Pose, WorldError, check_position};
use crate::math::{Angle, Fx, Vec2};

impl World {
    /// Pushes a dynamic body with a force in N at a world point during the next tick. Forces add up, and are
    /// gone after the tick.
    ///
    /// # Errors
    /// When the handle is stale, or the body is not dynamic or is disabled.
    pub fn apply_force(&mut self, id: BodyId, force: Vec2<Fx>, point: Vec2<Fx>) -> Result<(), WorldError> {
        self.dynamic_body(id)?.apply_force(force, point);
        Ok(())
    }

    /// Pushes a dynamic body with a force in N at its centre of mass during the next tick.
    ///
    /// # Errors
    /// When the handle is stale, or the body is not dynamic or is disabled.
    pub fn apply_force_to_centre(&mut self, id: BodyId, force: Vec2<Fx>) -> Result<(), WorldError> {
        let body = self.dynamic_body(id)?;
        body.apply_force(force, body.centre);
        Ok(())
    }

    /// Turns a dynamic body with a torque in N m during the next tick.
    ///
    /// # Errors
    /// When the handle is stale, or the body is not dynamic or is disabled.
    pub fn apply_torque(&mut self, id: BodyId, torque: Fx) -> Result<(), WorldError> {
        let body = self.dynamic_body(id)?;
        body.torque = body.torque.saturating_add(torque);
        Ok(())
    }

    /// Changes a dynamic body's velocity at once by an impulse in N s at a world point.
    ///
    /// # Errors
    /// When the handle is stale, or the body is not dynamic or is disabled.
    pub fn apply_impulse(
        &mut self,
        id: BodyId,
        impulse: Vec2<Fx>,
        point: Vec2<Fx>,
    ) -> Result<(), WorldError> {
        self.dynamic_body(id)?.apply_impulse(impulse, point);
        Ok(())
    }

    /// Changes a dynamic body's velocity at once by an impulse in N s at its centre of mass.
    ///
    /// # Errors
    /// When the handle is stale, or the body is not dynamic or is disabled.
    pub fn apply_impulse_to_centre(&mut self, id: BodyId, impulse: Vec2<Fx>) -> Result<(), WorldError> {
        let body = self.dynamic_body(id)?;
        body.apply_impulse(impulse, body.centre);
        Ok(())
    }

    /// Changes a dynamic body's angular velocity at once by an angular impulse in N m s.
    ///
    /// # Errors
    /// When the handle is stale, or the body is not dynamic or is disabled.
    pub fn apply_angular_impulse(&mut self, id: BodyId, impulse: Fx) -> Result<(), WorldError> {
        self.dynamic_body(id)?.apply_angular_impulse(impulse);
        Ok(())
    }

    /// Sets the velocity of a body's centre of mass in m/s and its angular velocity in rad/s.
    ///
    /// # Errors
    /// When the handle is stale, the body is fixed, or a speed is above [`crate::solver::SolverSettings::speed_max`].
    pub fn set_velocity(&mut self, id: BodyId, velocity: Vec2<Fx>, angular: Fx) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if body.kind() == BodyKind::Fixed {
            return Err(WorldError::WrongKind(id));
        }
        self.check_velocity(velocity, angular, body.radius_of_gyration())?;
        islands::wake_body(&mut self.state, &mut self.scratch, id.slot());
        let body = self.state.bodies.at_mut(id.slot());
        let was_moving = body.is_moving();
        body.target = None;
        body.velocity = velocity.narrow();
        body.set_angular_velocity(angular);
        body.hold_locked_axes();
        if !body.is_dynamic() && body.is_moving() && !was_moving {
            self.wake_joined(id);
        }
        Ok(())
    }

    /// Moves a kinematic body so that its origin is at a position, turned to an angle, after the next tick, by the
    /// velocity that takes it there; it then stops, unless it is given another target. What it meets is pushed, as
    /// by any kinematic body. Of the two ways to turn, it takes the shorter one.
    ///
    /// # Errors
    /// When the handle is stale, the body is not kinematic, the position is out of range, or it is too far away to
    /// be reached below [`crate::solver::SolverSettings::speed_max`].
    pub fn move_to(&mut self, id: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<(), WorldError> {
        check_position(position)?;
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if body.kind() != BodyKind::Kinematic {
            return Err(WorldError::WrongKind(id));
        }
        let rate = i64::from(self.state.config.tick_rate);
        let mut there = body.clone();
        there.set_transform(position, angle);
        let (shift, turn) = (there.centre - body.centre, (angle - body.angle).to_radians());
        let velocity = Vec2::new(shift.x.saturating_mul_int(rate), shift.y.saturating_mul_int(rate));
        let angular = if body.turns() { turn.saturating_mul_int(rate) } else { Fx::ZERO };
        self.set_velocity(id, velocity, angular)?;
        let body = self.state.bodies.at_mut(id.slot());
        if body.is_moving() {
            body.target = Some(Box::new(Pose { centre: there.centre, angle }));
            body.hold_locked_axes();
        }
        Ok(())
    }

    /// Moves a body's origin to a position, turned to an angle, without regard to what is in between. Its
    /// contacts and joints keep their impulses if they last.
    ///
    /// # Errors
    /// When the handle is stale or the position out of range.
    pub fn set_transform(&mut self, id: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<(), WorldError> {
        check_position(position)?;
        self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        self.wake_joined(id);
        let body = self.state.bodies.at_mut(id.slot());
        body.target = None;
        body.set_transform(position, angle);
        self.replace(id.slot());
        islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        Ok(())
    }

    /// A dynamic body that has been woken, to be pushed.
    pub(super) fn dynamic_body(&mut self, id: BodyId) -> Result<&mut Body, WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if !body.is_dynamic() || !body.enabled {
            return Err(WorldError::WrongKind(id));
        }
        islands::wake_body(&mut self.state, &mut self.scratch, id.slot());
        Ok(self.state.bodies.at_mut(id.slot()))
    }
}
