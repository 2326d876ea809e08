//! Limits, motors and springs of hinges away from the centres of mass of their bodies. An impulse on the angle of such
//! a hinge also changes the impulse at the point that pins the bodies. For a body on a fixed one, the inertia about the
//! pin at the distance `r` is `I + m r^2`.

use lockstep2d::body::JointId;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rot, TAU, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{JointDef, Revolute};

use crate::joint_bench::{Bench, Ground, RATE, close};

const SPEED: Fx = fx!(3);
/// Mass in kg and radius of gyration in m of B.
const MASS: Fx = fx!(2);
const GYRATION: Fx = fx!(0.5);

/// B turns at `speed` about its hinge at a distance of `arm` from its centre. The hinge is 1 m from the centre of A,
/// which is at rest. B's angle is `angle`; at 0, the centres and the hinge are on a line.
fn door(ground: Ground, arm: Fx, angle: Fx, speed: Fx, kind: Revolute) -> (Bench, JointId) {
    let out = Rot::from_angle(lockstep2d::math::Angle::from_radians(angle));
    let reach = out.apply_wide(Vec2::new(arm, fx!(0)));
    let place = Vec2::new(fx!(1), fx!(0)) + reach;
    let mut bench = Bench::with_mass(ground, fx!(0), (MASS, GYRATION), place, angle);
    let velocity = Vec2::new(-fx_mul(speed, reach.y), fx_mul(speed, reach.x));
    bench.world.set_velocity(bench.b, velocity, speed).expect("valid");
    let def = JointDef::new(bench.a, bench.b, kind);
    let joint = bench.join(def.anchor_a((fx!(1), fx!(0))).anchor_b((-arm, fx!(0))));
    (bench, joint)
}

fn grounds() -> [Ground; 3] {
    [Ground::Fixed, Ground::Free(fx!(0.5)), Ground::Free(fx!(40))]
}

const ARMS: [Fx; 5] = [fx!(0), fx!(0.25), fx!(0.5), fx!(1), fx!(3)];

/// A limit has no restitution: the bodies turn as one from then on. If the limit and the pin were solved one after the
/// other, a door with its hinge at 3 m from its centre would return at 0.7 times its speed, and its hinge would open by
/// 25 mm.
#[test]
fn a_limit_stops_a_door() {
    for ground in grounds() {
        for arm in ARMS {
            for side in [-1, 1] {
                let range =
                    Revolute::new().limit(fx!(-1) * i64::from(side == 1), fx!(1) * i64::from(side == -1));
                let (mut bench, joint) = door(ground, arm, fx!(-0.49) * side, SPEED * side, range);
                let (mut reached, mut fastest, mut widest) = (false, fx!(0), fx!(0));
                bench.run(120, |_, world| {
                    let angle = world.joint_angle(joint).expect("there") * side;
                    if reached {
                        let speed = world.joint_angular_velocity(joint).expect("there");
                        fastest = fastest.max(speed.abs());
                        widest = widest.max(world.joint_length(joint).expect("there"));
                    }
                    reached |= angle > fx!(-0.0005);
                    assert!(angle < fx!(0.002), "{ground:?}, arm {arm}: {angle} rad beyond the limit");
                });
                assert!(widest < fx!(0.0005), "{ground:?}, arm {arm}: gap {widest} m");
                assert!(
                    reached && fastest < SPEED / 100,
                    "{ground:?}, arm {arm}: {reached}, {fastest} rad/s"
                );
            }
        }
    }
}

/// A motor of unlimited torque reaches its speed within a tick.
#[test]
fn a_strong_motor_turns_a_door_at_once() {
    for ground in grounds() {
        for arm in ARMS {
            let (mut bench, joint) = door(ground, arm, fx!(0), fx!(0), Revolute::new().motor(SPEED, Fx::MAX));
            bench.run(60, |tick, world| {
                let speed = world.joint_angular_velocity(joint).expect("there");
                let what = format!("{ground:?}, arm {arm}, tick {tick}: rad/s");
                close(speed, SPEED, SPEED / 1000, &what);
                let gap = world.joint_length(joint).expect("there");
                assert!(gap < fx!(0.002), "{ground:?}, arm {arm}, tick {tick}: gap {gap} m");
            });
        }
    }
}

fn inertia_about_pin(arm: Fx) -> Fx {
    fx_mul(MASS, fx_mul(GYRATION, GYRATION) + fx_mul(arm, arm))
}

/// A motor of the torque `T` accelerates a door at `T / (I + m r^2)`.
#[test]
fn a_motor_exerts_its_torque_on_a_door() {
    for arm in ARMS {
        let kind = Revolute::new().motor(fx!(100), inertia_about_pin(arm) * 2);
        let (mut bench, joint) = door(Ground::Fixed, arm, fx!(0), fx!(0), kind);
        bench.run(60, |tick, world| {
            let speed = world.joint_angular_velocity(joint).expect("there");
            let expected = Fx::from_num(tick + 1) / 30;
            close(speed, expected, expected / 500, &format!("arm {arm}, tick {tick}: rad/s"));
        });
        let (_, torque) = bench.world.joint_force(joint).expect("there");
        close(torque, inertia_about_pin(arm) * 2, torque / 500, &format!("arm {arm}: N m"));
    }
}

/// The stiffness of a spring is `omega^2 I`, with the inertia `I` of the door about its centre of mass. The door
/// therefore follows the implicit integration of an oscillator (`joint_springs.rs`) with the mobility
/// `I / (I + m r^2)`.
#[test]
fn a_door_on_a_spring_swings_as_theory_says() {
    for (hertz, damping_ratio) in
        [(fx!(1), fx!(0.1)), (fx!(3), fx!(0)), (fx!(5), fx!(0.7)), (fx!(20), fx!(1))]
    {
        for arm in ARMS {
            let kind = Revolute::new().spring(hertz, damping_ratio, fx!(0));
            let (mut bench, joint) = door(Ground::Fixed, arm, fx!(0.2), fx!(0), kind);
            let inertia = fx_mul(MASS, fx_mul(GYRATION, GYRATION));
            let mobility = fx_div(inertia, inertia_about_pin(arm)).expect("positive");
            let h_omega = fx_mul(TAU, hertz) / RATE;
            let soft = fx_mul(damping_ratio * 2, h_omega) + fx_mul(h_omega, h_omega);
            let damping = Fx::ONE + fx_mul(mobility, soft);
            let (mut x, mut v, mut worst) = (fx!(0.2), fx!(0), fx!(0));
            bench.run(120, |_, world| {
                for _ in 0..4 {
                    let pull = fx_mul(fx_mul(fx_mul(h_omega, h_omega), mobility), x) * RATE;
                    v = fx_div(v - pull, damping).expect("more than 1");
                    x += v / RATE;
                }
                worst = worst.max((world.joint_angle(joint).expect("there") - x).abs());
            });
            assert!(worst < fx!(0.00002), "{hertz} Hz, ratio {damping_ratio}, arm {arm}: {worst} rad off");
        }
    }
}
