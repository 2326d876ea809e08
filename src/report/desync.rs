//! [`DesyncReport`]: what a peer writes when states differ.

use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::phases::TickPhases;
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::{Game, History, Past, RulesId};

/// Most bytes of saves that a report takes along.
pub const SAVES_BYTES_MAX: usize = 32 << 20;

/// A checkpoint at which the peers of a game do not have the same state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Desync {
    /// Number of players.
    pub players: u32,
    /// After how many ticks.
    pub tick: u64,
    /// How many ticks have been played with everybody's true inputs: all of them without prediction. What a history has
    /// beyond them rests on guesses, and is no evidence.
    pub known: u64,
    /// The seats that this peer plays, in ascending order; none of a spectator.
    pub seats: Vec<u32>,
    /// For each seat the state hash that its peer has, as far as it has said so. This peer's own are taken from its
    /// history.
    pub hashes: Vec<Option<StateHash>>,
}

/// Seats whose peers have the same state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The hash of that state.
    pub hash: StateHash,
    /// The seats, in ascending order.
    pub seats: Vec<u32>,
}

/// What a peer knows when states differ: two of them tell together who departed, when and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DesyncReport {
    /// The engine's semantics.
    pub semantics: u32,
    /// Everything else.
    pub(super) body: Body,
}

/// What follows the header of a report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Body {
    pub(super) rules_name: String,
    pub(super) rules_version: u32,
    pub(super) players: u32,
    pub(super) seats: Vec<u32>,
    pub(super) tick: u64,
    pub(super) hashes: Vec<Option<StateHash>>,
    /// State hashes, in ascending order of the ticks.
    pub(super) history: Vec<(u64, StateHash)>,
    /// The canonical bytes of saves, in ascending order of the ticks.
    pub(super) saves: Vec<(u64, Vec<u8>)>,
    /// What the phases of the tick that led there have left behind, in ascending order of the ticks.
    pub(super) phases: Vec<(u64, TickPhases)>,
    pub(super) replay: Vec<u8>,
}

impl DesyncReport {
    /// The report of a peer: `replay` has the inputs of the known ticks, for example from
    /// [`Recorder::so_far`](crate::replay::Recorder::so_far).
    ///
    /// Of each tick it has the hash. Of saves it has as many as fit into [`SAVES_BYTES_MAX`]: those of the tick at which
    /// the states differ and before it, the newest first, then those after it.
    #[must_use]
    pub fn new<G: Game>(found: &Desync, history: &History<G>, replay: Vec<u8>) -> Self {
        Self::within(SAVES_BYTES_MAX, found, history, replay)
    }

    /// [`DesyncReport::new`] with at most so many bytes of saves.
    #[must_use]
    pub fn within<G: Game>(bytes_max: usize, found: &Desync, history: &History<G>, replay: Vec<u8>) -> Self {
        let Desync { players, tick, known, ref seats, ref hashes } = *found;
        let states: Vec<_> = history.iter().filter(|past| past.tick <= known).collect();
        let mut hashes = hashes.clone();
        hashes.resize(usize::try_from(players).unwrap_or(0), None);
        if let Some(own) = history.get(tick) {
            for seat in seats.iter().filter_map(|&seat| usize::try_from(seat).ok()) {
                if let Some(hash) = hashes.get_mut(seat) {
                    *hash = Some(own.hash);
                }
            }
        }
        let RulesId { name, version } = G::RULES;
        let body = Body {
            rules_name: name.into(),
            rules_version: version,
            players,
            seats: seats.clone(),
            tick,
            hashes,
            history: states.iter().map(|past| (past.tick, past.hash)).collect(),
            saves: saves(bytes_max, tick, &states),
            phases: Vec::new(),
            replay,
        };
        DesyncReport { semantics: crate::SEMANTICS, body }
    }

    pub(super) fn with_phases(mut self, phases: Vec<(u64, TickPhases)>) -> Self {
        self.body.phases = phases;
        self
    }

    /// The name and version of the rules.
    #[must_use]
    pub fn rules(&self) -> (&str, u32) {
        (&self.body.rules_name, self.body.rules_version)
    }

    /// Number of players.
    #[must_use]
    pub fn players(&self) -> u32 {
        self.body.players
    }

    /// The seats that the peer who wrote it plays.
    #[must_use]
    pub fn seats(&self) -> &[u32] {
        &self.body.seats
    }

    /// The checkpoint at which the states were seen to differ: after how many ticks.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.body.tick
    }

    /// For each seat the hash that its peer had at that checkpoint, as far as known.
    #[must_use]
    pub fn hashes(&self) -> &[Option<StateHash>] {
        &self.body.hashes
    }

    /// Which seats agree at that checkpoint: the largest group first. Of three peers or more, that shows who departed.
    #[must_use]
    pub fn groups(&self) -> Vec<Group> {
        let mut groups: BTreeMap<StateHash, Vec<u32>> = BTreeMap::new();
        for (seat, hash) in (0..).zip(&self.body.hashes) {
            if let Some(hash) = hash {
                groups.entry(*hash).or_default().push(seat);
            }
        }
        let mut groups: Vec<Group> = groups.into_iter().map(|(hash, seats)| Group { hash, seats }).collect();
        groups.sort_by_key(|group| core::cmp::Reverse(group.seats.len()));
        groups
    }

    /// The state hash after each tick that the peer remembers, in ascending order of the ticks.
    #[must_use]
    pub fn history(&self) -> &[(u64, StateHash)] {
        &self.body.history
    }

    /// The canonical bytes of the game's save after some ticks, in ascending order.
    #[must_use]
    pub fn saves(&self) -> &[(u64, Vec<u8>)] {
        &self.body.saves
    }

    /// How ticks went, in ascending order of the ticks that they led to. Only a [`Trace`](super::Trace) tells.
    #[must_use]
    pub fn phases(&self) -> &[(u64, TickPhases)] {
        &self.body.phases
    }

    /// How many ticks of the history have no save, because the report would have become too large.
    #[must_use]
    pub fn saves_left_out(&self) -> usize {
        self.body.history.len().saturating_sub(self.body.saves.len())
    }

    /// The replay up to when the report was written: the bytes of a file.
    #[must_use]
    pub fn replay(&self) -> &[u8] {
        &self.body.replay
    }
}

/// The saves that a report takes along.
fn saves<S: Serialize>(bytes_max: usize, tick: u64, states: &[&Past<S>]) -> Vec<(u64, Vec<u8>)> {
    let until = states.iter().rev().filter(|past| past.tick <= tick);
    let after = states.iter().filter(|past| past.tick > tick);
    let mut left = bytes_max;
    let mut saves = Vec::new();
    for past in until.chain(after) {
        let bytes = codec::encode(&past.save);
        let Some(rest) = left.checked_sub(bytes.len()) else {
            break;
        };
        left = rest;
        saves.push((past.tick, bytes));
    }
    saves.sort_by_key(|(tick, _)| *tick);
    saves
}
