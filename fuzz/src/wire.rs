//! Copies of the packet layouts of `lockstep2d::net` and GGRS, to read and forge packets.

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::net::HandshakeParameters;
use serde::{Deserialize, Serialize};

const CHECKSUM_BYTES: usize = 8;

/// A packet of the engine.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Packet {
    Hello { nonce: u64, parameters: HandshakeParameters, seat: Option<u32>, watch: bool },
    Refused { nonce: u64, why: Refused },
    Redirect { nonce: u64, to: u32 },
    Welcome { nonce: u64, tick: u64, hash: StateHash, length: u64 },
    WantState { nonce: u64, offset: u64 },
    State { nonce: u64, offset: u64, bytes: Vec<u8> },
    WantInputs { nonce: u64, from: u64 },
    Inputs { nonce: u64, from: u64, ticks: Vec<Vec<u8>>, committed: u64 },
    Ready { nonce: u64, tick: u64, hash: StateHash },
    Plan { parent: u64, plan: Plan },
    Agreed { plan: u64 },
    Gone { session: u64, gone: u64, ticks: u64, settled: bool },
    Bye { session: u64 },
    Session { session: u64, message: Vec<u8> },
}

/// Reason why a peer is refused.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Refused {
    HandshakeParameters(HandshakeParameters),
    Full,
    Diverged { tick: u64 },
    Other(String),
}

/// A proposed session.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Plan {
    pub session: u64,
    pub base: u64,
    pub seat: u32,
    pub others: Vec<(u32, Option<u32>)>,
}

/// A message of GGRS 0.13.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Message {
    pub magic: u16,
    pub body: Body,
}

/// The body of a GGRS message.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Body {
    SyncRequest(u32),
    SyncReply(u32),
    Input(Input),
    InputAck(i32),
    QualityReport { frame_advantage: i16, ping: u128 },
    QualityReply { pong: u128 },
    ChecksumReport { checksum: u128, frame: i32 },
    KeepAlive,
}

/// Inputs of some frames, run-length encoded.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Input {
    /// For each player, whether it is disconnected and its last frame.
    pub connections: Vec<(bool, i32)>,
    pub disconnect_requested: bool,
    pub start_frame: i32,
    pub ack_frame: i32,
    pub bytes: Vec<u8>,
}

impl Packet {
    /// Decodes a packet without checking its checksum.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        codec::decode(bytes.get(CHECKSUM_BYTES..)?).ok()
    }

    /// Encodes the packet with a correct checksum.
    #[must_use]
    pub fn write(&self) -> Vec<u8> {
        let mut bytes = vec![0; CHECKSUM_BYTES];
        codec::encode_into(self, &mut bytes);
        repair(&mut bytes);
        bytes
    }
}

fn checksum(packet: &[u8]) -> Option<[u8; CHECKSUM_BYTES]> {
    let hash = StateHash::of_bytes(packet.get(CHECKSUM_BYTES..)?);
    hash.0.to_le_bytes().first_chunk().copied()
}

/// Whether the checksum is correct.
#[must_use]
pub fn is_right(packet: &[u8]) -> bool {
    checksum(packet).is_some_and(|sum| packet.starts_with(&sum))
}

/// Corrects the checksum.
pub fn repair(packet: &mut [u8]) {
    if let Some(sum) = checksum(packet) {
        packet[..CHECKSUM_BYTES].copy_from_slice(&sum);
    }
}
