//! Springs follow the implicit integration of a damped oscillator, up to rounding:
//!
//! ```text
//! v' = (v - K h omega^2 x) / (1 + K (2 zeta h omega + h^2 omega^2)),   x' = x + h v'
//! ```
//!
//! `x` is the stretch, `v` its velocity, `h` the sub-step and `zeta` the damping ratio. The mobility `K` is 1 for one
//! spring between the centres of two bodies. It is larger if the spring acts at the end of an arm and so also turns a
//! body, and 2 if two springs act.

use lockstep2d::body::JointId;
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, TAU, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{Distance, JointDef, JointKind, Motor, Prismatic, Revolute, Weld, Wheel};
use lockstep2d::world::World;

use crate::joint_bench::{Bench, Ground, RATE};

/// Simulates the formula above. A tick has four sub-steps.
struct Oscillator {
    x: Fx,
    v: Fx,
    hertz: Fx,
    damping_ratio: Fx,
    mobility: Fx,
}

impl Oscillator {
    fn tick(&mut self) -> Fx {
        let h_omega = fx_mul(TAU, self.hertz) / RATE;
        let soft = fx_mul(self.damping_ratio * 2, h_omega) + fx_mul(h_omega, h_omega);
        let damping = Fx::ONE + fx_mul(self.mobility, soft);
        for _ in 0..4 {
            let pull = fx_mul(fx_mul(fx_mul(h_omega, h_omega), self.mobility), self.x) * RATE;
            self.v = fx_div(self.v - pull, damping).expect("more than 1");
            self.x += self.v / RATE;
        }
        self.x
    }
}

/// Expects that a spring stretched by 0.5 (m or rad) follows the formula for at least three periods.
fn follows(
    kind: impl Fn(Fx, Fx) -> JointKind,
    place: Vec2<Fx>,
    angle: Fx,
    stretch: impl Fn(&World, JointId) -> Fx,
) {
    for ground in [Ground::Fixed, Ground::Free(fx!(0.7)), Ground::Free(fx!(40))] {
        for (hertz, damping_ratio) in [
            (fx!(1), fx!(0.1)),
            (fx!(1), fx!(1)),
            (fx!(2), fx!(0.5)),
            (fx!(3), fx!(0)),
            (fx!(5), fx!(0.1)),
            (fx!(5), fx!(0.7)),
        ] {
            let mut bench = Bench::new(ground, fx!(0), place, angle);
            let joint = bench.join(JointDef::new(bench.a, bench.b, kind(hertz, damping_ratio)));
            let x = stretch(&bench.world, joint);
            assert!((x.abs() - fx!(0.5)).abs() < fx!(0.0001), "starts at {x}");
            let mut theory = Oscillator { x, v: fx!(0), hertz, damping_ratio, mobility: fx!(1) };
            let mut worst = fx!(0);
            bench.run(200, |_, world| worst = worst.max((stretch(world, joint) - theory.tick()).abs()));
            assert!(worst < fx!(0.00001), "{ground:?}, {hertz} Hz, ratio {damping_ratio}: {worst} off");
        }
    }
}

const NEAR: Vec2<Fx> = Vec2::new(fx!(0), fx!(0));

#[test]
fn a_distance_spring_swings_as_theory_says() {
    let kind = |hertz, ratio| Distance::new().spring(hertz, ratio, fx!(2)).into();
    let stretch = |world: &World, id| world.joint_length(id).expect("there") - fx!(2);
    follows(kind, Vec2::new(fx!(1.5), fx!(2)), fx!(0), stretch);
}

#[test]
fn a_slider_on_a_spring_swings_as_theory_says() {
    let kind = |hertz, ratio| Prismatic::new().spring(hertz, ratio, fx!(1)).into();
    let stretch = |world: &World, id| world.joint_translation(id).expect("there").x - fx!(1);
    follows(kind, Vec2::new(fx!(1.5), fx!(0)), fx!(0), stretch);
}

#[test]
fn a_suspension_swings_as_theory_says() {
    let kind = |hertz, ratio| Wheel::new().spring(hertz, ratio, fx!(1)).into();
    let stretch = |world: &World, id| world.joint_translation(id).expect("there").x - fx!(1);
    follows(kind, Vec2::new(fx!(0.5), fx!(0)), fx!(0), stretch);
}

#[test]
fn a_hinge_on_a_spring_swings_as_theory_says() {
    let kind = |hertz, ratio| Revolute::new().spring(hertz, ratio, fx!(0.2)).into();
    let stretch = |world: &World, id| world.joint_angle(id).expect("there") - fx!(0.2);
    follows(kind, NEAR, fx!(-0.3), stretch);
}

#[test]
fn a_soft_weld_swings_as_theory_says() {
    let angle = |world: &World, id| world.joint_angle(id).expect("there");
    follows(|hertz, ratio| Weld::rigid().angular(hertz, ratio).into(), NEAR, fx!(0.5), angle);
    let apart = |world: &World, id| world.joint_translation(id).expect("there").y;
    let place = Vec2::new(fx!(0), fx!(0.5));
    follows(|hertz, ratio| Weld::rigid().linear(hertz, ratio).into(), place, fx!(0), apart);
}

#[test]
fn a_motor_pulls_its_frames_together_as_theory_says() {
    let angle = |world: &World, id| world.joint_angle(id).expect("there");
    let kind = |hertz, ratio| Motor::new().angular_spring(hertz, ratio, Fx::MAX).into();
    follows(kind, NEAR, fx!(-0.5), angle);
    let apart = |world: &World, id| world.joint_translation(id).expect("there").y;
    let kind = |hertz, ratio| Motor::new().linear_spring(hertz, ratio, Fx::MAX).into();
    follows(kind, Vec2::new(fx!(0), fx!(0.5)), fx!(0), apart);
}

/// The frequency of a spring is defined for two point masses. If a spring acts at the end of an arm `r` of B, it swings
/// `sqrt(1 + m r^2 / (mB k^2))` times as fast. `m` is the reduced mass, `mB` the mass of B and `k` its radius of
/// gyration.
#[test]
fn a_point_on_an_arm_swings_faster() {
    for (ground, reduced) in [(Ground::Fixed, fx!(1)), (Ground::Free(fx!(2)), fx!(0.5))] {
        for (arm, hertz, ratio) in [
            (fx!(0.5), fx!(2), fx!(0.1)),
            (fx!(0.5), fx!(1), fx!(0)),
            (fx!(1.5), fx!(1), fx!(0.1)),
            (fx!(1.5), fx!(5), fx!(0.5)),
            (fx!(8), fx!(0.5), fx!(0)),
        ] {
            // The stretch is so small that the rotation of B hardly shortens the arm.
            let x = arm / 100;
            let mut bench = Bench::new(ground, fx!(0), Vec2::new(arm, x), fx!(0));
            let kind = Motor::new().linear_spring(hertz, ratio, Fx::MAX);
            let joint = bench.join(JointDef::new(bench.a, bench.b, kind).anchor_b((-arm, fx!(0))));
            let mobility = fx!(1) + fx_mul(reduced, fx_mul(arm, arm) * 4);
            let mut theory = Oscillator { x, v: fx!(0), hertz, damping_ratio: ratio, mobility };
            let mut worst = fx!(0);
            bench.run(200, |_, world| {
                let stretch = world.joint_translation(joint).expect("there").y;
                worst = worst.max((stretch - theory.tick()).abs());
            });
            assert!(worst < x / 1000, "{ground:?}, arm {arm} m, {hertz} Hz, ratio {ratio}: {worst} off");
        }
    }
}

/// Suspensions and distance joints obey the formula of [`a_point_on_an_arm_swings_faster`].
#[test]
fn a_spring_along_a_line_swings_faster_on_an_arm() {
    for (ground, reduced) in [(Ground::Fixed, fx!(1)), (Ground::Free(fx!(2)), fx!(0.5))] {
        for (arm, hertz, ratio) in [
            (fx!(0.5), fx!(2), fx!(0.1)),
            (fx!(0.5), fx!(1), fx!(0)),
            (fx!(1.5), fx!(1), fx!(0.1)),
            (fx!(1.5), fx!(5), fx!(0.5)),
        ] {
            // The stretch is so small that the rotation of B hardly changes the arm.
            let x = arm / 1000;
            let long = fx!(2);
            let mobility = fx!(1) + fx_mul(reduced, fx_mul(arm, arm) * 4);
            let rest = Distance::new().spring(hertz, ratio, long);
            let suspension = Wheel::new().spring(hertz, ratio, fx!(0));
            for (kind, from, start) in
                [(rest.into(), -long, long), (JointKind::from(suspension), fx!(0), fx!(0))]
            {
                let mut bench = Bench::new(ground, fx!(0), Vec2::new(arm, x), fx!(0));
                // The spring acts along y, through A's centre.
                let def = JointDef::new(bench.a, bench.b, kind).angle_a(Angle::QUARTER);
                let joint = bench.join(def.anchor_a((fx!(0), from)).anchor_b((-arm, fx!(0))));
                let mut theory = Oscillator { x, v: fx!(0), hertz, damping_ratio: ratio, mobility };
                let mut worst = fx!(0);
                bench.run(200, |_, world| {
                    let stretch = world.joint_translation(joint).expect("there").x - start;
                    worst = worst.max((stretch - theory.tick()).abs());
                });
                assert!(worst < x / 100, "{kind:?}, {ground:?}, arm {arm} m: {worst} off");
            }
        }
    }
}

/// Two welds at one body act as one weld of twice the stiffness and damping.
#[test]
fn two_soft_welds_swing_as_one_of_twice_the_stiffness() {
    for ground in [Ground::Fixed, Ground::Free(fx!(0.7)), Ground::Free(fx!(40))] {
        for (hertz, ratio) in [(fx!(1), fx!(0.1)), (fx!(2), fx!(0.5)), (fx!(3), fx!(0)), (fx!(8), fx!(1))] {
            let mut bench = Bench::new(ground, fx!(0), Vec2::new(fx!(0), fx!(0.5)), fx!(0));
            let joints = [fx!(-0.75), fx!(0.75)].map(|side| {
                let kind = Weld::rigid().linear(hertz, ratio);
                let def = JointDef::new(bench.a, bench.b, kind);
                bench.join(def.anchor_a((side, fx!(0))).anchor_b((side, fx!(0))))
            });
            let (x, mobility) = (fx!(0.5), fx!(2));
            let mut theory = Oscillator { x, v: fx!(0), hertz, damping_ratio: ratio, mobility };
            let mut worst = fx!(0);
            bench.run(200, |_, world| {
                let x = theory.tick();
                for joint in joints {
                    let stretch = world.joint_translation(joint).expect("there").y;
                    worst = worst.max((stretch - x).abs());
                }
            });
            assert!(worst < fx!(0.0001), "{ground:?}, {hertz} Hz, ratio {ratio}: {worst} off");
        }
    }
}

/// When the body is at rest, the spring has reached its target.
#[test]
fn a_spring_on_an_arm_comes_to_rest_where_it_pulls() {
    let mut bench = Bench::new(Ground::Fixed, fx!(0), Vec2::new(fx!(3), fx!(1)), fx!(1));
    let kind =
        Motor::new().linear_spring(fx!(4), fx!(0.7), fx!(100)).angular_spring(fx!(4), fx!(0.7), fx!(100));
    let def = JointDef::new(bench.a, bench.b, kind).anchor_b((fx!(0.5), fx!(0.25))).angle_a(Angle::EIGHTH);
    let joint = bench.join(def);
    bench.run(600, |_, _| {});
    let (length, angle) = (bench.world.joint_length(joint), bench.world.joint_angle(joint));
    assert!(
        length.expect("there") < fx!(0.001) && angle.expect("there").abs() < fx!(0.001),
        "{length:?} {angle:?}"
    );
}
