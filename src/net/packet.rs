//! What peers say to each other, and the bytes of it.
//!
//! A packet is a checksum and the canonical encoding of a [`Packet`]. What does not decode, is too long or has another
//! checksum is dropped without a word, as networks do.

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::terms::Terms;
use super::transport::PACKET_BYTES_MAX;
use super::wire::Address;
use crate::codec;
use crate::hash::StateHash;

/// Names a session: a stretch of ticks that the same players play.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct SessionId(pub(super) u64);

/// Names one attempt of one peer to take part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Nonce(pub(super) u64);

/// Why somebody may not take part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Refused {
    /// The terms are others: here are the right ones.
    Terms(Terms),
    /// All seats are taken, or too many others are about to join.
    Full,
    /// The state reached by catching up is another one.
    Diverged { tick: u64 },
    /// Anything that is not in this list.
    Other(String),
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Packet<A> {
    /// A peer wants to take part, or to watch.
    Hello { nonce: Nonce, terms: Terms, seat: Option<u32>, watch: bool },
    /// It may not.
    Refused { nonce: Nonce, why: Refused },
    /// Somebody else decides.
    Redirect { nonce: Nonce, to: A },
    /// It may, and begins with the state after `tick` ticks, which has this hash and `length` bytes.
    Welcome { nonce: Nonce, tick: u64, hash: StateHash, length: u64 },
    /// It asks for that state's bytes from `offset` on.
    WantState { nonce: Nonce, offset: u64 },
    /// Some of them.
    State { nonce: Nonce, offset: u64, bytes: Vec<u8> },
    /// It asks for inputs from tick `from` on.
    WantInputs { nonce: Nonce, from: u64 },
    /// The inputs of some ticks from `from` on, each all seats' with its length in front; and how many ticks are final.
    Inputs { nonce: Nonce, from: u64, ticks: Vec<Vec<u8>>, committed: u64 },
    /// It has caught up, and its state after `tick` ticks has this hash.
    Ready { nonce: Nonce, tick: u64, hash: StateHash },
    /// The next session.
    Plan { parent: SessionId, plan: Plan<A> },
    /// The plan is known.
    Agreed { plan: SessionId },
    /// The seats in `gone` have left this session, of which the sender has final inputs for `ticks` ticks.
    /// `settled` if it has gone on since: then it needs no answer.
    Gone { session: SessionId, gone: u64, ticks: u64, settled: bool },
    /// The sender leaves.
    Bye { session: SessionId },
    /// A message of GGRS.
    Session { session: SessionId, message: Vec<u8> },
}

/// A session to come.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Plan<A> {
    pub(super) session: SessionId,
    /// Its first tick.
    pub(super) base: u64,
    /// The seat of who reads this.
    pub(super) seat: u32,
    /// Who plays, in ascending order of seats, but for the reader; the sender does not know its own address.
    pub(super) others: Vec<(u32, Option<A>)>,
}

const CHECKSUM_BYTES: usize = 8;

fn checksum(body: &[u8]) -> [u8; CHECKSUM_BYTES] {
    let hash = StateHash::of_bytes(body).0.to_le_bytes();
    [hash[0], hash[1], hash[2], hash[3], hash[4], hash[5], hash[6], hash[7]]
}

impl<A: Address> Packet<A> {
    pub(super) fn encode(&self) -> Vec<u8> {
        let body = codec::encode(self);
        let mut bytes = checksum(&body).to_vec();
        bytes.extend_from_slice(&body);
        bytes
    }

    pub(super) fn decode(bytes: &[u8]) -> Option<Self> {
        if bytes.len() > PACKET_BYTES_MAX {
            return None;
        }
        let (sum, body) = bytes.split_first_chunk::<CHECKSUM_BYTES>()?;
        if checksum(body) != *sum {
            return None;
        }
        codec::decode(body).ok()
    }
}
