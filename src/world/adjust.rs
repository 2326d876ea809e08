//! Changing what a body, a shape or the world is like between ticks. Each change either happens or returns an error
//! and leaves the world as it was.

use super::World;
use super::change::{mass_of, reach_max};
use super::config::check_gravity;
use super::islands;
use crate::body::{
    BodyId, BodyKind, BodySettings, Filter, Geometry, Handle, IslandId, MassSource, Material, ShapeDef,
    ShapeId, WorldError,
};
use crate::math::{Fx, Vec2};

impl World {
    /// Changes how a body takes part in the simulation: read [`crate::body::Body::settings`], change a copy, and pass
    /// it here. Wakes the body.
    ///
    /// # Errors
    /// When the handle is stale or a value out of range.
    pub fn set_body(&mut self, id: BodyId, settings: &BodySettings) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        settings.validate()?;
        let mass = mass_of(body.kind(), *body.mass_source, settings, self.shape_defs(body))?;
        islands::wake_body(&mut self.state, &mut self.scratch, id.slot());
        let body = self.state.bodies.redefine(id.slot());
        body.settings = *settings;
        body.set_mass(mass);
        body.hold_locked_axes();
        self.placed(id.slot());
        Ok(())
    }

    /// Changes the game's own number of a body.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] when it is not in the world.
    pub fn set_user_data(&mut self, id: BodyId, user_data: u64) -> Result<(), WorldError> {
        self.state.bodies.get_mut(id).ok_or(WorldError::StaleBody(id))?.user_data = user_data;
        Ok(())
    }

    /// Changes where a body's mass comes from. Keeps its place, its angular velocity and the velocity of its material.
    ///
    /// # Errors
    /// When the handle is stale, the mass is out of range, or the body turns too fast for it.
    pub fn set_mass(&mut self, id: BodyId, source: MassSource) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let mass = mass_of(body.kind(), source, &body.settings, self.shape_defs(body))?;
        self.check_spin(body, &mass)?;
        islands::wake_body(&mut self.state, &mut self.scratch, id.slot());
        let body = self.state.bodies.redefine(id.slot());
        *body.mass_source = source;
        body.set_mass(mass);
        self.placed(id.slot());
        Ok(())
    }

    /// Makes a body fixed, kinematic or dynamic. A fixed one stops; otherwise it keeps its velocity.
    ///
    /// # Errors
    /// When the handle is stale, a dynamic body would have no mass, a shape reaches too far for a body that moves, or
    /// a joint would be left without a dynamic body.
    pub fn set_kind(&mut self, id: BodyId, kind: BodyKind) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        for shape in self.shape_defs(body) {
            shape.validate(reach_max(kind))?;
        }
        let mass = mass_of(kind, *body.mass_source, &body.settings, self.shape_defs(body))?;
        self.check_spin(body, &mass)?;
        let stays_dynamic = |other: BodyId| match other == id {
            true => kind == BodyKind::Dynamic,
            false => self.state.bodies.at(other.slot()).is_dynamic(),
        };
        for joint in self.scratch.links.of(&self.state, id) {
            let (a, b) = self.state.joints.at(joint.slot()).def().bodies();
            if !stays_dynamic(a) && !stays_dynamic(b) {
                return Err(WorldError::JointWithoutDynamicBody);
            }
        }
        islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        self.wake_joined(id);
        let body = self.state.bodies.redefine(id.slot());
        body.kind = kind;
        body.target = None;
        body.set_mass(mass);
        if kind != BodyKind::Dynamic {
            (body.force, body.torque) = (Vec2::ZERO, Fx::ZERO);
        }
        if kind == BodyKind::Fixed {
            body.stop();
        }
        // The boxes of fixed shapes have a margin of their own.
        self.replace(id.slot());
        self.scratch.changes.rules = true;
        islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        Ok(())
    }

    /// Takes a body out of the simulation. It keeps its place and its velocity, but nothing touches it, no joint pulls
    /// it, and no query finds it, until [`World::enable`].
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] when it is not in the world.
    pub fn disable(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if !body.enabled {
            return Ok(());
        }
        let shapes = body.shapes.clone();
        islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        self.wake_joined(id);
        self.forget_contacts(&shapes);
        for shape in shapes {
            self.scratch.remove_box(shape.slot());
        }
        let body = self.state.bodies.redefine(id.slot());
        body.enabled = false;
        body.target = None;
        (body.force, body.torque) = (Vec2::ZERO, Fx::ZERO);
        self.scratch.roster.invalidate();
        Ok(())
    }

    /// Puts a disabled body back into the simulation, where it was.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] when it is not in the world.
    pub fn enable(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get_mut(id).ok_or(WorldError::StaleBody(id))?;
        if !body.enabled {
            body.enabled = true;
            self.placed(id.slot());
            self.wake_joined(id);
            islands::disturb(&mut self.state, &mut self.scratch, id.slot());
        }
        Ok(())
    }

    /// Wakes a body, with all that fell asleep together with it.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] when it is not in the world.
    pub fn wake(&mut self, id: BodyId) -> Result<(), WorldError> {
        self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        islands::wake_body(&mut self.state, &mut self.scratch, id.slot());
        Ok(())
    }

    /// Puts a dynamic body to sleep, whatever its velocity, with all that it is in contact with or joined to. Does
    /// nothing in a world without sleep.
    ///
    /// # Errors
    /// When the handle is stale or the body is not dynamic.
    pub fn sleep(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if !body.is_dynamic() || !body.enabled {
            return Err(WorldError::WrongKind(id));
        }
        if self.state.config.sleeping && !body.is_asleep() {
            islands::force_sleep(&mut self.state, &mut self.scratch, id.slot());
        }
        Ok(())
    }

    /// Changes anything about a shape: read [`crate::body::Shape::def`], change a copy, and pass it here. Unless the
    /// body's mass was given, it follows from its shapes anew. A shape that becomes or ceases to be a sensor, or to have
    /// contact events, ends its contacts; otherwise they last as long as the shapes touch.
    ///
    /// # Errors
    /// When the handle is stale, a value is out of range, or a dynamic body would be left without mass.
    pub fn set_shape(&mut self, id: ShapeId, def: &ShapeDef) -> Result<(), WorldError> {
        let shape = self.state.shapes.get(id).ok_or(WorldError::StaleShape(id))?;
        let slot = shape.body().slot();
        let owner = self.state.bodies.at(slot);
        def.validate(reach_max(owner.kind()))?;
        let with = owner
            .shapes
            .iter()
            .map(|other| if *other == id { def } else { &self.state.shapes.at(other.slot()).def });
        let mass = mass_of(owner.kind(), *owner.mass_source, &owner.settings, with)?;
        self.check_spin(owner, &mass)?;
        // Who was told that a contact began is told that it ended.
        let other_role = (shape.def.sensor, shape.def.events.contact) != (def.sensor, def.events.contact);
        islands::disturb(&mut self.state, &mut self.scratch, slot);
        if other_role {
            self.forget_contacts(&[id]);
        }
        *self.state.shapes.redefine(id.slot()).def = *def;
        self.state.bodies.redefine(slot).set_mass(mass);
        self.replace(slot);
        self.scratch.changes.rules = true;
        islands::disturb(&mut self.state, &mut self.scratch, slot);
        Ok(())
    }

    /// Gives a shape another geometry; see [`World::set_shape`].
    ///
    /// # Errors
    /// Those of [`World::set_shape`].
    pub fn set_geometry(&mut self, id: ShapeId, geometry: Geometry) -> Result<(), WorldError> {
        self.change_shape(id, |def| def.geometry = geometry)
    }

    /// Gives a shape another surface.
    ///
    /// # Errors
    /// Those of [`World::set_shape`].
    pub fn set_material(&mut self, id: ShapeId, material: Material) -> Result<(), WorldError> {
        self.change_shape(id, |def| def.material = material)
    }

    /// Gives a shape another filter.
    ///
    /// # Errors
    /// Those of [`World::set_shape`].
    pub fn set_filter(&mut self, id: ShapeId, filter: Filter) -> Result<(), WorldError> {
        self.change_shape(id, |def| def.filter = filter)
    }

    fn change_shape(&mut self, id: ShapeId, change: impl FnOnce(&mut ShapeDef)) -> Result<(), WorldError> {
        let mut def = *self.state.shapes.get(id).ok_or(WorldError::StaleShape(id))?.def;
        change(&mut def);
        self.set_shape(id, &def)
    }

    /// Changes the world's gravity, in m/s². Everything wakes.
    ///
    /// # Errors
    /// [`WorldError::Setting`] when it is not within ±100 000.
    pub fn set_gravity(&mut self, gravity: Vec2<Fx>) -> Result<(), WorldError> {
        if !check_gravity(gravity) {
            return Err(WorldError::Setting { name: "gravity" });
        }
        let islands: alloc::vec::Vec<IslandId> = self.state.islands.iter().map(|(id, _)| id).collect();
        for island in islands {
            islands::wake(&mut self.state, &mut self.scratch, island);
        }
        for (_, body) in self.state.bodies.iter_mut().filter(|(_, body)| body.is_dynamic()) {
            body.rest_ticks = 0;
        }
        self.state.config.gravity = gravity;
        Ok(())
    }

    /// Wakes what is joined to a body.
    pub(super) fn wake_joined(&mut self, id: BodyId) {
        if self.state.islands.len() == 0 {
            return;
        }
        for joint in self.scratch.links.of(&self.state, id) {
            let (a, b) = self.state.joints.at(joint.slot()).def().bodies();
            for body in [a, b] {
                islands::wake_body(&mut self.state, &mut self.scratch, body.slot());
            }
        }
    }
}
