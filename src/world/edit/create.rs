use alloc::boxed::Box;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::body::{
    Body, BodyDef, BodyId, BodyKind, Handle, JointId, SHAPES_PER_BODY_MAX, Shape, ShapeDef, ShapeId,
    WorldError, check_position,
};
use crate::math::{Angle, Fx, Vec2};
use crate::solver::{Joint, JointDef};
use crate::world::World;
use crate::world::derived::{fat_box, mass_of, offset_max};
use crate::world::islands::{joints_changed, wake_body, wake_overlapping, wake_overlapping_shape};
use crate::world::state::{Island, State};

/// Position and rotation of a body.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::{fx, math::{Angle, Fx, Vec2}, world::BodyPose};
/// # let mut world = World::default();
/// // A row of dominoes.
/// let pose = |i| BodyPose { position: Vec2::new(fx!(0.4) * Fx::from_num(i), fx!(0.5)), angle: Angle::ZERO };
/// let domino = ShapeDef::new(Polygon::rectangle(fx!(0.05), fx!(0.5))?);
/// let poses: Vec<_> = (0..10).map(pose).collect();
/// let row = world.spawn_each(&BodyDef::dynamic(), &[domino], &poses)?;
/// assert_eq!(world.body(row[9]).map(|last| last.position()), Some(poses[9].position));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BodyPose {
    /// Position of the body's origin in the world, in metres.
    pub position: Vec2<Fx>,
    /// Rotation of the body.
    pub angle: Angle,
}

impl World {
    /// Adds a body with its shapes.
    ///
    /// # Errors
    /// [`WorldError`] if a value or the mass of a dynamic body is out of range, the name or an area is not valid, the
    /// world is full, or there are more than [`SHAPES_PER_BODY_MAX`] shapes.
    #[doc(alias = "create_body")]
    #[doc(alias = "rigid body")]
    pub fn spawn(&mut self, body: &BodyDef, shapes: &[ShapeDef]) -> Result<BodyId, WorldError> {
        let config = self.state.config;
        check_room(self.state.bodies.len(), 1, config.body_limit, "bodies")?;
        check_room(self.state.shapes.len(), shapes.len(), config.shape_limit, "shapes")?;
        check_shapes_of_body(shapes.len())?;
        body.validate()?;
        for shape in shapes {
            shape.validate(offset_max(body.kind))?;
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
        self.scratch.update_body(&self.state, id.slot());
        if !self.state.bodies.at(id.slot()).is_dynamic() {
            wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        }
        Ok(id)
    }

    /// Adds one body for each pose. Unlike repeated calls of [`World::spawn`], a recording of this call contains the
    /// definition only once.
    ///
    /// # Errors
    /// The errors of [`World::spawn`]. No body is then added.
    pub fn spawn_each(
        &mut self,
        body: &BodyDef,
        shapes: &[ShapeDef],
        poses: &[BodyPose],
    ) -> Result<Vec<BodyId>, WorldError> {
        let config = self.state.config;
        check_room(self.state.bodies.len(), poses.len(), config.body_limit, "bodies")?;
        let wanted = shapes.len().saturating_mul(poses.len());
        check_room(self.state.shapes.len(), wanted, config.shape_limit, "shapes")?;
        for pose in poses {
            check_position(pose.position)?;
        }
        // All other errors depend only on the definitions. They therefore occur at the first pose, when no body has
        // been added yet.
        poses
            .iter()
            .map(|pose| self.spawn(&BodyDef { position: pose.position, angle: pose.angle, ..*body }, shapes))
            .collect()
    }

    /// Attaches a shape to a body. Recomputes the body's mass from all shapes, unless the mass was given.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, a value is out of range, an area is not valid, the body rotates too fast
    /// for its new mass, the world is full, or the body has [`SHAPES_PER_BODY_MAX`] shapes.
    #[doc(alias = "collider")]
    #[doc(alias = "fixture")]
    pub fn add_shape(&mut self, body: BodyId, shape: &ShapeDef) -> Result<ShapeId, WorldError> {
        check_room(self.state.shapes.len(), 1, self.state.config.shape_limit, "shapes")?;
        let owner = self.state.bodies.get(body).ok_or(WorldError::StaleBody(body))?;
        shape.validate(offset_max(owner.kind()))?;
        check_shapes_of_body(owner.shapes.len() + 1)?;
        let shapes = self.shape_defs(owner).chain([shape]);
        let mass = mass_of(owner.kind(), *owner.mass_source, &owner.settings, shapes)?;
        self.check_spin(owner, &mass)?;
        wake_body(&mut self.state, &mut self.scratch, body.slot());
        self.prepare_mass(body, &mass);
        self.replace_mass(body.slot(), mass);
        let id = self.insert_shape(body, shape);
        // Updates all shapes of the body: if the centre of mass has moved, their positions are rounded differently.
        self.scratch.update_body(&self.state, body.slot());
        wake_overlapping_shape(&mut self.state, &mut self.scratch, id.slot());
        Ok(id)
    }

    /// Connects two bodies by a joint, which has no effect while neither body is dynamic.
    ///
    /// # Errors
    /// [`WorldError`] if a handle is stale, both bodies are the same, a value is out of range, a lower limit is above
    /// the upper one, or the world is full.
    #[doc(alias = "create_joint")]
    #[doc(alias = "constraint")]
    pub fn add_joint(&mut self, def: &JointDef) -> Result<JointId, WorldError> {
        check_room(self.state.joints.len(), 1, self.state.config.joint_limit, "joints")?;
        self.check_joint(def)?;
        Ok(self.insert_joint(*def))
    }

    /// Adds one joint for each pair of bodies. Unlike repeated calls of [`World::add_joint`], a recording of this call
    /// contains the definition only once.
    ///
    /// # Errors
    /// The errors of [`World::add_joint`]. No joint is then added.
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

    pub(super) fn check_joint(&self, def: &JointDef) -> Result<(), WorldError> {
        let (a, b) = def.bodies();
        let kind = |id: BodyId| self.state.bodies.get(id).map(Body::kind).ok_or(WorldError::StaleBody(id));
        def.validate([kind(a)?, kind(b)?])
    }

    /// The definition must be valid.
    fn insert_joint(&mut self, def: JointDef) -> JointId {
        let (a, b) = def.bodies();
        let id = self.state.joints.insert(Joint::new(def));
        self.scratch.joint_links.add(id, (a, b));
        joints_changed(&mut self.state, &mut self.scratch, Vec::from([a, b]));
        id
    }

    /// The definition must be valid, and the caller has to update the caches of the body.
    fn insert_shape(&mut self, body: BodyId, def: &ShapeDef) -> ShapeId {
        let State { bodies, shapes, config, .. } = &mut *self.state;
        let owner = bodies.redefine(body.slot());
        let fat = fat_box(def, owner, config);
        let id = shapes.insert(Shape { body, def: Box::new(*def), fat });
        owner.shapes.push(id);
        id
    }
}

fn check_shapes_of_body(count: usize) -> Result<(), WorldError> {
    check_room(count, 0, SHAPES_PER_BODY_MAX, "shapes of one body")
}

fn check_room(count: usize, more: usize, limit: u32, what: &'static str) -> Result<(), WorldError> {
    if count.saturating_add(more) > limit as usize { Err(WorldError::Full { what, limit }) } else { Ok(()) }
}
