use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::phases::TickPhases;
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::{Game, History, Past, RulesId};

/// Maximum bytes of saves in a report from [`DesyncReport::new`].
pub const SAVES_BYTES_MAX: usize = 32 << 20;

/// A checkpoint at which the peers of a game have different states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Desync {
    /// Number of players.
    pub players: u32,
    /// Number of ticks after which the states differ.
    pub tick: u64,
    /// Number of ticks simulated with confirmed inputs. Later entries of a history depend on predicted inputs and are
    /// not evidence.
    pub known: u64,
    /// The seats of this peer, ascending; empty for a spectator.
    pub seats: Vec<u32>,
    /// For each seat, the state hash of its peer, if received. [`DesyncReport::new`] takes this peer's own hash from
    /// the history.
    pub hashes: Vec<Option<StateHash>>,
}

/// Seats whose peers have the same state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Hash of that state.
    pub hash: StateHash,
    /// The seats, ascending.
    pub seats: Vec<u32>,
}

/// The data of one peer at a desync, for [`compare`](super::compare()).
///
/// ```
/// # use lockstep2d::{hash::StateHash, lockstep::{Game, History, Sandbox, SandboxSetup}, replay::Recording};
/// use lockstep2d::report::{Desync, DesyncReport, Group};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60)?;
/// # let mut history = History::<Sandbox>::of_ticks(60);
/// # for tick in 0..=30 {
/// #     history.push(tick, recording.game().save(), recording.game().state_hash());
/// #     recording.step(&[vec![]])?;
/// # }
/// # let ours = history.get(30).expect("a tick of the last second").hash;
/// # let replay = recording.take_bytes();
/// // A custom network layer has found that the state of the third player differs from that of the first two.
/// let hashes = vec![None, Some(ours), Some(StateHash(7))];
/// let found = Desync { players: 3, tick: 30, known: 30, seats: vec![0], hashes };
/// let report = DesyncReport::new(&found, &history, replay);
/// let majority = Group { hash: ours, seats: vec![0, 1] };
/// assert_eq!(report.groups(), [majority, Group { hash: StateHash(7), seats: vec![2] }]);
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DesyncReport {
    /// Version of the engine's semantics.
    pub semantics: u32,
    pub(super) body: Body,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Body {
    pub(super) rules_name: String,
    pub(super) rules_version: u32,
    pub(super) players: u32,
    pub(super) seats: Vec<u32>,
    pub(super) tick: u64,
    pub(super) hashes: Vec<Option<StateHash>>,
    pub(super) history: Vec<(u64, StateHash)>,
    pub(super) saves: Vec<(u64, Vec<u8>)>,
    pub(super) phases: Vec<(u64, TickPhases)>,
    pub(super) replay: Vec<u8>,
}

impl DesyncReport {
    /// Creates the report of a peer. `replay` has the inputs of the known ticks, for example from
    /// [`Recorder::so_far`](crate::replay::Recorder::so_far).
    ///
    /// The report has the hash of each known tick in the history, and as many saves as fit into [`SAVES_BYTES_MAX`].
    /// Saves up to the tick that differs are added first, starting with the newest, then the later saves.
    #[must_use]
    pub fn new<G: Game>(found: &Desync, history: &History<G>, replay: Vec<u8>) -> Self {
        Self::within(SAVES_BYTES_MAX, found, history, replay)
    }

    /// Like [`DesyncReport::new`] with at most `bytes_max` bytes of saves.
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

    /// Name and version of the rules.
    #[must_use]
    pub fn rules(&self) -> (&str, u32) {
        (&self.body.rules_name, self.body.rules_version)
    }

    /// Number of players.
    #[must_use]
    pub fn players(&self) -> u32 {
        self.body.players
    }

    /// The seats of the peer that wrote the report.
    #[must_use]
    pub fn seats(&self) -> &[u32] {
        &self.body.seats
    }

    /// Number of ticks after which the states of the peers differ.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.body.tick
    }

    /// For each seat, the hash of its peer's state at [`DesyncReport::tick`], if known.
    #[must_use]
    pub fn hashes(&self) -> &[Option<StateHash>] {
        &self.body.hashes
    }

    /// The seats, grouped by their peers' states at [`DesyncReport::tick`], largest group first. Seats without a known
    /// hash are left out.
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

    /// State hashes of the peer's known ticks, ascending by tick.
    #[must_use]
    pub fn history(&self) -> &[(u64, StateHash)] {
        &self.body.history
    }

    /// Canonical bytes of the game's saves, ascending by tick.
    #[must_use]
    pub fn saves(&self) -> &[(u64, Vec<u8>)] {
        &self.body.saves
    }

    /// Phase digests of steps, ascending by the tick that the step led to. Only reports of a [`Trace`](super::Trace)
    /// have them.
    #[must_use]
    pub fn phases(&self) -> &[(u64, TickPhases)] {
        &self.body.phases
    }

    /// Number of ticks in the history whose saves were left out for lack of space.
    #[must_use]
    pub fn saves_left_out(&self) -> usize {
        self.body.history.len().saturating_sub(self.body.saves.len())
    }

    /// The replay up to the report, as the bytes of a file; empty without a replay.
    #[must_use]
    pub fn replay(&self) -> &[u8] {
        &self.body.replay
    }
}

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
