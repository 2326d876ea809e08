//! A game in which two players add to a sum.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Setup {
    /// Larger values than 1000 are refused.
    pub(crate) start: i32,
    /// Ignored by the rules.
    pub(crate) label: String,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Input {
    pub(crate) add: i8,
    /// Ignored by the rules.
    pub(crate) wink: bool,
    /// Not encoded, so it is 0 in every decoded input.
    #[serde(skip)]
    pub(crate) mood: u8,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Counter {
    pub(crate) sum: i64,
    pub(crate) tick: u64,
    /// Sum of the moods. It is above 0 only if inputs were used without being encoded and decoded.
    pub(crate) moods: u64,
}

pub(crate) const PLAYERS: u32 = 2;

impl Game for Counter {
    type Setup = Setup;
    type Input = Input;
    type Save = Counter;

    const RULES: RulesId = RulesId { name: "counter", version: 3 };

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        if setup.start > 1000 {
            return Err(SetupError { why: "the sum starts above 1000".into() });
        }
        Ok(Counter { sum: setup.start.into(), tick: 0, moods: 0 })
    }

    fn players(&self) -> u32 {
        PLAYERS
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[Input]) {
        self.sum += inputs.iter().map(|input| i64::from(input.add)).sum::<i64>();
        self.moods += inputs.iter().map(|input| u64::from(input.mood)).sum::<u64>();
        self.tick += 1;
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(self)
    }

    fn save(&self) -> Counter {
        self.clone()
    }

    fn load(&mut self, save: &Counter) {
        *self = save.clone();
    }

    /// A tick costs one unit of work, plus the magnitudes of the added numbers.
    fn work(&self, inputs: &[Input]) -> u64 {
        1 + inputs.iter().map(|input| u64::from(input.add.unsigned_abs())).sum::<u64>()
    }

    fn claims(&self) -> Vec<(String, i64)> {
        vec![("sum".into(), self.sum), ("half".into(), self.sum / 2)]
    }
}

/// Methods of [`Game`] that call those of the counter in the field `$counter`.
macro_rules! like_its_counter {
    ($counter:tt) => {
        fn players(&self) -> u32 {
            self.$counter.players()
        }

        fn tick_rate(&self) -> u32 {
            self.$counter.tick_rate()
        }

        fn state_hash(&self) -> ::lockstep2d::hash::StateHash {
            self.$counter.state_hash()
        }

        fn save(&self) -> Self::Save {
            self.$counter.save()
        }

        fn load(&mut self, save: &Self::Save) {
            self.$counter.load(save);
        }

        fn work(&self, inputs: &[Self::Input]) -> u64 {
            self.$counter.work(inputs)
        }
    };
}
pub(crate) use like_its_counter;

pub(crate) fn setup() -> Setup {
    Setup { start: 5, label: "a".into() }
}

pub(crate) fn add(first: i8, second: i8) -> [Input; 2] {
    [Input { add: first, ..Input::default() }, Input { add: second, ..Input::default() }]
}

/// Inputs of a tick. They change every five ticks.
pub(crate) fn inputs_at(tick: u64) -> [Input; 2] {
    let step = i8::try_from(tick / 5 % 7).unwrap() - 3;
    let mut inputs = add(step, 1);
    inputs[1].wink = tick % 11 == 4;
    inputs
}
