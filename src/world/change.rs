//! Changes to a world between ticks. Each one either happens or returns an error and leaves the world as it was.

use alloc::boxed::Box;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::World;
use super::config::Config;
use super::islands;
use super::state::{Island, State};
use super::stress;
use crate::body::{
    Body, BodyDef, BodyId, BodyKind, BodySettings, Handle, JointId, MassProperties, MassSource, REACH_MAX,
    SHAPES_PER_BODY_MAX, Shape, ShapeDef, ShapeId, WORLD_EXTENT_MAX, WorldError, check_position,
};
use crate::collision::{Pair, PosedShape};
use crate::math::{Aabb, Angle, Fx, Vec2, fx_mul};
use crate::solver::{Joint, JointDef};

/// Bits of [`Fx`] below the grid that the corners of fat boxes are on.
pub(super) const FAT_GRID_SHIFT: u32 = 10;

/// Where to put a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// Of its origin in the world, in metres.
    pub position: Vec2<Fx>,
    /// Its rotation.
    pub angle: Angle,
}

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
        let mass = mass_of(body.kind, body.mass, &body.settings, shapes.iter())?;
        self.check_velocity(body.velocity, body.angular_velocity, mass.gyration)?;
        let asleep = body.asleep && body.enabled && body.kind == BodyKind::Dynamic && config.sleeping;
        let mut body = Body::new(body, mass);
        if asleep || body.kind() == BodyKind::Fixed {
            body.stop();
        }
        let id = self.state.bodies.insert(body);
        for shape in shapes {
            self.insert_shape(id, shape);
        }
        if asleep {
            let island = self.state.islands.insert(Island { bodies: alloc::vec![id.slot()] });
            self.state.bodies.at_mut(id.slot()).island = Some(island);
        }
        self.placed(id.slot());
        if !self.state.bodies.at(id.slot()).is_dynamic() {
            islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        }
        Ok(id)
    }

    /// Adds a body of the same definition at every place: shorter to record than as many spawns.
    ///
    /// # Errors
    /// Those of [`World::spawn`]; none of the bodies is then added.
    pub fn spawn_each(
        &mut self,
        body: &BodyDef,
        shapes: &[ShapeDef],
        places: &[Place],
    ) -> Result<Vec<BodyId>, WorldError> {
        let config = self.state.config;
        check_room(self.state.bodies.len(), places.len(), config.body_limit, "bodies")?;
        let wanted = shapes.len().saturating_mul(places.len());
        check_room(self.state.shapes.len(), wanted, config.shape_limit, "shapes")?;
        for place in places {
            check_position(place.position)?;
        }
        // Whatever else may be wrong is wrong with the first one too.
        places
            .iter()
            .map(|place| {
                self.spawn(&BodyDef { position: place.position, angle: place.angle, ..*body }, shapes)
            })
            .collect()
    }

    /// Removes a body with its shapes and joints.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] when it is not in the world.
    pub fn despawn(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let shapes = body.shapes.clone();
        for joint in self.scratch.links.of(&self.state, id) {
            self.remove_joint(joint)?;
        }
        islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        self.forget_shapes(&shapes);
        self.state.bodies.remove(id);
        self.scratch.roster.invalidate();
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
        let mass = mass_of(owner.kind(), *owner.mass_source, &owner.settings, shapes)?;
        self.check_spin(owner, &mass)?;
        islands::wake_body(&mut self.state, &mut self.scratch, body.slot());
        self.state.bodies.redefine(body.slot()).set_mass(mass);
        let id = self.insert_shape(body, shape);
        // The centre of mass may have moved, and with it, by a rounding, the places of the other shapes.
        self.placed(body.slot());
        islands::disturb_around(&mut self.state, &mut self.scratch, id.slot());
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
        let rest = rest.map(|other| self.state.shapes.at(other.slot()).def());
        let mass = mass_of(owner.kind(), *owner.mass_source, &owner.settings, rest)?;
        self.check_spin(owner, &mass)?;
        islands::disturb(&mut self.state, &mut self.scratch, body.slot());
        self.forget_shapes(&[id]);
        let owner = self.state.bodies.redefine(body.slot());
        owner.shapes.retain(|other| *other != id);
        owner.set_mass(mass);
        // The centre of mass has moved, and with it, by a rounding, the places of the other shapes.
        self.placed(body.slot());
        Ok(())
    }

    /// Connects two bodies.
    ///
    /// # Errors
    /// When a handle is stale, both bodies are the same, neither is dynamic, an anchor is out of range, or the
    /// world is full.
    pub fn add_joint(&mut self, def: &JointDef) -> Result<JointId, WorldError> {
        check_room(self.state.joints.len(), 1, self.state.config.joint_limit, "joints")?;
        self.check_joint(def)?;
        Ok(self.insert_joint(*def))
    }

    fn check_joint(&self, def: &JointDef) -> Result<(), WorldError> {
        def.validate()?;
        let (a, b) = def.bodies();
        let dynamic =
            |id: BodyId| self.state.bodies.get(id).map(Body::is_dynamic).ok_or(WorldError::StaleBody(id));
        if dynamic(a)? | dynamic(b)? { Ok(()) } else { Err(WorldError::JointWithoutDynamicBody) }
    }

    /// Adds a joint that has been checked.
    fn insert_joint(&mut self, def: JointDef) -> JointId {
        let (a, b) = def.bodies();
        let id = self.state.joints.insert(Joint::new(def));
        self.scratch.links.add(id, (a, b));
        self.rejoined([a, b]);
        id
    }

    /// Adds a joint of the same definition between every pair of bodies: shorter to record than as many joints.
    ///
    /// # Errors
    /// Those of [`World::add_joint`]; none of the joints is then added.
    pub fn add_joint_each(
        &mut self,
        def: &JointDef,
        ends: &[(BodyId, BodyId)],
    ) -> Result<Vec<JointId>, WorldError> {
        check_room(self.state.joints.len(), ends.len(), self.state.config.joint_limit, "joints")?;
        let defs = || ends.iter().map(|&(a, b)| def.between(a, b));
        for def in defs() {
            self.check_joint(&def)?;
        }
        Ok(defs().map(|def| self.insert_joint(def)).collect())
    }

    /// Changes anything about a joint but its bodies: read [`Joint::def`], change a copy, and pass it here. Its
    /// impulses are kept if it stays of the same kind. Wakes its bodies.
    ///
    /// # Errors
    /// When the handle is stale, the bodies are others, or a value is out of range.
    pub fn set_joint(&mut self, id: JointId, def: &JointDef) -> Result<(), WorldError> {
        let joint = self.state.joints.get_mut(id).ok_or(WorldError::StaleJoint(id))?;
        def.validate()?;
        let (a, b) = joint.def.bodies();
        if (a, b) != def.bodies() {
            return Err(WorldError::JointOfOtherBodies(id));
        }
        joint.redefine(*def);
        self.rejoined([a, b]);
        Ok(())
    }

    /// Removes a joint.
    ///
    /// # Errors
    /// [`WorldError::StaleJoint`] when it is not in the world.
    pub fn remove_joint(&mut self, id: JointId) -> Result<(), WorldError> {
        let joint = self.state.joints.remove(id).ok_or(WorldError::StaleJoint(id))?;
        let (a, b) = joint.def.bodies();
        self.scratch.links.remove(id, (a, b));
        self.rejoined([a, b]);
        Ok(())
    }

    pub(super) fn shape_defs<'a>(&'a self, body: &'a Body) -> impl Iterator<Item = &'a ShapeDef> + Clone {
        body.shapes.iter().map(|id| self.state.shapes.at(id.slot()).def())
    }

    pub(super) fn check_velocity(
        &self,
        velocity: Vec2<Fx>,
        angular: Fx,
        gyration: Fx,
    ) -> Result<(), WorldError> {
        let limit = self.state.config.solver.speed_limit(self.state.config.tick_rate);
        for value in [velocity.length(), fx_mul(angular.saturating_abs(), gyration)] {
            if value > limit {
                return Err(WorldError::SpeedOutOfRange { value });
            }
        }
        Ok(())
    }

    /// Checks that a body may keep its angular velocity with another mass.
    pub(super) fn check_spin(&self, body: &Body, mass: &MassProperties) -> Result<(), WorldError> {
        self.check_velocity(Vec2::ZERO, body.angular_velocity(), mass.gyration)
    }

    /// Adds a shape that has been checked. It has to be posed afterwards.
    fn insert_shape(&mut self, body: BodyId, def: &ShapeDef) -> ShapeId {
        let State { bodies, shapes, config, .. } = &mut *self.state;
        let owner = bodies.redefine(body.slot());
        let fat = fat_box(def, owner, config);
        let id = shapes.insert(Shape { body, def: Box::new(*def), fat });
        owner.shapes.push(id);
        id
    }

    /// Gives the shapes of a body that has been moved new boxes.
    pub(super) fn replace(&mut self, slot: u32) {
        let State { bodies, shapes, config, .. } = &mut *self.state;
        let body = bodies.at(slot);
        for shape in &body.shapes {
            // Boxes of fixed bodies are not among what a step changes, and the body may have ceased to be fixed.
            let shape = shapes.redefine(shape.slot());
            shape.fat = fat_box(&shape.def, body, config);
        }
        self.placed(slot);
        self.scratch.changes.resting = true;
    }

    /// Brings the caches in line with a body that has come or been moved.
    pub(super) fn placed(&mut self, slot: u32) {
        let body = self.state.bodies.at(slot);
        self.scratch.place(&self.state, slot);
        self.scratch.changes.body(body);
        self.scratch.kinematic |= body.kind() == BodyKind::Kinematic;
        self.scratch.roster.invalidate();
    }

    fn rejoined(&mut self, bodies: [BodyId; 2]) {
        stress::rejoined(&mut self.state, &mut self.scratch, bodies);
    }

    /// Removes shapes from everything but their body.
    fn forget_shapes(&mut self, ids: &[ShapeId]) {
        self.forget_contacts(ids);
        for &id in ids {
            self.scratch.remove_box(id.slot());
            self.state.shapes.remove(id);
        }
    }

    /// Ends the contacts of shapes that are about to be removed or changed.
    pub(super) fn forget_contacts(&mut self, ids: &[ShapeId]) {
        let mut slots: Vec<u32> = ids.iter().map(|id| id.slot()).collect();
        slots.sort_unstable();
        let ends = |(a, b): Pair| slots.binary_search(&a).is_ok() || slots.binary_search(&b).is_ok();
        let State { contacts, resting, .. } = &*self.state;
        let before = contacts.len();
        // Surfaces are known by slots, which another shape may get before the next tick.
        self.scratch.found.touching.retain(|pair| !ends(pair.shapes));
        let touching =
            contacts.iter().chain(resting.iter()).filter(|contact| contact.touching && ends(contact.shapes));
        let removed: Vec<_> = touching.filter_map(|contact| self.state.reported(contact)).collect();
        self.state.removed_contacts.extend(removed);
        self.state.contacts.retain(|contact| !ends(contact.shapes));
        self.state.resting.retain(|contact| !ends(contact.shapes));
        if self.state.contacts.len() < before {
            // Manifolds and hints are found by the contact's place, which has moved.
            self.scratch.forget_contacts();
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
    settings: &BodySettings,
    shapes: impl Iterator<Item = &'a ShapeDef> + Clone,
) -> Result<MassProperties, WorldError> {
    let mass = match kind {
        BodyKind::Dynamic => MassProperties::dynamic(source, shapes)?,
        BodyKind::Fixed | BodyKind::Kinematic => {
            // A given mass waits for the body to become dynamic, and has to be possible.
            if matches!(source, MassSource::Given { .. }) {
                MassProperties::dynamic(source, shapes)?;
            }
            MassProperties::immovable()
        }
    };
    Ok(if settings.locks.rotation { mass.without_rotation() } else { mass })
}

/// The fat box of a shape that has come or been moved by hand. One of a fixed body has no margin: nothing moves it.
pub(super) fn fat_box(shape: &ShapeDef, body: &Body, config: &Config) -> Aabb {
    let bounds = PosedShape::new(shape, body, body.rotation()).bounds;
    match body.kind() {
        BodyKind::Fixed => fattened(bounds, Fx::ZERO),
        BodyKind::Kinematic | BodyKind::Dynamic => fattened(bounds, config.margin_of(bounds)),
    }
}

/// A fat box around another one. Its corners are multiples of 2^-22 m, so that snapshots need only 32 bits for how far
/// they are from the body's centre.
pub(super) fn fattened(bounds: Aabb, margin: Fx) -> Aabb {
    bounds.expanded(margin).rounded_out(FAT_GRID_SHIFT)
}

fn check_shapes_of_body(count: usize) -> Result<(), WorldError> {
    check_room(count, 0, SHAPES_PER_BODY_MAX, "shapes of one body")
}

fn check_room(count: usize, more: usize, limit: u32, what: &'static str) -> Result<(), WorldError> {
    if count.saturating_add(more) > limit as usize { Err(WorldError::Full { what, limit }) } else { Ok(()) }
}
