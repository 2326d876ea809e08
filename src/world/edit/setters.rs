//! Changing the properties of bodies and shapes.

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::body::{
    Area, BodyId, BodyKind, BodySettings, Filter, Geometry, Handle, MassProperties, MassSource, Material,
    Name, ShapeDef, ShapeId, WorldError,
};
use crate::collision::Contact;
use crate::math::{Fx, Speed, Vec2, narrow};
use crate::solver::limit_speed;
use crate::world::World;
use crate::world::derived::{mass_of, offset_max};
use crate::world::islands::{put_to_sleep, wake_body, wake_joined, wake_overlapping, wake_touching};
use crate::world::state::State;

impl World {
    /// Replaces the settings of a body: change a copy of [`crate::body::Body::settings`]. Wakes the body.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale or a value is out of range.
    #[doc(alias = "gravity_scale")]
    #[doc(alias = "damping")]
    #[doc(alias = "bullet")]
    pub fn set_body(&mut self, id: BodyId, settings: &BodySettings) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        settings.validate()?;
        let mass = mass_of(body.kind(), *body.mass_source, settings, self.shape_defs(body))?;
        wake_body(&mut self.state, &mut self.scratch, id.slot());
        self.state.bodies.redefine(id.slot()).settings = *settings;
        self.replace_mass(id.slot(), mass);
        self.state.bodies.redefine(id.slot()).hold_locked_axes();
        self.scratch.update_body(&self.state, id.slot());
        Ok(())
    }

    /// Replaces the number that the game stores with a body. It does not affect the simulation.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] if the body is not in the world.
    pub fn set_user_data(&mut self, id: BodyId, user_data: u64) -> Result<(), WorldError> {
        self.state.bodies.get_mut(id).ok_or(WorldError::StaleBody(id))?.user_data = user_data;
        Ok(())
    }

    /// Sets or removes the name of a body, which is shown in reports. It does not affect the simulation.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, or if the name was decoded from untrusted bytes and is not valid.
    pub fn set_name(&mut self, id: BodyId, name: Option<Name>) -> Result<(), WorldError> {
        name.map_or(Ok(()), |name| name.validate())?;
        self.state.bodies.get_mut(id).ok_or(WorldError::StaleBody(id))?.name = name.map(Box::new);
        Ok(())
    }

    /// Replaces the source of a body's mass. Keeps the pose and the motion of the body, and wakes it.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the mass is out of range, or the body rotates too fast for the new mass.
    #[doc(alias = "density")]
    #[doc(alias = "inertia")]
    pub fn set_mass(&mut self, id: BodyId, source: MassSource) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let mass = mass_of(body.kind(), source, &body.settings, self.shape_defs(body))?;
        self.check_spin(body, &mass)?;
        wake_body(&mut self.state, &mut self.scratch, id.slot());
        self.prepare_mass(id, &mass);
        *self.state.bodies.redefine(id.slot()).mass_source = source;
        self.replace_mass(id.slot(), mass);
        self.scratch.update_body(&self.state, id.slot());
        Ok(())
    }

    /// Makes a body fixed, kinematic or dynamic. A body that becomes fixed stops. A body that becomes kinematic keeps its
    /// velocity within the [speed limit](crate::solver::SolverSettings::speed_max), which impulses may have exceeded. The
    /// joints of the body stay, but have no effect while neither of their bodies is dynamic.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the mass is out of range, a shape or the anchor of a joint is too far
    /// from the origin of a body that moves, or the body rotates too fast for its mass.
    #[doc(alias = "static")]
    #[doc(alias = "body type")]
    pub fn set_kind(&mut self, id: BodyId, kind: BodyKind) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        for shape in self.shape_defs(body) {
            shape.validate(offset_max(kind))?;
        }
        let mass = mass_of(kind, *body.mass_source, &body.settings, self.shape_defs(body))?;
        if kind != BodyKind::Fixed {
            self.check_spin(body, &mass)?;
        }
        let kind_of = |other: BodyId| match other == id {
            true => kind,
            false => self.state.bodies.at(other.slot()).kind(),
        };
        let mut resting = Vec::new();
        for joint in self.scratch.joint_links.of(&self.state, id) {
            let def = self.state.joints.at(joint.slot()).def();
            let kinds = <[BodyId; 2]>::from(def.bodies()).map(kind_of);
            def.validate(kinds)?;
            if !kinds.contains(&BodyKind::Dynamic) {
                resting.push(joint);
            }
        }
        let speed_limit: Speed = narrow(self.speed_limit());
        wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        wake_joined(&mut self.state, &mut self.scratch, id);
        for joint in resting {
            self.state.joints.at_mut(joint.slot()).rest();
        }
        let body = self.state.bodies.redefine(id.slot());
        body.kind = kind;
        body.drop_target();
        self.replace_mass(id.slot(), mass);
        let body = self.state.bodies.redefine(id.slot());
        if kind != BodyKind::Dynamic {
            (body.force, body.torque) = (Vec2::ZERO, Fx::ZERO);
        }
        if kind == BodyKind::Kinematic {
            limit_speed(&mut body.velocity, speed_limit);
            body.spin = body.spin.clamp(-speed_limit, speed_limit);
        }
        if kind == BodyKind::Fixed {
            body.stop();
        }
        self.refit_body(id.slot());
        self.scratch.pairs.changes.rules_changed();
        wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        Ok(())
    }

    /// Takes a body out of the simulation until [`World::enable`]. The body keeps its pose and velocity, but loses its
    /// applied forces, its target, and the velocity towards the target. It has no contacts, its joints are not solved,
    /// and no query finds it.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] if the body is not in the world.
    pub fn disable(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if !body.enabled {
            return Ok(());
        }
        let shapes = body.shapes.clone();
        wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        wake_joined(&mut self.state, &mut self.scratch, id);
        self.end_contacts(&shapes);
        for shape in shapes {
            self.scratch.shapes.remove(shape.slot());
        }
        for joint in self.scratch.joint_links.of(&self.state, id) {
            self.state.joints.at_mut(joint.slot()).rest();
        }
        let body = self.state.bodies.redefine(id.slot());
        body.enabled = false;
        body.drop_target();
        (body.force, body.torque) = (Vec2::ZERO, Fx::ZERO);
        self.scratch.awake.invalidate();
        Ok(())
    }

    /// Puts a disabled body back into the simulation at its pose.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] if the body is not in the world.
    pub fn enable(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get_mut(id).ok_or(WorldError::StaleBody(id))?;
        if !body.enabled {
            body.enabled = true;
            self.scratch.update_body(&self.state, id.slot());
            wake_joined(&mut self.state, &mut self.scratch, id);
            wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        }
        Ok(())
    }

    /// Wakes a body with its island. For a fixed or kinematic body, wakes the bodies that touch it, are joined to it or
    /// are in one of its areas.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] if the body is not in the world.
    pub fn wake(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let is_dynamic = body.is_dynamic();
        wake_body(&mut self.state, &mut self.scratch, id.slot());
        if !is_dynamic {
            wake_touching(&mut self.state, &mut self.scratch, id.slot());
            wake_joined(&mut self.state, &mut self.scratch, id);
        }
        Ok(())
    }

    /// Puts a dynamic body to sleep at any velocity, with the dynamic bodies that contacts, joints and areas connect to
    /// it. Does nothing if [`crate::world::Config::sleeping`] is off, or if a joint connects one of these bodies to a
    /// moving kinematic body. A contact of the last tick counts if its shapes still meet after all edits since.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, or the body is disabled or not dynamic.
    pub fn sleep(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        if !body.is_dynamic() || !body.enabled {
            return Err(WorldError::WrongKind(id));
        }
        if self.state.config.sleeping && !body.is_asleep() {
            put_to_sleep(&mut self.state, &mut self.scratch, id.slot());
        }
        Ok(())
    }

    /// Replaces the definition of a shape: change a copy of [`crate::body::Shape::def`]. Recomputes the body's mass
    /// from its shapes, unless the mass was given. A change of `sensor` ends the contacts of the shape. If a change of
    /// the event switches affects [touching](crate::world::ContactView::touching) pairs, the next tick reports an end
    /// for each pair that has no events any more, and a begin for each pair that now has events and still touches.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, a value or the mass of a dynamic body is out of range, an area is not
    /// valid, or the body rotates too fast for its new mass.
    #[doc(alias = "sensor")]
    #[doc(alias = "trigger")]
    pub fn set_shape(&mut self, id: ShapeId, def: &ShapeDef) -> Result<(), WorldError> {
        let shape = self.state.shapes.get(id).ok_or(WorldError::StaleShape(id))?;
        let (body, slot) = (shape.body(), shape.body().slot());
        let owner = self.state.bodies.at(slot);
        def.validate(offset_max(owner.kind()))?;
        let with = owner
            .shapes
            .iter()
            .map(|other| if *other == id { def } else { &self.state.shapes.at(other.slot()).def });
        let mass = mass_of(owner.kind(), *owner.mass_source, &owner.settings, with)?;
        self.check_spin(owner, &mass)?;
        let changes_sensor = shape.def.sensor != def.sensor;
        wake_overlapping(&mut self.state, &mut self.scratch, slot);
        self.prepare_mass(body, &mass);
        if changes_sensor {
            self.end_contacts(&[id]);
        }
        self.redefine_shape(id.slot(), def);
        self.end_manifolds(slot);
        self.replace_mass(slot, mass);
        self.refit_body(slot);
        self.scratch.pairs.changes.rules_changed();
        wake_overlapping(&mut self.state, &mut self.scratch, slot);
        Ok(())
    }

    /// Replaces the geometry of a shape: see [`World::set_shape`].
    ///
    /// # Errors
    /// The errors of [`World::set_shape`].
    pub fn set_geometry(&mut self, id: ShapeId, geometry: Geometry) -> Result<(), WorldError> {
        self.change_shape(id, |def| def.geometry = geometry)
    }

    /// Replaces the material of a shape; see [`World::set_shape`].
    ///
    /// # Errors
    /// The errors of [`World::set_shape`].
    pub fn set_material(&mut self, id: ShapeId, material: Material) -> Result<(), WorldError> {
        self.change_shape(id, |def| def.material = material)
    }

    /// Replaces the collision filter of a shape; see [`World::set_shape`].
    ///
    /// # Errors
    /// The errors of [`World::set_shape`].
    pub fn set_filter(&mut self, id: ShapeId, filter: Filter) -> Result<(), WorldError> {
        self.change_shape(id, |def| def.filter = filter)
    }

    /// Replaces the effect of a sensor on the bodies inside it; `None` for a sensor that only detects. Wakes the bodies
    /// in the area, unless the effect is the same.
    ///
    /// ```
    /// use lockstep2d::{body::{Area, BodyDef, Polygon, ShapeDef}, fx, world::World};
    /// let mut world = World::default();
    /// let air = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(9))?).sensor();
    /// let air = world.spawn(&BodyDef::fixed(), &[air])?;
    /// let air = world.shapes_of(air)[0];
    /// let leaf = ShapeDef::new(Polygon::square(fx!(0.1))?);
    /// let leaf = world.spawn(&BodyDef::dynamic().gravity_scale(fx!(0)), &[leaf])?;
    /// world.set_area(air, Some(Area::new().flow((fx!(3), fx!(0))).drag(fx!(2), fx!(2))))?;
    /// (0..60).for_each(|_| world.step());
    /// assert!(world.body(leaf).is_some_and(|leaf| leaf.velocity().x > fx!(2)));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, a value is out of range, or the shape of an area is not a sensor or has
    /// no interior.
    #[doc(alias = "wind")]
    pub fn set_area(&mut self, id: ShapeId, area: Option<Area>) -> Result<(), WorldError> {
        let shape = self.state.shapes.get(id).ok_or(WorldError::StaleShape(id))?;
        if shape.def.area == area { Ok(()) } else { self.change_shape(id, |def| def.area = area) }
    }

    /// Prepares for a change of the mass from 0 to a positive value or back. Contacts and joints with other bodies
    /// without mass then begin or cease to act. Therefore wakes overlapping and joined bodies, and makes the next pair
    /// update check all pairs.
    pub(super) fn prepare_mass(&mut self, id: BodyId, mass: &MassProperties) {
        if self.state.bodies.at(id.slot()).has_mass() != (mass.mass > 0) {
            wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
            wake_joined(&mut self.state, &mut self.scratch, id);
            self.scratch.pairs.changes.rules_changed();
        }
    }

    /// Replaces the definition of a shape. If the new definition changes the events of a touching pair, lists the pair for
    /// the next tick. A sensor pair also ceases to touch, and begins anew in the next tick.
    fn redefine_shape(&mut self, slot: u32, def: &ShapeDef) {
        self.spend_scan();
        let list_reported = |state: &State| -> Vec<_> {
            let contacts = state.contacts.iter().chain(state.sleeping_contacts.iter());
            let touching = contacts
                .filter(|contact| contact.touching && (contact.shapes.0 == slot || contact.shapes.1 == slot));
            touching.map(|contact| (contact.shapes, state.reported(contact))).collect()
        };
        let before = list_reported(&self.state);
        *self.state.shapes.redefine(slot).def = *def;
        let after = list_reported(&self.state);
        let State { contacts, sleeping_contacts, edited_contacts, .. } = &mut *self.state;
        for ((pair, old), (_, new)) in before.into_iter().zip(after).filter(|((_, old), (_, new))| old != new)
        {
            // A pair of solid shapes has events either in `old` or in `new`.
            let Some(edited) = old.or(new) else { continue };
            edited_contacts.push(edited);
            if edited.sensor.is_none() {
                continue;
            }
            let find = |list: &[Contact]| list.binary_search_by_key(&pair, |contact| contact.shapes).ok();
            if let Some(index) = find(contacts) {
                contacts[index].touching = false;
            } else if let Some(index) = find(sleeping_contacts) {
                sleeping_contacts[index].touching = false;
            }
        }
    }

    /// Replaces the mass of a body. Drops the kept manifolds of its contacts, because lever arms are relative to the
    /// centre of mass.
    pub(super) fn replace_mass(&mut self, body: u32, mass: MassProperties) {
        if self.state.bodies.at(body).mass != mass {
            self.end_manifolds(body);
        }
        self.state.bodies.redefine(body).set_mass(mass);
    }

    fn change_shape(&mut self, id: ShapeId, change: impl FnOnce(&mut ShapeDef)) -> Result<(), WorldError> {
        let mut def = *self.state.shapes.get(id).ok_or(WorldError::StaleShape(id))?.def;
        change(&mut def);
        self.set_shape(id, &def)
    }
}
