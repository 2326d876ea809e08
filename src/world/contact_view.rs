//! The contacts of the last tick, to look at.

use core::fmt;

use super::World;
use crate::body::ShapeId;
use crate::collision::{Contact, Manifold, ManifoldPoint};
use crate::fx;
use crate::math::{Fx, Speed, fx_div, fx_mul, widen};
pub use crate::solver::SolverColour;

/// Two shapes in contact.
#[derive(Clone, Copy)]
pub struct ContactView<'a> {
    /// The shape in the smaller slot.
    pub shape_a: ShapeId,
    /// The other shape.
    pub shape_b: ShapeId,
    /// Whether they touch, or are only about to.
    pub touching: bool,
    /// Normal and points.
    pub manifold: &'a Manifold,
    world: &'a World,
    contact: &'a Contact,
}

/// Without the world that it is a part of.
impl fmt::Debug for ContactView<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ContactView")
            .field("shape_a", &self.shape_a)
            .field("shape_b", &self.shape_b)
            .field("touching", &self.touching)
            .field("normal", &self.manifold.normal)
            .field("points", &self.manifold.points())
            .finish_non_exhaustive()
    }
}

/// What a contact point exerts on shape B.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactForce {
    /// Along the normal, in N, not negative.
    pub normal: Fx,
    /// By friction, in N, along the normal turned counter-clockwise by a right angle.
    pub friction: Fx,
}

impl World {
    /// The contacts of the last tick that had points, sorted by pair, as they were found at its start. Empty until
    /// the next tick after a restore or the removal of a shape or body, since manifolds are not state.
    pub fn contacts(&self) -> impl Iterator<Item = ContactView<'_>> {
        let found = &self.scratch.found;
        found.contacts.iter().zip(&found.manifolds).map(|(&index, manifold)| {
            let contact = &self.state.contacts[index as usize];
            let event = self.state.contact_event(contact);
            let (shape_a, shape_b) = (event.shape_a, event.shape_b);
            ContactView { shape_a, shape_b, touching: contact.touching, manifold, world: self, contact }
        })
    }
}

impl ContactView<'_> {
    /// What each of the manifold's points exerted in the last sub-step of the tick: nothing if it did not push. If
    /// the bodies are resting, that is also what it exerts all the time.
    pub fn forces(&self) -> impl Iterator<Item = (&ManifoldPoint, ContactForce)> {
        let mass = self.reduced_mass();
        self.accelerations().map(move |(point, [normal, friction])| {
            (point, ContactForce { normal: fx_mul(normal, mass), friction: fx_mul(friction, mass) })
        })
    }

    /// The forces for each kilogram of the reduced mass, in m/s².
    pub(crate) fn accelerations(&self) -> impl Iterator<Item = (&ManifoldPoint, [Fx; 2])> {
        let config = self.world.config();
        let rate = config.tick_rate.saturating_mul(config.solver.sub_steps);
        // An impulse is kept as the relative velocity that it would give to the centres of mass.
        let per_second = move |p: Speed| widen(p).saturating_mul_int(rate.into());
        self.manifold.points().iter().map(move |point| {
            let p = self.contact.impulse_of(point.feature).unwrap_or_default();
            (point, [per_second(p.normal), per_second(p.tangent)])
        })
    }

    /// Where the solver had it in the last tick; `None` if there was nothing to solve, as with a sensor.
    #[must_use]
    pub fn solver_colour(&self) -> Option<SolverColour> {
        let touching = &self.world.scratch.found.touching;
        let place = touching.binary_search_by_key(&self.contact.shapes, |pair| pair.shapes).ok()?;
        self.world.scratch.solver.contact_colour(place)
    }

    /// `mA mB / (mA + mB)` in kg, where what is not dynamic counts as infinitely heavy: what a force between the two
    /// accelerates. 0 if neither is dynamic.
    #[must_use]
    pub fn reduced_mass(&self) -> Fx {
        let (a, b) = self.world.state.bodies_of(self.contact.shapes);
        match (a.is_dynamic(), b.is_dynamic()) {
            (true, true) => {
                let (light, heavy) = (a.mass().min(b.mass()), a.mass().max(b.mass()));
                let ratio = fx_div(light, heavy).unwrap_or_default();
                fx_div(light, ratio + fx!(1)).unwrap_or_default()
            }
            (true, false) => a.mass(),
            (false, true) => b.mass(),
            (false, false) => Fx::ZERO,
        }
    }
}
