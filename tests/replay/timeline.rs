//! After a seek, the state is the one that a playback without seeks reaches at the same tick. A seek within the part
//! that has been played simulates at most two intervals between keyframes, even if the memory budget is small.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::codec;
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, Sandbox, SandboxSetup, SetupError};
use lockstep2d::math::{Angle, Fx, Rng, Vec2};
use lockstep2d::replay::{
    LimitKind, Limits, RawReplay, Recording, SeekError, Step, Timeline, TimelineOptions, Verdict,
    VerifiedReplay,
};
use lockstep2d::world::{BodyPose, Command};

use crate::counter::{Counter, Input, Setup, add, inputs_at, like_its_counter, setup};
use crate::forge::forge;
use crate::record;

pub(crate) fn open<'a, G: Game>(file: &'a [u8], interval: u32, bytes: usize) -> Timeline<'a, G> {
    let options = TimelineOptions { interval, bytes };
    Timeline::open(file, &options, &Limits::default()).unwrap()
}

/// State hashes of a playback without seeks: one at the start and one after each tick.
pub(crate) fn hashes<G: Game>(file: &[u8]) -> Vec<StateHash> {
    let mut replay = VerifiedReplay::<G>::open(file, &Limits::default()).unwrap();
    let mut hashes = vec![replay.game().state_hash()];
    while replay.step().unwrap() == Step::Ticked {
        hashes.push(replay.game().state_hash());
    }
    hashes
}

pub(crate) fn at(tick: u64) -> usize {
    usize::try_from(tick).unwrap()
}

fn random_tick(rng: &mut Rng, ticks: u64) -> u64 {
    u64::from(rng.below(u32::try_from(ticks).unwrap() + 1))
}

pub(crate) fn recorded(scene: &str, ticks: u64, interval: u32) -> Vec<u8> {
    let scene = lockstep2d_scenes::Scene::find(scene).unwrap();
    let mut recording = Recording::<Sandbox>::start(&scene.setup(1), interval).unwrap();
    for tick in 0..ticks {
        let commands = scene.commands(tick, recording.game());
        recording.step(&[commands]).unwrap();
    }
    recording.finish().unwrap()
}

#[test]
fn any_tick_of_a_hundred_thousand_is_two_intervals_away() {
    const TICKS: u64 = 100_000;
    let file = record(TICKS, 60, inputs_at);
    let hashes = hashes::<Counter>(&file);
    // The first case has memory for all keyframes, and the second for about a hundred. In the last two cases, the
    // interval is not a multiple of the block length of 60 ticks.
    for (interval, bytes) in [(300, 64 << 20), (60, 50_000), (37, 64 << 20), (1000, 64 << 20)] {
        let mut timeline = open::<Counter>(&file, interval, bytes);
        assert_eq!((timeline.simulated(), timeline.ticks()), (0, TICKS), "expected no simulation on opening");
        timeline.play_all().unwrap();
        assert_eq!((timeline.tick(), timeline.played(), timeline.simulated()), (0, TICKS, TICKS));
        let mut rng = Rng::new(7);
        let mut longest = 0;
        for _ in 0..2000 {
            let (tick, before) = (random_tick(&mut rng, TICKS), timeline.simulated());
            timeline.seek(tick).unwrap();
            assert_eq!(timeline.tick(), tick);
            assert_eq!(timeline.game().state_hash(), hashes[at(tick)], "tick {tick}");
            longest = longest.max(timeline.simulated() - before);
        }
        assert!(
            longest <= 2 * timeline.interval(),
            "{longest} ticks at an interval of {}",
            timeline.interval()
        );
        assert!(longest > timeline.interval() / 2, "expected a seek of more than half an interval");
        assert!(bytes < 1 << 20 || timeline.interval() <= u64::from(interval), "{}", timeline.interval());
    }
}

#[test]
fn before_it_has_been_played_a_seek_plays_what_is_missing_and_no_more() {
    let file = record(5000, 60, inputs_at);
    let hashes = hashes::<Counter>(&file);
    let mut timeline = open::<Counter>(&file, 120, 1 << 20);
    let mut rng = Rng::new(3);
    for _ in 0..500 {
        let (tick, before) = (random_tick(&mut rng, 5000), timeline.simulated());
        let missing = tick.saturating_sub(timeline.played());
        timeline.seek(tick).unwrap();
        assert!(timeline.simulated() - before <= missing + 120, "tick {tick}");
        assert_eq!(timeline.game().state_hash(), hashes[at(tick)]);
    }
}

#[test]
fn worlds_come_back_at_every_tick() {
    for (scene, ticks) in [("game", 400), ("spawning", 600), ("ragdoll", 320)] {
        let file = recorded(scene, ticks, 20);
        let hashes = hashes::<Sandbox>(&file);
        let mut timeline = open::<Sandbox>(&file, 40, 64 << 20);
        let mut rng = Rng::new(5);
        timeline.seek(ticks).unwrap();
        for _ in 0..60 {
            let (tick, before) = (random_tick(&mut rng, ticks), timeline.simulated());
            timeline.seek(tick).unwrap();
            assert_eq!(timeline.game().state_hash(), hashes[at(tick)], "{scene}, tick {tick}");
            assert!(timeline.simulated() - before < 40, "{scene}, tick {tick}");
        }
        timeline.seek(ticks).unwrap();
        let before = timeline.simulated();
        for tick in (0..ticks).rev() {
            assert_eq!(timeline.step_back(), Ok(Step::Ticked));
            assert_eq!(timeline.game().state_hash(), hashes[at(tick)], "{scene}, back at tick {tick}");
        }
        assert_eq!(timeline.step_back(), Ok(Step::Ended));
        assert!(
            timeline.simulated() - before <= ticks,
            "expected at most one more simulation of each tick: {}",
            timeline.simulated() - before
        );
        assert_eq!((timeline.tick(), timeline.step()), (0, Ok(Step::Ticked)));
    }
}

#[test]
fn steps_backwards_are_cheap_in_little_memory_too() {
    let file = record(20_000, 60, inputs_at);
    // There is memory for about 100 keyframes, and for 30 saves for stepping backwards.
    let mut timeline = open::<Counter>(&file, 60, 40_000);
    timeline.seek(20_000).unwrap();
    let interval = timeline.interval();
    assert!(interval >= 240, "{interval}");
    let before = timeline.simulated();
    for _ in 0..interval {
        timeline.step_back().unwrap();
    }
    let each = (timeline.simulated() - before) / interval;
    assert!(each <= interval / 20, "{each} ticks for a step, at an interval of {interval}");
}

#[test]
fn keyframes_stay_within_their_budget_and_evenly_spread() {
    let file = record(50_000, 60, inputs_at);
    for bytes in [0, 1, 10_000, 100_000, 1 << 20] {
        let mut timeline = open::<Counter>(&file, 60, bytes);
        timeline.seek(50_000).unwrap();
        let (interval, ticks): (u64, Vec<u64>) = (timeline.interval(), timeline.keyframes().collect());
        let count = u64::try_from(ticks.len()).unwrap();
        assert!(ticks.iter().zip(0..).all(|(tick, number)| *tick == number * interval), "{bytes}: {ticks:?}");
        assert!(count == 1 || count == 50_000 / interval + 1, "{bytes} bytes: {count} at {interval}");
        let saves = ticks.len() * codec::encode(timeline.game()).len();
        assert!(ticks.len() == 1 || saves <= bytes, "{saves} bytes of saves in a budget of {bytes}");
        timeline.seek(12_345).unwrap();
        assert_eq!(timeline.game().tick, 12_345);
    }
}

#[test]
fn there_is_no_tick_behind_the_last() {
    let file = record(35, 10, inputs_at);
    for whole in [file.len(), file.len() - 1] {
        let mut timeline = open::<Counter>(&file[..whole], 10, 1 << 20);
        assert_eq!(timeline.seek(36), Err(SeekError::NoSuchTick { tick: 36, ticks: 35 }));
        assert_eq!(timeline.tick(), 0);
        timeline.seek(35).unwrap();
        assert_eq!(timeline.step(), Ok(Step::Ended));
        assert_eq!(timeline.game().tick, 35);
    }
}

#[test]
fn a_checkpoint_that_is_another_is_found_on_the_way() {
    let file = forge(&record(50, 10, inputs_at), |forged| *forged.payload(2).last_mut().unwrap() ^= 1);
    let mut timeline = open::<Counter>(&file, 10, 1 << 20);
    let diverged = SeekError::Replay(Verdict::Diverged { last_equal: Some(20), first_different: 30 });
    assert_eq!(timeline.seek(45), Err(diverged.clone()));
    assert_eq!((timeline.tick(), timeline.played()), (30, 29));
    for tick in [29, 3, 20, 28] {
        timeline.seek(tick).unwrap();
        assert_eq!(timeline.game().tick, tick);
    }
    assert_eq!(timeline.seek(30), Err(diverged.clone()));
    timeline.seek(29).unwrap();
    assert_eq!((timeline.step(), timeline.tick()), (Err(diverged), 29));
}

#[test]
fn limits_hold_on_the_way_and_repeated_ticks_count_once() {
    let file = record(100, 10, |tick| add(if tick == 70 { 100 } else { 1 }, 1));
    let limits = Limits { tick_work: 50, ..Limits::default() };
    let mut timeline = Timeline::<Counter>::open(&file, &TimelineOptions::default(), &limits).unwrap();
    let exceeded = Verdict::LimitExceeded { limit: LimitKind::TickWork, value: 102, max: 50 };
    assert_eq!(timeline.seek(100), Err(SeekError::Replay(exceeded)));
    timeline.seek(69).unwrap();
    // One of the 99 ticks costs 102 units of work, and each of the others costs 3. Ticks that are simulated again must
    // not count again.
    let limits = Limits { total_work: 700, ..Limits::default() };
    let mut timeline = Timeline::<Counter>::open(&file, &TimelineOptions::default(), &limits).unwrap();
    for _ in 0..50 {
        timeline.seek(99).unwrap();
        timeline.seek(0).unwrap();
    }
}

/// A replay of balls that fall for 41 ticks and touch the floor in tick 42. The work of that tick includes their
/// contacts.
fn falling_balls() -> Vec<u8> {
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let floor = Polygon::rectangle(fx!(20), fx!(1)).unwrap();
    let poses =
        (0..20).map(|x| BodyPose { position: Vec2::new(Fx::from(x - 10), fx!(4)), angle: Angle::ZERO });
    let commands = vec![
        Command::Spawn { body: BodyDef::fixed(), shapes: vec![ShapeDef::new(floor)] },
        Command::SpawnEach { body: BodyDef::dynamic(), shapes: vec![ball], poses: poses.collect() },
    ];
    let setup = SandboxSetup { commands, ..SandboxSetup::default() };
    let mut recording = Recording::<Sandbox>::start(&setup, 60).unwrap();
    (0..120).for_each(|_| recording.step(&[vec![]]).unwrap());
    recording.finish().unwrap()
}

/// State hashes at the start and after each tick, and the work of each tick.
pub(crate) fn hashes_and_works(file: &[u8]) -> (Vec<StateHash>, Vec<u64>) {
    let mut replay = RawReplay::<Sandbox>::open(file, &Limits::default()).unwrap();
    let (mut hashes, mut works) = (vec![replay.game().state_hash()], vec![]);
    let mut before = replay.work();
    while replay.step() == Ok(Step::Ticked) {
        hashes.push(replay.game().state_hash());
        works.push(replay.work() - before);
        before = replay.work();
    }
    (hashes, works)
}

/// The world counts its work during the step, so a step has already begun when it exceeds the limit.
#[test]
fn a_world_that_exceeds_a_limit_stays_at_the_last_tick() {
    let file = falling_balls();
    let (hashes, works) = hashes_and_works(&file);
    let most = *works.iter().max().unwrap();
    let last = works.iter().position(|&work| work == most).unwrap();
    assert!(last > 30, "the step in which the balls land costs most");
    let limits = Limits { tick_work: most - 1, ..Limits::default() };
    let mut timeline = Timeline::<Sandbox>::open(&file, &TimelineOptions::default(), &limits).unwrap();
    assert!(matches!(timeline.seek(120), Err(SeekError::Replay(Verdict::LimitExceeded { .. }))));
    assert_eq!(timeline.tick(), last as u64);
    assert_eq!(timeline.game().state_hash(), hashes[last]);
    for tick in [last, 3, last - 1, last] {
        timeline.seek(tick as u64).unwrap();
        assert_eq!(timeline.game().state_hash(), hashes[tick]);
    }
}

#[test]
fn a_game_that_leaves_its_replay_has_no_limits() {
    let file = falling_balls();
    let (hashes, works) = hashes_and_works(&file);
    let limits = Limits { tick_work: works[0], ..Limits::default() };
    let mut replay = RawReplay::<Sandbox>::open(&file, &limits).unwrap();
    while replay.tick() < 30 {
        replay.step().unwrap();
    }
    assert!(works[30..].iter().any(|&work| work > works[0]), "the limit is below the work of later ticks");
    let mut game = replay.into_game();
    (30..120).for_each(|_| game.step(&[vec![]]));
    assert_eq!(game.state_hash(), hashes[120]);
}

/// A counter whose sum also depends on a value that is not saved.
struct Forgetful {
    counter: Counter,
    last: i64,
}

impl Game for Forgetful {
    type Setup = Setup;
    type Input = Input;
    type Save = Counter;

    const RULES: RulesId = Counter::RULES;

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        Ok(Forgetful { counter: Counter::new(setup)?, last: 0 })
    }

    like_its_counter!(counter);

    fn step(&mut self, inputs: &[Input]) {
        self.counter.step(inputs);
        self.counter.sum += self.last;
        self.last = 1 + self.counter.sum % 5;
    }
}

#[test]
fn a_game_that_does_not_save_all_of_itself_is_found_out() {
    let mut recording = Recording::<Forgetful>::start(&setup(), 10).unwrap();
    (0..100).for_each(|tick| recording.step(&inputs_at(tick)).unwrap());
    let file = recording.finish().unwrap();
    let mut timeline = open::<Forgetful>(&file, 20, 1 << 20);
    timeline.seek(100).unwrap();
    assert_eq!(timeline.seek(55), Err(SeekError::Forgetful { tick: 50 }));
    // A later seek to tick 50 may fail. If it succeeds, the timeline shows the right state.
    if timeline.seek(50).is_ok() {
        assert_eq!(timeline.game().state_hash(), hashes::<Forgetful>(&file)[50]);
    }
}

#[test]
fn inputs_of_a_verified_replay_are_those_of_the_tick() {
    let file = record(35, 10, inputs_at);
    let mut replay = VerifiedReplay::<Counter>::open(&file, &Limits::default()).unwrap();
    assert_eq!(replay.inputs(), &[] as &[Input]);
    for tick in 0..35 {
        replay.step().unwrap();
        assert_eq!(replay.inputs(), inputs_at(tick));
    }
    let units: u64 = (0..35).map(|tick| Counter { sum: 0, tick: 0, moods: 0 }.work(&inputs_at(tick))).sum();
    assert_eq!(replay.work(), units);
}
