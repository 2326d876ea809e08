//! Collision detection: broad phase, narrow phase, queries, and contacts.

mod broad_phase;
mod contact;
mod kept_manifold;
mod manifold;
mod narrow_phase;
mod query;
mod shape;

pub use broad_phase::BroadPhaseKind;
pub(crate) use broad_phase::{BroadPhase, Moved};
pub(crate) use contact::{Contact, Pair, PointImpulse};
pub(crate) use kept_manifold::{KeptManifold, KeptSide};
pub use manifold::{Feature, Manifold, ManifoldPoint};
pub(crate) use narrow_phase::{
    BoxPairs, CachedAxis, GhostFilter, OneWay, SatCounters, SmallBoxes, SmallBoxesRange, collide,
    collide_near, is_ghost, is_open, margin_for, may_meet, pass_direction,
};
pub(crate) use query::{
    Distance, RelativePose, Ring, SKIN, SKIN_TOLERANCE, ShapeHit, StartPolicy, Sweep, TimeOfImpact, cast_ray,
    cast_shape, contains_point, distance, first_impact, first_overlap, goes_against, normal_at, overlap,
    time_of_impact,
};
pub(crate) use shape::{Fraction, Link, Outline, PosedShape, SupportShape, arm_of, to_grid};
