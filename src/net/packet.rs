//! The packets that peers exchange, and their encoding.
//!
//! A packet is a checksum followed by the canonical encoding of a [`Packet`]. A packet that does not decode, is too
//! long or has a wrong checksum is dropped silently, like a packet lost by the network.

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::handshake::HandshakeParameters;
use super::transport::PACKET_BYTES_MAX;
use super::wire::Address;
use crate::codec;
use crate::hash::StateHash;

/// Identifies a session: a range of ticks played by the same players.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct SessionId(pub(super) u64);

/// Identifies one attempt of one peer to join.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Nonce(pub(super) u64);

/// Reason why a peer is refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Refused {
    /// The handshake parameters differ; these are the right ones.
    HandshakeParameters(HandshakeParameters),
    /// All seats are taken, or too many peers are joining.
    Full,
    /// The state after catching up has another hash.
    Diverged { tick: u64 },
    /// Any other reason.
    Other(String),
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Packet<A> {
    /// A peer asks to join or to watch.
    Hello { nonce: Nonce, parameters: HandshakeParameters, seat: Option<u32>, watch: bool },
    /// The request is refused.
    Refused { nonce: Nonce, why: Refused },
    /// Another peer decides about requests.
    Redirect { nonce: Nonce, to: A },
    /// The request is accepted. The peer begins with the state after `tick` ticks, which has this hash and `length`
    /// bytes.
    Welcome { nonce: Nonce, tick: u64, hash: StateHash, length: u64 },
    /// The joining peer requests the bytes of that state from `offset` on.
    WantState { nonce: Nonce, offset: u64 },
    /// A piece of that state.
    State { nonce: Nonce, offset: u64, bytes: Vec<u8> },
    /// The joining peer requests inputs from tick `from` on.
    WantInputs { nonce: Nonce, from: u64 },
    /// The inputs of ticks from `from` on, one list per tick with the encoded inputs of all seats, and the number of
    /// final ticks.
    Inputs { nonce: Nonce, from: u64, ticks: Vec<Vec<u8>>, committed: u64 },
    /// The joining peer has caught up, and its state after `tick` ticks has this hash.
    Ready { nonce: Nonce, tick: u64, hash: StateHash },
    /// A proposed session.
    Plan { parent: SessionId, plan: Plan<A> },
    /// The proposed session is acknowledged.
    Agreed { plan: SessionId },
    /// The seats in `gone` have left this session, for which the sender has the final inputs of `ticks` ticks. If
    /// `settled`, the sender has already continued without them from tick `ticks` on, and needs no answer.
    Gone { session: SessionId, gone: u64, ticks: u64, settled: bool },
    /// The sender leaves.
    Bye { session: SessionId },
    /// A message of GGRS.
    Session { session: SessionId, message: Vec<u8> },
}

/// A proposed session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Plan<A> {
    pub(super) session: SessionId,
    /// First tick.
    pub(super) base: u64,
    /// Seat of the receiver.
    pub(super) seat: u32,
    /// The players except the receiver, in ascending order of seats. The sender has no address, because it does not
    /// know its own.
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
