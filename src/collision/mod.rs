//! Collision detection: broad phase, narrow phase and what contacts remember. It reads bodies and returns
//! contacts; it never changes a body.

mod box_box;
mod box_list;
mod broad_phase;
mod circle_circle;
mod circle_hull;
mod contact;
mod core;
mod distance;
mod hull_hull;
mod link;
mod manifold;
mod narrow_phase;
mod one_way;
mod pass_by;
mod pose;
mod ray;
mod search;
mod segment;
mod shape_cast;
mod sweep_and_prune;
mod time_of_impact;
mod tree;

pub(crate) use box_box::{BoxPairs, SmallBoxes};
pub use broad_phase::BroadPhaseKind;
pub(crate) use broad_phase::{BroadPhase, Moved, Pair};
pub(crate) use contact::{Contact, PointImpulse};
pub(crate) use core::{Core, Fraction};
pub(crate) use distance::{distance, overlap};
pub(crate) use link::Link;
pub use manifold::{Feature, Manifold, ManifoldPoint};
pub(crate) use narrow_phase::{collide, collide_near, margin_for, may_meet};
pub(crate) use one_way::OneWay;
pub(crate) use pass_by::{Passage, pass_by};
pub(crate) use pose::{Outline, PosedShape, arm_of};
pub(crate) use ray::{cast_ray, contains_point};
pub(crate) use shape_cast::{SKIN, ShapeHit, cast_shape};
pub(crate) use time_of_impact::{Sweep, TimeOfImpact, time_of_impact};
