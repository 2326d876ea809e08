//! A seek starts from a stored state. A keyframe file that is invalid or belongs to another replay is not used.

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::codec;
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::replay::{
    KEYFRAMES_MAGIC, KeyframesError, KeyframesFlaw, LimitKind, Limits, Recording, SeekError, Timeline,
    TimelineOptions, Verdict,
};
use lockstep2d::world::Command;

use crate::counter::{Counter, add, inputs_at};
use crate::record;
use crate::timeline::{at, hashes, hashes_and_works, open, recorded};

#[test]
fn keyframes_of_a_file_spare_the_way() {
    let file = recorded("game", 400, 20);
    let hashes = hashes::<Sandbox>(&file);
    let mut first = open::<Sandbox>(&file, 40, 64 << 20);
    first.seek(400).unwrap();
    let bytes = first.keyframes_to_bytes();
    for tick in [399, 40, 39, 200, 0] {
        let mut timeline = open::<Sandbox>(&file, 40, 64 << 20);
        timeline.use_keyframes(&bytes).unwrap();
        assert_eq!(timeline.keyframes_to_bytes(), bytes);
        timeline.seek(tick).unwrap();
        assert_eq!(timeline.game().state_hash(), hashes[at(tick)]);
        assert!(timeline.simulated() < 40, "tick {tick}: {}", timeline.simulated());
        assert!(timeline.played() < 40, "skipped ticks must not count as played");
        let before = timeline.simulated();
        timeline.play_all().unwrap();
        assert_eq!((timeline.played(), timeline.tick()), (400, tick));
        assert!((360..440).contains(&(timeline.simulated() - before)), "expected all ticks and the way back");
    }
    // Keyframes are 40 ticks apart in the file. A requested interval is rounded up to a multiple of 40, and only the
    // keyframes at multiples of the rounded interval are used.
    for (interval, then) in [(20, 40), (40, 40), (60, 80), (100, 120)] {
        let mut timeline = open::<Sandbox>(&file, interval, 64 << 20);
        timeline.use_keyframes(&bytes).unwrap();
        assert_eq!(timeline.interval(), then);
        assert!(timeline.keyframes().all(|tick| tick % then == 0));
    }
}

#[test]
fn keyframes_of_an_interval_within_blocks_are_those_at_checkpoints() {
    let file = record(100, 10, inputs_at);
    let mut timeline = open::<Counter>(&file, 4, 1 << 20);
    timeline.seek(100).unwrap();
    let bytes = timeline.keyframes_to_bytes();
    timeline.use_keyframes(&bytes).unwrap();
    assert_eq!(timeline.keyframes().collect::<Vec<_>>(), [0, 20, 40, 60, 80, 100]);
}

fn every_20_ticks() -> TimelineOptions {
    TimelineOptions { interval: 20, ..TimelineOptions::default() }
}

/// Seeks to each keyframe of a file and plays the tick after it. The limit is the work of this tick without a seek.
fn assert_keyframes_need_no_more_work(file: &[u8]) {
    let (hashes, works) = hashes_and_works(file);
    let mut first = open::<Sandbox>(file, 20, 64 << 20);
    first.play_all().unwrap();
    let bytes = first.keyframes_to_bytes();
    for tick in (20..works.len()).step_by(20) {
        let limits = Limits { tick_work: works[tick], ..Limits::default() };
        let mut timeline = Timeline::<Sandbox>::open(file, &every_20_ticks(), &limits).unwrap();
        timeline.use_keyframes(&bytes).unwrap();
        let next = u64::try_from(tick + 1).unwrap();
        assert_eq!(timeline.seek(next), Ok(()), "tick {tick}");
        assert_eq!((timeline.game().state_hash(), timeline.simulated()), (hashes[tick + 1], 1));
        // A second seek loads the keyframe again.
        timeline.seek(0).unwrap();
        assert_eq!(timeline.seek(next), Ok(()), "tick {tick}");
    }
}

/// The tick after a keyframe searches all pairs. `verify` never searches that many in one tick of a game that adds its
/// shapes one after the other.
#[test]
fn a_tick_after_a_keyframe_is_within_the_limits_of_verify() {
    let ball = ShapeDef::new(Geometry::circle(fx!(0.25)).unwrap());
    let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 20).unwrap();
    for tick in 0..200 {
        let body = |def: BodyDef, y| BodyDef { position: Vec2::new(Fx::from(tick), Fx::from(y)), ..def };
        let spawn = |body| Command::Spawn { body, shapes: vec![ball] };
        let command = if tick % 4 == 0 { body(BodyDef::dynamic(), 1) } else { body(BodyDef::fixed(), 0) };
        recording.step(&[vec![spawn(command)]]).unwrap();
    }
    assert_keyframes_need_no_more_work(&recording.finish().unwrap());
    for scene in ["game", "ragdoll", "rain", "waterworks"] {
        assert_keyframes_need_no_more_work(&recorded(scene, 200, 20));
    }
}

/// Keyframes of a file replace the ticks before them. Nobody has checked the work of these ticks.
#[test]
fn keyframes_lift_no_limit() {
    let file = record(60, 10, |tick| add(if matches!(tick, 5 | 40) { 100 } else { 1 }, 1));
    let mut first = open::<Counter>(&file, 20, 1 << 20);
    first.play_all().unwrap();
    let bytes = first.keyframes_to_bytes();
    let limits = Limits { tick_work: 50, ..Limits::default() };
    let exceeded = Verdict::LimitExceeded { limit: LimitKind::TickWork, value: 102, max: 50 };
    for (tick, then) in [(35, 10), (40, 41)] {
        let mut timeline = Timeline::<Counter>::open(&file, &every_20_ticks(), &limits).unwrap();
        timeline.use_keyframes(&bytes).unwrap();
        timeline.seek(tick).unwrap();
        assert_eq!(timeline.seek(then), Err(SeekError::Replay(exceeded.clone())));
    }
}

/// Writes a keyframe file as `docs/FORMAT.md` specifies, without the library.
fn keyframes(replay: &[u8], interval: u64, saves: &[(u64, Counter)]) -> Vec<u8> {
    let saves: Vec<(u64, Vec<u8>)> = saves.iter().map(|(tick, save)| (*tick, codec::encode(save))).collect();
    of_body(&(("counter", 3u32), StateHash::of_bytes(replay), interval, saves))
}

fn of_body<T: serde::Serialize>(body: &T) -> Vec<u8> {
    let body = codec::encode(body);
    let mut bytes = KEYFRAMES_MAGIC.to_vec();
    bytes.extend(1u32.to_le_bytes());
    bytes.extend(lockstep2d::SEMANTICS.to_le_bytes());
    bytes.extend(u64::try_from(body.len()).unwrap().to_le_bytes());
    bytes.extend(body);
    let hash = StateHash::of_bytes(&bytes);
    bytes.extend(hash.0.to_le_bytes());
    bytes
}

fn refused(file: &[u8], keyframes: &[u8]) -> KeyframesError {
    let mut timeline = open::<Counter>(file, 10, 1 << 20);
    let error = timeline.use_keyframes(keyframes).unwrap_err();
    timeline.seek(35).unwrap();
    assert_eq!(timeline.game().tick, 35, "expected seeking without keyframes to work");
    error
}

#[test]
fn what_is_no_file_of_keyframes_is_refused() {
    let file = record(35, 10, inputs_at);
    let mut timeline = open::<Counter>(&file, 10, 1 << 20);
    let mut saves = Vec::new();
    for tick in [10, 20, 30] {
        timeline.seek(tick).unwrap();
        saves.push((tick, timeline.game().clone()));
    }
    let good = timeline.keyframes_to_bytes();
    assert_eq!(good, keyframes(&file, 10, &saves), "expected the layout of the document");

    for cut in 0..good.len() {
        refused(&file, &good[..cut]);
    }
    for at in 0..good.len() {
        for bit in 0..8 {
            let mut bad = good.clone();
            bad[at] ^= 1 << bit;
            refused(&file, &bad);
        }
    }
    assert_eq!(refused(&file, &file), KeyframesError::NotKeyframes);
    assert_eq!(refused(&record(36, 10, inputs_at), &good), KeyframesError::OtherReplay);
    let other_rules =
        of_body(&(("counter", 4u32), StateHash::of_bytes(&file), 10u64, Vec::<(u64, Vec<u8>)>::new()));
    assert!(matches!(refused(&file, &other_rules), KeyframesError::Rules { version: 4, .. }));
    let huge = of_body(&(("counter", 3u32), StateHash::of_bytes(&file), 10u64, u64::MAX));
    assert!(matches!(refused(&file, &huge), KeyframesError::Decode(_)));
    let huge = of_body(&(("counter", 3u32), StateHash::of_bytes(&file), 10u64, 1u64, 10u64, u64::MAX));
    assert!(matches!(refused(&file, &huge), KeyframesError::Decode(_)));

    let with = |interval, ticks: &[u64]| {
        let saves: Vec<_> = ticks.iter().map(|tick| (*tick, saves[0].1.clone())).collect();
        refused(&file, &keyframes(&file, interval, &saves))
    };
    for (interval, ticks, flaw) in [
        (0, &[][..], KeyframesFlaw::Interval),
        (10, &[0], KeyframesFlaw::Ticks),
        (10, &[10, 10], KeyframesFlaw::Ticks),
        (10, &[20, 10], KeyframesFlaw::Ticks),
        (20, &[10], KeyframesFlaw::Ticks),
        (10, &[40], KeyframesFlaw::Ticks),
        (1, &[u64::MAX], KeyframesFlaw::Ticks),
        (5, &[10, 15], KeyframesFlaw::Checkpoint),
    ] {
        assert_eq!(with(interval, ticks), KeyframesError::Invalid(flaw), "{interval}, {ticks:?}");
    }
}

/// The forged keyframe is well-formed, but its state is not that of the replay's checkpoint at tick 20.
#[test]
fn a_keyframe_with_another_state_is_found_when_it_is_used() {
    let file = record(35, 10, inputs_at);
    let forged = Counter { sum: 1_000_000, tick: 20, moods: 0 };
    let mut timeline = open::<Counter>(&file, 10, 1 << 20);
    timeline.use_keyframes(&keyframes(&file, 10, &[(20, forged)])).unwrap();
    timeline.seek(7).unwrap();
    let there = timeline.game().clone();
    assert!(matches!(timeline.seek(25), Err(SeekError::Keyframe { tick: 20, .. })));
    assert_eq!((timeline.tick(), timeline.game()), (7, &there), "expected the timeline to stay where it was");
    timeline.seek(19).unwrap();

    let garbage =
        of_body(&(("counter", 3u32), StateHash::of_bytes(&file), 10u64, vec![(20u64, vec![1u8, 2])]));
    let mut timeline = open::<Counter>(&file, 10, 1 << 20);
    timeline.use_keyframes(&garbage).unwrap();
    assert!(matches!(timeline.seek(25), Err(SeekError::Keyframe { tick: 20, .. })));
    assert_eq!(timeline.tick(), 0);
}

#[test]
fn damaged_keyframes_with_repaired_hashes_never_lead_elsewhere() {
    let file = record(35, 10, inputs_at);
    let hashes = hashes::<Counter>(&file);
    let mut timeline = open::<Counter>(&file, 10, 1 << 20);
    timeline.seek(35).unwrap();
    let good = timeline.keyframes_to_bytes();
    let body = good.len() - 16;
    let mut led = 0;
    for at_byte in 24..body {
        for bit in 0..8 {
            let mut bad = good[..body].to_vec();
            bad[at_byte] ^= 1 << bit;
            let hash = StateHash::of_bytes(&bad);
            bad.extend(hash.0.to_le_bytes());
            let mut timeline = open::<Counter>(&file, 10, 1 << 20);
            if timeline.use_keyframes(&bad).is_err() {
                continue;
            }
            for tick in [12, 25, 35] {
                if timeline.seek(tick).is_ok() {
                    led += 1;
                    assert_eq!(timeline.game().state_hash(), hashes[at(tick)], "byte {at_byte}, bit {bit}");
                }
            }
        }
    }
    assert!(led > 100, "expected more than 100 seeks to succeed, found {led}");
}
