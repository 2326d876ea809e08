//! A body on the middle of a turning floor feels no force along the floor, in the frame of the floor. Bodies that press
//! on each other while they turn together keep their angular momentum, and start no motion of their own.

use lockstep2d::body::{Area, BodyDef, BodyId, Falloff, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul};
use lockstep2d::solver::{Distance, JointDef, JointKind, Spring, Weld};
use lockstep2d::world::{Config, World};

use crate::sweep;

fn rectangle(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid"))
}

/// Distance in metres of `body` from the y axis of `ground`, which is at the origin.
fn drift(world: &World, ground: BodyId, body: BodyId) -> Fx {
    let [ground, body] = [ground, body].map(|id| world.body(id).expect("there"));
    ground.angle().direction().widen().dot(body.position()).abs()
}

/// If lever arms lagged behind the rotation, a crate of 4 m x 2 m would creep by 0.5 m in 30 s at 0.5 rad/s.
#[test]
fn a_crate_does_not_creep_in_a_centrifuge() {
    let sizes = [(fx!(0.5), fx!(0.25)), (fx!(2), fx!(1)), (fx!(4), fx!(4))];
    let cases = sizes.into_iter().flat_map(|size| [fx!(-0.5), fx!(0.2), fx!(0.5)].map(|omega| (size, omega)));
    let cases = cases.flat_map(|case| [30, 60, 120, 240].map(|rate| (rate, case)));
    sweep::for_each(sweep::sample(cases, 5), |(tick_rate, ((half_width, half_height), omega))| {
        let config = Config { gravity: Vec2::ZERO, tick_rate, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        let floor = rectangle(fx!(8), fx!(1)).offset((fx!(0), fx!(-11)));
        let ring = world.spawn(&BodyDef::kinematic().angular_velocity(omega), &[floor]).expect("valid");
        let height = half_height - fx!(10);
        let def = BodyDef::dynamic().position((fx!(0), height)).velocity((-fx_mul(omega, height), fx!(0)));
        let cargo = rectangle(half_width, half_height);
        let cargo = world.spawn(&def.angular_velocity(omega), &[cargo]).expect("valid");
        (0..30 * tick_rate).for_each(|_| world.step());
        let drift = drift(&world, ring, cargo);
        assert!(
            drift < fx!(0.01),
            "{half_width} m x {half_height} m, {omega} rad/s, {tick_rate} Hz: {drift} m"
        );
    });
}

#[test]
fn a_crate_does_not_creep_on_a_planet() {
    let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
    let field = Area::new().attraction(fx!(10), fx!(20), Falloff::InverseSquare);
    let field = ShapeDef::new(Geometry::circle(fx!(60)).expect("valid")).area(field);
    world.spawn(&BodyDef::fixed(), &[field]).expect("valid");
    let planet = rectangle(fx!(20), fx!(20));
    let planet = world.spawn(&BodyDef::kinematic().angular_velocity(fx!(0.2)), &[planet]).expect("valid");
    let def = BodyDef::dynamic().position((fx!(0), fx!(21))).velocity((fx!(-4.2), fx!(0)));
    let crate_ = rectangle(fx!(1), fx!(1));
    let crate_ = world.spawn(&def.angular_velocity(fx!(0.2)), &[crate_]).expect("valid");
    (0..7200).for_each(|_| world.step());
    assert!(drift(&world, planet, crate_) < fx!(0.01));
}

/// A world without gravity.
fn space(tick_rate: u32) -> World {
    World::new(Config { gravity: Vec2::ZERO, tick_rate, ..Config::default() }).expect("valid")
}

/// A body on the x axis that turns about the origin.
fn orbiting(x: Fx, omega: Fx) -> BodyDef {
    BodyDef::dynamic().position((x, fx!(0))).velocity((fx!(0), fx_mul(omega, x))).angular_velocity(omega)
}

/// Joins two bodies that collide with each other, at the position of the second one.
fn join(world: &mut World, a: BodyId, b: BodyId, kind: impl Into<JointKind>) {
    let anchor = world.body(b).expect("there").position();
    let joint = JointDef { collide_connected: true, ..world.joint_at(a, b, kind, anchor).expect("there") };
    world.add_joint(&joint).expect("valid");
}

/// Angular momentum about the origin, in kg m²/s, of bodies without linear momentum.
fn angular_momentum(world: &World) -> Fx {
    let spin = |body: &lockstep2d::body::Body| {
        let orbit: Fx = body.centre_of_mass().cross(body.velocity());
        fx_mul(orbit, body.mass()) + fx_mul(body.inertia(), body.angular_velocity())
    };
    world.bodies().map(|(_, body)| spin(body)).sum()
}

/// With normals and lever arms of the start of the tick, three boxes would keep 0.57 of their angular momentum after 1 s
/// and 0 after 10 s, and two discs 0.30 and 0.
#[test]
fn bodies_that_press_on_each_other_keep_their_angular_momentum() {
    let spawn_boxes = |world: &mut World, omega: Fx| {
        let boxes = [-1, 0, 1].map(|x| {
            let def = orbiting(Fx::from(x), omega);
            world.spawn(&def, &[rectangle(fx!(0.5), fx!(0.5))]).expect("valid")
        });
        boxes.windows(2).for_each(|pair| join(world, pair[0], pair[1], Weld::rigid()));
    };
    let spawn_discs = |world: &mut World, omega: Fx| {
        let disc = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
        let [a, b] = [fx!(-0.5), fx!(0.5)].map(|x| world.spawn(&orbiting(x, omega), &[disc]).expect("valid"));
        let spring = Spring { hertz: fx!(3), damping_ratio: fx!(0.5), target: fx!(0.2) };
        let spring = JointDef::new(a, b, Distance { spring: Some(spring), ..Distance::new() });
        world.add_joint(&JointDef { collide_connected: true, ..spring }).expect("valid");
    };
    for (omega, rate, boxes, discs) in [
        (fx!(2), 60, [fx!(0.97), fx!(0.83)], [fx!(0.93), fx!(0.72)]),
        (fx!(2), 120, [fx!(0.985), fx!(0.9)], [fx!(0.97), fx!(0.86)]),
        (fx!(-0.5), 60, [fx!(0.995), fx!(0.98)], [fx!(0.96), fx!(0.78)]),
    ] {
        check("boxes", &spawn_boxes, omega, rate, boxes);
        check("discs", &spawn_discs, omega, rate, discs);
    }
}

/// Expects that bodies keep at least the given fractions of their angular momentum after 1 s and 10 s.
fn check(name: &str, spawn: &dyn Fn(&mut World, Fx), omega: Fx, rate: u32, least: [Fx; 2]) {
    let mut world = space(rate);
    spawn(&mut world, omega);
    let start = angular_momentum(&world);
    for (seconds, least) in [1, 9].into_iter().zip(least) {
        (0..rate * seconds).for_each(|_| world.step());
        let kept = angular_momentum(&world) / start;
        assert!((least..=fx!(1.01)).contains(&kept), "{name}, {omega} rad/s, {rate} Hz: {kept}");
    }
}

/// With normals and lever arms of the start of the tick, the boxes would reach 2.6 J.
#[test]
fn overlapping_boxes_on_a_weld_start_no_motion() {
    for rate in [30, 60, 120] {
        let mut world = space(rate);
        let square = rectangle(fx!(0.5), fx!(0.5)).friction(fx!(0));
        let a = world.spawn(&BodyDef::dynamic(), &[square]).expect("valid");
        let turned = BodyDef::dynamic().position((fx!(0.7), fx!(0))).angle(Angle::from_degrees(fx!(17)));
        let b = world.spawn(&turned, &[square]).expect("valid");
        join(&mut world, a, b, Weld::rigid());
        for _ in 0..rate * 20 {
            world.step();
            let energy: Fx = world.bodies().map(|(_, body)| body.kinetic_energy()).sum();
            assert!(energy < fx!(0.1), "{rate} Hz: {energy} J");
        }
    }
}

/// Crates on the inner walls of a hull that turns freely. With normals and lever arms of the start of the tick they would
/// creep by up to 0.17 m at 0.2 rad/s and 0.47 m at 0.5 rad/s.
#[test]
fn crates_do_not_creep_in_a_hull_that_turns() {
    for omega in [fx!(0.2), fx!(0.5)] {
        let mut world = space(60);
        let wall = |half: (Fx, Fx), at: (Fx, Fx)| rectangle(half.0, half.1).offset(at);
        let (lying, standing) = ((fx!(10), fx!(1)), (fx!(1), fx!(8)));
        let walls = [
            wall(lying, (fx!(0), fx!(-9))),
            wall(lying, (fx!(0), fx!(9))),
            wall(standing, (fx!(-9), fx!(0))),
            wall(standing, (fx!(9), fx!(0))),
        ];
        let hull = world.spawn(&BodyDef::dynamic().angular_velocity(omega), &walls).expect("valid");
        let places = [(0, 15), (0, -15), (0, 13), (0, -13), (14, 0), (-14, 0)];
        let crates = places.map(|(x, y)| {
            let at = Vec2::new(Fx::from(x) / 2, Fx::from(y) / 2);
            let half_height = if x == 0 { fx!(0.5) } else { fx!(1) };
            let def =
                BodyDef::dynamic().position(at).velocity(at.perp().scale(omega)).angular_velocity(omega);
            (at, world.spawn(&def, &[rectangle(fx!(1), half_height)]).expect("valid"))
        });
        (0..3600).for_each(|_| world.step());
        for (start, id) in crates {
            let [hull, body] = [hull, id].map(|id| world.body(id).expect("there"));
            let creep = (hull.transform().apply_inverse(body.position()) - start).length();
            assert!(creep < fx!(0.1), "{omega} rad/s: {creep} m");
        }
    }
}

/// The spins of two frictionless balls do not turn the line of their centres.
#[test]
fn balls_that_slide_on_each_other_start_no_orbit() {
    let mut world = space(60);
    let disc = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).friction(fx!(0));
    let balls = [fx!(-0.5), fx!(0.5)].map(|x| {
        let def = BodyDef::dynamic().position((x, fx!(0))).angular_velocity(fx!(2));
        world.spawn(&def, &[disc]).expect("valid")
    });
    let spring = Spring { hertz: fx!(3), damping_ratio: fx!(0.5), target: fx!(0.2) };
    let spring = JointDef::new(balls[0], balls[1], Distance { spring: Some(spring), ..Distance::new() });
    world.add_joint(&JointDef { collide_connected: true, ..spring }).expect("valid");
    (0..600).for_each(|_| world.step());
    for id in balls {
        let ball = world.body(id).expect("there");
        assert!(ball.velocity().length() < fx!(0.01), "{:?}", ball.velocity());
        assert!((ball.angular_velocity() - fx!(2)).abs() < fx!(0.01));
    }
}
