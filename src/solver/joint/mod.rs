//! Joints: what a user defines, what the state keeps, and the rows and point blocks that the kernels solve.
//!
//! A kind of joint only lists its parts: along which direction which row springs, drives, limits or holds, and which
//! points are pinned. Everything else is the same for all but
//! hinges, of which there are most by far: they are solved in wide batches of their own. Within a joint the order is E. Catto's (Box2D v3): springs,
//! motors and limits first, and last what must not give way.

mod basis;
mod constraint;
mod def;
mod distance;
mod hinge;
mod list;
mod motor;
mod options;
mod parts;
mod place;
mod point;
mod prismatic;
mod revolute;
mod rotations;
mod row;
mod state;
mod weld;
mod wheel;

pub(super) use constraint::JointSet;
pub use def::{JointDef, JointFrame, JointKind, Threshold, ThresholdAction};
pub use distance::Distance;
pub use motor::{LinearDrive, Motor, Pull};
pub use options::{Drive, Limit, Soft, Spring};
pub use prismatic::Prismatic;
pub use revolute::Revolute;
pub use state::Joint;
pub use weld::Weld;
pub use wheel::Wheel;
