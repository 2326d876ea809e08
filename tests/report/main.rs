//! What two peers tell together after their states have become different.
#![expect(clippy::unwrap_used, reason = "what goes wrong in a helper fails the test")]

mod bisect;
mod compare;
mod fields;
mod format;
#[path = "../common/sweep.rs"]
mod sweep;
mod yard;
