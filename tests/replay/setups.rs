//! Setups with more than one encoding are refused.

use std::collections::BTreeSet;
use std::marker::PhantomData;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::replay::{Flaw, Limits, RecordError, Recording, Verdict, verify};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize};

use crate::forge::forge;

/// Accepts any setup; the state never changes.
struct Still<S>(PhantomData<S>);

impl<S: Serialize + DeserializeOwned> Game for Still<S> {
    type Setup = S;
    type Input = ();
    type Save = ();

    const RULES: RulesId = RulesId { name: "still", version: 1 };

    fn new(_: &S) -> Result<Self, SetupError> {
        Ok(Still(PhantomData))
    }

    fn players(&self) -> u32 {
        0
    }

    fn tick_rate(&self) -> u32 {
        1
    }

    fn step(&mut self, _: &[()]) {}

    fn state_hash(&self) -> StateHash {
        StateHash(1)
    }

    fn save(&self) {}

    fn load(&mut self, (): &()) {}

    fn work(&self, _: &[()]) -> u64 {
        1
    }
}

/// A setup whose value increases each time it is decoded.
#[derive(Serialize)]
struct Growing(u8);

impl<'de> Deserialize<'de> for Growing {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        u8::deserialize(deserializer).map(|number| Growing(number + 1))
    }
}

#[test]
fn a_game_without_players_can_be_recorded() {
    let mut recording = Recording::<Still<u8>>::start(&7, 2).unwrap();
    for _ in 0..3 {
        recording.step(&[]).unwrap();
    }
    let file = recording.finish().unwrap();
    let expected = Verdict::Match { ticks: 3, hash: StateHash(1) };
    assert_eq!(verify::<Still<u8>>(&file, &Limits::default()), expected);
}

#[test]
fn a_setup_that_changes_in_its_encoding_is_not_recorded() {
    assert_eq!(Recording::<Still<Growing>>::start(&Growing(7), 2).err(), Some(RecordError::Setup));
}

#[test]
fn a_setup_that_could_be_written_otherwise_is_refused() {
    let file = Recording::<Still<BTreeSet<u8>>>::start(&BTreeSet::from([3, 4]), 2).unwrap().finish().unwrap();
    assert!(verify::<Still<BTreeSet<u8>>>(&file, &Limits::default()).is_match());
    let setup = 40 + "still".len();
    let swapped = forge(&file, |forged| {
        assert_eq!(forged.header[setup + 8..setup + 10], [3, 4]);
        forged.header.swap(setup + 8, setup + 9);
    });
    let expected = Verdict::Malformed { offset: setup as u64, flaw: Flaw::Setup };
    assert_eq!(verify::<Still<BTreeSet<u8>>>(&swapped, &Limits::default()), expected);
}
