//! A small game with one of many planted faults.

use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering};

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use serde::{Deserialize, Serialize};

/// Planted fault. The setup selects it, so that one compiled game serves for all faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Mistake {
    None,
    SaveLacksField,
    BothLackField,
    HashLacksField,
    /// A static counter affects the state.
    Global,
    /// `load` does not recompute the total.
    LoadKeepsCache,
    /// `step` uses the cached strength of the last hit if the same player hits again, and `load` keeps the cache.
    StaleMemory,
    /// Each step adds half the number of calls of `state_hash`, `work` and `claims` to the state.
    HashCounts,
    /// Unless `state_hash` was called before the eighth step, this step adds a hit.
    HashTidies,
    SaveIsUnordered,
    /// The value of a claim is the number of calls of `state_hash`, `work` and `claims`.
    ClaimsCount,
    /// The work of a tick is the number of calls of `state_hash`, `work` and `claims`.
    WorkCounts,
    ClaimsTwice,
    ClaimsGlobal,
    Unreadable,
    WorkIsHuge,
    /// Only the tenth tick has too much work.
    TenthIsHuge,
}

/// Two players walk along a line and hit each other. After a hit, a player cannot hit again for 20 ticks.
pub(crate) struct Toy {
    mistake: Mistake,
    state: State,
    /// Sum of the places, cached.
    total: i64,
    /// Player and strength of the last hit, cached.
    last_hit: Option<(usize, u32)>,
    polls: Cell<u32>,
    tidy: Cell<bool>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct State {
    places: [i64; 2],
    cooldown: [u8; 2],
    hits: [u32; 2],
    tick: u64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Save {
    state: State,
    #[serde(with = "unordered")]
    seen: Unordered,
    flag: Flag,
}

#[expect(clippy::disallowed_types, reason = "a planted fault")]
type Unordered = std::collections::HashSet<u64>;

mod unordered {
    use serde::{Deserialize, Deserializer, Serializer};

    use super::Unordered;

    pub(super) fn serialize<S: Serializer>(set: &Unordered, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(set)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Unordered, D::Error> {
        Vec::deserialize(deserializer).map(Unordered::from_iter)
    }
}

/// A byte that cannot be decoded if it is above 1. [`Mistake::Unreadable`] encodes a 2.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(try_from = "u8")]
pub(crate) struct Flag(u8);

impl TryFrom<u8> for Flag {
    type Error = &'static str;

    fn try_from(byte: u8) -> Result<Self, Self::Error> {
        if byte <= 1 { Ok(Flag(byte)) } else { Err("a flag above 1") }
    }
}

/// Bit 0: right, bit 1: left, bit 2: hit.
pub(crate) type Pad = u8;

static SHARED: AtomicU32 = AtomicU32::new(0);

impl Toy {
    fn has(&self, mistake: Mistake) -> bool {
        self.mistake == mistake
    }

    fn hit(&mut self, player: usize) {
        let other = 1 - player;
        let near = (self.state.places[player] - self.state.places[other]).abs() <= 2;
        if !near || self.state.cooldown[player] > 0 {
            return;
        }
        self.state.cooldown[player] = 20;
        let mut strength = 1 + u32::from(self.state.tick.is_multiple_of(3));
        if self.has(Mistake::StaleMemory) {
            strength = match self.last_hit {
                Some((last, strength)) if last == player => strength,
                _ => strength,
            };
            self.last_hit = Some((player, strength));
        }
        if self.has(Mistake::Global) {
            strength += SHARED.fetch_add(1, Ordering::Relaxed) % 7;
        }
        self.state.hits[player] += strength;
    }
}

impl Game for Toy {
    type Setup = Mistake;
    type Input = Pad;
    type Save = Save;

    const RULES: RulesId = RulesId { name: "toy", version: 1 };

    fn new(&mistake: &Mistake) -> Result<Self, SetupError> {
        let state = State { places: [-3, 3], cooldown: [0; 2], hits: [0; 2], tick: 0 };
        Ok(Toy { mistake, state, total: 0, last_hit: None, polls: Cell::new(0), tidy: Cell::new(false) })
    }

    fn players(&self) -> u32 {
        2
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, pads: &[Pad]) {
        for (player, &pad) in pads.iter().enumerate() {
            self.state.cooldown[player] = self.state.cooldown[player].saturating_sub(1);
            let variant = i64::from(pad & 1) - i64::from(pad >> 1 & 1);
            self.state.places[player] = (self.state.places[player] + variant).clamp(-9, 9);
            self.total = match self.has(Mistake::LoadKeepsCache) {
                true => self.total + variant,
                false => self.state.places.iter().sum(),
            };
            if pad & 4 != 0 {
                self.hit(player);
            }
        }
        if self.total > 4 {
            self.state.hits[0] += 1;
        }
        if self.has(Mistake::HashCounts) {
            self.state.hits[1] += self.polls.replace(0) / 2;
        }
        if self.has(Mistake::HashTidies) && !self.tidy.get() {
            self.state.hits[0] += u32::from(self.state.tick == 7);
        }
        self.state.tick += 1;
    }

    fn state_hash(&self) -> StateHash {
        self.polls.set(self.polls.get() + 1);
        self.tidy.set(true);
        let State { places, cooldown, hits, tick } = &self.state;
        let cooldown = match self.mistake {
            Mistake::HashLacksField | Mistake::BothLackField => &[0; 2],
            _ => cooldown,
        };
        StateHash::of(&(places, cooldown, hits, tick))
    }

    fn save(&self) -> Save {
        let mut state = self.state.clone();
        if self.has(Mistake::SaveLacksField) || self.has(Mistake::BothLackField) {
            state.cooldown = [0; 2];
        }
        let seen = if self.has(Mistake::SaveIsUnordered) { 0..state.tick.min(6) } else { 0..0 };
        let flag = Flag(if self.has(Mistake::Unreadable) && state.tick == 9 { 2 } else { 0 });
        Save { state, seen: seen.collect(), flag }
    }

    fn load(&mut self, save: &Save) {
        self.state = save.state.clone();
        if !self.has(Mistake::LoadKeepsCache) {
            self.total = self.state.places.iter().sum();
        }
    }

    fn work(&self, pads: &[Pad]) -> u64 {
        assert_eq!(pads.len(), 2, "expected an input for each player");
        self.polls.set(self.polls.get() + 1);
        match self.mistake {
            Mistake::WorkCounts => self.polls.get().into(),
            Mistake::WorkIsHuge => u64::MAX,
            Mistake::TenthIsHuge if self.state.tick == 9 => u64::MAX,
            _ => 1,
        }
    }

    fn claims(&self) -> Vec<(String, i64)> {
        self.polls.set(self.polls.get() + 1);
        let hits = self.state.hits.map(i64::from);
        match self.mistake {
            Mistake::ClaimsCount => vec![("polls".into(), self.polls.get().into())],
            Mistake::ClaimsTwice => hits.map(|hits| ("hits".into(), hits)).into(),
            Mistake::ClaimsGlobal => {
                vec![("shared".into(), SHARED.fetch_add(1, Ordering::Relaxed).into())]
            }
            _ => vec![("a".into(), hits[0]), ("b".into(), hits[1])],
        }
    }
}
