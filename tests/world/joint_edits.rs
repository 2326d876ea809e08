//! Changes of joints and of their bodies between ticks.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, JointId, MassSource, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{
    Distance, JointDef, JointKind, JointLimit, JointPart, Motor, Prismatic, Revolute, Weld, Wheel,
};
use lockstep2d::world::{Config, World};

use super::{ball, is_asleep, rectangle, run, spawn, weightless, world_with_floor};

fn body(mass: Fx, gyration: Fx) -> BodyDef {
    BodyDef::dynamic().mass(MassSource::Given { mass, centre: Vec2::ZERO, gyration })
}

fn spawn_bare(world: &mut World, def: BodyDef) -> BodyId {
    world.spawn(&def, &[]).expect("valid")
}

fn at(world: &World, id: BodyId) -> Vec2<Fx> {
    world.body(id).expect("there").position()
}

fn kinds() -> [JointKind; 8] {
    [
        Revolute::new().into(),
        Revolute::new().limit(fx!(-0.5), fx!(0.5)).motor(fx!(1), fx!(50)).into(),
        Weld::rigid().into(),
        Weld::rigid().linear(fx!(3), fx!(0.5)).angular(fx!(3), fx!(0.5)).into(),
        Prismatic::new().limit(fx!(-1), fx!(1)).into(),
        Wheel::new().spring(fx!(2), fx!(0.5), fx!(0.2)).into(),
        Distance::rod(fx!(1)).into(),
        Motor::new().linear_spring(fx!(2), fx!(0.5), fx!(500)).angular(fx!(1), fx!(5)).into(),
    ]
}

/// A body that is joined to a fixed body. The origin of the fixed body is near the anchor or far away.
fn pendulum(kind: JointKind, ground: (Vec2<Fx>, Angle), swapped: bool) -> (World, BodyId, JointId) {
    let anchor = Vec2::new(fx!(3000), fx!(-7));
    let mut world = World::default();
    let ground = spawn_bare(&mut world, BodyDef::fixed().position(ground.0).angle(ground.1));
    let bob = spawn_bare(&mut world, body(fx!(2), fx!(0.4)).position(anchor + Vec2::new(fx!(1), fx!(0))));
    let (a, b) = if swapped { (bob, ground) } else { (ground, bob) };
    let mut def = world.joint_at(a, b, kind, anchor).expect("there");
    if matches!(kind, JointKind::Distance(_)) {
        let frame = if swapped { &mut def.frame_a } else { &mut def.frame_b };
        frame.anchor = Vec2::ZERO;
    }
    let joint = world.add_joint(&def).expect("valid");
    (world, bob, joint)
}

#[test]
fn an_anchor_far_away_on_a_fixed_body_holds_like_a_near_one() {
    for kind in kinds() {
        for swapped in [false, true] {
            let near = Vec2::new(fx!(2990), fx!(0));
            let (mut near, bob, joint) = pendulum(kind, (near, Angle::ZERO), swapped);
            let (mut far, far_bob, far_joint) =
                pendulum(kind, (Vec2::ZERO, Angle::from_degrees(fx!(33))), swapped);
            for tick in 0..240 {
                near.step();
                far.step();
                let apart = at(&near, bob).distance(at(&far, far_bob));
                assert!(apart < fx!(0.001), "{kind:?}, swapped {swapped}, tick {tick}: {apart} m apart");
            }
            assert_eq!(far.validate(), Ok(()));
            let ((force, torque), (far_force, far_torque)) =
                (near.joint_force(joint).expect("there"), far.joint_force(far_joint).expect("there"));
            let within = fx!(0.02) + force.length() / 100;
            assert!((force - far_force).length() < within, "{kind:?}: {force:?} N, {far_force:?} N");
            // The anchors come apart a little, so the lever arms at A differ.
            assert!((torque - far_torque).abs() < within, "{kind:?}: {torque} N m, {far_torque} N m");
        }
    }
}

#[test]
fn a_joint_at_the_edge_of_the_world_holds() {
    let edge = fx!(1073741820);
    let mut world = World::default();
    let ground = spawn_bare(&mut world, BodyDef::fixed().position((fx!(3), fx!(0))));
    let place = Vec2::new(edge, fx!(0));
    let bob = spawn_bare(&mut world, body(fx!(1), fx!(0.3)).position(place));
    let def = world.joint_at(ground, bob, Revolute::new(), place + Vec2::new(fx!(0), fx!(1))).expect("there");
    let joint = world.add_joint(&def).expect("valid");
    run(&mut world, 120);
    assert!(world.joint_error(joint).expect("there") < fx!(0.001));
    assert!(at(&world, bob).distance(place) < fx!(0.001));
}

/// The platform is kinematic, fixed, kinematic and dynamic in turn.
#[test]
fn a_joint_rests_while_neither_body_is_dynamic() {
    let mut world = World::default();
    let wall = spawn_bare(&mut world, BodyDef::fixed());
    let platform =
        spawn(&mut world, BodyDef::dynamic().position((fx!(1), fx!(0))), rectangle(fx!(1), fx!(0.1)));
    let hinge = world.joint_at(wall, platform, Revolute::new(), Vec2::ZERO).expect("there");
    let joint = world.add_joint(&hinge).expect("valid");
    run(&mut world, 30);
    assert!(world.joint_force(joint).expect("there").0.length() > fx!(1));
    for kind in [BodyKind::Kinematic, BodyKind::Fixed, BodyKind::Kinematic] {
        world.set_kind(platform, kind).expect("its joint rests");
        assert_eq!(world.validate(), Ok(()));
        run(&mut world, 30);
        assert_eq!(world.joint_force(joint), Some((Vec2::ZERO, fx!(0))));
    }
    world.set_velocity(platform, Vec2::ZERO, fx!(0)).expect("valid");
    world.set_transform(platform, Vec2::new(fx!(1), fx!(0)), Angle::ZERO).expect("valid");
    world.set_kind(platform, BodyKind::Dynamic).expect("valid");
    run(&mut world, 60);
    assert!(world.joint_error(joint).expect("there") < fx!(0.01));
    assert!(at(&world, platform).y < fx!(-0.3), "it swings again");
}

#[test]
fn a_joint_may_be_added_between_bodies_that_become_dynamic_later() {
    let (mut world, floor) = world_with_floor();
    let crate_ =
        spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(9))), rectangle(fx!(0.5), fx!(0.5)));
    let joint =
        world.add_joint(&world.joint_at(floor, crate_, Weld::rigid(), at(&world, crate_)).expect("there"));
    let joint = joint.expect("neither body is dynamic");
    run(&mut world, 10);
    world.set_kind(crate_, BodyKind::Dynamic).expect("valid");
    run(&mut world, 120);
    assert!(world.joint_error(joint).expect("there") < fx!(0.001));
    assert!(at(&world, crate_).y > fx!(8.99), "the weld holds it");
}

/// Under gravity `a`, anchors come apart by `a / (2 pi f)^2` for the joint's own frequency `f`. Sub-steps add no error
/// at rest.
#[test]
fn a_joint_yields_by_its_own_softness() {
    let limit: JointKind = Prismatic::new().limit(fx!(0), fx!(0)).into();
    let hinge: JointKind = Revolute::new().into();
    for (kind, extra) in [
        (hinge, false),
        (Weld::rigid().into(), false),
        (Distance::rod(fx!(1)).into(), false),
        (Wheel::new().into(), false),
        (limit, false),
        // If `extra`, a second joint is solved in a block with this one.
        (hinge, true),
        (Weld::rigid().into(), true),
    ] {
        for hertz in [fx!(3), fx!(8), fx!(25)] {
            // A body that creeps to its place would fall asleep on the way.
            let mut world = World::new(Config { sleeping: false, ..Config::default() }).expect("valid");
            let top = spawn_bare(&mut world, BodyDef::fixed().position((fx!(0), fx!(1))));
            let bob = spawn_bare(&mut world, body(fx!(2), fx!(0.5)));
            let def = JointDef::new(top, bob, kind).softness(hertz, fx!(1));
            let upright = Angle::from_degrees(fx!(90));
            let def = match kind {
                JointKind::Distance(_) => def,
                JointKind::Prismatic(_) => def.anchor_b((fx!(0), fx!(1))).angle_a(upright).angle_b(upright),
                _ => def.anchor_b((fx!(0), fx!(1))),
            };
            world.add_joint(&def).expect("valid");
            if extra {
                let weight = spawn_bare(&mut world, body(fx!(0.0001), fx!(0.1)).position((fx!(0), fx!(-1))));
                let def = JointDef::new(bob, weight, Weld::rigid());
                world.add_joint(&def.anchor_a((fx!(0), fx!(-1)))).expect("valid");
            }
            run(&mut world, 600);
            let omega = fx_mul(fx!(6.283185307), hertz);
            let expected = fx_div(fx!(10), fx_mul(omega, omega)).expect("positive");
            let sag = -at(&world, bob).y;
            assert!(
                (sag - expected).abs() < expected / 100,
                "{kind:?}, {hertz} Hz, extra {extra}: {sag} m, expected {expected} m"
            );
        }
    }
}

/// If each joint of dynamic bodies gets the softness of the world as its own softness, the results do not change by a
/// bit.
#[test]
fn the_softness_of_the_world_as_a_joints_own_changes_nothing() {
    let net = |own: u32| {
        let mut rng = Rng::new(7);
        let (mut world, _) = world_with_floor();
        let mut bodies = Vec::new();
        for i in 0..30 {
            let place = Vec2::new(Fx::from_num(i % 6), Fx::from_num(2 + i / 6));
            bodies.push(spawn(&mut world, BodyDef::dynamic().position(place), ball(fx!(0.3))));
        }
        let right = (0..30).filter(|i| i % 6 < 5).map(|i| (i, i + 1));
        for (i, other) in right.chain((0..24).map(|i| (i, i + 6))) {
            let kind = kinds()[rng.below(7) as usize];
            let def = world.joint_at(bodies[i], bodies[other], kind, at(&world, bodies[i])).expect("there");
            let def = if rng.below(2) < own { def.softness(fx!(60), fx!(2)) } else { def };
            world.add_joint(&def).expect("valid");
        }
        run(&mut world, 120);
        bodies.iter().map(|&id| (at(&world, id), world.body(id).expect("there").angle())).collect::<Vec<_>>()
    };
    let without = net(0);
    assert_eq!(without, net(1), "every other joint");
    assert_eq!(without, net(2), "all joints");
}

/// A disabled joint exerts no force, and its bodies collide and sleep.
#[test]
fn a_disabled_joint_is_as_if_absent() {
    let build = |joined: bool| {
        let (mut world, floor) = world_with_floor();
        let low =
            spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.5))), rectangle(fx!(0.5), fx!(0.5)));
        let high =
            spawn(&mut world, BodyDef::dynamic().position((fx!(0.1), fx!(3))), rectangle(fx!(0.5), fx!(0.5)));
        if joined {
            for (a, b) in [(low, high), (floor, high)] {
                world.add_joint(&JointDef::new(a, b, Weld::rigid()).disabled()).expect("valid");
            }
        }
        (world, [low, high])
    };
    let ((mut absent, ids), (mut disabled, _)) = (build(false), build(true));
    for tick in 0..240 {
        absent.step();
        disabled.step();
        assert_eq!(disabled.validate(), Ok(()));
        for id in ids {
            let [a, b] = [&absent, &disabled].map(|world| world.body(id).expect("there"));
            assert_eq!(
                (a.position(), a.angle(), a.velocity()),
                (b.position(), b.angle(), b.velocity()),
                "tick {tick}"
            );
            assert_eq!(a.is_asleep(), b.is_asleep(), "tick {tick}");
        }
    }
    assert!(is_asleep(&disabled, ids[1]) && at(&disabled, ids[1]).y > fx!(1.4), "it rests on the other box");
}

#[test]
fn a_joint_that_is_switched_off_and_on_keeps_its_handle() {
    let mut world = weightless();
    let [a, b] =
        [fx!(0), fx!(1)].map(|x| spawn(&mut world, BodyDef::dynamic().position((x, fx!(0))), ball(fx!(0.6))));
    let joint =
        world.add_joint(&world.joint_at(a, b, Weld::rigid(), at(&world, a)).expect("there")).expect("valid");
    run(&mut world, 60);
    assert!(at(&world, a).distance(at(&world, b)) < fx!(1.001), "welded, they do not collide");
    world.disable_joint(joint).expect("there");
    run(&mut world, 120);
    assert!(at(&world, a).distance(at(&world, b)) > fx!(1.18), "now they do");
    assert_eq!(world.joint_force(joint), Some((Vec2::ZERO, fx!(0))));
    world.enable_joint(joint).expect("there");
    run(&mut world, 120);
    assert!(at(&world, a).distance(at(&world, b)) < fx!(1.01));
    world.remove_joint(joint).expect("there");
    assert_eq!(world.disable_joint(joint), Err(WorldError::StaleJoint(joint)));
}

/// The game sets motor, limit and target of a resting lift in every tick.
#[test]
fn a_setter_that_changes_nothing_wakes_nobody() {
    let (mut world, floor) = world_with_floor();
    let lift = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(3))), rectangle(fx!(1), fx!(0.1)));
    let range = JointLimit { lower: fx!(-1), upper: fx!(1) };
    let slider =
        Prismatic::new().motor(fx!(-1), fx!(200)).limit(fx!(-1), fx!(1)).spring(fx!(1), fx!(1), fx!(0.5));
    let def = world.joint_along(floor, lift, slider, (fx!(0), fx!(3)), (fx!(0), fx!(1))).expect("there");
    let joint = world.add_joint(&def).expect("valid");
    let set = |world: &mut World, speed: Fx, target: Fx| {
        world.set_joint_motor_speed(joint, speed).expect("it has a motor");
        world.set_joint_motor_max(joint, fx!(200)).expect("it has a motor");
        world.set_joint_spring_target(joint, target).expect("it has a spring");
        world.set_joint_limit(joint, Some(range)).expect("it may have a limit");
        world.enable_joint(joint).expect("there");
        world.set_joint(joint, &world.joint(joint).expect("there").def().clone()).expect("valid");
    };
    for _ in 0..600 {
        set(&mut world, fx!(-1), fx!(0.5));
        world.step();
    }
    assert!(is_asleep(&world, lift));
    let before = world.state_hash();
    set(&mut world, fx!(-1), fx!(0.5));
    assert_eq!(world.state_hash(), before);
    for (speed, target) in [(fx!(0), fx!(0.5)), (fx!(0), fx!(0))] {
        set(&mut world, speed, target);
        assert!(!is_asleep(&world, lift), "speed {speed}, target {target}");
        run(&mut world, 300);
    }
}

#[test]
fn a_setter_of_a_part_that_is_missing_is_refused() {
    let mut world = weightless();
    let [a, b] =
        [fx!(0), fx!(2)].map(|x| spawn(&mut world, BodyDef::dynamic().position((x, fx!(0))), ball(fx!(0.5))));
    let joint = world.add_joint(&JointDef::new(a, b, Revolute::new())).expect("valid");
    let without = |what| Err(WorldError::JointWithout { joint, what });
    let before = world.state_hash();
    assert_eq!(world.set_joint_motor_speed(joint, fx!(1)), without("motor"));
    assert_eq!(world.set_joint_motor_max(joint, fx!(1)), without("motor"));
    assert_eq!(world.set_joint_motor_velocity(joint, Vec2::ZERO), without("linear motor"));
    assert_eq!(world.set_joint_spring_target(joint, fx!(1)), without("spring"));
    assert_eq!(world.set_joint_limit(joint, Some(JointLimit { lower: fx!(1), upper: fx!(0) })), {
        Err(WorldError::JointLimitReversed { lower: fx!(1), upper: fx!(0) })
    });
    assert_eq!(world.state_hash(), before);
    let weld = world.add_joint(&JointDef::new(a, b, Weld::rigid())).expect("valid");
    assert_eq!(
        world.set_joint_limit(weld, None),
        Err(WorldError::JointWithout { joint: weld, what: "limit" })
    );
    let motor = Motor::new().linear((fx!(1), fx!(0)), fx!(5));
    let motor = world.add_joint(&JointDef::new(a, b, motor)).expect("valid");
    world.set_joint_motor_velocity(motor, (fx!(2), fx!(0))).expect("it has one");
    let JointKind::Motor(Motor { linear: Some(linear), .. }) = world.joint(motor).expect("there").def().kind
    else {
        panic!("expected a linear motor");
    };
    assert_eq!(linear.velocity.x, fx!(2));
}

/// A bridge of 12 kg is on a hinge 1 m from its centre. The motor, limit or spring bears 120 N m, and the hinge 120 N.
#[test]
fn motor_limit_and_spring_are_told_apart() {
    let motor = Revolute::new().motor(fx!(0), fx!(500));
    let limit = Revolute::new().limit(fx!(0), fx!(1));
    let spring = Revolute::new().spring(fx!(6), fx!(1), fx!(0));
    let parts = [JointPart::Motor, JointPart::Limit, JointPart::Spring];
    for (kind, part) in [motor, limit, spring].into_iter().zip(parts) {
        let mut world = World::default();
        let wall = spawn_bare(&mut world, BodyDef::fixed());
        let bridge = spawn_bare(&mut world, body(fx!(12), fx!(0.6)).position((fx!(1), fx!(0))));
        let def = JointDef::new(wall, bridge, kind).anchor_b((fx!(-1), fx!(0)));
        let joint = world.add_joint(&def).expect("valid");
        run(&mut world, 600);
        let (force, torque) = world.joint_force(joint).expect("there");
        assert!((force - Vec2::new(fx!(0), fx!(120))).length() < fx!(0.5), "{kind:?}: {force:?} N");
        // The spring has turned the bridge a little.
        assert!((torque - fx!(120)).abs() < fx!(1), "{kind:?}: {torque} N m");
        for other in parts {
            let (own_force, own_torque) = world.joint_part_force(joint, other).expect("there");
            assert!(own_force.length() < fx!(0.01), "{kind:?}, {other:?}: {own_force:?} N");
            let expected = if other == part { torque } else { fx!(0) };
            assert!((own_torque - expected).abs() < fx!(0.05), "{kind:?}, {other:?}: {own_torque} N m");
        }
    }
}

/// Spring and motor bear the weight together. The motor bears at most its largest force.
#[test]
fn the_springs_of_welds_and_motor_joints_are_told_apart() {
    let weld: JointKind = Weld::rigid().linear(fx!(4), fx!(1)).into();
    let motor = Motor::new().linear_spring(fx!(4), fx!(1), fx!(500)).linear(Vec2::ZERO, fx!(7));
    for (kind, motor_force) in [(weld, fx!(0)), (motor.into(), fx!(7))] {
        let mut world = World::default();
        let wall = spawn_bare(&mut world, BodyDef::fixed());
        let bob = spawn_bare(&mut world, body(fx!(3), fx!(0.4)));
        let joint = world.add_joint(&JointDef::new(wall, bob, kind)).expect("valid");
        run(&mut world, 600);
        let part = |part| world.joint_part_force(joint, part).expect("there").0.y;
        let (spring, drive) = (part(JointPart::Spring), part(JointPart::Motor));
        assert!((spring + drive - fx!(30)).abs() < fx!(0.1), "{kind:?}: {spring} N and {drive} N");
        assert!(drive.abs() <= motor_force + fx!(0.01), "{kind:?}: {drive} N");
        assert_eq!(part(JointPart::Limit), fx!(0));
    }
}

#[test]
fn a_definition_at_a_point_fits_the_current_poses() {
    let mut rng = Rng::new(5);
    for _ in 0..200 {
        let mut world = weightless();
        let mut any = |most: Fx| Vec2::new(rng.range(-most, most), rng.range(-most, most));
        let (first, second, anchor, axis) = (any(fx!(20)), any(fx!(20)), any(fx!(20)), any(fx!(1)));
        let [a, b] = [first, second].map(|place| {
            let def = BodyDef::dynamic().position(place).angle(rng.angle());
            spawn(&mut world, def, ball(fx!(0.5)))
        });
        let def = world.joint_along(a, b, Prismatic::new(), anchor, axis).expect("there");
        let joint = world.add_joint(&def).expect("valid");
        let (at_a, at_b) = world.joint_anchors(joint).expect("there");
        assert!(at_a.distance(anchor) < fx!(0.000001) && at_b.distance(anchor) < fx!(0.000001));
        assert!(world.joint_angle(joint).expect("there").abs() < fx!(0.000001));
        // B moves along the axis.
        let direction = axis.normalized().expect("not 0").widen();
        world.set_velocity(b, direction, fx!(0)).expect("valid");
        let velocity = world.joint_velocity(joint).expect("there");
        assert!((velocity - Vec2::new(fx!(1), fx!(0))).length() < fx!(0.00001), "{velocity:?}");
    }
    let mut world = weightless();
    let gone = spawn_bare(&mut world, body(fx!(1), fx!(1)));
    world.despawn(gone).expect("there");
    let other = spawn_bare(&mut world, BodyDef::fixed());
    assert_eq!(world.joint_at(other, gone, Revolute::new(), Vec2::ZERO), Err(WorldError::StaleBody(gone)));
}
