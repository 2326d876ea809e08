use core::fmt;

use crate::body::ShapeId;
use crate::collision::{Contact, Manifold, ManifoldPoint};
use crate::math::{Fx, Speed, fx_mul, widen};
pub use crate::solver::SolverColour;
use crate::world::World;

/// Two shapes in contact.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[square])?;
/// # world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square])?;
/// # (0..20).for_each(|_| world.step());
/// use lockstep2d::world::ContactView;
/// let load = |contact: &ContactView| contact.forces().map(|(_, force)| force.normal).sum::<Fx>();
/// // Two points carry the weight of 10 N.
/// let contact = world.contacts().next().expect("a box on the ground");
/// assert!(contact.touching && (load(&contact) - fx!(10)).abs() < fx!(0.1));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy)]
pub struct ContactView<'a> {
    /// The shape in the smaller slot.
    pub shape_a: ShapeId,
    /// The shape in the larger slot.
    pub shape_b: ShapeId,
    /// Whether the shapes touch. If not, the contact is speculative.
    pub touching: bool,
    /// Normal and contact points.
    pub manifold: &'a Manifold,
    world: &'a World,
    contact: &'a Contact,
}

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

/// Force of a contact point on shape B.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, math::Fx, world::World};
/// use lockstep2d::world::ContactForce;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[square])?;
/// let scale = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square])?;
/// # (0..20).for_each(|_| world.step());
/// // The weight of the box is the sum of the forces that its ground exerts.
/// let push = |force: ContactForce| force.normal;
/// let pushes = world.contacts_of(scale).map(|contact| contact.forces().map(|(_, force)| push(force)).sum::<Fx>());
/// let weight: Fx = pushes.sum();
/// assert!((weight - fx!(10)).abs() < fx!(0.1));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactForce {
    /// Component along the normal in N, not negative.
    pub normal: Fx,
    /// Friction in N, along the normal rotated counter-clockwise by a right angle.
    pub friction: Fx,
}

impl World {
    /// Returns the contacts of the last tick that had points, sorted by pair, as found at the start of the tick.
    /// Leaves out contacts that an edit has ended, and contacts of bodies that have fallen asleep. Empty after a
    /// restore until the next tick.
    #[doc(alias = "manifold")]
    pub fn contacts(&self) -> impl Iterator<Item = ContactView<'_>> {
        let output = self.scratch.contacts.output();
        output.contacts.iter().zip(&output.manifolds).map(|(&index, manifold)| {
            let contact = &self.state.contacts[index as usize];
            let event = self.state.contact_event(contact);
            let (shape_a, shape_b) = (event.shape_a, event.shape_b);
            ContactView { shape_a, shape_b, touching: contact.touching, manifold, world: self, contact }
        })
    }

    /// Returns the depth in metres of the deepest point of the [contacts](World::contacts): 0 if nothing overlaps.
    #[doc(alias = "penetration")]
    #[must_use]
    pub fn deepest_overlap(&self) -> Fx {
        let points = self.contacts().flat_map(|contact| contact.manifold.points());
        points.map(|point| -widen(point.separation)).fold(Fx::ZERO, Fx::max)
    }
}

impl ContactView<'_> {
    /// Returns the force at each point of the manifold in the last sub-step of the tick, without restitution impulses.
    pub fn forces(&self) -> impl Iterator<Item = (&ManifoldPoint, ContactForce)> {
        let mass = self.reduced_mass();
        self.accelerations().map(move |(point, [normal, friction])| {
            (point, ContactForce { normal: fx_mul(normal, mass), friction: fx_mul(friction, mass) })
        })
    }

    /// Normal force and friction of each point, divided by the reduced mass: accelerations in m/s².
    pub(crate) fn accelerations(&self) -> impl Iterator<Item = (&ManifoldPoint, [Fx; 2])> {
        let config = self.world.config();
        let rate = config.tick_rate.saturating_mul(config.solver.sub_steps);
        // An impulse is stored as the relative velocity that it would give to the centres of mass.
        let per_second = move |p: Speed| widen(p).saturating_mul_int(rate.into());
        self.manifold.points().iter().map(move |point| {
            let p = self.contact.impulse_of(point.feature).unwrap_or_default();
            (point, [per_second(p.normal), per_second(p.tangent)])
        })
    }

    /// Colour of the contact in the solver's graph colouring. `None` if it was not solved.
    #[must_use]
    pub fn solver_colour(&self) -> Option<SolverColour> {
        let touching = &self.world.scratch.contacts.output().touching;
        let place = touching.binary_search_by_key(&self.contact.shapes, |pair| pair.shapes).ok()?;
        // The solver numbers pairs by the index of their manifold. `place` may be smaller than this index, because
        // edits remove pairs from `touching`.
        self.world.scratch.solver.contact_colour(touching.get(place)?.manifold as usize)
    }

    /// The mass that a force between the bodies accelerates: `mA mB / (mA + mB)` in kg. Bodies that are not dynamic or
    /// have no mass count as infinitely heavy. The result is 0 if both bodies count as infinitely heavy.
    #[must_use]
    pub fn reduced_mass(&self) -> Fx {
        self.world.state.reduced_mass(self.contact.shapes)
    }
}
