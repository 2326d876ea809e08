//! Locked degrees of freedom stay at zero, and the other motion follows theory.

use lockstep2d::body::{BodyDef, BodySettings, Continuous, MotionLocks};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{Distance, JointDef, Revolute};
use lockstep2d::world::World;

use super::{ball, rectangle, run, spawn, square, weightless, world_with_floor};

fn close(a: Fx, b: Fx, tolerance: Fx) {
    assert!((a - b).abs() < tolerance, "{a} differs from {b}");
}

/// A ball hits a box of equal mass off centre, and gives the box all of its velocity along the normal.
#[test]
fn a_box_that_does_not_turn_takes_the_whole_momentum() {
    let mut world = weightless();
    let shape = square(fx!(1)).restitution(fx!(1)).friction(fx!(0));
    let target = spawn(&mut world, BodyDef::dynamic().lock_rotation(), shape);
    let radius = fx!(0.5);
    let ball = ball(radius).restitution(fx!(1)).friction(fx!(0)).density(fx!(5.09295817894));
    let thrown = BodyDef::dynamic().position((fx!(-3), fx!(0.8))).velocity((fx!(5), fx!(0)));
    let thrown = spawn(&mut world, thrown, ball);
    run(&mut world, 90);
    let (a, b) = (world.body(thrown).expect("there"), world.body(target).expect("there"));
    close(a.mass(), b.mass(), fx!(0.0001));
    assert_eq!((b.angle(), b.angular_velocity()), (Angle::ZERO, Fx::ZERO));
    close(a.velocity().x, fx!(0), fx!(0.01));
    close(b.velocity().x, fx!(5), fx!(0.01));
    close(b.velocity().y, fx!(0), fx!(0.001));
}

/// A ball of mass `m1` hits a box of mass `m2` and inertia `I` at the distance `d` from its centre. The impulse is
/// `2 v / (1 / m1 + 1 / m2 + d² / I)`.
#[test]
fn a_box_that_turns_takes_less() {
    let mut world = weightless();
    let target = spawn(&mut world, BodyDef::dynamic(), square(fx!(1)).restitution(fx!(1)).friction(fx!(0)));
    let ball = ball(fx!(0.5)).restitution(fx!(1)).friction(fx!(0)).density(fx!(5.09295817894));
    let thrown = BodyDef::dynamic().position((fx!(-3), fx!(0.8))).velocity((fx!(5), fx!(0)));
    spawn(&mut world, thrown, ball);
    run(&mut world, 60);
    let body = world.body(target).expect("there");
    // With m = 4 kg, I = 4 (2² + 2²) / 12 = 2.667 kg m² and d = 0.8 m, the impulse is 10 / (0.25 + 0.25 + 0.24) = 13.51
    // N s.
    close(body.velocity().x, fx!(3.378), fx!(0.02));
    close(body.angular_velocity(), fx!(-4.054), fx!(0.05));
}

#[test]
fn impulses_and_torques_do_not_turn_what_does_not_turn() {
    let mut world = weightless();
    let id = spawn(&mut world, BodyDef::dynamic().lock_rotation().angular_velocity(fx!(3)), square(fx!(0.5)));
    let (up, aside) = (Vec2::new(fx!(0), fx!(2)), Vec2::new(fx!(0.5), fx!(0)));
    world.apply_impulse(id, up, aside).expect("dynamic");
    world.apply_angular_impulse(id, fx!(5)).expect("dynamic");
    world.apply_torque(id, fx!(50)).expect("dynamic");
    world.apply_force(id, up, aside).expect("dynamic");
    run(&mut world, 1);
    let body = world.body(id).expect("there");
    assert_eq!((body.angle(), body.angular_velocity()), (Angle::ZERO, Fx::ZERO));
    close(body.velocity().y, fx!(2) + fx!(2 / 60), fx!(0.001));
}

#[test]
fn a_locked_axis_holds_whatever_pushes() {
    for (locked_x, def) in [(true, BodyDef::dynamic().lock_x()), (false, BodyDef::dynamic().lock_y())] {
        let (mut world, _) = world_with_floor();
        let id =
            spawn(&mut world, def.position((fx!(0), fx!(3))).velocity((fx!(1), fx!(1))), square(fx!(0.5)));
        for tick in 0..120 {
            let from = BodyDef::dynamic().position((fx!(-4), fx!(3.2))).velocity((fx!(20), fx!(-5)));
            if tick % 20 == 0 {
                spawn(&mut world, from, ball(fx!(0.3)));
            }
            world.apply_force_to_centre(id, Vec2::new(fx!(30), fx!(7))).expect("dynamic");
            world.apply_impulse_to_centre(id, Vec2::new(fx!(0.3), fx!(0.3))).expect("dynamic");
            let held = |velocity: Vec2<Fx>| if locked_x { velocity.x } else { velocity.y };
            assert_eq!(held(world.body(id).expect("there").velocity()), Fx::ZERO);
            run(&mut world, 1);
            assert_eq!(held(world.body(id).expect("there").velocity()), Fx::ZERO);
        }
        let end = world.body(id).expect("there").position();
        let (held, free) = if locked_x { (end.x, end.y) } else { (end.y - fx!(3), end.x) };
        assert_eq!(held, Fx::ZERO);
        assert!(free.abs() > fx!(0.5), "expected motion along the free axis: {free}");
    }
}

/// All axes of the post are locked.
#[test]
fn a_ball_comes_back_from_a_locked_axis() {
    let mut world = weightless();
    let post = spawn(&mut world, BodyDef::dynamic().lock_x().lock_y().lock_rotation(), square(fx!(0.5)));
    let thrown = BodyDef::dynamic().position((fx!(-3), fx!(0))).velocity((fx!(5), fx!(0)));
    let thrown = spawn(&mut world, thrown, ball(fx!(0.5)).restitution(fx!(1)));
    run(&mut world, 120);
    assert_eq!(world.body(post).expect("there").position(), Vec2::ZERO);
    let left = world.body(thrown).expect("there");
    assert!(
        left.position().x < fx!(-0.9),
        "expected the ball to stay in front of the post: x = {}",
        left.position().x
    );
    assert!(left.velocity().x <= fx!(0.01), "{}", left.velocity().x);
}

#[test]
fn kinematic_bodies_keep_to_their_locks() {
    let mut world = weightless();
    let rail =
        BodyDef::kinematic().lock_y().lock_rotation().velocity((fx!(1), fx!(1))).angular_velocity(fx!(1));
    let rail = spawn(&mut world, rail, rectangle(fx!(1), fx!(0.2)));
    run(&mut world, 60);
    world.move_to(rail, Vec2::new(fx!(1.5), fx!(0.5)), Angle::from_bits(1 << 29)).expect("valid");
    run(&mut world, 1);
    let body = world.body(rail).expect("there");
    assert_eq!((body.position(), body.angle()), (Vec2::new(fx!(1.5), fx!(0)), Angle::ZERO));
}

#[test]
fn locks_may_change_while_it_moves() {
    let mut world = weightless();
    let def = BodyDef::dynamic().velocity((fx!(1), fx!(1))).angular_velocity(fx!(2));
    let id = spawn(&mut world, def, square(fx!(0.5)));
    let locks = MotionLocks { x: true, y: false, rotation: true };
    world.set_body(id, &BodySettings { locks, ..BodySettings::default() }).expect("valid");
    run(&mut world, 60);
    let body = world.body(id).expect("there");
    assert_eq!((body.position().x, body.angle()), (Fx::ZERO, Angle::ZERO));
    close(body.position().y, fx!(1), fx!(0.001));
    world.set_body(id, &BodySettings::default()).expect("valid");
    world.apply_angular_impulse(id, fx!(1)).expect("dynamic");
    run(&mut world, 60);
    assert!(world.body(id).expect("there").angle() != Angle::ZERO, "expected the body to turn again");
}

/// The reported torque of a rope about its anchor is zero, even if the rotation of a body at the rope is locked. The
/// motor of a hinge reports its torque even if the rotation of one of the two bodies is locked.
#[test]
fn the_torque_of_a_joint_is_that_on_the_body_that_turns() {
    let mut world = World::default();
    let ceiling = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let def = BodyDef::dynamic().position((fx!(0.5), fx!(-2))).lock_rotation();
    let crate_ = spawn(&mut world, def, square(fx!(0.5)));
    let rope = JointDef::new(ceiling, crate_, Distance::rope(fx!(2))).anchor_b((fx!(-0.5), fx!(0)));
    let rope = world.add_joint(&rope).expect("valid");
    run(&mut world, 60);
    let (force, torque) = world.joint_force(rope).expect("there");
    close(force.y, fx!(10), fx!(0.1));
    close(torque, fx!(0), fx!(0.01));

    let mut world = weightless();
    let def = BodyDef::dynamic().lock_rotation();
    let trolley = spawn(&mut world, def, square(fx!(0.5)));
    let wheel = spawn(&mut world, BodyDef::dynamic(), square(fx!(0.5)).density(fx!(2)).sensor());
    let motor = JointDef::new(trolley, wheel, Revolute::new().motor(fx!(1000), fx!(10)));
    let motor = world.add_joint(&motor).expect("valid");
    run(&mut world, 2);
    close(world.joint_force(motor).expect("there").1, fx!(10), fx!(0.1));
}

/// A kinematic body that hits another body within a tick carries that body for the rest of the tick, but not along
/// locked axes.
#[test]
fn a_kinematic_body_does_not_carry_along_locked_axes() {
    let mut world = weightless();
    let settings = BodySettings { continuous: Continuous::Kinematic, ..BodySettings::default() };
    let def = BodyDef { settings, ..BodyDef::dynamic().position((fx!(0.3), fx!(0))) };
    let held = spawn(&mut world, def.lock_x().lock_y().lock_rotation(), ball(fx!(0.03)));
    let blade = BodyDef::kinematic().velocity((fx!(30), fx!(0))).angular_velocity(fx!(3));
    spawn(&mut world, blade, rectangle(fx!(0.01), fx!(2)));
    run(&mut world, 3);
    let body = world.body(held).expect("there");
    assert_eq!((body.position(), body.angle()), (Vec2::new(fx!(0.3), fx!(0)), Angle::ZERO));
}
