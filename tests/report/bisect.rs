//! Bisection finds the tick, phase, body and field of a random bit flip. It simulates fewer ticks than three
//! verifications of the replay.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, History, RulesId, Sandbox, SandboxSetup, SetupError};
use lockstep2d::math::Rng;
use lockstep2d::replay::{Limits, Recorder, Recording, verify};
use lockstep2d::report::{Comparison, Desync, DesyncReport, Evidence, Stage, Trace, bisect};
use lockstep2d::world::{BodyField, Command, World};

use crate::sweep;
use crate::yard::{BODIES, Flip, PLAYERS, When, Yard, YardSave, inputs_at};

thread_local! {
    static FLIP: Cell<Option<Flip>> = const { Cell::new(None) };
    static STEPS: Cell<u64> = const { Cell::new(0) };
    static LOADS: Cell<u64> = const { Cell::new(0) };
    /// Whether games start with all bodies disabled.
    static FROZEN: Cell<bool> = const { Cell::new(false) };
}

/// A yard that counts its steps and loads. With `FAULTY`, it also applies the flip in `FLIP`.
struct Faulty<const FAULTY: bool>(Yard);

impl<const FAULTY: bool> Faulty<FAULTY> {
    fn flip(&mut self, now: When) {
        let tick = self.0.world.tick() + u64::from(now == When::Before);
        if let Some(flip) = FLIP.get().filter(|flip| FAULTY && flip.tick == tick && flip.when == now) {
            flip.apply(&mut self.0);
        }
    }
}

impl<const FAULTY: bool> Game for Faulty<FAULTY> {
    type Setup = u64;
    type Input = u8;
    type Save = YardSave;

    const RULES: RulesId = Yard::RULES;

    fn new(seed: &u64) -> Result<Self, SetupError> {
        let mut yard = Yard::new(seed)?;
        let bodies: Vec<_> = yard.world.bodies().map(|(id, _)| id).collect();
        for body in bodies.into_iter().filter(|_| FROZEN.get()) {
            yard.world.disable(body).expect("a body of this world");
        }
        Ok(Faulty(yard))
    }

    fn players(&self) -> u32 {
        PLAYERS
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u8]) {
        STEPS.set(STEPS.get() + 1);
        self.flip(When::Before);
        self.0.step(inputs);
        self.flip(When::After);
    }

    fn state_hash(&self) -> StateHash {
        self.0.state_hash()
    }

    fn save(&self) -> YardSave {
        self.0.save()
    }

    fn load(&mut self, save: &YardSave) {
        LOADS.set(LOADS.get() + 1);
        self.0.load(save);
    }

    fn work(&self, inputs: &[u8]) -> u64 {
        self.0.work(inputs)
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        self.0.world_mut()
    }
}

type Sound = Faulty<false>;

const LENGTH: u32 = 200;
const TICKS: u64 = LENGTH as u64;

fn inputs(tick: u64) -> Vec<u8> {
    (0..u64::from(PLAYERS)).map(|player| inputs_at(tick, player)).collect()
}

/// Returns a random flip that changes the state, and the path of the flipped body.
fn random_flip(rng: &mut Rng, seed: u64) -> (Flip, String) {
    let mut below = |n: u32| rng.next_u32() % n;
    loop {
        let field = BodyField::ALL[below(6) as usize];
        let flip = Flip {
            tick: 1 + u64::from(below(LENGTH - 60)),
            when: if below(2) == 0 { When::Before } else { When::After },
            body: below(u32::try_from(BODIES).unwrap()) as usize,
            field,
            bit: below(field.bits()),
        };
        let mut yard = Yard::new(&seed).unwrap();
        (1..flip.tick).for_each(|tick| yard.step(&inputs(tick - 1)));
        if flip.when == When::After {
            yard.step(&inputs(flip.tick - 1));
        }
        let before = yard.state_hash();
        let Some(path) = flip.apply(&mut yard) else { continue };
        assert_ne!(yard.state_hash(), before);
        // The step may erase the flip. Such flips are left out.
        if flip.when == When::Before {
            yard.step(&inputs(flip.tick - 1));
            let mut right = Yard::new(&seed).unwrap();
            (0..flip.tick).for_each(|tick| right.step(&inputs(tick)));
            if right.state_hash() == yard.state_hash() {
                continue;
            }
        }
        return (flip, path);
    }
}

fn evidence(bytes: Vec<u8>) -> Evidence {
    Evidence::read(bytes, &Limits::default()).unwrap()
}

/// Path of the blamed subject, and name of its field.
fn culprit(found: &Comparison) -> (String, String) {
    if let Some(told) = &found.explanation {
        return (told.path.clone(), told.differences[0].field().name().into());
    }
    let subject = found.subjects.first().expect("something differs");
    (subject.path.clone(), subject.differences[0].field().name().into())
}

#[test]
fn a_flipped_bit_is_found_in_its_trace_for_less_than_three_verifications() {
    let worst = AtomicU64::new(0);
    let cases = sweep::sample(0..100, 7);
    let drawn = Mutex::new(BTreeSet::new());
    sweep::for_each(cases, |case| {
        let (flip, path) = random_flip(&mut Rng::new(600 + case), case);
        let when = if flip.when == When::Before { "before" } else { "after" };
        drawn.lock().unwrap().extend([flip.field.name(), when]);
        FLIP.set(Some(flip));
        let mut trace = Trace::<Faulty<true>>::start(&case, LENGTH).unwrap();
        (0..TICKS).for_each(|tick| trace.step(&inputs(tick)).unwrap());
        let trace = evidence(trace.report().to_bytes());
        STEPS.set(0);
        let found = bisect::<Sound>(&trace, None, &Limits::default()).unwrap();
        worst.fetch_max(STEPS.get(), Ordering::Relaxed);
        let what = format!("{flip:?} of {path}");
        assert_eq!(found.first_different, Some(flip.tick), "{what}");
        assert_eq!(found.last_equal, Some(flip.tick - 1), "{what}");
        let stage = if flip.when == When::Before { Stage::BeforeStep } else { Stage::AfterStep };
        assert_eq!(found.stage, Some(stage), "{what}");
        assert_eq!(culprit(&found), (path.clone(), flip.field.name().into()), "{what}");
    });
    // The flips covered every field, and both points in time (before and after the step).
    let drawn = drawn.into_inner().unwrap();
    assert_eq!(drawn.len(), BodyField::ALL.len() + 2, "only {drawn:?}");
    let worst = worst.into_inner();
    println!("at most {worst} steps, verification takes {TICKS}");
    assert!(worst < 3 * TICKS, "expected less than three verifications of {TICKS} ticks, took {worst} steps");
}

#[test]
fn a_replay_tells_the_second_and_the_trace_of_that_second_the_rest() {
    let mut rng = Rng::new(7);
    let (flip, path) = random_flip(&mut rng, 5);
    FLIP.set(Some(flip));
    let mut recording = Recording::<Faulty<true>>::start(&5, 60).unwrap();
    (0..TICKS).for_each(|tick| recording.step(&inputs(tick)).unwrap());
    let replay = recording.finish().unwrap();
    let limits = Limits::default();
    assert!(!verify::<Sound>(&replay, &limits).is_match());

    let found = bisect::<Sound>(&evidence(replay.clone()), None, &limits).unwrap();
    let (last, first) = (found.last_equal.unwrap(), found.first_different.unwrap());
    assert!(last < flip.tick && flip.tick <= first && first == last + 60, "{found:?}");
    assert!(found.notes.last().unwrap().contains("a trace of them"), "{found:?}");

    // The faulty program simulates the replay that it has recorded.
    let trace = Trace::<Faulty<true>>::of_replay(&replay, &limits, first, 60).unwrap();
    assert_eq!((trace.tick(), trace.history().len()), (first, 61));
    let found = bisect::<Sound>(&evidence(trace.to_bytes()), None, &limits).unwrap();
    assert_eq!(found.first_different, Some(flip.tick), "{found:?}");
    assert_eq!(culprit(&found), (path, flip.field.name().into()), "{found:?}");
    // A program without the fault finds no difference in its own trace.
    let own = Trace::<Sound>::of_replay(&replay, &limits, u64::MAX, 60).unwrap();
    assert!(bisect::<Sound>(&evidence(own.to_bytes()), None, &limits).unwrap().is_equal());
}

#[test]
fn checkpoints_of_every_tick_tell_the_tick() {
    let mut rng = Rng::new(8);
    for case in 0..6 {
        let (flip, path) = random_flip(&mut rng, case);
        FLIP.set(Some(flip));
        let mut recording = Recording::<Faulty<true>>::start(&case, 1).unwrap();
        (0..TICKS).for_each(|tick| recording.step(&inputs(tick)).unwrap());
        let replay = evidence(recording.finish().unwrap());
        STEPS.set(0);
        let found = bisect::<Sound>(&replay, None, &Limits::default()).unwrap();
        assert!(STEPS.get() < 3 * TICKS);
        assert_eq!(found.first_different, Some(flip.tick), "{found:?}");
        // The comparison cannot try all bits, so it may blame no body. It must not blame the wrong one.
        let told = found.explanation.map(|told| told.path);
        assert!(told.as_ref().is_none_or(|told| *told == path), "blamed {told:?} instead of {path}");
    }
}

/// A report of ten ticks. The hash of the last tick is given by `hash`, and is not that of the saved state.
fn misstated(hash: impl FnOnce(&mut Sound) -> StateHash) -> Evidence {
    let (mut recorder, mut game) = Recorder::<Sound>::start(&3, 60).unwrap();
    let mut history = History::<Sound>::of_ticks(20);
    for tick in 1..=10 {
        game.step(recorder.record(&inputs(tick)).unwrap());
        history.push(tick, game.save(), game.state_hash());
    }
    let replay = recorder.so_far(game.state_hash());
    let save = game.save();
    history.push(10, save, hash(&mut game));
    let found = Desync { players: PLAYERS, tick: 10, known: 10, seats: Vec::new(), hashes: Vec::new() };
    evidence(DesyncReport::new(&found, &history, replay).to_bytes())
}

#[test]
fn a_hash_that_is_not_of_its_save_may_be_explained() {
    let mut path = None;
    let flip = Flip { tick: 10, when: When::After, body: 0, field: BodyField::VelocityX, bit: 0 };
    let report = misstated(|game| {
        path = flip.apply(&mut game.0);
        game.state_hash()
    });
    let found = bisect::<Sound>(&report, None, &Limits::default()).unwrap();
    assert_eq!((found.first_different, found.tick, found.subjects.len()), (Some(10), Some(10), 0));
    assert_eq!(found.explanation.map(|told| (told.path, told.bit)), path.map(|path| (path, 0)));
}

/// The world refuses to flip bits of bodies that are disabled, asleep or not dynamic. Therefore an untrusted report
/// with many such bodies causes no work.
#[test]
fn bodies_that_do_not_move_are_not_searched() {
    FROZEN.set(true);
    let report = misstated(|_| StateHash(7));
    LOADS.set(0);
    let found = bisect::<Sound>(&report, None, &Limits::default()).unwrap();
    FROZEN.set(false);
    assert_eq!((found.first_different, found.explanation), (Some(10), None));
    assert!(LOADS.get() < 10, "loaded {} states", LOADS.get());
}

/// A flip that the world refuses changes nothing, so the search tries the next flip without loading the state again.
/// The number of tried flips is limited.
#[test]
fn the_loads_of_a_search_are_limited() {
    let report = misstated(|_| StateHash(7));
    LOADS.set(0);
    let found = bisect::<Sound>(&report, None, &Limits::default()).unwrap();
    assert_eq!((found.first_different, found.explanation), (Some(10), None));
    // The search may cost as much as 15 ticks, and a load is charged as half a tick. This allows about 30 loads.
    assert!(LOADS.get() <= 32, "loaded {} states", LOADS.get());
}

fn sandbox(seed: u64) -> SandboxSetup {
    let mut setup = SandboxSetup::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.4)).unwrap());
    for place in 0..12 {
        let x = lockstep2d::math::Fx::from_num((place + seed) % 12) * 2;
        let body = BodyDef::dynamic().position((x, fx!(3)));
        setup.commands.push(Command::Spawn { body, shapes: vec![ball] });
    }
    setup
}

/// Two replays differ in one command, by one bit of a velocity.
#[test]
fn of_two_replays_the_tick_after_the_first_other_command_is_found() {
    sweep::for_each(sweep::sample(0..40, 7), |case| {
        let mut rng = Rng::new(900 + case);
        let tick = u64::from(rng.next_u32()) % 200;
        let body = rng.next_u32() as usize % 12;
        let bit = rng.next_u32() % 20;
        let record = |planted: bool| {
            let mut recording = Recording::<Sandbox>::start(&sandbox(case), 60).unwrap();
            for now in 0..260 {
                let mut commands = Vec::new();
                if now == tick && planted {
                    let (id, body) = recording.game().world().bodies().nth(body).unwrap();
                    let mut velocity = body.velocity();
                    velocity.x = lockstep2d::math::Fx::from_bits(velocity.x.to_bits() ^ (1 << (bit + 11)));
                    commands.push(Command::SetVelocity {
                        body: id,
                        velocity,
                        angular_velocity: body.angular_velocity(),
                    });
                }
                recording.step(&[commands]).unwrap();
            }
            evidence(recording.finish().unwrap())
        };
        let (a, b) = (record(false), record(true));
        let found = bisect::<Sandbox>(&a, Some(&b), &Limits::default()).unwrap();
        assert_eq!((found.last_equal, found.first_different), (Some(tick), Some(tick + 1)), "{found:?}");
        assert_eq!(found.input.as_ref().map(|input| input.tick), Some(tick), "{found:?}");
        assert_eq!(found.stage, Some(Stage::BeforeStep), "{found:?}");
        let (path, name) = culprit(&found);
        assert!(path.ends_with(&format!("body {body}v0")), "{path} {name}");
        let found = bisect::<Sandbox>(&a, Some(&a), &Limits::default()).unwrap();
        assert!(found.is_equal() && found.last_equal == Some(260));
    });
}

/// The inputs may differ in an earlier tick than the states.
#[test]
fn replays_whose_states_meet_again_part_where_every_tick_says_so() {
    let record = |kicks: &[(u64, i32)]| {
        let mut recording = Recording::<Sandbox>::start(&sandbox(0), 60).unwrap();
        for now in 0..120 {
            let kick = kicks.iter().find(|(tick, _)| *tick == now);
            // Kick 0 sets gravity to its current value: the inputs differ, and the states are equal.
            let commands = match kick {
                Some((_, 0)) => {
                    vec![Command::SetGravity { gravity: recording.game().world().config().gravity }]
                }
                Some(_) => {
                    vec![Command::SetGravity { gravity: lockstep2d::math::Vec2::new(fx!(1), fx!(-9)) }]
                }
                None => Vec::new(),
            };
            recording.step(&[commands]).unwrap();
        }
        evidence(recording.finish().unwrap())
    };
    let found = |a: &[(u64, i32)], b: &[(u64, i32)]| {
        bisect::<Sandbox>(&record(a), Some(&record(b)), &Limits::default()).unwrap()
    };
    let same = found(&[(20, 0)], &[(40, 0)]);
    assert_eq!((same.first_different, same.last_equal), (None, Some(120)), "{same:?}");
    assert!(same.input.is_some() && !same.is_equal());
    let later = found(&[(20, 0), (77, 1)], &[(40, 0)]);
    assert_eq!((later.first_different, later.last_equal), (Some(78), Some(77)), "{later:?}");
}
