//! Games with a planted mistake are found out, each by the way that is there for it; games without one are not.
#![expect(clippy::unwrap_used, reason = "what goes wrong in a helper fails the test")]

#[expect(unreachable_pub, reason = "elsewhere it is a library")]
#[path = "../../examples/fuzzing/src/lib.rs"]
mod harvest;
mod inputs;
mod physics;
mod planted;
mod random_order;
mod sandbox;
mod toy;
