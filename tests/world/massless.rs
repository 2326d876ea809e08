//! A dynamic body has no mass if it has no shape, only lines, or density 0. It coasts, and pushes others like a
//! kinematic body.

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::{Distance, JointDef, Revolute, Weld};
use lockstep2d::world::World;

fn square(half: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::square(half).expect("valid"))
}

fn run(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        // A copy without caches has equal states.
        let mut copy = World::from_bytes(&world.to_bytes()).expect("valid");
        world.step();
        copy.step();
        assert_eq!(copy.state_hash(), world.state_hash());
        assert_eq!(world.validate(), Ok(()));
    }
    assert_eq!(world.faults(), 0);
}

fn height(world: &World, body: BodyId) -> Fx {
    world.body(body).expect("there").position().y
}

#[test]
fn a_body_without_mass_keeps_its_velocity() {
    let mut world = World::default();
    let line = Geometry::segment(Vec2::ZERO, Vec2::new(fx!(1), fx!(0))).expect("valid");
    let def = BodyDef::dynamic().velocity((fx!(1), fx!(2))).angular_velocity(fx!(3));
    let bodies = [&[][..], &[ShapeDef::new(line)], &[square(fx!(1)).density(fx!(0))]]
        .map(|shapes| world.spawn(&def, shapes).expect("valid"));
    for body in bodies {
        assert_eq!(world.body(body).expect("there").mass(), fx!(0));
        world.apply_force(body, Vec2::new(fx!(100), fx!(0)), Vec2::ZERO).expect("dynamic");
        world.apply_torque(body, fx!(100)).expect("dynamic");
        world.apply_impulse(body, Vec2::new(fx!(100), fx!(0)), Vec2::ZERO).expect("dynamic");
        world.apply_angular_impulse(body, fx!(100)).expect("dynamic");
    }
    run(&mut world, 120);
    for body in bodies {
        let body = world.body(body).expect("there");
        assert_eq!(body.velocity(), Vec2::new(fx!(1), fx!(2)));
        assert!((body.angular_velocity() - fx!(3)).abs() < fx!(0.00001));
        assert!((body.position() - Vec2::new(fx!(2), fx!(4))).length() < fx!(0.001));
    }
}

#[test]
fn damping_slows_a_body_without_mass_until_it_sleeps() {
    let mut world = World::default();
    let def = BodyDef::dynamic().velocity((fx!(1), fx!(0))).linear_damping(fx!(2));
    let body = world.spawn(&def, &[]).expect("valid");
    run(&mut world, 60);
    // Damping of 2 for one second leaves 1 / (1 + 2 / 240)^240 of the velocity.
    let speed = world.body(body).expect("there").velocity().x;
    assert!((speed - fx!(0.136465)).abs() < fx!(0.0002), "{speed}");
    run(&mut world, 120);
    assert!(world.body(body).expect("there").is_asleep());
}

#[test]
fn a_box_rests_on_a_platform_without_mass() {
    let mut world = World::default();
    let platform = world.spawn(&BodyDef::dynamic(), &[square(fx!(2)).density(fx!(0))]).expect("valid");
    // The platform has no contact with fixed bodies, such as this wall.
    let wall = BodyDef::fixed().position((fx!(3), fx!(0)));
    world.spawn(&wall, &[square(fx!(1.5))]).expect("valid");
    let load = BodyDef::dynamic().position((fx!(0), fx!(4)));
    let load = world.spawn(&load, &[square(fx!(0.5)).density(fx!(100))]).expect("valid");
    run(&mut world, 240);
    assert_eq!(world.body(platform).expect("there").position(), Vec2::ZERO);
    assert!((height(&world, load) - fx!(2.5)).abs() < fx!(0.002), "{}", height(&world, load));
    assert!(world.body(load).expect("there").is_asleep() && world.body(platform).expect("there").is_asleep());
    world.set_velocity(platform, Vec2::new(fx!(0), fx!(1)), fx!(0)).expect("dynamic");
    run(&mut world, 60);
    assert!((height(&world, platform) - fx!(1)).abs() < fx!(0.0001));
    assert!((height(&world, load) - fx!(3.5)).abs() < fx!(0.01), "{}", height(&world, load));
}

#[test]
fn joints_hold_on_to_bodies_without_mass() {
    let mut world = World::default();
    let hook = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(5))), &[]).expect("valid");
    let other = world.spawn(&BodyDef::dynamic().position((fx!(3), fx!(5))), &[]).expect("valid");
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let ball = ShapeDef::new(Geometry::circle(fx!(0.3)).expect("valid"));
    let bob = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(3))), &[ball]).expect("valid");
    world.add_joint(&JointDef::new(hook, bob, Revolute::new()).anchor_b((fx!(0), fx!(2)))).expect("valid");
    // Joints between bodies without mass and fixed ones have no effect, even if their anchors are apart.
    let idle = [
        JointDef::new(hook, other, Revolute::new()),
        JointDef::new(other, ground, Weld::rigid()),
        JointDef::new(hook, ground, Distance::rod(fx!(1))),
    ];
    let idle = idle.map(|def| world.add_joint(&def).expect("valid"));
    run(&mut world, 120);
    assert!((height(&world, bob) - fx!(3)).abs() < fx!(0.01), "{}", height(&world, bob));
    assert_eq!(height(&world, hook), fx!(5));
    for joint in idle {
        assert_eq!(world.joint_force(joint), Some((Vec2::ZERO, fx!(0))));
    }
}

#[test]
fn a_body_gains_and_loses_its_mass_with_its_shapes() {
    let mut world = World::default();
    let body = world.spawn(&BodyDef::dynamic().velocity((fx!(1), fx!(0))), &[]).expect("valid");
    run(&mut world, 30);
    assert_eq!(height(&world, body), fx!(0));
    let shape = world.add_shape(body, &square(fx!(0.5))).expect("valid");
    assert_eq!(world.body(body).expect("there").mass(), fx!(1));
    run(&mut world, 30);
    let falling = world.body(body).expect("there").velocity();
    assert!(falling.y < fx!(-4) && falling.x == fx!(1), "{falling:?}");
    world.remove_shape(shape).expect("there");
    run(&mut world, 30);
    assert_eq!(world.body(body).expect("there").velocity(), falling);
}

/// When a body loses its mass, its contacts and joints cease to act, and they act again when it has a mass. This holds
/// while bodies are awake and while they sleep.
#[test]
fn a_body_that_loses_its_mass_lets_go_of_what_it_rests_on() {
    let mut world = World::default();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(1)).expect("valid"));
    let ground = world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    let body =
        world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square(fx!(0.5))]).expect("valid");
    let hook = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(3))), &[]).expect("valid");
    let rope = JointDef::new(hook, body, Distance::rope(fx!(2.6)));
    world.add_joint(&rope).expect("valid");
    world.add_joint(&JointDef::new(ground, hook, Distance::rope(fx!(1)))).expect("valid");
    run(&mut world, 60);
    let contacts = |world: &World| world.contacts_of(body).count();
    assert!(world.body(body).expect("there").is_asleep() && world.body(hook).expect("there").is_asleep());
    let shape = world.shapes_of(body)[0];
    let weightless = square(fx!(0.5)).density(fx!(0));
    world.set_shape(shape, &weightless).expect("valid");
    run(&mut world, 60);
    assert_eq!(contacts(&world), 0);
    // The box sleeps while the hook is awake, because a joint between two bodies without mass does not act.
    world.set_velocity(hook, Vec2::new(fx!(0), fx!(1)), fx!(0)).expect("dynamic");
    run(&mut world, 60);
    assert!(world.body(body).expect("there").is_asleep() && !world.body(hook).expect("there").is_asleep());
    world.set_shape(shape, &square(fx!(0.5))).expect("valid");
    run(&mut world, 60);
    // The box hangs on the rising hook.
    assert_eq!(contacts(&world), 0);
    assert!((height(&world, hook) - height(&world, body) - fx!(2.6)).abs() < fx!(0.01));
}
