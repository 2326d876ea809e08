use alloc::vec::Vec;

use crate::body::{BodyId, Handle, JointId, ShapeId, WorldError};
use crate::collision::Pair;
use crate::world::World;
use crate::world::derived::mass_of;
use crate::world::islands::{contact_ended, joints_changed, wake_overlapping};
use crate::world::state::State;

impl World {
    /// Removes a body with its shapes and joints.
    ///
    /// # Errors
    /// [`WorldError::StaleBody`] if the body is not in the world.
    #[doc(alias = "destroy_body")]
    pub fn despawn(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let shapes = body.shapes.clone();
        let mut joined = Vec::new();
        for joint in self.scratch.joint_links.of(&self.state, id) {
            joined.extend(self.take_joint(joint)?);
        }
        joints_changed(&mut self.state, &mut self.scratch, joined);
        wake_overlapping(&mut self.state, &mut self.scratch, id.slot());
        self.delete_shapes(&shapes);
        self.state.bodies.remove(id);
        self.scratch.awake.invalidate();
        Ok(())
    }

    /// Removes a shape. Recomputes the body's mass from the remaining shapes, unless the mass was given.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the mass of a dynamic body would be out of range, or the body would
    /// rotate too fast.
    pub fn remove_shape(&mut self, id: ShapeId) -> Result<(), WorldError> {
        let shape = self.state.shapes.get(id).ok_or(WorldError::StaleShape(id))?;
        let body = shape.body();
        let owner = self.state.bodies.at(body.slot());
        let rest = owner.shapes.iter().filter(|&&other| other != id);
        let rest = rest.map(|other| self.state.shapes.at(other.slot()).def());
        let mass = mass_of(owner.kind(), *owner.mass_source, &owner.settings, rest)?;
        self.check_spin(owner, &mass)?;
        wake_overlapping(&mut self.state, &mut self.scratch, body.slot());
        self.prepare_mass(body, &mass);
        self.delete_shapes(&[id]);
        let owner = self.state.bodies.redefine(body.slot());
        owner.shapes.retain(|other| *other != id);
        self.replace_mass(body.slot(), mass);
        // Updates all shapes of the body: if the centre of mass has moved, their positions are rounded differently.
        self.scratch.update_body(&self.state, body.slot());
        Ok(())
    }

    /// Removes a joint.
    ///
    /// # Errors
    /// [`WorldError::StaleJoint`] if the joint is not in the world.
    #[doc(alias = "destroy_joint")]
    pub fn remove_joint(&mut self, id: JointId) -> Result<(), WorldError> {
        let bodies = self.take_joint(id)?;
        joints_changed(&mut self.state, &mut self.scratch, bodies.into());
        Ok(())
    }

    /// Removes a joint and returns its bodies, which the caller passes to [`joints_changed`].
    fn take_joint(&mut self, id: JointId) -> Result<[BodyId; 2], WorldError> {
        let joint = self.state.joints.remove(id).ok_or(WorldError::StaleJoint(id))?;
        let bodies = joint.def.bodies();
        self.scratch.joint_links.remove(id, bodies);
        Ok(bodies.into())
    }

    /// Removes shapes, but leaves their handles in the list of their body.
    fn delete_shapes(&mut self, ids: &[ShapeId]) {
        self.end_contacts(ids);
        for &id in ids {
            self.scratch.shapes.remove(id.slot());
            self.state.shapes.remove(id);
        }
    }

    /// Ends the contacts of shapes that are about to be removed, changed or disabled. The next tick reports their end
    /// events.
    pub(super) fn end_contacts(&mut self, ids: &[ShapeId]) {
        if ids.is_empty() {
            return;
        }
        // Continues even if this exhausts the budget: no contact of a removed shape may stay.
        self.spend_scan();
        let mut slots: Vec<u32> = ids.iter().map(|id| id.slot()).collect();
        slots.sort_unstable();
        let ends = |(a, b): Pair| slots.binary_search(&a).is_ok() || slots.binary_search(&b).is_ok();
        let State { contacts, sleeping_contacts, .. } = &*self.state;
        self.scratch.contacts.remove_surfaces(|pair| ends(pair.shapes));
        let is_listed = contacts.iter().any(|contact| ends(contact.shapes));
        let touching = contacts.iter().chain(sleeping_contacts.iter());
        let ended: Vec<_> =
            touching.filter(|contact| contact.touching && ends(contact.shapes)).copied().collect();
        for contact in ended {
            let removed = self.state.reported(&contact);
            self.state.edited_contacts.extend(removed);
            if self.state.supports(contact.shapes) {
                contact_ended(&mut self.state, contact.shapes);
            }
        }
        // The sleeping contacts are searched before they are borrowed mutably, because a mutable borrow drops their
        // packed form.
        if self.state.sleeping_contacts.iter().any(|contact| ends(contact.shapes)) {
            self.scratch.meter.spend_visit(&self.state.sleeping_contacts);
            self.state.sleeping_contacts.retain(|contact| !ends(contact.shapes));
        }
        if is_listed {
            // Other contacts keep their manifolds for `World::contacts`.
            let contacts = &mut self.state.contacts;
            self.scratch.contacts.split_off(contacts, &mut Vec::new(), |contact| !ends(contact.shapes));
        }
    }
}
