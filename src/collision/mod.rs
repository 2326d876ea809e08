//! Collision detection: broad phase, narrow phase and what contacts remember. It reads bodies and returns
//! contacts; it never changes a body.

mod broad_phase;
mod circle_circle;
mod circle_hull;
mod contact;
mod core;
mod distance;
mod hull_hull;
mod manifold;
mod narrow_phase;
mod pose;
mod ray;
mod segment;
mod shape_cast;
mod sweep_and_prune;
mod time_of_impact;

pub use broad_phase::BroadPhaseKind;
pub(crate) use broad_phase::{BroadPhase, Pair, Proxy};
pub(crate) use contact::{Contact, PointImpulse, match_pairs};
pub(crate) use core::{Core, to_grid};
pub(crate) use distance::{Distance, distance, overlap};
pub(crate) use hull_hull::{AxisHint, SatCounters};
pub use manifold::{Feature, Manifold, ManifoldPoint};
pub(crate) use narrow_phase::{collide, margin_for};
pub(crate) use pose::{Outline, PosedShape};
pub(crate) use ray::{RayHit, cast_ray, contains_point};
pub(crate) use shape_cast::{SKIN, ShapeHit, cast_shape};
pub(crate) use time_of_impact::{Sweep, TimeOfImpact, time_of_impact};
