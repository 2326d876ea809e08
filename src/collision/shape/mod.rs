//! Shapes in world axes, for the narrow phase and for queries.

pub(in crate::collision) mod link;
pub(in crate::collision) mod posed;
pub(in crate::collision) mod support;

pub(crate) use link::Link;
pub(crate) use posed::{Outline, PosedShape, arm_of};
pub(crate) use support::{Fraction, SupportShape, to_grid};
