//! A recording returns its bytes while the game runs. It steps the game with the inputs as a reader of the replay
//! decodes them, and writes nothing that a verifier would refuse.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, InputError, RulesId, SetupError};
use lockstep2d::replay::{
    CHECKPOINT_INTERVAL, ClaimDifference, Limits, RecordError, Recorder, Recording, Verdict, verify,
};

use crate::counter::{Counter, Input, Setup, add, inputs_at, setup};
use crate::{record, verdict};

#[test]
fn what_was_appended_is_always_a_valid_prefix() {
    let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
    let mut file = recording.take_bytes();
    for tick in 0..35 {
        match verdict(&file) {
            Verdict::Incomplete { ticks, .. } => assert_eq!(ticks, tick / 10 * 10, "at tick {tick}"),
            other => panic!("at tick {tick}: {other}"),
        }
        recording.step(&inputs_at(tick)).unwrap();
        file.extend(recording.take_bytes());
        assert!(recording.take_bytes().is_empty(), "expected the bytes only once");
    }
    file.extend(recording.finish().unwrap());
    assert_eq!(file, record(35, 10, inputs_at), "expected the same bytes as from one recording");
    assert!(verdict(&file).is_match());
}

#[test]
fn the_game_is_stepped_with_what_was_written() {
    let mut moody = add(1, 2);
    moody[0].mood = 9;
    let mut direct = Counter::new(&setup()).unwrap();
    direct.step(&moody);
    assert_eq!(direct.moods, 9, "expected the mood to change the state");

    let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
    recording.step(&moody).unwrap();
    assert_eq!((recording.game().moods, recording.game().sum), (0, 8));
    assert!(verdict(&recording.finish().unwrap()).is_match());
}

#[test]
fn a_recorder_without_its_game_writes_the_same() {
    let (mut recorder, mut game) = Recorder::<Counter>::start(&setup(), 10).unwrap();
    for tick in 0..35 {
        let inputs = recorder.record(&inputs_at(tick)).unwrap().to_vec();
        game.step(&inputs);
        recorder.checkpoint(game.state_hash());
    }
    assert_eq!(recorder.ticks(), 35);
    assert_eq!(recorder.finish(&game).unwrap(), record(35, 10, inputs_at));
}

#[test]
fn a_checkpoint_cannot_be_forgotten() {
    let (mut recorder, _) = Recorder::<Counter>::start(&setup(), 2).unwrap();
    recorder.record(&add(0, 0)).unwrap();
    recorder.record(&add(0, 0)).unwrap();
    assert!(recorder.is_checkpoint_due());
    assert_eq!(recorder.record(&add(0, 0)), Err(RecordError::CheckpointDue));
    assert_eq!(recorder.ticks(), 2);
}

#[test]
fn inputs_that_cannot_be_recorded_are_not_played() {
    let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
    recording.step(&add(1, 1)).unwrap();
    let before = recording.game().clone();
    let expected = RecordError::Inputs(InputError::Count { players: 2, inputs: 3 });
    assert_eq!(recording.step(&vec![Input::default(); 3]), Err(expected));
    assert_eq!((recording.game(), recording.ticks()), (&before, 1));
    recording.step(&add(1, 1)).unwrap();
    assert!(verdict(&recording.finish().unwrap()).is_match());
}

#[test]
fn what_cannot_start_is_refused() {
    let refused = |setup: &Setup, interval| Recording::<Counter>::start(setup, interval).err().unwrap();
    for ticks in [0, 3601] {
        assert_eq!(refused(&setup(), ticks), RecordError::CheckpointInterval { ticks });
    }
    let why = "the sum starts above 1000".into();
    let too_high = Setup { start: 1001, ..setup() };
    assert_eq!(refused(&too_high, 10), RecordError::SetupRefused { why });
    let long = Setup { label: "x".repeat(17 << 20), ..setup() };
    assert_eq!(refused(&long, 10), RecordError::SetupLength { bytes: (17 << 20) + 12 });
}

/// A game whose inputs are texts of any length, so that a block can exceed the maximum length, and whose setup is the
/// list of its claims.
struct Scribe {
    claims: Vec<(String, i64)>,
}

impl Game for Scribe {
    type Setup = Vec<(String, i64)>;
    type Input = String;
    type Save = ();

    const RULES: RulesId = RulesId { name: "scribe", version: 1 };

    fn new(setup: &Self::Setup) -> Result<Self, SetupError> {
        Ok(Scribe { claims: setup.clone() })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        1
    }

    fn step(&mut self, _: &[String]) {}

    fn state_hash(&self) -> StateHash {
        StateHash(1)
    }

    fn save(&self) {}

    fn load(&mut self, (): &()) {}

    fn work(&self, _: &[String]) -> u64 {
        1
    }

    fn claims(&self) -> Vec<(String, i64)> {
        self.claims.clone()
    }
}

#[test]
fn a_block_is_never_longer_than_a_verifier_takes() {
    let mut recording = Recording::<Scribe>::start(&Vec::new(), CHECKPOINT_INTERVAL).unwrap();
    let page = "x".repeat(5 << 20);
    let mut written: u64 = 0;
    for number in 0..3 {
        recording.step(&[format!("{page}{number}")]).unwrap();
        written += 1;
    }
    match recording.step(&[format!("{page}3")]) {
        Err(RecordError::BlockLength { bytes }) => assert!(bytes > 16 << 20, "{bytes}"),
        other => panic!("{other:?}"),
    }
    assert_eq!(recording.ticks(), written, "expected the refused tick not to count");
    recording.step(&[format!("{page}2")]).unwrap();
    recording.step(&["short".into()]).unwrap();
    let file = recording.finish().unwrap();
    let verdict = verify::<Scribe>(&file, &Limits::default());
    assert_eq!(verdict, Verdict::Match { ticks: 5, hash: StateHash(1) });
}

#[test]
fn claims_are_written_in_order_or_not_at_all() {
    let finish = |claims: &[(String, i64)]| Recording::<Scribe>::start(&claims.to_vec(), 1).unwrap().finish();
    let named = |names: &[&str]| names.iter().map(|name| (name.to_string(), -1)).collect::<Vec<_>>();
    let many = |count: i64| (0..count).map(|index| (format!("{index}"), index)).collect::<Vec<_>>();
    for good in [named(&[]), named(&["b", "a", "ab"]), named(&[&"n".repeat(64)]), many(256)] {
        let file = finish(&good).unwrap();
        let verdict = verify::<Scribe>(&file, &Limits::default());
        assert!(verdict.is_match(), "{good:?}: {verdict}");
    }
    for bad in [named(&[""]), named(&["a", "b", "a"]), named(&[&"n".repeat(65)]), many(257)] {
        assert_eq!(finish(&bad), Err(RecordError::Claims));
    }
}

#[test]
fn a_claim_mismatch_is_explained() {
    let difference = ClaimDifference::Value { name: "sum".into(), claimed: Some(9), actual: Some(8) };
    let verdict = Verdict::ClaimMismatch { ticks: 7, hash: StateHash(1), difference };
    let expected =
        "claim mismatch: all 7 ticks agree, but the trailer claims 9 as \"sum\", the game reports 8";
    assert_eq!(verdict.to_string(), expected);
}
