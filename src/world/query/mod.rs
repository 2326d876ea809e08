//! Queries that find shapes of a world between ticks. They see enabled bodies at their current poses.
//!
//! The order of results is part of the contract. Hits of rays and of casts without rotation are ordered by their exact
//! fraction before rounding, then by slot. Casts that turn use the rounded fraction. Lists of shapes and planes near a
//! place are in slot order.

mod cast;
mod character;
mod mover_planes;
mod one_way;
mod overlap;
mod probe;
mod seam;
mod single;
mod step_edge;
mod turning;
mod walk;

pub use cast::{CastHit, RayHit};
pub use character::{Moved, Mover, MoverState};
pub use mover_planes::{MoverPlane, clip_velocity, solve_planes};
pub use overlap::ClosestPoints;
pub use probe::Probe;
pub use single::{Displacement, ProbeHit, TimeOfImpact};

use super::World;
use crate::body::{BodyId, Handle, ShapeId};
use crate::fx;
use crate::math::Fx;

/// Margin in metres by which a search enlarges its area, because positions are rounded to a grid.
const SLACK: Fx = fx!(0.000001);

/// Selects the shapes that a query sees. The collision filters of shape and query must accept each other.
///
/// ```
/// use lockstep2d::world::QueryFilter;
/// let solid = QueryFilter::default();
/// let walls_only = QueryFilter { mask: 0b10, ..QueryFilter::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueryFilter {
    /// Categories that the query belongs to.
    pub category: u64,
    /// Categories that the query sees.
    pub mask: u64,
    /// Whether the query sees sensors.
    pub sensors: bool,
    /// A body that the query does not see, usually the one that makes the query.
    pub except: Option<BodyId>,
    /// Further bodies that the query does not see.
    pub except_also: [Option<BodyId>; Self::EXCEPT_ALSO_MAX],
    /// Treatment of shapes that contain or overlap the start of a ray or cast.
    pub initial_overlap: InitialOverlap,
}

/// Treatment of shapes that contain or overlap the start of a ray or cast. Hits on such shapes have `starts_inside`
/// set.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::{fx, math::Vec2, world::{InitialOverlap, QueryFilter}};
/// # let mut world = World::default();
/// let room = ShapeDef::new(Polygon::square(fx!(2))?);
/// world.spawn(&BodyDef::fixed(), &[room])?;
/// // A ray that starts inside a shape.
/// let outside = Vec2::new(fx!(5), fx!(0));
/// let solid = world.cast_ray(Vec2::ZERO, outside, QueryFilter::default());
/// assert!(solid.is_some_and(|hit| hit.starts_inside && hit.fraction == 0));
/// let hollow = QueryFilter::default().initial_overlap(InitialOverlap::Ignore);
/// assert_eq!(world.cast_ray(Vec2::ZERO, outside, hollow), None);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InitialOverlap {
    /// A ray reports such shapes, at fraction 0. A cast reports only the shapes into which it would move deeper.
    #[default]
    Resist,
    /// Rays and casts report such shapes, at fraction 0.
    Report,
    /// Rays and casts do not see such shapes, such as a floor into which a body has sunk slightly.
    Ignore,
}

impl Default for QueryFilter {
    /// Sees everything except sensors.
    fn default() -> Self {
        QueryFilter {
            category: u64::MAX,
            mask: u64::MAX,
            sensors: false,
            except: None,
            except_also: [None; Self::EXCEPT_ALSO_MAX],
            initial_overlap: InitialOverlap::Resist,
        }
    }
}

impl QueryFilter {
    /// Largest number of bodies in [`QueryFilter::except_also`].
    pub const EXCEPT_ALSO_MAX: usize = 8;

    /// Replaces [`QueryFilter::except_also`]. `None` if there are more than [`QueryFilter::EXCEPT_ALSO_MAX`] bodies.
    #[must_use]
    pub fn except_all(mut self, bodies: &[BodyId]) -> Option<Self> {
        self.except_also = [None; Self::EXCEPT_ALSO_MAX];
        for (i, &body) in bodies.iter().enumerate() {
            *self.except_also.get_mut(i)? = Some(body);
        }
        Some(self)
    }

    /// Sets the treatment of shapes that contain or overlap the start of a ray or cast.
    #[must_use]
    pub const fn initial_overlap(mut self, overlap: InitialOverlap) -> Self {
        self.initial_overlap = overlap;
        self
    }

    fn leaves_out(&self, body: BodyId) -> bool {
        self.except == Some(body) || self.except_also.contains(&Some(body))
    }

    /// Sets the body that the query does not see ([`QueryFilter::except`]).
    #[must_use]
    pub const fn except(mut self, body: BodyId) -> Self {
        self.except = Some(body);
        self
    }
}

impl World {
    fn is_present(&self, id: ShapeId) -> bool {
        self.state.shapes.get(id).is_some() && self.state.body_of(id.slot()).enabled
    }

    /// The handle of the shape in a slot if the query sees it.
    fn seen(&self, slot: u32, filter: QueryFilter) -> Option<ShapeId> {
        let shape = self.state.shapes.at(slot);
        let accepted =
            shape.filter().mask & filter.category != 0 && shape.filter().category & filter.mask != 0;
        let wanted = (filter.sensors || !shape.is_sensor()) && !filter.leaves_out(shape.body());
        (accepted && wanted).then(|| self.state.shapes.handle_at(slot))
    }
}
