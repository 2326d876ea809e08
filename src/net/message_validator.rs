//! [`MessageValidator`]: validates messages before GGRS reads them. It drops messages on which GGRS would panic, and
//! removes those parts with which a peer could decide alone which player has left.
//!
//! GGRS trusts the messages of the peers of a game. All messages of one remote pass through this validator first; those
//! that GGRS could not have sent are dropped.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::time::Duration;

use ggrs::Message;
use ggrs_bincode::Options as _;
use serde::{Deserialize, Serialize};

use super::options::INPUT_DELAY_MAX;
use super::transport::PACKET_BYTES_MAX;

/// Layout of GGRS's messages, version 0.13.
#[derive(Serialize, Deserialize)]
struct Shadow {
    magic: u16,
    body: Body,
}

#[derive(Serialize, Deserialize)]
enum Body {
    SyncRequest(u32),
    SyncReply(u32),
    Input(Input),
    InputAck(i32),
    QualityReport { frame_advantage: i16, ping: u128 },
    QualityReply { pong: u128 },
    ChecksumReport { checksum: u128, frame: i32 },
    KeepAlive,
}

#[derive(Serialize, Deserialize)]
struct Input {
    connections: Vec<Connection>,
    disconnect_requested: bool,
    start_frame: i32,
    ack_frame: i32,
    bytes: Vec<u8>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
struct Connection {
    disconnected: bool,
    last_frame: i32,
}

/// Maximum number of frames that a peer can be ahead: GGRS has room for 128.
const FRAMES_AHEAD: i32 = 96;
/// Maximum number of bytes of the unpacked inputs in one message.
const INPUT_BYTES_MAX: usize = 64 << 10;
/// Retransmission interval of inputs, and of the synchronisation request before the first input. Without
/// retransmission, peers that all wait for a lost packet would have no newer inputs to send.
const SEND_AGAIN: Duration = Duration::from_millis(50);
/// Number of own pings that are kept.
const PINGS: usize = 16;

/// State of the message validator for one remote in one session.
#[derive(Debug)]
pub(super) struct MessageValidator {
    players: usize,
    /// The newest frame whose input has been accepted; -1 before the first.
    last_frame: i32,
    /// Pings that have been sent and not been answered.
    pings: VecDeque<u128>,
    /// The last message to the remote that must not be lost, and the time at which it was sent.
    needed: Option<(Duration, Vec<u8>)>,
}

impl MessageValidator {
    pub(super) const fn new(players: usize) -> Self {
        MessageValidator { players, last_frame: -1, pings: VecDeque::new(), needed: None }
    }

    /// Encodes a message to the remote and records it.
    pub(super) fn send(&mut self, message: &Message, now: Duration) -> Option<Vec<u8>> {
        let bytes = layout().serialize(message).ok()?;
        match layout().deserialize(&bytes).map(|shadow: Shadow| shadow.body) {
            Ok(Body::QualityReport { ping, .. }) => {
                if self.pings.len() == PINGS {
                    self.pings.pop_front();
                }
                self.pings.push_back(ping);
            }
            Ok(Body::Input(_) | Body::SyncRequest(_)) => self.needed = Some((now, bytes.clone())),
            _ => {}
        }
        Some(bytes)
    }

    /// The message to retransmit, if one is due. GGRS itself waits four times as long, measured by the system clock.
    pub(super) fn send_again(&mut self, now: Duration) -> Option<Vec<u8>> {
        let (sent, bytes) = self.needed.as_mut().filter(|(sent, _)| now >= *sent + SEND_AGAIN)?;
        *sent = now;
        Some(bytes.clone())
    }

    /// Decodes a message of the remote, if it is safe to pass to GGRS. `frame` is the current local frame.
    pub(super) fn receive(&mut self, bytes: &[u8], frame: i32) -> Option<Message> {
        let mut shadow: Shadow = layout().deserialize(bytes).ok()?;
        let frames = -1..=frame.saturating_add(FRAMES_AHEAD);
        match &mut shadow.body {
            Body::Input(input) => self.check_input(input, frame)?,
            // An unknown pong would give an absurd round-trip time.
            Body::QualityReply { pong } => {
                let known = self.pings.iter().position(|ping| ping == pong)?;
                self.pings.remove(known);
            }
            Body::ChecksumReport { frame, .. } | Body::InputAck(frame) if !frames.contains(frame) => {
                return None;
            }
            _ => {}
        }
        layout().deserialize(&layout().serialize(&shadow).ok()?).ok()
    }

    fn check_input(&mut self, input: &mut Input, frame: i32) -> Option<()> {
        // Peers agree on departures in `departure.rs`, because GGRS could let each peer end a player at another frame.
        input.disconnect_requested = false;
        input.connections.iter_mut().for_each(|connection| connection.disconnected = false);
        let frames = -1..=frame.saturating_add(FRAMES_AHEAD);
        let possible = input.connections.iter().all(|connection| frames.contains(&connection.last_frame));
        let first = if self.last_frame < 0 { i32::from(INPUT_DELAY_MAX) } else { self.last_frame + 1 };
        if !possible
            || input.connections.len() != self.players
            || !frames.contains(&input.ack_frame)
            || !(0..=first).contains(&input.start_frame)
        {
            return None;
        }
        let count = i32::try_from(count_inputs(&unpack(&input.bytes)?)?).ok()?;
        let last = input.start_frame + count - 1;
        if count == 0 || !frames.contains(&last) {
            return None;
        }
        self.last_frame = self.last_frame.max(last);
        Some(())
    }
}

fn layout() -> impl ggrs_bincode::Options {
    ggrs_bincode::DefaultOptions::new()
        .with_fixint_encoding()
        .with_limit(PACKET_BYTES_MAX as u64)
        .reject_trailing_bytes()
}

/// Number of inputs, each preceded by its length in two bytes; `None` if the last one is incomplete.
fn count_inputs(mut bytes: &[u8]) -> Option<usize> {
    let mut count = 0;
    while let Some((length, rest)) = bytes.split_first_chunk() {
        bytes = rest.get(usize::from(u16::from_le_bytes(*length))..)?;
        count += 1;
    }
    bytes.is_empty().then_some(count)
}

/// Decodes the run-length encoding of `bitfield-rle`, up to [`INPUT_BYTES_MAX`] bytes.
///
/// Every part starts with a varint. Its lowest bit tells whether a run of equal bytes follows, and the next bit whether
/// these are ones. The other bits are the number of bytes.
fn unpack(mut bytes: &[u8]) -> Option<Vec<u8>> {
    let mut unpacked = Vec::new();
    while !bytes.is_empty() {
        let head = varint(&mut bytes)?;
        let is_run = head & 1 == 1;
        let length = usize::try_from(if is_run { head >> 2 } else { head >> 1 }).ok()?;
        if length > INPUT_BYTES_MAX - unpacked.len() {
            return None;
        }
        if is_run {
            unpacked.resize(unpacked.len() + length, if head & 2 == 2 { 255 } else { 0 });
        } else {
            unpacked.extend_from_slice(bytes.get(..length)?);
            bytes = &bytes[length..];
        }
    }
    Some(unpacked)
}

/// Reads a varint with seven bits per byte, lowest bits first; at most four bytes.
fn varint(bytes: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for shift in [0, 7, 14, 21] {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u32::from(byte & 127) << shift;
        if byte & 128 == 0 {
            return Some(value);
        }
    }
    None
}
