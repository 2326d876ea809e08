//! The check finds a setup whose encoding leaves out a field. A verifier of a replay with this setup would play another
//! game.

use lockstep2d::check::{CheckOptions, Fault, Variant, check};
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
struct Setup {
    is_hashed: bool,
    #[serde(skip)]
    speed: u32,
}

/// A walker with a constant speed.
struct Walker {
    is_hashed: bool,
    speed: u32,
    place: u32,
}

impl Game for Walker {
    type Setup = Setup;
    type Input = bool;
    type Save = (u32, u32);

    const RULES: RulesId = RulesId { name: "walker", version: 1 };

    fn new(&Setup { is_hashed, speed }: &Setup) -> Result<Self, SetupError> {
        Ok(Walker { is_hashed, speed, place: 0 })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[bool]) {
        self.place = self.place.wrapping_add(if inputs[0] { self.speed } else { 0 });
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&(self.place, if self.is_hashed { self.speed } else { 0 }))
    }

    fn save(&self) -> Self::Save {
        (self.speed, self.place)
    }

    fn load(&mut self, &(speed, place): &Self::Save) {
        (self.speed, self.place) = (speed, place);
    }

    fn work(&self, _: &[bool]) -> u64 {
        1
    }
}

/// Number of ticks after which the check finds the fault; `None` if it finds none.
fn found(setup: &Setup) -> Option<u64> {
    let options = CheckOptions::default().without(Variant::ByteSwapped);
    let error = check::<Walker>(setup, &vec![vec![true]; 20], &options).err()?;
    let finding = &error.failure().unwrap().finding;
    assert_eq!((finding.variant, &finding.fault), (Variant::Recorded, &Fault::Hash));
    assert!(finding.hint().contains("setup"));
    assert!(!finding.differences.is_empty(), "the saves differ");
    Some(finding.tick)
}

#[test]
fn a_setup_that_its_encoding_changes_is_found() {
    assert_eq!(found(&Setup { is_hashed: true, speed: 3 }), Some(0));
    assert_eq!(found(&Setup { is_hashed: false, speed: 3 }), Some(20));
    // A decoded setup has the default speed, 0. The encoding therefore does not change a setup with this speed.
    assert_eq!(found(&Setup { is_hashed: true, speed: 0 }), None);
}
