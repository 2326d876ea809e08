//! A game that implements only the required items of `Game`.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::replay::{Limits, Recording, verify};

use crate::says;

struct Bare {
    pressed: u32,
}

impl Game for Bare {
    type Setup = u32;
    type Input = u8;
    type Save = u32;

    const RULES: RulesId = RulesId { name: "bare", version: 1 };

    fn new(pressed: &u32) -> Result<Self, SetupError> {
        if *pressed > 100 {
            return Err(SetupError { why: format!("{pressed} is more than 100") });
        }
        Ok(Bare { pressed: *pressed })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        10
    }

    fn step(&mut self, inputs: &[u8]) {
        self.pressed = inputs.iter().fold(self.pressed, |sum, input| sum.wrapping_add((*input).into()));
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.pressed)
    }

    fn save(&self) -> u32 {
        self.pressed
    }

    fn load(&mut self, save: &u32) {
        self.pressed = *save;
    }

    fn work(&self, _: &[u8]) -> u64 {
        1
    }
}

#[test]
fn a_setup_that_is_refused_says_why() {
    let refused = Bare::new(&101).err().expect("too many");
    says([(refused, "the setup cannot start a game: 101 is more than 100")]);
}

#[test]
fn the_least_of_games_can_be_replayed() {
    let mut recording = Recording::<Bare>::start(&5, 2).expect("a valid setup");
    for tick in 0..7u8 {
        recording.step(&[tick / 3]).expect("one input");
    }
    let replay = recording.finish().expect("no claims");
    assert!(verify::<Bare>(&replay, &Limits::default()).is_match());
}

#[test]
fn what_a_game_need_not_say() {
    let mut game = Bare::new(&0).expect("valid");
    assert_eq!(Bare::absent(), 0, "expected the input of an absent player to be 0");
    assert!(game.world_mut().is_none());
    assert!(game.claims().is_empty());
}
