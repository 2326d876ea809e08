//! A bouncing ball: restitution `e` returns a fraction `e` of the speed, so `e^2` of the height.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, fx_mul, sqrt};
use lockstep2d::world::World;

/// Drops a ball of restitution `e` from a height and returns the heights of its rebounds: the highest positions of the
/// ball's lowest point between two impacts.
fn rebounds(e: Fx, height: Fx, ticks: u32) -> Vec<Fx> {
    let mut world = World::default();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).restitution(e);
    let def = BodyDef::dynamic().position((fx!(0), height + fx!(0.5)));
    let ball = world.spawn(&def, &[ball]).expect("valid");
    let (mut heights, mut peak, mut rising) = (Vec::new(), Fx::ZERO, false);
    for _ in 0..ticks {
        world.step();
        let body = world.body(ball).expect("still there");
        let now_rising = body.velocity().y > Fx::ZERO;
        if now_rising && !rising {
            peak = Fx::ZERO;
        }
        peak = peak.max(body.position().y - fx!(0.5));
        if rising && !now_rising {
            heights.push(peak);
        }
        rising = now_rising;
    }
    assert_eq!(world.faults(), 0);
    heights
}

/// The time of impact has an error of up to one tick. The velocity that gravity adds in that tick is lost, which lowers
/// the rebound by up to `e^2 H 2 g dt / v`.
#[test]
fn a_rebound_returns_the_square_of_the_restitution() {
    let g = fx!(10);
    for (e, height) in [
        (fx!(0.5), fx!(10)),
        (fx!(0.8), fx!(10)),
        (fx!(0.8), fx!(3)),
        (fx!(0.95), fx!(5)),
        (fx!(1), fx!(2)),
        (fx!(0.9), fx!(40)),
        (fx!(0.1), fx!(1.1955)),
        (fx!(0.3), fx!(1.1955)),
        (fx!(0.5), fx!(1.1955)),
    ] {
        let rebound = rebounds(e, height, 600)[0];
        let ideal = fx_mul(fx_mul(e, e), height);
        let v = sqrt(fx_mul(g * 2, height)).expect("positive");
        let lost = lockstep2d::math::fx_div(g * 2 / 60, v).expect("moving");
        let least = fx_mul(ideal, Fx::ONE - lost) - fx!(0.005);
        assert!(rebound <= ideal, "e {e}: {rebound} m is higher than {ideal} m");
        assert!(rebound >= least, "e {e}: {rebound} m is lower than {least} m");
    }
}

#[test]
fn no_rebound_is_higher_than_the_one_before() {
    for e in [fx!(0.3), fx!(0.8), fx!(0.95), fx!(0.99), fx!(1)] {
        let heights = rebounds(e, fx!(10), 60 * 300);
        assert!(!heights.is_empty(), "e {e}: expected a rebound");
        for (i, pair) in heights.windows(2).enumerate() {
            assert!(pair[1] <= pair[0], "e {e}, rebound {}: {} m after {} m", i + 1, pair[1], pair[0]);
        }
    }
}

/// A box that lands flat bounces flat, at a fraction `e` of its speed: its two contact points bounce together.
#[test]
fn a_box_that_lands_flat_does_not_spin_or_gain_energy() {
    for (half_width, half_height) in [(fx!(0.3), fx!(0.8)), (fx!(0.5), fx!(0.5)), (fx!(1), fx!(0.2))] {
        for e in [fx!(0.5), fx!(0.9), fx!(1)] {
            let mut world = World::default();
            let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
            world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
            let shape =
                ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid")).restitution(e);
            let def = BodyDef::dynamic().position((fx!(0), half_height + fx!(2)));
            let body = world.spawn(&def, &[shape]).expect("valid");
            let (mut highest, mut bounced) = (Fx::ZERO, false);
            for tick in 0..100 {
                world.step();
                let body = world.body(body).expect("still there");
                bounced |= body.velocity().y > Fx::ZERO;
                if bounced {
                    highest = highest.max(body.position().y - half_height);
                }
                let spin = body.angular_velocity().abs();
                // The box may no longer be quite flat at its second impact, which is after tick 70 or later.
                let bound = if tick < 70 { fx!(0.02) } else { fx!(0.2) };
                assert!(spin < bound, "{half_width} x {half_height}, e {e}, tick {tick}: {spin} rad/s");
            }
            let ideal = fx_mul(fx_mul(e, e), fx!(2));
            assert!(highest <= ideal + fx!(0.001), "e {e}: {highest} m of {ideal} m");
            assert!(highest >= ideal * 9 / 10 - fx!(0.005), "e {e}: {highest} m of {ideal} m");
        }
    }
}
