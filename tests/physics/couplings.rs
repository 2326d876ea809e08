//! Pulleys and gears at the ends of their ranges.

use lockstep2d::body::{BodyDef, BodyId, JointId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{Gear, JointDef, Prismatic, Pulley, Revolute};

use crate::joint_bench::{Bench, Ground, close};

/// Places a body 1 m below a wheel, on a rope whose other end is at a fixed body, 5 m below the other wheel. The rope
/// becomes taut when the body is `taut` metres below its wheel. With `on_a`, the body is A of the pulley, otherwise it
/// is B. With `in_block`, a slider also holds the body on a vertical line, and the solver treats both joints as one
/// block.
fn hang(ratio: Fx, (on_a, in_block): (bool, bool), taut: Fx) -> (Bench, BodyId, JointId) {
    let mut bench = Bench::new(Ground::Fixed, fx!(-10), Vec2::new(fx!(1), fx!(4)), fx!(0));
    let (ground, body) = (bench.a, bench.b);
    let (wheel, far) = (Vec2::new(fx!(1), fx!(5)), Vec2::new(fx!(-1), fx!(5)));
    let rope = if on_a {
        JointDef::new(body, ground, Pulley::new(wheel, far, taut + ratio * 5).ratio(ratio))
            .anchor_b((fx!(-1), fx!(0)))
    } else {
        JointDef::new(ground, body, Pulley::new(far, wheel, fx!(5) + fx_mul(ratio, taut)).ratio(ratio))
            .anchor_a((fx!(-1), fx!(0)))
    };
    let rope = bench.join(rope);
    if in_block {
        let slider = JointDef::new(ground, body, Prismatic::new()).anchor_a((fx!(1), fx!(4)));
        bench.join(slider.angle_a(Angle::QUARTER).angle_b(Angle::QUARTER));
    }
    (bench, body, rope)
}

const RATIOS: [Fx; 6] = [fx!(0.25), fx!(0.4), fx!(0.7), fx!(1), fx!(2.5), fx!(4)];

fn each(mut test: impl FnMut(Fx, (bool, bool))) {
    for ratio in RATIOS {
        for side in [(false, false), (true, false), (false, true), (true, true)] {
            test(ratio, side);
        }
    }
}

/// The rope is an inelastic limit: it stops the body where it becomes taut.
#[test]
fn a_body_that_falls_into_its_rope_does_not_rebound() {
    each(|ratio, side| {
        let (mut bench, body, _) = hang(ratio, side, fx!(5));
        let what = format!("ratio {ratio}, {side:?}");
        bench.run(120, |tick, world| {
            let body = world.body(body).expect("there");
            let (y, up) = (body.position().y, body.velocity().y);
            // The rope becomes taut at y = 0. Until then the body falls freely for 4 m, which takes sqrt(2 * 4 / 10) =
            // 0.89 s.
            assert!(y > fx!(-0.005), "{what}, tick {tick}: stretched to {y} m");
            assert!(up < fx!(0.1), "{what}, tick {tick}: rebounds at {up} m/s");
        });
    });
}

/// Under a weight of 20 N, the rope yields by `g / (2 pi 60)^2` = 0.0704 mm, as all joints do.
#[test]
fn a_weight_stretches_a_rope_as_little_as_any_joint() {
    each(|ratio, side| {
        let (mut bench, body, rope) = hang(ratio, side, fx!(1));
        bench.run(240, |_, _| {});
        let what = format!("ratio {ratio}, {side:?}");
        let sag = fx!(4) - bench.world.body(body).expect("there").position().y;
        close(sag, fx!(0.0000704), fx!(0.00002), &what);
        let force = bench.world.joint_force(rope).expect("there").0.length();
        let expected = if side.0 { ratio * 20 } else { fx!(20) };
        close(force, expected, fx_div(expected, fx!(100)).expect("not 0"), &what);
    });
}

/// `NA wA + NB wB = 0`, with the numbers of teeth `N` and the angular velocities `w`. Both wheels turn about the same
/// point, so they have no pitch point.
#[test]
fn a_small_wheel_with_many_teeth_turns_at_the_ratio_of_the_teeth() {
    for (teeth, gyration) in [(1000, fx!(0.002)), (1000, fx!(0.005)), (1000, fx!(0.05)), (10, fx!(0.5))] {
        let mut bench = Bench::with_mass(Ground::Fixed, fx!(0), (fx!(1), gyration), Vec2::ZERO, fx!(0));
        bench.join(JointDef::new(bench.a, bench.b, Revolute::new()));
        let driver = BodyDef::kinematic().velocity(Vec2::ZERO).angular_velocity(fx!(1));
        let driver = bench.world.spawn(&driver, &[]).expect("valid");
        bench.join(JointDef::new(bench.b, driver, Gear::new(teeth, -teeth)));
        bench.run(60, |_, _| {});
        let turning = bench.world.body(bench.b).expect("there").angular_velocity();
        close(turning, fx!(1), fx!(0.005), &format!("{teeth} teeth, {gyration} m"));
    }
}
