use alloc::vec::Vec;

use super::super::{RulesId, SetupError};
use super::*;

struct Toy;

impl Game for Toy {
    type Setup = ();
    type Input = ();
    type Save = u64;
    const RULES: RulesId = RulesId { name: "toy", version: 1 };

    fn new(&(): &()) -> Result<Self, SetupError> {
        Ok(Toy)
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, _: &[()]) {}

    fn state_hash(&self) -> StateHash {
        StateHash(0)
    }

    fn save(&self) -> u64 {
        0
    }

    fn load(&mut self, _: &u64) {}

    fn work(&self, _: &[()]) -> u64 {
        0
    }
}

fn push(history: &mut History<Toy>, tick: u64, hash: u128) {
    history.push(tick, tick, StateHash(hash));
}

fn known(history: &History<Toy>) -> Vec<(u64, u128)> {
    for past in history.iter() {
        let found = history.get(past.tick).map(|found| (found.hash, found.save));
        assert_eq!(found, Some((past.hash, past.tick)));
    }
    history.iter().map(|past| (past.tick, past.hash.0)).collect()
}

#[test]
fn it_has_two_seconds_and_a_rollback_and_never_nothing() {
    assert_eq!(History::new(&Toy).capacity(), 2 * 60 + 16);
    assert_eq!(History::<Toy>::of_ticks(0).capacity(), 1);
}

#[test]
fn the_last_ticks_are_known_and_no_others() {
    let mut history = History::of_ticks(3);
    assert_eq!((history.oldest(), history.newest()), (None, None));
    (0..5).for_each(|tick| push(&mut history, tick, 100 + u128::from(tick)));
    assert_eq!(known(&history), [(2, 102), (3, 103), (4, 104)]);
    assert_eq!((history.oldest(), history.newest()), (Some(2), Some(4)));
    assert!(history.get(1).is_none() && history.get(5).is_none());
    history.truncate(3);
    assert_eq!(known(&history), [(2, 102), (3, 103)]);
}

#[test]
fn a_rollback_replaces_what_never_happened() {
    let mut history = History::of_ticks(10);
    (0..6).for_each(|tick| push(&mut history, tick, 0));
    push(&mut history, 3, 1);
    assert_eq!(known(&history), [(0, 0), (1, 0), (2, 0), (3, 1)]);
    push(&mut history, 0, 2);
    assert_eq!(known(&history), [(0, 2)]);
    push(&mut history, 8, 3);
    assert_eq!(known(&history), [(0, 2), (8, 3)], "not every tick has to be saved");
    push(&mut history, 100, 4);
    assert_eq!(known(&history), [(100, 4)]);
}
