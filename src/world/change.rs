//! Changes to a world between ticks. Each one either happens or returns an error and leaves the world as it was.

use alloc::vec::Vec;

use super::World;
use super::config::check_gravity;
use crate::body::{
    Body, BodyDef, BodyId, BodyKind, Handle, JointId, MassProperties, MassSource, REACH_MAX,
    SHAPES_PER_BODY_MAX, Shape, ShapeDef, ShapeId, WORLD_EXTENT_MAX, WorldError, check_position,
};
use crate::collision::PosedShape;
use crate::math::{Angle, Fx, Vec2, fx_mul};
use crate::solver::{Joint, JointDef};

impl World {
    /// Adds a body with its shapes.
    ///
    /// # Errors
    /// When a value is out of range, a dynamic body has no mass, or the world is full.
    pub fn spawn(&mut self, body: &BodyDef, shapes: &[ShapeDef]) -> Result<BodyId, WorldError> {
        let config = self.state.config;
        check_room(self.state.bodies.len(), 1, config.body_limit, "bodies")?;
        check_room(self.state.shapes.len(), shapes.len(), config.shape_limit, "shapes")?;
        check_shapes_of_body(shapes.len())?;
        body.validate()?;
        for shape in shapes {
            shape.validate(reach_max(body.kind))?;
        }
        let mass = mass_of(body.kind, body.mass, shapes.iter())?;
        self.check_velocity(body.velocity, body.angular_velocity, mass.gyration)?;
        let mut body = Body::new(body, mass);
        if body.kind() == BodyKind::Fixed {
            body.stop();
        }
        let id = self.state.bodies.insert(body);
        for shape in shapes {
            self.insert_shape(id, shape);
        }
        self.scratch.poses.pose_body(&self.state, self.state.bodies.at(id.slot()));
        Ok(id)
    }

    /// Removes a body with its shapes and joints.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] when it is not in the world.
    pub fn despawn(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let shapes = body.shapes.clone();
        let joined = |(joint_id, joint): (JointId, &Joint)| {
            let (a, b) = joint.def().bodies();
            (a == id || b == id).then_some(joint_id)
        };
        let joints: Vec<JointId> = self.state.joints.iter().filter_map(joined).collect();
        for joint in joints {
            self.remove_joint(joint)?;
        }
        self.forget_shapes(&shapes);
        self.state.bodies.remove(id);
        Ok(())
    }

    /// Attaches a shape to a body. Unless the body's mass was given, it follows from all shapes anew.
    ///
    /// # Errors
    /// When the handle is stale, a value is out of range, or the world is full.
    pub fn add_shape(&mut self, body: BodyId, shape: &ShapeDef) -> Result<ShapeId, WorldError> {
        check_room(self.state.shapes.len(), 1, self.state.config.shape_limit, "shapes")?;
        let owner = self.state.bodies.get(body).ok_or(WorldError::StaleBody(body))?;
        shape.validate(reach_max(owner.kind()))?;
        check_shapes_of_body(owner.shapes.len() + 1)?;
        let shapes = self.shape_defs(owner).chain([shape]);
        let mass = mass_of(owner.kind(), owner.mass_source, shapes)?;
        self.check_spin(owner, &mass)?;
        self.state.bodies.at_mut(body.slot()).set_mass(mass);
        let id = self.insert_shape(body, shape);
        // The centre of mass may have moved, and with it, by a rounding, the places of the other shapes.
        self.scratch.poses.pose_body(&self.state, self.state.bodies.at(body.slot()));
        Ok(id)
    }

    /// Removes a shape. Unless the body's mass was given, it follows from the remaining shapes.
    ///
    /// # Errors
    /// When the handle is stale, or a dynamic body would be left without mass.
    pub fn remove_shape(&mut self, id: ShapeId) -> Result<(), WorldError> {
        let shape = self.state.shapes.get(id).ok_or(WorldError::StaleShape(id))?;
        let body = shape.body();
        let owner = self.state.bodies.at(body.slot());
        let rest = owner.shapes.iter().filter(|&&other| other != id);
        let rest = rest.map(|other| &self.state.shapes.at(other.slot()).def);
        let mass = mass_of(owner.kind(), owner.mass_source, rest)?;
        self.check_spin(owner, &mass)?;
        self.forget_shapes(&[id]);
        let owner = self.state.bodies.at_mut(body.slot());
        owner.shapes.retain(|&other| other != id);
        owner.set_mass(mass);
        // The centre of mass has moved, and with it, by a rounding, the places of the other shapes.
        self.scratch.poses.pose_body(&self.state, self.state.bodies.at(body.slot()));
        Ok(())
    }

    /// Connects two bodies.
    ///
    /// # Errors
    /// When a handle is stale, both bodies are the same, neither is dynamic, an anchor is out of range, or the
    /// world is full.
    pub fn add_joint(&mut self, def: &JointDef) -> Result<JointId, WorldError> {
        check_room(self.state.joints.len(), 1, self.state.config.joint_limit, "joints")?;
        def.validate()?;
        let (a, b) = def.bodies();
        let dynamic =
            |id: BodyId| self.state.bodies.get(id).map(Body::is_dynamic).ok_or(WorldError::StaleBody(id));
        if !(dynamic(a)? | dynamic(b)?) {
            return Err(WorldError::JointWithoutDynamicBody);
        }
        self.scratch.pairs_changed = true;
        Ok(self.state.joints.insert(Joint::new(*def)))
    }

    /// Removes a joint.
    ///
    /// # Errors
    /// [`WorldError::StaleJoint`] when it is not in the world.
    pub fn remove_joint(&mut self, id: JointId) -> Result<(), WorldError> {
        self.state.joints.remove(id).ok_or(WorldError::StaleJoint(id))?;
        self.scratch.pairs_changed = true;
        Ok(())
    }

    /// Pushes a dynamic body with a force in N at a world point during the next tick. Forces add up, and are
    /// gone after the tick.
    ///
    /// # Errors
    /// When the handle is stale or the body is not dynamic.
    pub fn apply_force(&mut self, id: BodyId, force: Vec2<Fx>, point: Vec2<Fx>) -> Result<(), WorldError> {
        self.dynamic_body(id)?.apply_force(force, point);
        Ok(())
    }

    /// Turns a dynamic body with a torque in N m during the next tick.
    ///
    /// # Errors
    /// When the handle is stale or the body is not dynamic.
    pub fn apply_torque(&mut self, id: BodyId, torque: Fx) -> Result<(), WorldError> {
        let body = self.dynamic_body(id)?;
        body.torque = body.torque.saturating_add(torque);
        Ok(())
    }

    /// Changes a dynamic body's velocity at once by an impulse in N s at a world point.
    ///
    /// # Errors
    /// When the handle is stale or the body is not dynamic.
    pub fn apply_impulse(
        &mut self,
        id: BodyId,
        impulse: Vec2<Fx>,
        point: Vec2<Fx>,
    ) -> Result<(), WorldError> {
        self.dynamic_body(id)?.apply_impulse(impulse, point);
        Ok(())
    }

    /// Changes a dynamic body's angular velocity at once by an angular impulse in N m s.
    ///
    /// # Errors
    /// When the handle is stale or the body is not dynamic.
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
        let body = self.state.bodies.at_mut(id.slot());
        body.velocity = velocity.narrow();
        body.set_angular_velocity(angular);
        Ok(())
    }

    /// Moves a body's origin to a position, turned to an angle, without regard to what is in between. Its
    /// contacts and joints keep their impulses if they last.
    ///
    /// # Errors
    /// When the handle is stale or the position out of range.
    pub fn set_transform(&mut self, id: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<(), WorldError> {
        check_position(position)?;
        let body = self.state.bodies.get_mut(id).ok_or(WorldError::StaleBody(id))?;
        body.set_transform(position, angle);
        self.place_shapes(id);
        Ok(())
    }

    /// Changes the world's gravity, in m/s².
    ///
    /// # Errors
    /// [`WorldError::Setting`] when it is not within ±100 000.
    pub fn set_gravity(&mut self, gravity: Vec2<Fx>) -> Result<(), WorldError> {
        if !check_gravity(gravity) {
            return Err(WorldError::Setting { name: "gravity" });
        }
        self.state.config.gravity = gravity;
        Ok(())
    }

    fn shape_defs<'a>(&'a self, body: &'a Body) -> impl Iterator<Item = &'a ShapeDef> + Clone {
        body.shapes.iter().map(|id| &self.state.shapes.at(id.slot()).def)
    }

    fn dynamic_body(&mut self, id: BodyId) -> Result<&mut Body, WorldError> {
        let body = self.state.bodies.get_mut(id).ok_or(WorldError::StaleBody(id))?;
        if body.is_dynamic() { Ok(body) } else { Err(WorldError::WrongKind(id)) }
    }

    fn check_velocity(&self, velocity: Vec2<Fx>, angular: Fx, gyration: Fx) -> Result<(), WorldError> {
        let limit = self.state.config.solver.speed_limit(self.state.config.tick_rate);
        for value in [velocity.length(), fx_mul(angular.saturating_abs(), gyration)] {
            if value > limit {
                return Err(WorldError::SpeedOutOfRange { value });
            }
        }
        Ok(())
    }

    /// Checks that a body may keep its angular velocity with another mass.
    fn check_spin(&self, body: &Body, mass: &MassProperties) -> Result<(), WorldError> {
        self.check_velocity(Vec2::ZERO, body.angular_velocity(), mass.gyration)
    }

    /// Adds a shape that has been checked. It has to be posed afterwards.
    fn insert_shape(&mut self, body: BodyId, def: &ShapeDef) -> ShapeId {
        let owner = self.state.bodies.at_mut(body.slot());
        let fat = fat_box(def, owner, self.state.config.fat_margin);
        let id = self.state.shapes.insert(Shape { body, def: *def, fat });
        owner.shapes.push(id);
        self.scratch.pairs_changed = true;
        id
    }

    /// Gives the shapes of a body that has been moved new boxes.
    fn place_shapes(&mut self, id: BodyId) {
        let body = self.state.bodies.at(id.slot());
        for shape in &body.shapes {
            let shape = self.state.shapes.at_mut(shape.slot());
            shape.fat = fat_box(&shape.def, body, self.state.config.fat_margin);
        }
        self.scratch.poses.pose_body(&self.state, body);
        self.scratch.pairs_changed = true;
    }

    /// Removes shapes from everything but their body.
    fn forget_shapes(&mut self, ids: &[ShapeId]) {
        let gone = |slot: u32| ids.iter().any(|id| id.slot() == slot);
        let ends = |shapes: (u32, u32)| gone(shapes.0) || gone(shapes.1);
        let touching = self.state.contacts.iter().filter(|contact| contact.touching && ends(contact.shapes));
        let removed: Vec<_> = touching.map(|contact| self.state.contact_event(contact)).collect();
        self.state.removed_contacts.extend(removed);
        // Manifolds and hints are found by the contact's place, which moves.
        self.state.contacts.retain(|contact| !ends(contact.shapes));
        self.scratch.forget_contacts();
        for &id in ids {
            self.scratch.broad_phase.remove(id.slot());
            self.state.shapes.remove(id);
        }
    }
}

/// Offsets on bodies that can move make lever arms, which have less range than positions.
pub(super) fn reach_max(kind: BodyKind) -> Fx {
    match kind {
        BodyKind::Fixed => WORLD_EXTENT_MAX,
        BodyKind::Kinematic | BodyKind::Dynamic => REACH_MAX,
    }
}

pub(super) fn mass_of<'a>(
    kind: BodyKind,
    source: MassSource,
    shapes: impl Iterator<Item = &'a ShapeDef> + Clone,
) -> Result<MassProperties, WorldError> {
    match kind {
        BodyKind::Dynamic => MassProperties::dynamic(source, shapes),
        BodyKind::Fixed | BodyKind::Kinematic => {
            // A given mass waits for the body to become dynamic, and has to be possible.
            if matches!(source, MassSource::Given { .. }) {
                MassProperties::dynamic(source, shapes)?;
            }
            Ok(MassProperties::immovable())
        }
    }
}

pub(super) fn fat_box(shape: &ShapeDef, body: &Body, margin: Fx) -> crate::math::Aabb {
    PosedShape::new(shape, body, body.rotation()).bounds.expanded(margin)
}

fn check_shapes_of_body(count: usize) -> Result<(), WorldError> {
    check_room(count, 0, SHAPES_PER_BODY_MAX, "shapes of one body")
}

fn check_room(count: usize, more: usize, limit: u32, what: &'static str) -> Result<(), WorldError> {
    if count.saturating_add(more) > limit as usize { Err(WorldError::Full { what, limit }) } else { Ok(()) }
}
