//! Gears, racks and pulleys against theory. Numbers of teeth `N`, angular velocities `w`, angular accelerations
//! `alpha`, inertias `I`, torques `T` (for the pulley, the tension of the rope):
//!
//! ```text
//! gear      NA wA + NB wB = 0;   torques NB TA = NA TB;   alpha_A = T / (IA + (NA / NB)^2 IB)
//! planet    turns by (1 + N_sun / N_planet) times the turn of its arm about a sun at rest
//! rack      x = -r angle
//! pulley    T = g (1 + q) / (1 / mA + q^2 / mB) with the ratio q
//! ```

use lockstep2d::body::{BodyDef, BodyId, Geometry, JointId, MassSource, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Rng, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{Gear, JointDef, JointKind, JointPart, Prismatic, Pulley, Rack, Revolute};
use lockstep2d::world::{Config, World};

fn world(gravity: Fx) -> World {
    World::new(Config { gravity: Vec2::new(fx!(0), gravity), ..Config::default() }).expect("valid")
}

fn wheel(world: &mut World, radius: Fx, x: Fx) -> BodyId {
    let disc = ShapeDef::new(Geometry::circle(radius).expect("valid"));
    world.spawn(&BodyDef::dynamic().position((x, fx!(0))).never_sleeps(), &[disc]).expect("valid")
}

fn hinge(world: &mut World, ground: BodyId, body: BodyId, kind: Revolute) -> JointId {
    let at = world.body(body).expect("valid").position();
    let def = world.joint_at(ground, body, kind, at).expect("valid");
    world.add_joint(&def).expect("valid")
}

fn fitted(world: &mut World, a: BodyId, b: BodyId, kind: impl Into<JointKind>) -> JointId {
    let def = world.fit_joint(&JointDef::new(a, b, kind)).expect("valid");
    world.add_joint(&def).expect("valid")
}

fn omega(world: &World, body: BodyId) -> Fx {
    world.body(body).expect("valid").angular_velocity()
}

fn at(world: &World, body: BodyId) -> Vec2<Fx> {
    world.body(body).expect("valid").position()
}

#[track_caller]
fn close(found: Fx, expected: Fx, tolerance: Fx) {
    assert!((found - expected).abs() <= tolerance, "expected {expected}, got {found}");
}

#[track_caller]
fn run(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        world.step();
    }
    assert_eq!(world.validate(), Ok(()));
    assert_eq!(world.faults(), 0);
}

/// The fit divides by numbers of teeth, so it must refuse zero.
#[test]
fn a_gear_without_teeth_cannot_be_fitted() {
    let mut world = world(fx!(0));
    let (a, b) = (wheel(&mut world, fx!(1), fx!(0)), wheel(&mut world, fx!(1), fx!(2)));
    for (teeth_a, teeth_b) in [(0, 1), (1, 0), (0, 0), (i32::MIN, 1)] {
        let def = JointDef::new(a, b, Gear::new(teeth_a, teeth_b));
        let fitted = world.fit_joint(&def);
        assert!(matches!(fitted, Err(WorldError::JointOutOfRange { .. })), "{teeth_a} {teeth_b}: {fitted:?}");
    }
}

/// In each case, a motor turns wheel A for a minute, against a brake on wheel B.
#[test]
fn the_ratio_is_kept_under_load() {
    for (teeth, x, radii) in [
        ([20, 40], fx!(3), [fx!(1), fx!(2)]),
        ([40, 13], fx!(1.3), [fx!(1), fx!(0.3)]),
        ([20, -60], fx!(2), [fx!(1), fx!(3)]),
        ([7, 93], fx!(10), [fx!(0.7), fx!(9.3)]),
        ([30, -30], fx!(5), [fx!(1), fx!(1)]),
    ] {
        let mut world = world(fx!(0));
        let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
        let a = wheel(&mut world, radii[0], fx!(0));
        let b = wheel(&mut world, radii[1], x);
        let axle_a = hinge(&mut world, ground, a, Revolute::new().motor(fx!(9), fx!(400)));
        let axle_b = hinge(&mut world, ground, b, Revolute::new().motor(fx!(0), fx!(20)));
        let gear = fitted(&mut world, a, b, Gear::new(teeth[0], teeth[1]));
        // The largest error while the wheels spin up, in the first 10 s, and the largest one afterwards.
        let mut worst = [fx!(0); 2];
        for tick in 0..3600 {
            world.step();
            let worst = &mut worst[usize::from(tick >= 600)];
            *worst = (*worst).max(world.joint_error(gear).expect("valid"));
        }
        run(&mut world, 0);
        // Like all joints, gears yield by a / (2 pi 60 Hz)^2 under an acceleration a: by 4 mm where the brake holds a
        // wheel of 0.3 kg. Without a pitch point, the error is an angle, and is 2 pi radians for a skipped tooth.
        let unit = if teeth[0] + teeth[1] == 0 { fx!(10) } else { fx!(1) };
        let most = [fx_mul(fx!(0.008), unit), fx_mul(fx!(0.006), unit)];
        assert!(worst[0] < most[0] && worst[1] < most[1], "{teeth:?}: the teeth are {worst:?} m apart");
        close(omega(&world, a), fx!(9), fx!(0.02));
        let turned = [axle_a, axle_b].map(|axle| world.joint_angle(axle).expect("valid"));
        let apart = turned[0] * i64::from(teeth[0]) + turned[1] * i64::from(teeth[1]);
        assert!(turned[0] > fx!(500));
        // A skipped tooth would change `apart` by 2 pi.
        close(apart, fx!(0), fx!(1));
    }
}

#[test]
fn torques_are_in_the_ratio_of_the_teeth() {
    let mut world = world(fx!(0));
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let (a, b) = (wheel(&mut world, fx!(1), fx!(0)), wheel(&mut world, fx!(2), fx!(3)));
    hinge(&mut world, ground, a, Revolute::new());
    let brake = hinge(&mut world, ground, b, Revolute::new().motor(fx!(0), Fx::MAX));
    let gear = fitted(&mut world, a, b, Gear::new(20, 40));
    for _ in 0..120 {
        world.apply_torque(a, fx!(6)).expect("valid");
        world.step();
    }
    // 6 N m on A become 12 N m on B, which the brake resists. The force at the pitch point is 6 N m / 1 m.
    let (_, torque) = world.joint_part_force(brake, JointPart::Motor).expect("valid");
    close(torque, fx!(12), fx!(0.02));
    let (force, torque) = world.joint_force(gear).expect("valid");
    close(force.x, fx!(0), fx!(0.01));
    close(force.y, fx!(6), fx!(0.02));
    close(torque, fx!(-12), fx!(0.02));
}

#[test]
fn a_wheel_accelerates_with_the_inertia_of_both() {
    let mut world = world(fx!(0));
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let (a, b) = (wheel(&mut world, fx!(0.5), fx!(0)), wheel(&mut world, fx!(1.5), fx!(2)));
    hinge(&mut world, ground, a, Revolute::new());
    hinge(&mut world, ground, b, Revolute::new());
    fitted(&mut world, a, b, Gear::new(12, 36));
    for _ in 0..60 {
        world.apply_torque(a, fx!(5)).expect("valid");
        world.step();
    }
    // I = pi r^4 / 2 for a density of 1.
    let inertia = |r: Fx| fx_mul(PI, fx_mul(fx_mul(r, r), fx_mul(r, r))) / 2;
    let both = inertia(fx!(0.5)) + inertia(fx!(1.5)) / 9;
    let expected = fx_div(fx!(5), both).expect("valid");
    close(omega(&world, a), expected, expected / 500);
    close(omega(&world, b), -expected / 3, expected / 500);
}

/// Three meshing wheels without motors or brakes keep their energy for a minute.
#[test]
fn a_free_train_keeps_its_energy() {
    let mut world = world(fx!(0));
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let wheels = [(fx!(1), fx!(0)), (fx!(2), fx!(3)), (fx!(0.5), fx!(5.5))]
        .map(|(radius, x)| wheel(&mut world, radius, x));
    for body in wheels {
        hinge(&mut world, ground, body, Revolute::new());
    }
    fitted(&mut world, wheels[0], wheels[1], Gear::new(20, 40));
    fitted(&mut world, wheels[1], wheels[2], Gear::new(40, 10));
    world.set_velocity(wheels[0], Vec2::ZERO, fx!(10)).expect("valid");
    run(&mut world, 60);
    let start = crate::energy(&world);
    run(&mut world, 3540);
    close(crate::energy(&world), start, start / 100);
    close(omega(&world, wheels[2]), omega(&world, wheels[0]) * 2, fx!(0.002));
}

#[test]
fn a_planet_turns_as_its_arm_takes_it_around_the_sun() {
    let mut world = world(fx!(0));
    let sun = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let plank = ShapeDef::new(Polygon::rectangle(fx!(1.5), fx!(0.1)).expect("valid"));
    let arm = world.spawn(&BodyDef::dynamic().position((fx!(1.5), fx!(0))), &[plank]).expect("valid");
    let planet = wheel(&mut world, fx!(1), fx!(3));
    let drive = Revolute::new().motor(fx!(1), fx!(1000));
    let drive = world.joint_at(sun, arm, drive, (fx!(0), fx!(0))).expect("valid");
    let drive = world.add_joint(&drive).expect("valid");
    let axle = world.joint_at(arm, planet, Revolute::new(), (fx!(3), fx!(0))).expect("valid");
    world.add_joint(&axle).expect("valid");
    let gear = fitted(&mut world, sun, planet, Gear::new(40, 20));
    run(&mut world, 1200);
    assert!(world.joint_error(gear).expect("valid") < fx!(0.002));
    assert!(world.joint_angle(drive).expect("valid") > fx!(19));
    close(omega(&world, planet), fx!(3), fx!(0.01));
}

/// A bar with two meshing wheels in free space keeps its momentum and angular momentum.
#[test]
fn free_wheels_on_a_bar_keep_their_momentum() {
    let mut rng = Rng::new(3);
    for round in 0..30 {
        let mut world = world(fx!(0));
        let plank = ShapeDef::new(Polygon::rectangle(fx!(1.5), fx!(0.2)).expect("valid"));
        let bar = world.spawn(&BodyDef::dynamic().position((fx!(1.5), fx!(0))), &[plank]).expect("valid");
        let (a, b) = (wheel(&mut world, fx!(1), fx!(0)), wheel(&mut world, fx!(2), fx!(3)));
        for body in [a, b] {
            hinge(&mut world, bar, body, Revolute::new());
        }
        let gear = fitted(&mut world, a, b, Gear::new(20, if round % 2 == 0 { 40 } else { -41 }));
        for body in [bar, a, b] {
            world.set_velocity(body, Vec2::ZERO, rng.range(fx!(-6), fx!(6))).expect("valid");
        }
        let momentum = |world: &World| {
            let of = |(_, body): (BodyId, &lockstep2d::body::Body)| {
                let (x, v, m) = (body.position(), body.velocity(), body.mass());
                let spin = fx_mul(body.inertia(), body.angular_velocity());
                (v.scale(m), fx_mul(m, x.cross(v)) + spin)
            };
            world.bodies().map(of).fold((Vec2::ZERO, fx!(0)), |a, b| (a.0 + b.0, a.1 + b.1))
        };
        let start = momentum(&world);
        run(&mut world, 600);
        let end = momentum(&world);
        close(end.0.length(), fx!(0), fx!(0.01));
        close(end.1, start.1, fx!(0.05) + start.1.abs() / 500);
        assert!(world.joint_error(gear).expect("valid") < fx!(0.005), "round {round}");
    }
}

#[test]
fn a_rack_moves_as_its_wheel_rolls() {
    let mut world = world(fx!(-10));
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let pinion = wheel(&mut world, fx!(0.5), fx!(0));
    let crank = hinge(&mut world, ground, pinion, Revolute::new().motor(fx!(-2), fx!(300)));
    // The bar is to the right of the wheel.
    let bar = ShapeDef::new(Polygon::rectangle(fx!(0.1), fx!(3)).expect("valid"));
    let rack = BodyDef::dynamic().position((fx!(0.5), fx!(0))).never_sleeps();
    let rack = world.spawn(&rack, &[bar]).expect("valid");
    let slide = world
        .joint_along(ground, rack, Prismatic::new(), (fx!(0.5), fx!(0)), (fx!(0), fx!(1)))
        .expect("valid");
    world.add_joint(&slide).expect("valid");
    // The axis of the rack points up. Its pitch line is to the right of the wheel.
    let def = JointDef::new(pinion, rack, Rack::new(fx!(0.5))).angle_b(Angle::QUARTER);
    let def = world.fit_joint(&def).expect("valid");
    let joint = world.add_joint(&def).expect("valid");
    let mut worst = fx!(0);
    for _ in 0..300 {
        world.step();
        worst = worst.max(world.joint_error(joint).expect("valid"));
    }
    run(&mut world, 0);
    assert!(worst < fx!(0.003), "{worst}");
    let turned = world.joint_angle(crank).expect("valid");
    assert!(turned < fx!(-9));
    // The right side of a wheel that turns clockwise goes down.
    close(at(&world, rack).y, turned / 2, fx!(0.005));
    // The motor of the crank carries the rack: 1.2 kg on a lever of half a metre.
    let (_, torque) = world.joint_part_force(crank, JointPart::Motor).expect("valid");
    close(torque, fx!(6), fx!(0.05));
}

#[test]
fn a_wheel_rolls_along_a_rack_that_is_fixed() {
    let mut world = world(fx!(0));
    let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let disc = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let def = BodyDef::dynamic().position((fx!(0), fx!(0.5))).angular_velocity(fx!(-4)).never_sleeps();
    let pinion = world.spawn(&def.velocity((fx!(2), fx!(0))), &[disc]).expect("valid");
    let slot =
        world.joint_at(ground, pinion, lockstep2d::solver::Wheel::new(), (fx!(0), fx!(0.5))).expect("valid");
    world.add_joint(&slot).expect("valid");
    let joint = fitted(&mut world, pinion, ground, Rack::new(fx!(0.5)));
    let start = crate::energy(&world);
    run(&mut world, 1800);
    assert!(world.joint_error(joint).expect("valid") < fx!(0.001));
    close(at(&world, pinion).x, fx!(60), fx!(0.2));
    close(crate::energy(&world), start, start / 200);
}

/// Two weights at the ends of a rope over two wheels, 20 m below these.
fn atwood(world: &mut World, masses: [Fx; 2], ratio: Fx) -> ([BodyId; 2], JointId) {
    let disc = ShapeDef::new(Geometry::circle(fx!(0.3)).expect("valid"));
    let weights = [(fx!(-2), masses[0]), (fx!(2), masses[1])].map(|(x, mass)| {
        let mass = MassSource::Given { mass, centre: Vec2::ZERO, gyration: fx!(0.2) };
        world.spawn(&BodyDef::dynamic().position((x, fx!(-10))).mass(mass), &[disc]).expect("valid")
    });
    let [a, b] = weights;
    let rope = Pulley::new((fx!(-2), fx!(10)), (fx!(2), fx!(10)), fx!(0)).ratio(ratio);
    (weights, fitted(world, a, b, rope))
}

#[test]
fn weights_on_a_rope_accelerate_as_theory_says() {
    for (masses, ratio) in [
        ([fx!(1), fx!(2)], fx!(1)),
        ([fx!(5), fx!(1)], fx!(1)),
        ([fx!(1), fx!(1)], fx!(2)),
        ([fx!(1), fx!(9)], fx!(0.5)),
        ([fx!(1), fx!(20)], fx!(4)),
        ([fx!(20), fx!(1)], fx!(0.25)),
        ([fx!(0.1), fx!(50)], fx!(4)),
    ] {
        let mut world = world(fx!(-10));
        let (weights, rope) = atwood(&mut world, masses, ratio);
        let inverse = |x: Fx| fx_div(fx!(1), x).expect("valid");
        let sum = inverse(masses[0]) + fx_mul(fx_mul(ratio, ratio), inverse(masses[1]));
        let tension = fx_div(fx!(10) + ratio * 10, sum).expect("valid");
        let start = crate::energy(&world);
        run(&mut world, 30);
        for (body, pull) in weights.into_iter().zip([tension, fx_mul(tension, ratio)]) {
            let mass = world.body(body).expect("valid").mass();
            let expected = (fx_div(pull, mass).expect("valid") - fx!(10)) / 2;
            close(world.body(body).expect("valid").velocity().y, expected, fx!(0.02));
        }
        let (force, _) = world.joint_force(rope).expect("valid");
        close(force.y, fx_mul(tension, ratio), tension / 50);
        assert!(
            world.joint_error(rope).expect("valid") < fx!(0.004),
            "{}",
            world.joint_error(rope).expect("valid")
        );
        // The integration error of a free fall for the time t is a loss of m g^2 h t / 2, which is 0.1 J for each kg.
        close(crate::energy(&world), start, (masses[0] + masses[1]) * 3 / 20);
    }
}

#[test]
fn a_rope_in_balance_rests_and_a_loose_one_does_not_pull() {
    let mut world = world(fx!(-10));
    // At a ratio of 2, 3 kg balance 6 kg.
    let (weights, rope) = atwood(&mut world, [fx!(3), fx!(6)], fx!(2));
    run(&mut world, 600);
    for body in weights {
        close(at(&world, body).y, fx!(-10), fx!(0.01));
        assert!(world.body(body).expect("valid").is_asleep());
    }
    let mut longer = *world.joint(rope).expect("valid").def();
    let JointKind::Pulley(pulley) = &mut longer.kind else { panic!("a pulley") };
    pulley.length += fx!(3);
    world.set_joint(rope, &longer).expect("valid");
    // The weights fall freely until the rope is taut again, after 0.45 s.
    run(&mut world, 24);
    for body in weights {
        close(world.body(body).expect("valid").velocity().y, fx!(-4), fx!(0.001));
    }
    run(&mut world, 600);
    let lengths = weights.map(|body| fx!(10) - at(&world, body).y);
    close(lengths[0] + lengths[1] * 2, pulley_length(&world, rope), fx!(0.01));
}

fn pulley_length(world: &World, rope: JointId) -> Fx {
    let JointKind::Pulley(pulley) = &world.joint(rope).expect("valid").def().kind else { panic!("a pulley") };
    pulley.length
}

#[test]
fn couplings_out_of_range_are_refused() {
    let mut world = world(fx!(0));
    let (a, b) = (wheel(&mut world, fx!(1), fx!(0)), wheel(&mut world, fx!(1), fx!(3)));
    let mut refused = |kind: JointKind| {
        let error = world.add_joint(&JointDef::new(a, b, kind)).unwrap_err();
        let WorldError::JointOutOfRange { what, .. } = error else { panic!("{error:?}") };
        what
    };
    for (teeth, side) in [
        ([0, 5], "number of teeth on A"),
        ([5, 1001], "number of teeth on B"),
        ([-1001, 5], "number of teeth on A"),
        ([-5, -6], "number of teeth on B, as A is a ring,"),
        ([i32::MIN, i32::MAX], "number of teeth on A"),
    ] {
        assert_eq!(refused(Gear::new(teeth[0], teeth[1]).into()), side);
    }
    for radius in [fx!(0), fx!(129), Fx::MIN] {
        assert_eq!(refused(Rack::new(radius).into()), "radius in m");
    }
    let pulley = Pulley::new(Vec2::ZERO, Vec2::ZERO, fx!(1));
    assert_eq!(refused(Pulley { length: fx!(-1), ..pulley }.into()), "rope length in m");
    assert_eq!(refused(pulley.ratio(fx!(0.2)).into()), "ratio");
    assert_eq!(refused(pulley.ratio(fx!(4.1)).into()), "ratio");
    assert_eq!(
        refused(Pulley { wheel_b: Vec2::new(Fx::MAX, fx!(0)), ..pulley }.into()),
        "wheel coordinate in m"
    );
}

/// The lever arm of a rack at the other end of the world exceeds its format and saturates. Nothing may overflow.
#[test]
fn a_rack_may_be_at_the_other_end_of_the_world() {
    let mut world = world(fx!(0));
    let corner = fx!(999999000);
    let pinion = wheel(&mut world, fx!(0.5), fx!(0));
    world.set_transform(pinion, (-corner, -corner), Angle::ZERO).expect("valid");
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
    let rack = world.spawn(&BodyDef::dynamic().position((corner, corner)), &[square]).expect("valid");
    for degrees in 0..8 {
        let angle = Angle::from_degrees(fx!(45) * degrees);
        let def = JointDef::new(pinion, rack, Rack::new(fx!(0.5))).angle_b(angle);
        let joint = world.add_joint(&def).expect("valid");
        world.step();
        world.remove_joint(joint).expect("valid");
    }
    assert!(world.body(rack).is_some());
}
