//! Joints hold and bear loads as theory predicts.

use lockstep2d::body::{BodyDef, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Vec2, fx_mul, sqrt};
use lockstep2d::solver::{Distance, JointDef, JointKind, Motor, Prismatic, Revolute, Weld, Wheel};
use lockstep2d::world::World;

use crate::joint_bench::{Bench, Ground, close};

/// A body on a rod of length `L` = 2 m without mass swings with the period `T = 2 pi sqrt(L / g) (1 + a^2 / 16)`. The
/// amplitude `a` is 0.1 radians.
#[test]
fn a_rod_is_a_pendulum() {
    let (sin, cos) = (fx!(0.0998334), fx!(0.9950042));
    let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(sin * 2, -cos * 2), fx!(0));
    let joint = bench.join(JointDef::new(bench.a, bench.b, Distance::rod(fx!(2))));
    let b = bench.b;
    let (mut crossings, mut last) = (Vec::new(), fx!(1));
    bench.run(1200, |tick, world| {
        let x = world.body(b).expect("there").position().x;
        if last < Fx::ZERO && x >= Fx::ZERO {
            let part = lockstep2d::math::fx_div(x, x - last).expect("it moves");
            crossings.push((Fx::from_num(tick + 1) - part) / 60);
        }
        last = x;
        close(world.joint_length(joint).expect("there"), fx!(2), fx!(0.002), "m of rod");
    });
    let periods = i64::try_from(crossings.len()).expect("few") - 1;
    let period = (crossings[crossings.len() - 1] - crossings[0]) / periods;
    let small = fx_mul(PI * 2, sqrt(fx!(0.2)).expect("positive"));
    close(period, small + small / 1600, small / 200, "s");
}

/// The axis of a slider descends at 30 degrees, 1 m beside the centre of its load. The load slides without friction and
/// does not turn.
#[test]
fn a_slider_slides_down_its_slope_and_does_not_turn() {
    for ground in [Ground::Fixed, Ground::Free(fx!(1000000))] {
        let mut bench = Bench::new(ground, fx!(-10), Vec2::ZERO, fx!(0));
        if let Ground::Free(_) = ground {
            // Gravity would accelerate the ground as well, so a force on the load replaces it.
            bench.world.set_gravity(Vec2::ZERO).expect("valid");
        }
        let tilt = Angle::from_degrees(fx!(-30));
        let def = JointDef::new(bench.a, bench.b, Prismatic::new()).angle_a(tilt).angle_b(tilt);
        let def = def.anchor_a((fx!(0.6), fx!(0.8))).anchor_b((fx!(0.6), fx!(0.8)));
        let joint = bench.join(def);
        let b = bench.b;
        for _ in 0..120 {
            if let Ground::Free(_) = ground {
                let at = bench.world.body(b).expect("there").position();
                bench.world.apply_force(b, Vec2::new(fx!(0), fx!(-20)), at).expect("valid");
            }
            bench.run(1, |tick, world| {
                let angle = world.joint_angle(joint).expect("there");
                assert!(angle.abs() < fx!(0.002), "{ground:?}, tick {tick}: {angle} rad");
                let across = world.joint_translation(joint).expect("there").y;
                assert!(across.abs() < fx!(0.005), "{ground:?}, tick {tick}: {across} m off the axis");
            });
        }
        let along = bench.world.joint_translation(joint).expect("there").x;
        // The distance after 2 s is `g / 2 sin(30 degrees) t^2` = 10 m. The integration adds the motion of half a
        // sub-step.
        close(along, fx!(10), fx!(0.05), "m");
    }
}

/// Builds planks of 1 m and 1 kg that are welded end to end and to a wall. Returns the world and the height of the tip
/// after 10 s.
fn cantilever(planks: i64, kind: Weld) -> (World, Fx) {
    let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(0), fx!(100)), fx!(0));
    let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.29) };
    let (mut last, mut anchor) = (bench.a, fx!(0));
    for i in 0..planks {
        let at = Fx::from_num(i) + fx!(0.5);
        let plank = BodyDef::dynamic().mass(mass).position((at, fx!(0)));
        let plank = bench.world.spawn(&plank, &[]).expect("valid");
        bench.join(JointDef::new(last, plank, kind).anchor_a((anchor, fx!(0))).anchor_b((fx!(-0.5), fx!(0))));
        (last, anchor) = (plank, fx!(0.5));
    }
    bench.run(600, |_, _| {});
    let tip = bench.world.body(last).expect("there").position().y;
    (bench.world, tip)
}

#[test]
fn a_cantilever_of_rigid_welds_hardly_bends() {
    for (planks, most) in [(1, fx!(0.01)), (4, fx!(0.2))] {
        let (world, tip) = cantilever(planks, Weld::rigid());
        assert!(tip.abs() < most, "{planks} planks: the tip hangs {tip} m");
        for (id, _) in world.joints() {
            assert!(world.joint_length(id).expect("there") < fx!(0.01));
        }
        // The first weld bears 10 N per plank, and the torque of these loads.
        let (first, _) = world.joints().next().expect("there");
        let (force, torque) = world.joint_force(first).expect("there");
        let planks = Fx::from_num(planks);
        close(force.y, planks * 10, planks / 5, "N");
        close(torque, fx_mul(planks, planks) * 5, fx_mul(planks, planks) / 4, "N m");
    }
}

/// A soft joint yields to a load `m g` on a mass `m` by `g / omega^2`. With two rods, the upper hinge carries both of
/// them, with a stiffness of 60 Hz. With one rod, the hinge connects a fixed body and a body without other joints,
/// which makes it an anchored hinge. An anchored hinge has a stiffness of 120 Hz, so it yields a quarter as much to an
/// equal load.
#[test]
fn a_hinge_sags_as_its_stiffness_says_and_an_anchored_hinge_is_twice_as_stiff() {
    let sag = |rods: i64| {
        let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(9), fx!(0)), fx!(0));
        let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.29) };
        let mut above = bench.a;
        let joints: Vec<_> = (0..rods)
            .map(|i| {
                let rod = BodyDef::dynamic().mass(mass).position((fx!(0), -Fx::from_num(i) - fx!(0.5)));
                let rod = bench.world.spawn(&rod, &[]).expect("valid");
                let hangs_from = if i == 0 { fx!(0) } else { fx!(-0.5) };
                let def = JointDef::new(core::mem::replace(&mut above, rod), rod, Revolute::new());
                bench.join(def.anchor_a((fx!(0), hangs_from)).anchor_b((fx!(0), fx!(0.5))))
            })
            .collect();
        bench.run(600, |_, _| {});
        bench.world.joint_length(joints[0]).expect("there")
    };
    let (soft, stiff) = (fx!(0.000070362), fx!(0.0000175905));
    close(sag(1), stiff, stiff / 50, "m");
    close(sag(2), soft * 2, soft / 50, "m");
}

/// A load of 2 kg on a spring of 3 Hz comes to rest `g / omega^2` below the target.
#[test]
fn a_wheel_sinks_into_its_suspension() {
    let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::ZERO, fx!(0));
    let kind = Wheel::new().spring(fx!(3), fx!(0.3), fx!(0)).limit(fx!(-0.5), fx!(0.5));
    let def = JointDef::new(bench.a, bench.b, kind).angle_a(Angle::QUARTER);
    let joint = bench.join(def);
    let mut lowest = fx!(0);
    bench.run(300, |_, world| {
        let at = world.joint_translation(joint).expect("there");
        lowest = lowest.min(at.x);
        assert!(at.y.abs() < fx!(0.001), "{} m off the axis", at.y);
    });
    // The load sinks by 10 / (6 pi)^2 m. The first overshoot is exp(-pi zeta / sqrt(1 - zeta^2)) = 0.372 of that.
    let sunk = fx!(0.028145);
    close(bench.world.joint_translation(joint).expect("there").x, -sunk, sunk / 100, "m at rest");
    close(lowest, -fx_mul(sunk, fx!(1.372)), sunk / 20, "m at first");
}

/// Joints work with mass ratios up to 100, at sizes of 1 cm to 50 m, a billion metres from the origin. A hinge that
/// carries two bodies opens by less than 5 cm plus a twentieth of the size.
#[test]
fn joints_work_at_any_size_and_place() {
    let kinds = |size: Fx| -> [JointKind; 8] {
        [
            Revolute::new()
                .limit(fx!(-0.5), fx!(0.5))
                .motor(fx!(1), fx!(1))
                .spring(fx!(2), fx!(0.5), fx!(0))
                .into(),
            Prismatic::new().limit(-size, size).motor(size, fx!(1)).spring(fx!(2), fx!(0.5), fx!(0)).into(),
            Distance::rod(size).into(),
            Distance::new().limit(size / 2, size).spring(fx!(2), fx!(0.5), size / 2).into(),
            Weld::rigid().into(),
            Weld::rigid().linear(fx!(5), fx!(1)).angular(fx!(5), fx!(1)).into(),
            Wheel::new().limit(-size, size).motor(fx!(1), fx!(1)).spring(fx!(2), fx!(0.5), fx!(0)).into(),
            Motor::new()
                .linear_spring(fx!(2), fx!(0.5), fx!(1000000))
                .angular_spring(fx!(2), fx!(0.5), fx!(1000000))
                .into(),
        ]
    };
    let origin = Vec2::new(fx!(1000000000), fx!(-1000000000));
    for size in [fx!(0.01), fx!(0.1), fx!(1), fx!(50)] {
        // With a mass ratio of 100, joints of any size sag by some centimetres. This is more than the size of the
        // smallest joints, so these get equal masses.
        let under = if size < fx!(0.1) { (1, 1) } else { (1, 100) };
        for (kind, masses) in kinds(size).into_iter().flat_map(|kind| [(kind, under), (kind, (100, 1))]) {
            let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(0), fx!(100)), fx!(0));
            let body = |bench: &mut Bench, mass: i64, x: Fx| {
                let mass =
                    MassSource::Given { mass: Fx::from_num(mass), centre: Vec2::ZERO, gyration: size / 2 };
                let body = BodyDef::dynamic().mass(mass).position((origin.x + x, origin.y));
                bench.world.spawn(&body, &[]).expect("valid")
            };
            let wall = bench.world.spawn(&BodyDef::fixed().position(origin), &[]).expect("valid");
            let first = body(&mut bench, masses.0, size / 2);
            let second = body(&mut bench, masses.1, size * 3 / 2);
            let hinge = JointDef::new(wall, first, Revolute::new()).anchor_b((-size / 2, fx!(0)));
            let hinge = bench.join(hinge);
            let def = JointDef::new(first, second, kind).anchor_a((size / 2, fx!(0)));
            let apart = matches!(kind, JointKind::Distance(_));
            bench.join(def.anchor_b((if apart { size / 2 } else { -size / 2 }, fx!(0))));
            bench.run(300, |tick, world| {
                let gap = world.joint_length(hinge).expect("there");
                assert!(
                    gap < size / 20 + fx!(0.05),
                    "{kind:?} of {size} m, {masses:?}, tick {tick}: gap {gap} m"
                );
            });
        }
    }
}
