//! Desync reports of two peers whose states diverged.
#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]

mod bisect;
mod compare;
mod fields;
mod format;
mod strangers;
mod yard;

use lockstep2d_tests::sweep;
