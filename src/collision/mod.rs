//! Collision detection: broad phase, narrow phase and what contacts remember. It reads bodies and returns
//! contacts; it never changes a body.

mod broad_phase;
mod circle_circle;
mod circle_hull;
mod contact;
mod hull_hull;
mod link;
mod manifold;
mod narrow_phase;
mod one_way;
mod pass_by;
mod pose;
mod segment;
mod sweep_and_prune;

pub use broad_phase::BroadPhaseKind;
pub(crate) use broad_phase::{BroadPhase, Pair, Proxy};
pub(crate) use contact::{Contact, PointImpulse, match_pairs};
pub(crate) use hull_hull::{AxisHint, SatCounters};
pub(crate) use link::Link;
pub use manifold::{Feature, Manifold, ManifoldPoint};
pub(crate) use narrow_phase::{collide, margin_for};
pub(crate) use one_way::OneWay;
pub(crate) use pass_by::{Passage, pass_by};
pub(crate) use pose::{Outline, PosedShape};
