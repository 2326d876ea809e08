//! Changes to joints.
//!
//! Setting a value that a joint already has does not wake its bodies, so a machine whose motors are set in every tick
//! can fall asleep.

use alloc::vec::Vec;

use crate::body::{BodyId, JointId, WorldError};
use crate::math::{Angle, Fx, Vec2};
use crate::solver::{JointDef, JointFrame, JointKind, JointLimit};
use crate::world::World;
use crate::world::islands::{joint_retuned, joints_changed};
use crate::world::state::State;

impl World {
    /// Returns the definition of a joint for [`World::add_joint`]. Both anchors are at a world point, in metres, and
    /// the angle of the joint is 0 at the current poses.
    ///
    /// ```
    /// use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, solver::Revolute, world::World};
    /// let mut world = World::default();
    /// let plank = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.1))?);
    /// let ground = world.spawn(&BodyDef::fixed(), &[])?;
    /// let teeter = world.spawn(&BodyDef::dynamic().position((fx!(140), fx!(2))), &[plank])?;
    /// let hinge = Revolute::new().limit(fx!(-0.3), fx!(0.3));
    /// let def = world.joint_at(ground, teeter, hinge, (fx!(140), fx!(2)))?;
    /// world.add_joint(&def)?;
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] if a body is not in the world.
    #[doc(alias = "Initialize")]
    pub fn joint_at(
        &self,
        a: BodyId,
        b: BodyId,
        kind: impl Into<JointKind>,
        anchor: impl Into<Vec2<Fx>>,
    ) -> Result<JointDef, WorldError> {
        self.joint_along(a, b, kind, anchor, Vec2::new(Fx::ONE, Fx::ZERO))
    }

    /// Like [`World::joint_at`], for a prismatic or wheel joint along `axis`, in world coordinates. The length of the
    /// axis does not matter. The zero vector means the x axis.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] if a body is not in the world.
    pub fn joint_along(
        &self,
        a: BodyId,
        b: BodyId,
        kind: impl Into<JointKind>,
        anchor: impl Into<Vec2<Fx>>,
        axis: impl Into<Vec2<Fx>>,
    ) -> Result<JointDef, WorldError> {
        let (anchor, axis) = (anchor.into(), Angle::of(axis.into()));
        let frame = |id: BodyId| -> Result<JointFrame, WorldError> {
            let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
            let angle = axis - body.angle();
            Ok(JointFrame { anchor: body.transform().apply_inverse(anchor), angle })
        };
        let (frame_a, frame_b) = (frame(a)?, frame(b)?);
        Ok(JointDef { frame_a, frame_b, ..JointDef::new(a, b, kind) })
    }

    /// Returns a copy of the definition of a gear, rack or pulley, adjusted so that the joint has no position error at
    /// the current poses. Adjusts the angle of a gear's frame on A, the anchor of a rack on B, or the length of a
    /// pulley's rope.
    ///
    /// # Errors
    /// [`WorldError`] if a body is not in the world or a value is out of range.
    pub fn fit_joint(&self, def: &JointDef) -> Result<JointDef, WorldError> {
        self.check_joint(def)?;
        let (a, b) = def.bodies();
        let body = |id: BodyId| self.state.bodies.get(id).ok_or(WorldError::StaleBody(id));
        Ok(def.fitted(body(a)?, body(b)?))
    }

    /// Replaces the definition of a joint except for its bodies: change a copy of [`crate::solver::Joint::def`]. A
    /// different definition wakes the bodies.
    ///
    /// If the kind stays the same, the joint keeps its count of whole turns and, if `def` is enabled, its impulses.
    /// Exception: a rack resets its count of turns to 0 if this makes its position error smaller.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the bodies are different, a value is out of range, or a lower limit is
    /// above the upper one.
    #[doc(alias = "motor")]
    #[doc(alias = "spring")]
    #[doc(alias = "limit")]
    pub fn set_joint(&mut self, id: JointId, def: &JointDef) -> Result<(), WorldError> {
        let joint = self.state.joints.get(id).ok_or(WorldError::StaleJoint(id))?;
        let (a, b) = joint.def.bodies();
        if (a, b) != def.bodies() {
            return Err(WorldError::JointOfOtherBodies(id));
        }
        self.check_joint(def)?;
        if *joint.def == *def {
            return Ok(());
        }
        let changes_collisions =
            (joint.def.enabled, joint.def.collide_connected) != (def.enabled, def.collide_connected);
        let State { bodies, joints, .. } = &mut *self.state;
        if let (Some(joint), Some(a), Some(b)) = (joints.get_mut(id), bodies.get(a), bodies.get(b)) {
            joint.redefine(*def, a, b);
        }
        if changes_collisions {
            joints_changed(&mut self.state, &mut self.scratch, Vec::from([a, b]));
        } else {
            joint_retuned(&mut self.state, &mut self.scratch, [a, b]);
        }
        Ok(())
    }

    /// Enables a disabled joint, which starts without impulses, and wakes its bodies.
    ///
    /// # Errors
    /// [`WorldError::StaleJoint`] if the joint is not in the world.
    pub fn enable_joint(&mut self, id: JointId) -> Result<(), WorldError> {
        self.change_joint(id, |def| {
            def.enabled = true;
            Ok(())
        })
    }

    /// Takes a joint out of the simulation until [`World::enable_joint`], and wakes its bodies.
    ///
    /// # Errors
    /// [`WorldError::StaleJoint`] if the joint is not in the world.
    pub fn disable_joint(&mut self, id: JointId) -> Result<(), WorldError> {
        self.change_joint(id, |def| {
            def.enabled = false;
            Ok(())
        })
    }

    /// Sets the target speed in rad/s or m/s of a joint's motor. For a motor joint, sets the speed of its angular
    /// motor. A change wakes the bodies.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the joint has no motor, or the speed is out of range.
    pub fn set_joint_motor_speed(&mut self, id: JointId, speed: Fx) -> Result<(), WorldError> {
        self.change_joint(id, |def| {
            let motor = def.kind.motor_mut().ok_or(WorldError::JointWithout { joint: id, what: "motor" })?;
            motor.speed = speed;
            Ok(())
        })
    }

    /// Sets the largest force in N or torque in N m of a joint's motor. For a motor joint, sets the torque of its
    /// angular motor. A change wakes the bodies.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the joint has no motor, or the value is negative.
    pub fn set_joint_motor_max(&mut self, id: JointId, max: Fx) -> Result<(), WorldError> {
        self.change_joint(id, |def| {
            let motor = def.kind.motor_mut().ok_or(WorldError::JointWithout { joint: id, what: "motor" })?;
            motor.max = max;
            Ok(())
        })
    }

    /// Sets the target velocity of a motor joint in m/s, along the world axes. A change wakes the bodies.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the joint has no linear motor, or the velocity is out of range.
    pub fn set_joint_motor_velocity(
        &mut self,
        id: JointId,
        velocity: impl Into<Vec2<Fx>>,
    ) -> Result<(), WorldError> {
        let velocity = velocity.into();
        self.change_joint(id, |def| {
            let JointKind::Motor(crate::solver::Motor { linear: Some(linear), .. }) = &mut def.kind else {
                return Err(WorldError::JointWithout { joint: id, what: "linear motor" });
            };
            linear.velocity = velocity;
            Ok(())
        })
    }

    /// Sets the target of a joint's spring in rad or m. A change wakes the bodies.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the joint has no spring with a target, or the target is out of range.
    pub fn set_joint_spring_target(&mut self, id: JointId, target: Fx) -> Result<(), WorldError> {
        self.change_joint(id, |def| {
            let spring =
                def.kind.spring_mut().ok_or(WorldError::JointWithout { joint: id, what: "spring" })?;
            spring.target = target;
            Ok(())
        })
    }

    /// Sets the range of a joint's angle, translation or length in rad or m; `None` for no limit. A change wakes the
    /// bodies.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the kind of joint has no limit, or the limit is not valid.
    pub fn set_joint_limit(&mut self, id: JointId, limit: Option<JointLimit>) -> Result<(), WorldError> {
        self.change_joint(id, |def| {
            let own = def.kind.limit_mut().ok_or(WorldError::JointWithout { joint: id, what: "limit" })?;
            *own = limit;
            Ok(())
        })
    }

    fn change_joint(
        &mut self,
        id: JointId,
        change: impl FnOnce(&mut JointDef) -> Result<(), WorldError>,
    ) -> Result<(), WorldError> {
        let mut def = *self.state.joints.get(id).ok_or(WorldError::StaleJoint(id))?.def;
        change(&mut def)?;
        self.set_joint(id, &def)
    }
}
