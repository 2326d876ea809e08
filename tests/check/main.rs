//! Games with a planted fault fail the check in the variant for this kind of fault.
#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]

#[expect(unreachable_pub, reason = "the file is a library in its own package")]
#[path = "../../examples/fuzzing/src/lib.rs"]
mod harvest;
mod inputs;
mod physics;
mod planted;
mod random_order;
mod sandbox;
mod setup;
mod toy;
