//! Forces, impulses, velocities and poses of bodies. Each change wakes the body, unless the new velocity of a kinematic
//! body is 0.

use alloc::boxed::Box;

use super::velocity_to;
use crate::body::{Body, BodyId, BodyKind, Handle, Pose, WorldError, check_position};
use crate::fx;
use crate::math::{Angle, Fx, Vec2};
use crate::world::World;
use crate::world::islands::{wake_body, wake_joined, wake_overlapping};

/// Smallest displacement along an axis, in metres, at which [`World::set_transform`] drops the kept manifolds of the
/// body's contacts. Kept manifolds cannot be used after long displacements, which they measure only modulo 1024 m.
const KEPT_MOVE_MAX: Fx = fx!(1);

impl World {
    /// Applies a force in N at a world point, in metres, to a dynamic body for the next tick. Forces add up, and so do
    /// their torques about the centre of mass. The sum of forces saturates at ±2^31 N along each axis, the sum of
    /// torques at ±2^31 N m. The resolutions are 2^-32 N and 2^-32 N m.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, or the body is disabled or not dynamic.
    pub fn apply_force(
        &mut self,
        id: BodyId,
        force: impl Into<Vec2<Fx>>,
        point: impl Into<Vec2<Fx>>,
    ) -> Result<(), WorldError> {
        let (force, point) = (force.into(), point.into());
        self.dynamic_body(id)?.apply_force(force, point);
        Ok(())
    }

    /// Like [`World::apply_force`], at the body's centre of mass.
    ///
    /// # Errors
    /// The errors of [`World::apply_force`].
    pub fn apply_force_to_centre(
        &mut self,
        id: BodyId,
        force: impl Into<Vec2<Fx>>,
    ) -> Result<(), WorldError> {
        let force = force.into();
        let body = self.dynamic_body(id)?;
        body.apply_force(force, body.centre);
        Ok(())
    }

    /// Applies a torque in N m to a dynamic body for the next tick. Torques add up.
    ///
    /// # Errors
    /// The errors of [`World::apply_force`].
    pub fn apply_torque(&mut self, id: BodyId, torque: Fx) -> Result<(), WorldError> {
        let body = self.dynamic_body(id)?;
        body.torque = body.torque.saturating_add(torque);
        Ok(())
    }

    /// Changes the velocity of a dynamic body by an impulse in N s at a world point, in metres. The next tick limits
    /// the speed: see [`crate::solver::SolverSettings::speed_max`].
    ///
    /// # Errors
    /// The errors of [`World::apply_force`].
    pub fn apply_impulse(
        &mut self,
        id: BodyId,
        impulse: impl Into<Vec2<Fx>>,
        point: impl Into<Vec2<Fx>>,
    ) -> Result<(), WorldError> {
        let (impulse, point) = (impulse.into(), point.into());
        self.dynamic_body(id)?.apply_impulse(impulse, point);
        Ok(())
    }

    /// Like [`World::apply_impulse`], at the body's centre of mass.
    ///
    /// # Errors
    /// The errors of [`World::apply_impulse`].
    pub fn apply_impulse_to_centre(
        &mut self,
        id: BodyId,
        impulse: impl Into<Vec2<Fx>>,
    ) -> Result<(), WorldError> {
        let impulse = impulse.into();
        let body = self.dynamic_body(id)?;
        body.apply_impulse(impulse, body.centre);
        Ok(())
    }

    /// Changes the angular velocity of a dynamic body by an angular impulse in N m s.
    ///
    /// # Errors
    /// The errors of [`World::apply_force`].
    pub fn apply_angular_impulse(&mut self, id: BodyId, impulse: Fx) -> Result<(), WorldError> {
        self.dynamic_body(id)?.apply_angular_impulse(impulse);
        Ok(())
    }

    /// Sets the velocity of a body's centre of mass in m/s and its angular velocity in rad/s.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the body is fixed, or a speed exceeds the limit: see
    /// [`speed_max`](crate::solver::SolverSettings::speed_max).
    pub fn set_velocity(
        &mut self,
        id: BodyId,
        velocity: impl Into<Vec2<Fx>>,
        angular: Fx,
    ) -> Result<(), WorldError> {
        let velocity = velocity.into();
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if body.kind() == BodyKind::Fixed {
            return Err(WorldError::WrongKind(id));
        }
        self.check_velocity(velocity, angular, body.radius_of_gyration())?;
        let body = self.state.bodies.at_mut(id.slot());
        body.target = None;
        body.velocity = velocity.narrow();
        body.set_angular_velocity(angular);
        body.hold_locked_axes();
        let (is_dynamic, moves) = (body.is_dynamic(), body.is_moving());
        // A kinematic body whose new velocity is 0 wakes no body.
        if is_dynamic || moves {
            wake_body(&mut self.state, &mut self.scratch, id.slot());
        }
        if !is_dynamic && moves {
            wake_joined(&mut self.state, &mut self.scratch, id);
        }
        Ok(())
    }

    /// Sets the pose that a kinematic body reaches in the next tick: the position of its origin in metres, and its
    /// rotation. The body pushes dynamic bodies on its way, and stops at the target unless it gets another target. The
    /// body rotates in the direction of the smaller angle. Until the next step, [`Body::velocity`] is the velocity with
    /// which the body reaches the target. After the step it is 0, even if the body gets a target in every tick. A
    /// target equal to the current pose wakes no body.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the body is not kinematic, the position is out of range, or the pose is
    /// out of reach at the speed limit: see [`speed_max`](crate::solver::SolverSettings::speed_max).
    #[doc(alias = "set_target_transform")]
    #[doc(alias = "move_kinematic")]
    pub fn move_to(
        &mut self,
        id: BodyId,
        position: impl Into<Vec2<Fx>>,
        angle: Angle,
    ) -> Result<(), WorldError> {
        let position = position.into();
        check_position(position)?;
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if body.kind() != BodyKind::Kinematic {
            return Err(WorldError::WrongKind(id));
        }
        let mut there = body.clone();
        there.set_transform(position, angle);
        let target = Pose { centre: there.centre, angle };
        let (velocity, angular) = velocity_to(body, &target, self.state.config.tick_rate);
        self.set_velocity(id, velocity, angular)?;
        let body = self.state.bodies.at_mut(id.slot());
        if body.is_moving() {
            body.target = Some(Box::new(target));
            body.hold_locked_axes();
        }
        Ok(())
    }

    /// Teleports a body: sets the position of its origin in metres, and its rotation. Contacts and joints that still
    /// exist afterwards keep their impulses for warm starting. Cancels a target of [`World::move_to`], with the
    /// velocity towards it.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale or the position is out of range.
    #[doc(alias = "teleport")]
    #[doc(alias = "set_position")]
    pub fn set_transform(
        &mut self,
        id: BodyId,
        position: impl Into<Vec2<Fx>>,
        angle: Angle,
    ) -> Result<(), WorldError> {
        let position = position.into();
        check_position(position)?;
        self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        wake_joined(&mut self.state, &mut self.scratch, id);
        let body = self.state.bodies.at_mut(id.slot());
        let by = position - body.position();
        body.drop_target();
        body.set_transform(position, angle);
        if by.x.saturating_abs().max(by.y.saturating_abs()) >= KEPT_MOVE_MAX {
            self.end_manifolds(id.slot());
        }
        self.refit_body(id.slot());
        wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        Ok(())
    }

    /// Wakes a dynamic body and returns it.
    pub(super) fn dynamic_body(&mut self, id: BodyId) -> Result<&mut Body, WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if !body.is_dynamic() || !body.enabled {
            return Err(WorldError::WrongKind(id));
        }
        wake_body(&mut self.state, &mut self.scratch, id.slot());
        Ok(self.state.bodies.at_mut(id.slot()))
    }
}
