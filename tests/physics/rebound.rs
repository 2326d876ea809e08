//! Restitution `e` returns a fraction `e` of the speed, so `e^2` of the height.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_div, fx_mul};
use lockstep2d::world::{Config, World};

use crate::sweep;

/// Drops a ball with its lowest point at `height`. Returns the largest height of this point after each impact.
fn rebounds(e: Fx, height: Fx, ticks: u32) -> Vec<Fx> {
    rebounds_above(e, None, height, ticks)
}

fn rebounds_above(e: Fx, threshold: Option<Fx>, height: Fx, ticks: u32) -> Vec<Fx> {
    let mut world = World::default();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    let mut ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).restitution(e);
    ball.material.restitution_threshold = threshold;
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

/// The rebound reaches `e^2 H`. In each sub-step of length `h`, a body moves with the velocity at the middle of the
/// sub-step, so it may rise up to `g h^2 / 8` above the parabola. Positions are read at ticks, so the highest one may
/// be below the top.
#[test]
fn a_rebound_returns_the_square_of_the_restitution() {
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
        let most = ideal + ABOVE_THE_TOP;
        let least = ideal - BETWEEN_TICKS;
        assert!(rebound <= most, "e {e}: {rebound} m is higher than {ideal} m");
        assert!(rebound >= least, "e {e}: {rebound} m is lower than {least} m");
    }
}

/// Largest height in metres of the top of a parabola above the position at the nearest tick: `g dt^2 / 8`, with `dt` of
/// a tick.
const BETWEEN_TICKS: Fx = fx!(0.00035);

/// Largest height in metres of a ball above the parabola: `g h^2 / 8`, with a sub-step `h`.
const ABOVE_THE_TOP: Fx = fx!(0.000022);

#[test]
fn no_rebound_is_higher_than_the_one_before() {
    for e in [fx!(0.3), fx!(0.8), fx!(0.95), fx!(0.99), fx!(1)] {
        let heights = rebounds(e, fx!(10), 60 * 300);
        assert!(!heights.is_empty(), "e {e}: expected a rebound");
        for (i, pair) in heights.windows(2).enumerate() {
            assert!(
                pair[1] <= pair[0] + BETWEEN_TICKS,
                "e {e}, rebound {}: {} m after {} m",
                i + 1,
                pair[1],
                pair[0]
            );
        }
    }
}

/// Both contact points bounce together.
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
                // The second impact, in tick 70 or later, may be slightly tilted.
                let bound = if tick < 70 { fx!(0.02) } else { fx!(0.2) };
                assert!(spin < bound, "{half_width} x {half_height}, e {e}, tick {tick}: {spin} rad/s");
            }
            let ideal = fx_mul(fx_mul(e, e), fx!(2));
            assert!(highest <= ideal + fx!(0.001), "e {e}: {highest} m of {ideal} m");
            assert!(highest >= ideal * 9 / 10 - fx!(0.005), "e {e}: {highest} m of {ideal} m");
        }
    }
}

/// A corner within 5 mm of the floor bounces together with the corner that hits.
#[test]
fn a_box_that_lands_almost_flat_does_not_spin() {
    let boxes = [(fx!(0.3), fx!(0.8)), (fx!(0.5), fx!(0.5)), (fx!(1), fx!(0.2))].into_iter();
    let cases = boxes.flat_map(|shape| [fx!(0.3), fx!(0.5), fx!(0.9), fx!(1)].map(|e| (shape, e)));
    let cases = cases.flat_map(|(shape, e)| (0..64).map(move |height| (shape, e, height)));
    sweep::for_each(
        sweep::sample(cases, 5),
        |((half_width, half_height), e, height): ((Fx, Fx), Fx, i64)| {
            let mut world = World::default();
            let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
            world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
            let shape = Polygon::rectangle(half_width, half_height).expect("valid");
            let tilt = Angle::from_radians(fx_div(fx!(0.002), half_width).expect("not zero"));
            let above = half_height + fx!(0.5) + fx!(0.003) * height;
            let def = BodyDef::dynamic().position((fx!(0), above)).angle(tilt);
            let body = world.spawn(&def, &[ShapeDef::new(shape).restitution(e)]).expect("valid");
            for _ in 0..60 {
                world.step();
                let body = world.body(body).expect("still there");
                if body.velocity().y > Fx::ZERO {
                    let spin = body.angular_velocity().abs();
                    assert!(spin < fx!(0.01), "{half_width} x {half_height}, e {e}, {height}: {spin} rad/s");
                    return;
                }
            }
            panic!("{half_width} x {half_height}, e {e}, {height}: expected a rebound");
        },
    );
}

#[test]
fn the_threshold_of_the_world_is_the_default_of_a_material() {
    for (e, height) in [(fx!(0.5), fx!(3)), (fx!(0.9), fx!(1))] {
        assert_eq!(rebounds_above(e, Some(fx!(1)), height, 600), rebounds(e, height, 600));
    }
}

/// A ball bounces if its speed is at or above the threshold. Of the thresholds of the two shapes, the smaller one
/// applies.
#[test]
fn the_smaller_threshold_of_two_shapes_decides_whether_they_bounce() {
    let speed = fx!(0.5);
    for (floor, ball, bounces) in [
        (None, None, false),
        (None, Some(fx!(0.4)), true),
        (Some(fx!(0.4)), None, true),
        (Some(fx!(0)), Some(fx!(3)), true),
        (Some(fx!(0.6)), Some(fx!(0.7)), false),
        (Some(fx!(3)), None, false),
    ] {
        let after = speed_after_a_bounce(speed, [floor, ball]);
        if bounces {
            assert!((after - speed).abs() < fx!(0.001), "{floor:?}, {ball:?}: {after} m/s");
        } else {
            assert!(after.abs() < fx!(0.001), "{floor:?}, {ball:?}: {after} m/s");
        }
    }
}

/// Speed of a ball in m/s a second after an impact with restitution 1, without gravity.
fn speed_after_a_bounce(speed: Fx, thresholds: [Option<Fx>; 2]) -> Fx {
    let config = Config { gravity: Vec2::ZERO, sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    let mut floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
    floor.material.restitution_threshold = thresholds[0];
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    let mut ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).restitution(fx!(1));
    ball.material.restitution_threshold = thresholds[1];
    let def = BodyDef::dynamic().position((fx!(0), fx!(0.6))).velocity((fx!(0), -speed));
    let ball = world.spawn(&def, &[ball]).expect("valid");
    for _ in 0..80 {
        world.step();
    }
    world.body(ball).expect("still there").velocity().y
}

/// The ball bounces between two walls for 100 s.
#[test]
fn a_slow_ball_with_a_threshold_of_zero_keeps_its_speed() {
    for speed in [fx!(0.05), fx!(0.1), fx!(0.3), fx!(0.9), fx!(1.1), fx!(2)] {
        let config = Config { gravity: Vec2::ZERO, sleeping: false, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        let wall = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(5)).expect("valid"));
        for x in [fx!(-1.6), fx!(1.6)] {
            world.spawn(&BodyDef::fixed().position((x, fx!(0))), &[wall]).expect("valid");
        }
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
        let ball = ball.restitution(fx!(1)).restitution_threshold(fx!(0));
        let ball = world.spawn(&BodyDef::dynamic().velocity((speed, fx!(0))), &[ball]).expect("valid");
        for _ in 0..6000 {
            world.step();
        }
        let left = world.body(ball).expect("still there").velocity().x.abs();
        assert!((left - speed).abs() < speed / 1000, "{speed} m/s: {left} m/s left");
    }
}

/// The ball hits the floor at 0.05 to 20 m/s, and bounces for 100 s.
#[test]
fn elastic_falls_rebound_to_the_same_height() {
    for speed in [fx!(0.05), fx!(0.1), fx!(0.3), fx!(0.5), fx!(0.9), fx!(1.1), fx!(2), fx!(10), fx!(20)] {
        let height = fx_mul(speed, speed) / 20;
        let heights = rebounds_above(fx!(1), Some(fx!(0)), height, 6000);
        assert!(heights.len() >= 20, "{speed} m/s: expected rebounds");
        for rebound in heights {
            let error = rebound - height;
            let rounding = height / 50_000;
            let expected = -BETWEEN_TICKS - rounding..=ABOVE_THE_TOP + rounding;
            assert!(expected.contains(&error), "{speed} m/s: {rebound} m after {height} m");
        }
    }
}

/// `|v'| = e |v|` in whichever sub-step the impact occurs, for all speeds that a body definition allows. When a ball
/// hits a ball of a tenth of its mass, the light ball leaves with 20/11 of the speed of the heavy one.
#[test]
fn fast_rebounds_keep_their_speed() {
    let speed_after = |speed: Fx, gap: Fx, target: (BodyDef, Fx)| {
        let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).restitution(fx!(1));
        let (def, density) = target;
        let hit = world.spawn(&def.position((fx!(0.5), fx!(0))), &[ball.density(density)]).expect("valid");
        let def = BodyDef::dynamic().position((-gap - fx!(0.5), fx!(0))).velocity((speed, fx!(0)));
        let thrown = world.spawn(&def, &[ball]).expect("valid");
        (0..10).for_each(|_| world.step());
        assert_eq!(world.faults(), 0, "{speed} m/s");
        [thrown, hit].map(|id| world.body(id).expect("there").velocity().x)
    };
    for phase in 0..12 {
        let gap = |speed: Fx| speed * phase / 720 + fx!(0.1);
        for speed in [fx!(100), fx!(255), fx!(300), fx!(400)] {
            let [back, _] = speed_after(speed, gap(speed), (BodyDef::fixed(), fx!(1)));
            assert!((back + speed).abs() < fx!(0.01), "phase {phase}: {back} of {speed} m/s");
        }
        for speed in [fx!(100), fx!(200)] {
            let [_, away] = speed_after(speed, gap(speed), (BodyDef::dynamic(), fx!(0.1)));
            let expected = speed * 20 / 11;
            assert!((away - expected).abs() < fx!(0.05), "phase {phase}: {away} instead of {expected} m/s");
        }
    }
}

/// The wall returns `e` times the speed. The velocity changes by at most 500 m/s. The limit for an impulse is 511 m/s.
#[test]
fn a_bumper_returns_more_than_the_speed() {
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
    for (shape, e) in [(ball, fx!(1.5)), (ball, fx!(1.2)), (square, fx!(1.5)), (square, fx!(1.01))] {
        for speed in [fx!(2), fx!(20), fx!(90), fx!(200)] {
            let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
            let wall = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(5)).expect("valid")).restitution(e);
            world.spawn(&BodyDef::fixed().position((fx!(1), fx!(0))), &[wall]).expect("valid");
            let def = BodyDef::dynamic().position((fx!(-2), fx!(0))).velocity((speed, fx!(0)));
            let thrown = world.spawn(&def, &[shape]).expect("valid");
            for _ in 0..180 {
                world.step();
            }
            let left = -world.body(thrown).expect("there").velocity().x;
            let expected = fx_mul(e, speed);
            assert!((left - expected).abs() < speed / 1000 + fx!(0.001), "{e} at {speed} m/s: {left}");
            assert_eq!(world.faults(), 0, "{e} at {speed} m/s");
            assert_eq!(world.validate(), Ok(()));
        }
    }
}

/// Here, `e` times the closing speed is 1200 m/s, which is outside of the range of the type `Speed`. The change of
/// velocity is clamped and does not wrap around. The clamp counts as a fault.
#[test]
fn bumpers_at_the_speed_limit_part() {
    let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).restitution(fx!(1.5));
    let [left, right] = [(fx!(-5), fx!(400)), (fx!(5), fx!(-400))].map(|(x, speed)| {
        let def = BodyDef::dynamic().position((x, fx!(0))).velocity((speed, fx!(0)));
        world.spawn(&def, &[ball]).expect("valid")
    });
    for _ in 0..10 {
        world.step();
        assert_eq!(world.validate(), Ok(()));
    }
    let speed = |id| world.body(id).expect("there").velocity().x;
    assert!(speed(left) < fx!(-100) && speed(right) > fx!(100), "{} {}", speed(left), speed(right));
    assert!(world.faults() > 0);
}
