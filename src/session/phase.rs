//! The phases of an endpoint, from its request to join until it takes part.

use alloc::boxed::Box;

use super::state::Session;
use super::transfer::Download;

#[derive(Debug)]
pub(super) enum Phase {
    Asking {
        nonce: u64,
        cookie: u64,
        next_at: u64,
    },
    Downloading(Download),
    InMatch(Box<Session>),
    /// The contact has refused the request. Waits for `Endpoint::ask`.
    Refused,
}

impl Phase {
    /// Before the first request, or while one phase replaces another.
    pub(super) const UNASKED: Self = Phase::Asking { nonce: 0, cookie: 0, next_at: u64::MAX };
}
