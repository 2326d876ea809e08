//! Shapes in world axes: as the narrow phase collides them, and as queries see them.

pub(in crate::collision) mod link;
pub(in crate::collision) mod posed;
pub(in crate::collision) mod support;

pub(crate) use link::Link;
pub(crate) use posed::{Outline, PosedShape, arm_of};
pub(crate) use support::{Fraction, SupportShape};
