//! Edits whose cost depends on joints, on contacts of sleeping bodies, or on slots of bodies that are gone; and worlds
//! whose cost must not be overestimated. The commands of a tick are charged before the first one is executed. The
//! numbers of visited joints and contacts are not known by then, so the world has to count them.

use lockstep2d::body::{BodyDef, BodyKind, MassSource};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::replay::{Limits, Step, VerifiedReplay, verify};
use lockstep2d::solver::{JointDef, SolverSettings, Weld};
use lockstep2d::world::{BodyPose, Command, Config};

use super::builders::{body, each, grid, octagon, spawn, square, still};
use super::cost::{Case, Script, record, setup, too_expensive, too_expensive_commands};

fn with_rounds(sub_steps: u32, iterations: u32) -> Config {
    let solver = SolverSettings { sub_steps, iterations, ..SolverSettings::default() };
    Config { solver, ..still() }
}

/// Repeats commands on the first of two bodies with many joints.
fn beside_joints(name: &str, first: &[Command], repeated: &[Command]) -> Option<String> {
    let weld = JointDef { enabled: false, ..JointDef::new(body(0), body(1), Weld::rigid()) };
    let case = |count: i64| -> Case<'_> {
        let count = usize::try_from(count).expect("a number");
        let script = move |_| [first.to_vec(), vec![repeated.to_vec(); count].concat()].concat();
        let bare = || spawn(BodyDef::dynamic(), Vec::new());
        let joints = Command::AddJointEach { joint: weld, ends: vec![(body(0), body(1)); 20_000] };
        (setup(vec![bare(), bare(), joints], with_rounds(1, 1)), 1, Box::new(script))
    };
    too_expensive(name, 500, case)
}

#[test]
fn edits_of_a_body_with_many_joints() {
    let body = body(0);
    let mass = |mass| Command::SetMass { body, mass };
    let given = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(1) };
    let kinematic = [Command::SetKind { body, kind: BodyKind::Kinematic }];
    let velocity =
        |x: Fx| Command::SetVelocity { body, velocity: Vec2::new(x, Fx::ZERO), angular_velocity: Fx::ZERO };
    let there = Command::MoveTo { body, position: Vec2::new(fx!(1), fx!(0)), angle: Angle::ZERO };
    let wrong = [
        beside_joints("SetMass", &[], &[mass(given), mass(MassSource::Shapes)]),
        beside_joints("SetVelocity", &kinematic, &[velocity(fx!(1)), velocity(fx!(0))]),
        beside_joints("MoveTo", &kinematic, &[there, velocity(fx!(0))]),
        beside_joints("Wake", &kinematic, &[Command::Wake { body }]),
    ];
    assert!(wrong.iter().all(Option::is_none), "{wrong:#?}");
}

/// Two bodies with `count` shapes each, all at one point. The bodies fall asleep in the second tick.
fn sleepers(config: Config, count: i64, third_tick: Vec<Command>) -> Case<'static> {
    let count = usize::try_from(count).expect("a number");
    let crowd = |shape| spawn(BodyDef::dynamic(), vec![shape; count]);
    let script = move |tick| match tick {
        0 => Vec::new(),
        1 => vec![Command::Sleep { body: body(0) }],
        _ => third_tick.clone(),
    };
    (setup(vec![crowd(square(fx!(0.5))), crowd(octagon())], config), 3, Box::new(script))
}

#[test]
fn settings_beside_sleeping_contacts() {
    let set = |sub_steps| Command::SetConfig { config: with_rounds(sub_steps, 1) };
    // The bodies fall asleep again, so that the tick does not solve their contacts.
    let mut commands: Vec<_> = [set(2), set(1)].into_iter().cycle().take(200).collect();
    commands.push(Command::Sleep { body: body(0) });
    let (setup, ticks, script) = sleepers(with_rounds(1, 1), 100, commands);
    // Each change of the settings converts the impulses of 10 000 contacts.
    let limits = Limits { tick_work: 200 * 10_000, ..Limits::default() };
    let verdict = verify::<Sandbox>(&record(&setup, ticks, &script), &limits);
    assert_eq!(verdict.name(), "limit_exceeded", "{verdict}");
}

#[test]
fn solving_of_woken_pairs() {
    let set = || vec![Command::SetConfig { config: with_rounds(16, 16) }];
    let wrong = too_expensive("woken pairs", 140, |count| sleepers(with_rounds(1, 1), count, set()));
    assert!(wrong.is_none(), "{wrong:#?}");
}

/// A body, and slots whose bodies have been removed.
fn beside_vacant_slots(slots: u32) -> Vec<Command> {
    let poses = vec![BodyPose { position: Vec2::ZERO, angle: Angle::ZERO }; slots as usize];
    let mut commands = vec![
        spawn(BodyDef::dynamic(), Vec::new()),
        Command::SpawnEach { body: BodyDef::fixed(), shapes: Vec::new(), poses },
    ];
    commands.extend((1..=slots).map(|slot| Command::Despawn { body: body(slot) }));
    commands
}

#[test]
fn edits_beside_vacant_slots() {
    let setup = setup(beside_vacant_slots(20_000), still());
    let gravity = |y: Fx| Command::SetGravity { gravity: Vec2::new(Fx::ZERO, y) };
    let asleep = [Command::Sleep { body: body(0) }, Command::Wake { body: body(0) }];
    let wrong = [
        too_expensive_commands(
            "SetGravity beside vacant slots",
            &setup,
            &[gravity(fx!(-1)), gravity(fx!(-2))],
        ),
        too_expensive_commands("Sleep, Wake beside vacant slots", &setup, &asleep),
    ];
    assert!(wrong.iter().all(Option::is_none), "{wrong:#?}");
}

/// A tick may visit all slots, and a visit takes some 10 ns. So vacant slots count as work.
#[test]
fn ticks_beside_vacant_slots() {
    let game = Sandbox::new(&setup(beside_vacant_slots(100_000), still())).expect("a setup");
    assert!(game.world().work(0, 0) >= 1000);
}

/// Mean work units of a tick, over ten seconds.
fn mean_work(commands: Vec<Command>, config: Config) -> u64 {
    let ticks = 600;
    let file = record(&setup(commands, config), ticks, &(Box::new(|_| Vec::new()) as Script<'_>));
    let mut play =
        VerifiedReplay::<Sandbox>::open(&file, &Limits::default()).expect("a replay that can start");
    let started = play.work();
    while play.step().expect("a replay that can be played") != Step::Ended {}
    (play.work() - started) / ticks
}

/// Two fixed shapes never make a pair, so scenery costs work for its shapes, but not for pairs of them.
#[test]
fn a_day_among_many_tiles_is_within_the_default_limits() {
    let tiles = (0..2000).map(|x| square(fx!(0.5)).offset((fx!(0.05) * x, fx!(0)))).collect();
    let ball = spawn(BodyDef::dynamic().position((fx!(50), fx!(3))), vec![square(fx!(0.5))]);
    let limits = Limits::default();
    let tick = mean_work(vec![spawn(BodyDef::fixed(), tiles), ball], Config::default());
    assert!(tick * limits.ticks <= limits.total_work, "{tick} units a tick");
}

#[test]
fn resting_boxes_are_not_compared_with_each_other() {
    let boxes =
        |side| mean_work(vec![each(BodyDef::dynamic(), square(fx!(0.5)), grid(side, fx!(2)))], still());
    let (few, many) = (boxes(10), boxes(20));
    assert!(many < 5 * few, "four times as many boxes: {few} and {many} units");
}
