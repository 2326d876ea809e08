//! Work units bound the time: no tick and no setup takes more than a microsecond for each unit (three in builds with
//! debug assertions). The limits of a verifier depend on this bound.
//!
//! Each case is recorded, and played by the verifier's player, which charges the units. A limit below the work of the
//! case must stop verification within the time that the units of the limit allow. Times are processor times of the
//! thread, where the system reports them, and the shortest of several runs, so that other load has little effect.
#![expect(clippy::disallowed_types, reason = "the test measures time")]

mod builders;
mod cost;
mod uncounted;

use std::time::Duration;

use lockstep2d::body::{
    Area, BodyDef, BodyKind, BodySettings, Chain, Continuous, Geometry, JointId, MassSource, ShapeDef,
    ShapeId,
};
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::replay::{Limits, Recording, verify};
use lockstep2d::solver::{JointDef, Revolute, Threshold, ThresholdAction, Weld};
use lockstep2d::world::{Command, Config, Explosion};
use lockstep2d_tests::sweep;

use builders::{body, each, grid, identifier, joined, octagon, spawn, square, still};
use cost::{Case, computed, setup, too_expensive, too_expensive_commands};

#[test]
fn removed_and_broken_joints() {
    let weld = JointDef::new(body(0), body(1), Weld::rigid());
    let hinge = JointDef::new(body(0), body(1), Revolute::new());
    let breaking = JointDef {
        threshold: Threshold { force: Some(Fx::ZERO), torque: None, action: ThresholdAction::Break },
        ..weld
    };
    let setup_of = |count, joint| setup(joined(usize::try_from(count).expect("a number"), joint), still());
    let slots = |count| 0..u32::try_from(count).expect("slots");
    let remove = |slot| Command::RemoveJoint { joint: identifier::<JointId>(slot) };
    let oldest = |count| -> Case<'_> {
        let all = move |tick| slots(count).filter(|_| tick == 0).map(remove).collect();
        (setup_of(count, weld), 2, Box::new(all))
    };
    let newest = |count| -> Case<'_> {
        let all = move |tick| slots(count).rev().filter(|_| tick == 0).map(remove).collect();
        (setup_of(count, hinge), 2, Box::new(all))
    };
    let pull = |_| {
        vec![Command::ApplyForce { body: body(0), force: Vec2::new(fx!(900), Fx::ZERO), point: Vec2::ZERO }]
    };
    let wrong = [
        too_expensive("joints removed, oldest first", 20_000, oldest),
        too_expensive("joints removed, newest first", 20_000, newest),
        too_expensive("joints that break", 20_000, |count| (setup_of(count, breaking), 2, Box::new(pull))),
    ];
    assert!(wrong.iter().all(Option::is_none), "{wrong:#?}");
}

/// A hub to which hinges join `count` bodies. The hinges have motors of very different strengths.
fn motors_of_hub(count: i64) -> Case<'static> {
    let limbs = u32::try_from(count).expect("a number");
    let mut commands =
        vec![each(BodyDef::dynamic(), square(fx!(0.5)), grid(count + 1, fx!(2)).take(limbs as usize + 1))];
    for power in 0..8u32 {
        let motor = Revolute::new().motor(fx!(50), fx!(0.001) * 4i64.pow(power));
        let joint = JointDef::new(body(0), body(1), motor).anchor_b((fx!(2), fx!(0)));
        let ends = (1..=limbs).filter(|limb| limb % 8 == power).map(|limb| (body(0), body(limb)));
        commands.push(Command::AddJointEach { joint, ends: ends.collect() });
    }
    (setup(commands, still()), 3, Box::new(|_| Vec::new()))
}

/// Many hinges at one body have motors of very different strength that all slip. The block solver needs many rounds to
/// find the motors at their limit.
#[test]
fn motors_in_blocks() {
    let wrong = too_expensive("motors in blocks", 64, motors_of_hub);
    assert!(wrong.is_none(), "{wrong:#?}");
}

#[test]
fn motors_in_blocks_with_many_iterations() {
    let case = |count: i64| -> Case<'_> {
        let (world, ticks, script) = motors_of_hub(count);
        let mut config = world.config;
        config.solver.iterations = 16;
        (setup(world.commands, config), ticks, script)
    };
    let wrong = too_expensive("motors in blocks, 16 iterations", 64, case);
    assert!(wrong.is_none(), "{wrong:#?}");
}

/// Elastic shapes that hit at the same time are solved against each other in many passes.
#[test]
fn elastic_crowds() {
    let mut wrong = Vec::new();
    for (name, gap) in [("apart", fx!(1.001)), ("touching", fx!(1)), ("overlapping", fx!(0.3))] {
        for iterations in [1, 16] {
            let case = |count: i64| -> Case<'_> {
                let square = square(fx!(0.5)).restitution(fx!(1)).restitution_threshold(fx!(0));
                let mut commands = vec![each(BodyDef::dynamic(), square, grid(count, gap))];
                commands.extend((0..u32::try_from(count * count).expect("a number")).map(|slot| {
                    let velocity = |bit: u32| if slot >> bit & 1 == 0 { fx!(20) } else { fx!(-20) };
                    let velocity = Vec2::new(velocity(0), velocity(1));
                    Command::SetVelocity { body: body(slot), velocity, angular_velocity: fx!(1) }
                }));
                let mut config = still();
                config.solver.iterations = iterations;
                (setup(commands, config), 4, Box::new(|_| Vec::new()))
            };
            wrong.extend(too_expensive(&format!("elastic squares {name}, {iterations} iterations"), 8, case));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Edits of a body search all contacts, also those of sleeping bodies.
#[test]
fn edits_beside_sleeping_contacts() {
    let case = |count: i64| -> Case<'_> {
        let last = u32::try_from(64 * 64).expect("a number");
        let shapes = || vec![square(fx!(0.5))];
        let commands = vec![
            each(BodyDef::dynamic(), square(fx!(0.5)), grid(64, fx!(0.3))),
            spawn(BodyDef::dynamic().position((fx!(-100), Fx::ZERO)), shapes()),
        ];
        let edits = move |tick| match tick {
            0 => Vec::new(),
            1 => vec![Command::Sleep { body: body(0) }],
            _ => {
                let toggled = [Command::Disable { body: body(last) }, Command::Enable { body: body(last) }];
                let count = usize::try_from(count).expect("a number");
                toggled.into_iter().cycle().take(2 * count).collect()
            }
        };
        (setup(commands, still()), 3, Box::new(edits))
    };
    let wrong = too_expensive("edits beside sleeping contacts", 50, case);
    assert!(wrong.is_none(), "{wrong:#?}");
}

#[test]
fn bullets_over_obstacles() {
    let mut wrong = Vec::new();
    for (bullets, obstacles, pair_limit) in [(300i64, 300i64, 0), (300, 300, 1 << 18), (30, 3000, 0)] {
        let bullet = BodyDef {
            settings: BodySettings { continuous: Continuous::Bullet, ..BodySettings::default() },
            ..BodyDef::dynamic()
        };
        let case = |bullets: i64| -> Case<'_> {
            let lined = (0..bullets).map(|number| (fx!(-8), fx!(0.0001) * number));
            let piled = (0..obstacles).map(|number| (fx!(0.0001) * number, Fx::ZERO));
            let commands =
                vec![each(bullet, square(fx!(0.05)), lined), each(BodyDef::fixed(), octagon(), piled)];
            let back = move |_| {
                let number = |slot: i64| body(u32::try_from(slot).expect("a slot"));
                (0..bullets)
                    .flat_map(|slot| {
                        let position = Vec2::new(fx!(-8), fx!(0.0001) * slot);
                        let velocity = Vec2::new(fx!(390), Fx::ZERO);
                        [
                            Command::SetTransform { body: number(slot), position, angle: Angle::ZERO },
                            Command::SetVelocity { body: number(slot), velocity, angular_velocity: fx!(30) },
                        ]
                    })
                    .collect()
            };
            (setup(commands, Config { pair_limit, ..still() }), 3, Box::new(back))
        };
        let name = format!("bullets, {obstacles} octagons, pair limit {pair_limit}");
        wrong.extend(too_expensive(&name, bullets, case));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn explosions_beside_many_shapes() {
    let body = BodyDef::dynamic().position((fx!(1), fx!(0)));
    let add = move || spawn(body, vec![square(fx!(0.5)); 4096]);
    let explode = |count| {
        let count = usize::try_from(count).expect("a number");
        vec![Command::Explode { explosion: Explosion::new(Vec2::ZERO, fx!(0.001)) }; count]
    };
    let before = |count| -> Case<'_> { (setup(vec![add()], still()), 2, Box::new(move |_| explode(count))) };
    // The body is added in the tick of its explosions.
    let late = |count| -> Case<'_> {
        (setup(Vec::new(), still()), 1, Box::new(move |_| [vec![add()], explode(count)].concat()))
    };
    let wrong =
        [too_expensive("explosions", 300, before), too_expensive("explosions of an added body", 300, late)];
    assert!(wrong.iter().all(Option::is_none), "{wrong:#?}");
}

#[test]
fn crowds_with_and_without_pairs() {
    let mut wrong = Vec::new();
    for pair_limit in [0, 1000, 1 << 18] {
        for (name, body, shape) in [
            ("squares", BodyDef::dynamic(), square(fx!(0.5))),
            ("sensors", BodyDef::dynamic(), ShapeDef { sensor: true, ..square(fx!(0.5)) }),
        ] {
            let case = |count| -> Case<'_> {
                let places = (0..count).map(|number| (fx!(0.0001) * number, Fx::ZERO));
                let config = Config { pair_limit, ..still() };
                (setup(vec![each(body, shape, places)], config), 3, Box::new(|_| Vec::new()))
            };
            wrong.extend(too_expensive(&format!("{name} on one spot, pair limit {pair_limit}"), 400, case));
        }
    }
    let apart = |side| -> Case<'_> {
        let squares = each(BodyDef::dynamic(), square(fx!(0.5)), grid(side, fx!(1.2)));
        (setup(vec![squares], Config::default()), 3, Box::new(|_| Vec::new()))
    };
    wrong.extend(too_expensive("separate squares in rows", 150, apart));
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn chains_of_many_links() {
    let points: Vec<Vec2<Fx>> = (0..2000).map(|x| Vec2::new(fx!(0.01) * x, fx!(0.001) * (x % 3))).collect();
    let links = Chain::new(&points).links().expect("a chain");
    let ball = ShapeDef::new(Geometry::circle(fx!(3)).expect("a circle"));
    let case = |count| -> Case<'_> {
        let places = (0..count).map(|x| (fx!(16) * x / count, fx!(2.99)));
        let balls = each(BodyDef::dynamic(), ball, places);
        let commands = vec![spawn(BodyDef::fixed(), links.clone()), balls];
        (setup(commands, Config::default()), 3, Box::new(|_| Vec::new()))
    };
    let wrong = too_expensive("large balls on a fine chain", 40, case);
    assert!(wrong.is_none(), "{wrong:#?}");
}

#[test]
fn every_command_of_an_awake_body() {
    every_command_of_a_body(false);
}

#[test]
fn every_command_of_a_body_asleep() {
    every_command_of_a_body(true);
}

/// Times every command that names one body or shape. The command is repeated in a tick, on a body with many shapes,
/// joints and neighbours.
fn every_command_of_a_body(settled: bool) {
    let many = body(0);
    let commands = || {
        let mut commands = vec![spawn(BodyDef::dynamic(), vec![square(fx!(0.5)); 200])];
        commands.push(each(BodyDef::dynamic(), square(fx!(0.5)), grid(20, fx!(0.9))));
        let joint = JointDef::new(many, body(1), Weld::rigid());
        commands
            .push(Command::AddJointEach { joint, ends: (1..400).map(|slot| (many, body(slot))).collect() });
        if settled {
            commands.extend((0..401).map(|slot| Command::Sleep { body: body(slot) }));
        }
        commands
    };
    let shape = identifier::<ShapeId>(0);
    let place = |tick: u64| Vec2::new(fx!(0.001) * i64::try_from(tick % 7).unwrap_or(0), Fx::ZERO);
    let cases: Vec<(&str, Vec<Command>)> = vec![
        (
            "SetTransform",
            vec![
                Command::SetTransform { body: many, position: place(3), angle: Angle::ZERO },
                Command::SetTransform { body: many, position: place(4), angle: Angle::ZERO },
            ],
        ),
        (
            "SetVelocity",
            vec![Command::SetVelocity { body: many, velocity: place(2), angular_velocity: Fx::ONE }],
        ),
        ("ApplyImpulse", vec![Command::ApplyImpulse { body: many, impulse: place(1), point: Vec2::ZERO }]),
        ("SetMass", vec![Command::SetMass { body: many, mass: MassSource::Shapes }]),
        (
            "SetKind",
            vec![
                Command::SetKind { body: many, kind: BodyKind::Kinematic },
                Command::SetKind { body: many, kind: BodyKind::Dynamic },
            ],
        ),
        ("Disable, Enable", vec![Command::Disable { body: many }, Command::Enable { body: many }]),
        ("Sleep, Wake", vec![Command::Sleep { body: many }, Command::Wake { body: many }]),
        (
            "SetShape",
            vec![
                Command::SetShape { shape, def: square(fx!(0.4)) },
                Command::SetShape { shape, def: square(fx!(0.5)) },
            ],
        ),
        (
            "SetArea",
            vec![
                Command::SetShape { shape, def: square(fx!(0.5)).sensor() },
                Command::SetArea { shape, area: Some(Area::new().acceleration(place(5))) },
                Command::SetArea { shape, area: None },
                Command::SetShape { shape, def: square(fx!(0.5)) },
            ],
        ),
        ("AddShape", vec![Command::AddShape { body: many, shape: square(fx!(0.4)) }]),
        (
            "DisableJoint, EnableJoint",
            vec![
                Command::DisableJoint { joint: identifier::<JointId>(7) },
                Command::EnableJoint { joint: identifier::<JointId>(7) },
            ],
        ),
        (
            "SetGravity",
            vec![Command::SetGravity { gravity: place(5) }, Command::SetGravity { gravity: place(6) }],
        ),
        ("Spawn, Despawn", vec![spawn(BodyDef::dynamic(), vec![square(fx!(0.5)); 4])]),
    ];
    let mut wrong = Vec::new();
    for (name, once) in sweep::sample(cases, if settled { 4 } else { 3 }) {
        let name = format!("{name}{}", if settled { ", asleep" } else { "" });
        wrong.extend(too_expensive_commands(&name, &setup(commands(), still()), &once));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The ticks cost far more than the limits. The limits allow at most a tenth of a second, and verification must end
/// within half a second, not after a whole tick.
#[test]
fn a_limit_ends_a_file_before_its_cost_is_paid() {
    let crowd = |count: i64, settings| {
        let def = BodyDef { settings, ..BodyDef::dynamic() };
        each(def, square(fx!(0.05)), (0..count).map(|number| (fx!(-8), fx!(0.001) * number)))
    };
    let bullet = BodySettings { continuous: Continuous::Bullet, ..BodySettings::default() };
    let obstacles =
        each(BodyDef::fixed(), octagon(), (0..600).map(|number| (fx!(0.0001) * number, Fx::ZERO)));
    let push = |_| {
        (0..600)
            .map(|slot| Command::SetVelocity {
                body: body(slot),
                velocity: Vec2::new(fx!(390), Fx::ZERO),
                angular_velocity: Fx::ZERO,
            })
            .collect::<Vec<_>>()
    };
    let setup = setup(vec![crowd(600, bullet), obstacles], Config { pair_limit: 0, ..still() });
    let mut recording = Recording::<Sandbox>::start(&setup, 60).expect("a setup that can start");
    for tick in 0..3 {
        recording.step(&[push(tick)]).expect("commands that can be recorded");
    }
    let file = recording.finish().expect("a replay");
    assert!(verify::<Sandbox>(&file, &Limits::default()).is_match());
    for limits in [
        Limits { tick_work: 100_000, ..Limits::default() },
        Limits { total_work: 100_000, ..Limits::default() },
        Limits { total_work: 5_000, ..Limits::default() },
    ] {
        let start = computed();
        let verdict = verify::<Sandbox>(&file, &limits);
        assert_eq!(verdict.name(), "limit_exceeded", "{limits:?}: {verdict}");
        assert!(computed() - start < Duration::from_millis(500), "{limits:?}: {:?}", computed() - start);
    }
}
