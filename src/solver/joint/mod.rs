//! Joints: what a user defines, what the state stores, and the rows and point blocks that the solver solves.
//!
//! A kind of joint only lists its parts (`parts`): which row is a spring, a motor, a limit or holds a position, along
//! which direction, and which points are pinned. Everything else is common to all kinds but hinges, which are by far
//! the most frequent and are solved in batches (`hinge`). Within a joint the order is that of Box2D v3: springs, motors
//! and limits first, and the rigid parts last.

mod cache_key;
mod constraint;
mod def;
mod distance;
mod hinge;
mod list;
mod motor;
mod options;
mod parts;
mod point;
mod pose;
mod prismatic;
mod revolute;
mod rotations;
mod row;
mod state;
mod weld;
mod wheel;

pub(super) use constraint::{JointSet, JointSource};
pub use def::{JointDef, JointFrame, JointKind, Threshold, ThresholdAction};
pub use distance::Distance;
pub use motor::{LinearDrive, Motor, Pull};
pub use options::{Drive, JointLimit, Soft, Spring};
pub use prismatic::Prismatic;
pub use revolute::Revolute;
pub use state::Joint;
pub use weld::Weld;
pub use wheel::Wheel;
