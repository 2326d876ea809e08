//! Joints: their definitions, their state, and their rows and point blocks.
//!
//! A kind of joint lists its parts (`parts`): rows, each with a function (spring, motor, limit, hold) and a direction,
//! and points, which pull or drive the anchors. A coupling (`coupling`) computes the row of a gear, a rack or a pulley.
//! Hinges are solved in batches (`hinge`). As in Box2D v3, rows of springs, motors and limits come before rows that
//! hold a position.

mod block;
mod cache_key;
mod constraint;
mod coupling;
mod def;
mod distance;
mod gear;
mod hinge;
mod list;
mod motor;
mod options;
mod parts;
mod point;
mod pose;
mod prismatic;
mod pulley;
mod revolute;
mod rotations;
mod row;
mod share;
mod state;
mod weld;
mod wheel;

pub(super) use constraint::{JointSet, JointSource};
pub use def::{JointDef, JointFrame, JointKind, Threshold, ThresholdAction};
pub use distance::Distance;
pub use gear::{Gear, Rack};
pub use motor::{LinearDrive, Motor, Pull};
pub use options::{Drive, JointLimit, Soft, Spring};
pub use prismatic::Prismatic;
pub use pulley::Pulley;
pub use revolute::Revolute;
pub(super) use share::JointShare;
pub use state::{Joint, JointPart};
pub use weld::Weld;
pub use wheel::Wheel;
