//! Desync reports: comparing the evidence of two peers whose states diverged finds the peer, the tick and the field.
#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]

mod bisect;
mod compare;
mod fields;
mod format;
mod yard;

use lockstep2d_tests::sweep;
