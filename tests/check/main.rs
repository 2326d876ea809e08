//! A game with a planted fault fails the check, and the failure names the variant that is meant for this kind of fault.
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
