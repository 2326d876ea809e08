//! Transfer of states in chunks. The receiver reports which chunks it has and how many may be in flight. The sender
//! sends missing chunks, repeatedly if they are lost, at a rate set by congestion control.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::congestion::Congestion;
use super::id::Tick;
use super::join_packet::{CHUNK_BYTES, JoinPacket, MASKS_MAX};
use super::view::has_bit;

/// Initial window: number of chunks that may be in flight.
const WINDOW_MIN: u32 = 56;
/// Largest window in chunks.
const WINDOW_MAX: u32 = 960;
/// Maximum time between two requests for chunks, in microseconds.
const WANT_INTERVAL: u64 = 20_000;
/// Number of received chunks after which the next request is sent early.
const WANT_CHUNKS: u32 = 16;
/// Round trip that is assumed before one is measured, in microseconds.
const ROUND_TRIP: u64 = 250_000;

pub(super) fn hash(bytes: &[u8]) -> u64 {
    let digest = twox_hash::XxHash3_128::oneshot(bytes).to_le_bytes();
    let [a, b, c, d, e, f, g, h, ..] = digest;
    u64::from_le_bytes([a, b, c, d, e, f, g, h])
}

fn chunk_count(length: u64) -> u32 {
    let chunk = u64::try_from(CHUNK_BYTES).unwrap_or(1);
    u32::try_from(length.div_ceil(chunk)).unwrap_or(u32::MAX)
}

#[derive(Debug)]
pub(super) struct Pinned {
    pub(super) tick: Tick,
    pub(super) hash: u64,
    pub(super) bytes: Vec<u8>,
}

impl Pinned {
    pub(super) fn new(tick: Tick, bytes: Vec<u8>) -> Self {
        Pinned { tick, hash: hash(&bytes), bytes }
    }
}

/// Whether a request ([`JoinPacket::Want`]) with these `masks` and this `next` reports chunk `index` as received.
fn in_masks(masks: &[u64], next: u32, index: u32) -> bool {
    let Some(after) = index.checked_sub(next) else { return true };
    let word = usize::try_from(after / 64).ok().and_then(|word| masks.get(word));
    word.is_some_and(|&mask| has_bit(mask, usize::try_from(after % 64).unwrap_or(64)))
}

#[derive(Clone, Debug)]
pub(super) struct Upload {
    pub(super) state: Arc<Pinned>,
    /// For each chunk: time of the last transmission, and number of transmissions.
    sent: Vec<(u64, u32)>,
    next: u32,
    window: u32,
    masks: Vec<u64>,
    round_trip: u64,
    cursor: u32,
    congestion: Congestion,
}

impl Upload {
    pub(super) fn new(state: Arc<Pinned>) -> Self {
        let count = chunk_count(u64::try_from(state.bytes.len()).unwrap_or(u64::MAX));
        let sent = alloc::vec![(0, 0); usize::try_from(count).unwrap_or(0)];
        let congestion = Congestion::new();
        let round_trip = ROUND_TRIP;
        Upload { state, sent, next: 0, window: 0, masks: Vec::new(), round_trip, cursor: 0, congestion }
    }

    fn has(&self, index: u32) -> bool {
        in_masks(&self.masks, self.next, index)
    }

    pub(super) fn take(&mut self, now: u64, next: u32, window: u32, masks: Vec<u64>) {
        if next < self.next {
            return;
        }
        let (first, masks_before) = (self.next, core::mem::replace(&mut self.masks, masks));
        self.next = next;
        self.window = window.min(WINDOW_MAX);
        self.cursor = next;
        // The round trip is measured with the highest chunk that arrived since the previous request, if this chunk was
        // sent only once.
        let end = next.saturating_add(self.window);
        let newest =
            (first..end).rev().find(|&index| self.has(index) && !in_masks(&masks_before, first, index));
        let sent = newest.and_then(|index| self.sent.get(usize::try_from(index).ok()?));
        if let Some(&(at, 1)) = sent {
            let sample = now.saturating_sub(at);
            self.congestion.measure(sample);
            self.round_trip = (3 * self.round_trip + sample) / 4;
        }
    }

    /// The next chunk that is missing and not in flight, if the window and the rate allow one.
    pub(super) fn next_chunk(&mut self, now: u64) -> Option<JoinPacket> {
        let again = self.round_trip + self.round_trip / 4 + 2 * WANT_INTERVAL;
        let end = self.next.saturating_add(self.window);
        while self.cursor < end && self.congestion.may_send(now) {
            let index = self.cursor;
            self.cursor += 1;
            if self.has(index) {
                continue;
            }
            let place = usize::try_from(index).ok()?;
            let (at, count) = self.sent.get_mut(place)?;
            if *count > 0 && now < at.saturating_add(again) {
                continue;
            }
            let is_again = *count > 0;
            *at = now;
            *count = count.saturating_add(1);
            let start = place * CHUNK_BYTES;
            let bytes = self.state.bytes.get(start..)?;
            let bytes = bytes.get(..CHUNK_BYTES).unwrap_or(bytes).to_vec();
            self.congestion.note_sent(u64::try_from(bytes.len()).unwrap_or(u64::MAX), is_again);
            return Some(JoinPacket::Chunk { hash: self.state.hash, index, bytes });
        }
        None
    }
}

#[derive(Clone, Debug)]
pub(super) struct Download {
    pub(super) hash: u64,
    length: u64,
    /// The bytes of the state up to the end of the highest received chunk. The buffer grows as chunks arrive, because
    /// the announced length may be wrong.
    bytes: Vec<u8>,
    have: Vec<bool>,
    next: u32,
    missing: u32,
    window: u32,
    want_at: u64,
    grow_at: u64,
    arrived: u32,
    pub(super) moved_at: u64,
}

impl Download {
    pub(super) fn new(now: u64, hash: u64, length: u64) -> Option<Self> {
        let count = chunk_count(length);
        let have = alloc::vec![false; usize::try_from(count).ok()?];
        Some(Download {
            hash,
            length,
            bytes: Vec::new(),
            have,
            next: 0,
            missing: count,
            window: WINDOW_MIN,
            want_at: 0,
            grow_at: now,
            arrived: 0,
            moved_at: now,
        })
    }

    /// Stores a chunk. Ignores chunks of a wrong length, and chunks beyond the largest window.
    pub(super) fn take(&mut self, now: u64, index: u32, bytes: &[u8]) {
        let Ok(place) = usize::try_from(index) else { return };
        let Some(have) = self.have.get_mut(place).filter(|have| !**have) else { return };
        let Ok(length) = usize::try_from(self.length) else { return };
        let start = place * CHUNK_BYTES;
        let end = (start + CHUNK_BYTES).min(length);
        let is_wanted = index < self.next.saturating_add(WINDOW_MAX);
        if !is_wanted || end - start != bytes.len() {
            return;
        }
        if self.bytes.len() < end {
            self.bytes.resize(end, 0);
        }
        let Some(target) = self.bytes.get_mut(start..end) else { return };
        target.copy_from_slice(bytes);
        *have = true;
        self.missing -= 1;
        self.arrived += 1;
        self.moved_at = now;
        while usize::try_from(self.next).ok().and_then(|next| self.have.get(next)) == Some(&true) {
            self.next += 1;
        }
    }

    pub(super) fn want(&mut self, now: u64) -> Option<JoinPacket> {
        if now < self.want_at && self.arrived < WANT_CHUNKS {
            return None;
        }
        if self.arrived > 0 && now >= self.grow_at {
            self.window = (self.window + self.window / 2).min(WINDOW_MAX);
            self.grow_at = now + 2 * WANT_INTERVAL;
        }
        self.want_at = now + WANT_INTERVAL;
        self.arrived = 0;
        let start = usize::try_from(self.next).ok()?;
        let after = self.have.get(start..).unwrap_or_default();
        let word = |chunks: &[bool]| {
            chunks
                .iter()
                .enumerate()
                .filter(|(_, have)| **have)
                .fold(0, |set, (bit, _)| set | super::view::bit(bit))
        };
        let mut masks: Vec<u64> = after.chunks(64).take(MASKS_MAX).map(word).collect();
        while masks.last() == Some(&0) {
            masks.pop();
        }
        Some(JoinPacket::Want { hash: self.hash, next: self.next, window: self.window, masks })
    }

    pub(super) const fn is_complete(&self) -> bool {
        self.missing == 0
    }

    pub(super) fn finish(self) -> Option<Vec<u8>> {
        (self.missing == 0 && hash(&self.bytes) == self.hash).then_some(self.bytes)
    }

    pub(super) fn progress(&self) -> (u64, u64) {
        let here =
            u64::from(chunk_count(self.length) - self.missing) * u64::try_from(CHUNK_BYTES).unwrap_or(0);
        (here.min(self.length), self.length)
    }
}
