//! Tests whether the hash covers all state that influences future ticks.
//!
//! The test replaces one byte or a run of bytes in a save by the bytes at the same place in a save of another tick. If
//! the changed state has the same hash, it must also have the same future under the same inputs.

#[cfg(test)]
mod tests;

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::ops::Range;

use super::checker::another;
use super::finding::{Fault, Finding};
use super::options::Variant;
use super::replica::Now;
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::Game;

/// Interval in ticks at which saves are stored, or [`CheckOptions::every`](super::CheckOptions::every) if that is
/// longer. In the first interval, the saves after 1, 2, 4, 8 and so on ticks are stored as well.
const INTERVAL: u64 = 16;
/// Number of ticks after a save for which the changed state is played.
const FUTURE: usize = 48;
/// Number of recent saves whose bytes may replace those of an older save.
const DONORS_MAX: usize = 6;
/// Maximum number of swaps that are tried with each save.
const TRIES_MAX: usize = 32;

pub(super) struct ByteSwaps<G: Game> {
    moments: VecDeque<Moment<G>>,
    donors: VecDeque<Vec<u8>>,
}

struct Moment<G: Game> {
    tick: u64,
    bytes: Vec<u8>,
    hash: StateHash,
    inputs: Vec<Vec<G::Input>>,
}

impl<G: Game> Default for ByteSwaps<G> {
    fn default() -> Self {
        ByteSwaps { moments: VecDeque::new(), donors: VecDeque::new() }
    }
}

impl<G: Game> ByteSwaps<G> {
    /// Stores a save after the tick if one is due, and examines the stored saves after which [`FUTURE`] ticks were
    /// played.
    pub(super) fn perturb(
        &mut self,
        game: &G,
        now: &Now<'_, G>,
        steps: &mut u64,
    ) -> Result<(), Box<Finding>> {
        self.moments.iter_mut().for_each(|moment| moment.inputs.push(now.inputs.to_vec()));
        let interval = INTERVAL.max(now.options.every);
        if now.tick.is_multiple_of(interval) || now.tick.is_power_of_two() && now.tick < interval {
            let bytes = codec::encode(&game.save());
            self.add_donor(&bytes);
            self.moments.push_back(Moment { tick: now.tick, bytes, hash: now.hash, inputs: Vec::new() });
        }
        while self.moments.front().is_some_and(|moment| moment.inputs.len() >= FUTURE) {
            if let Some(moment) = self.moments.pop_front() {
                self.examine(&moment, now, steps)?;
            }
        }
        Ok(())
    }

    /// Examines the remaining saves.
    pub(super) fn finish(&mut self, game: &G, now: &Now<'_, G>, steps: &mut u64) -> Result<(), Box<Finding>> {
        self.add_donor(&codec::encode(&game.save()));
        core::mem::take(&mut self.moments).iter().try_for_each(|moment| self.examine(moment, now, steps))
    }

    fn add_donor(&mut self, bytes: &[u8]) {
        if self.donors.len() >= DONORS_MAX {
            self.donors.pop_front();
        }
        self.donors.push_back(bytes.to_vec());
    }

    fn examine(&self, moment: &Moment<G>, now: &Now<'_, G>, steps: &mut u64) -> Result<(), Box<Finding>> {
        // The world's own hash covers all bytes of the world, so the test does not swap bytes of the world.
        let world = world_in::<G>(moment, now)?;
        let byte_swaps = self.donors.iter().flat_map(|donor| byte_swaps(&moment.bytes, donor));
        let mut byte_swaps: Vec<_> = byte_swaps.filter(|(range, _)| !overlap(range, &world)).collect();
        byte_swaps.sort_by(|a, b| (a.0.start, a.0.end, &a.1).cmp(&(b.0.start, b.0.end, &b.1)));
        byte_swaps.dedup();
        // The first swap to try depends on the tick, so that different saves try different swaps.
        let turn = usize::try_from(moment.tick).unwrap_or(0).wrapping_mul(7) % byte_swaps.len().max(1);
        byte_swaps.rotate_left(turn);
        for (range, replacement) in byte_swaps.into_iter().take(TRIES_MAX) {
            let mut bytes = moment.bytes.clone();
            bytes[range].copy_from_slice(&replacement);
            if let Some((after, a, b)) = self.futures_differ(moment, &bytes, now, steps)? {
                let finding = Finding::new(Variant::ByteSwapped, Fault::Unhashed, moment.tick + after);
                return Err(Box::new(Finding { played: now.tick, ..finding.with_saves(&a, &b) }));
            }
        }
        Ok(())
    }

    /// Plays the stored state and the changed state with the same inputs. Returns the number of ticks after which their
    /// hashes differ, and the saves of both states before these ticks. `None` if the hashes stay equal, or if the
    /// changed bytes are not the exact save of a state with the stored hash.
    #[expect(clippy::type_complexity, reason = "it is taken apart at once")]
    fn futures_differ(
        &self,
        moment: &Moment<G>,
        changed: &[u8],
        now: &Now<'_, G>,
        steps: &mut u64,
    ) -> Result<Option<(u64, G::Save, G::Save)>, Box<Finding>> {
        let Some((mut b, saved_b)) = loaded::<G>(changed, now)? else {
            return Ok(None);
        };
        // `load` may have corrected the changed bytes. Then they do not influence the future, and the swap tests
        // nothing.
        if b.state_hash() != moment.hash || codec::encode(&b.save()) != changed {
            return Ok(None);
        }
        let Some((mut a, saved_a)) = loaded::<G>(&moment.bytes, now)? else {
            return Ok(None);
        };
        for (inputs, after) in moment.inputs.iter().zip(1..) {
            a.step(inputs);
            b.step(inputs);
            *steps += 2;
            if a.state_hash() != b.state_hash() {
                return Ok(Some((after, saved_a, saved_b)));
            }
        }
        Ok(None)
    }
}

fn loaded<G: Game>(bytes: &[u8], now: &Now<'_, G>) -> Result<Option<(G, G::Save)>, Box<Finding>> {
    let Ok(save) = codec::decode::<G::Save>(bytes) else {
        return Ok(None);
    };
    if codec::encode(&save) != bytes {
        return Ok(None);
    }
    let mut game = another::<G>(now.setup, Variant::ByteSwapped, now.tick)?;
    game.load(&save);
    Ok(Some((game, save)))
}

/// Range of the bytes of the physics world in a save. Empty if there is none.
fn world_in<G: Game>(moment: &Moment<G>, now: &Now<'_, G>) -> Result<Range<usize>, Box<Finding>> {
    let Some((mut game, _)) = loaded::<G>(&moment.bytes, now)? else {
        return Ok(0..0);
    };
    let Some(world) = game.world_mut().map(|world| codec::encode(&world.save())) else {
        return Ok(0..0);
    };
    let start = moment.bytes.windows(world.len()).position(|bytes| bytes == world);
    Ok(start.map_or(0..0, |start| start..start + world.len()))
}

fn overlap(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.start < b.end && b.start < a.end
}

/// The possible swaps with the save `donor`: each byte that differs, and each run of two or more differing bytes. None
/// if the lengths differ.
fn byte_swaps(bytes: &[u8], donor: &[u8]) -> Vec<(Range<usize>, Vec<u8>)> {
    let mut found = Vec::new();
    if bytes.len() != donor.len() {
        return found;
    }
    let mut run: Option<usize> = None;
    for at in 0..=bytes.len() {
        let differs = at < bytes.len() && bytes[at] != donor[at];
        if differs {
            found.push((at..at + 1, donor[at..at + 1].to_vec()));
            run.get_or_insert(at);
        } else if let Some(start) = run.take().filter(|start| at - start > 1) {
            found.push((start..at, donor[start..at].to_vec()));
        }
    }
    found
}
