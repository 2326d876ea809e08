use alloc::string::String;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::ContactView;
use crate::body::{Body, BodyId, Handle, JointId, ShapeId, label};
use crate::world::World;

impl World {
    /// Returns the handle of a body, and its name if it has one, as in `13v0 ball`.
    #[must_use]
    pub fn body_label(&self, id: BodyId) -> String {
        label(id, self.body(id).and_then(Body::name))
    }

    /// Returns the shapes of a body in order of attachment. Empty if the body is not in the world.
    ///
    /// ```
    /// use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
    /// let mut world = World::default();
    /// let (wheel, tyre) = (ShapeDef::new(Geometry::circle(fx!(1))?), ShapeDef::new(Geometry::circle(fx!(2))?));
    /// let body = world.spawn(&BodyDef::dynamic(), &[wheel, tyre])?;
    /// let &[wheel, tyre] = world.shapes_of(body) else { panic!("two shapes") };
    /// # assert_ne!(wheel, tyre);
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    pub fn shapes_of(&self, id: BodyId) -> &[ShapeId] {
        self.body(id).map_or(&[], |body| body.shapes())
    }

    /// Returns the joints of a body in slot order. Empty if the body is not in the world.
    #[must_use]
    pub fn joints_of(&self, id: BodyId) -> Vec<JointId> {
        match self.body(id) {
            Some(_) => self.scratch.joint_links.of(&self.state, id),
            None => Vec::new(),
        }
    }

    /// Returns those of [`World::contacts`] in which a shape of the body takes part. Each call searches all contacts.
    pub fn contacts_of(&self, id: BodyId) -> impl Iterator<Item = ContactView<'_>> {
        let is_there = self.body(id).is_some();
        let is_own = move |shape: ShapeId| self.shape(shape).is_some_and(|shape| shape.body() == id);
        let contacts = is_there.then(|| self.contacts()).into_iter().flatten();
        contacts.filter(move |contact| is_own(contact.shape_a) || is_own(contact.shape_b))
    }

    /// Returns the shapes that a sensor overlapped at the end of the last tick, in slot order. Empty if the shape is no
    /// sensor or is not in the world, or if its body is disabled. Edits after the tick, such as a
    /// [`World::set_transform`] to a distant place, may remove shapes from the result, but never add any. The result is
    /// part of the state, so a restore also restores it.
    ///
    /// ```
    /// use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
    /// let mut world = World::default();
    /// let zone = world.spawn(&BodyDef::fixed(), &[ShapeDef::new(Geometry::circle(fx!(5))?).sensor()])?;
    /// let ball = world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(1))?)])?;
    /// world.step();
    /// assert_eq!(world.sensor_overlaps(world.shapes_of(zone)[0]), world.shapes_of(ball));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[doc(alias = "trigger")]
    #[doc(alias = "intersecting")]
    #[must_use]
    pub fn sensor_overlaps(&self, id: ShapeId) -> Vec<ShapeId> {
        let Some(sensor) = self.shape(id) else { return Vec::new() };
        let mut found = Vec::new();
        if !sensor.is_sensor() || !self.state.body_of(id.slot()).enabled {
            return found;
        }
        self.scratch.shapes.broad_phase().each_overlap(sensor.fat, |other| {
            let pair = (other.min(id.slot()), other.max(id.slot()));
            let is_inside = [&self.state.contacts, &*self.state.sleeping_contacts].iter().any(|list| {
                let at = list.binary_search_by_key(&pair, |contact| contact.shapes);
                at.is_ok_and(|at| list[at].touching)
            });
            if is_inside && sensor.detects(self.state.shapes.at(other)) {
                found.push(self.state.shapes.handle_at(other));
            }
            ControlFlow::Continue(())
        });
        found.sort_unstable();
        found
    }
}
