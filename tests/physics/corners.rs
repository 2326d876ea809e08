//! Bodies that hit several things within a tick.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, Revolute, SolverSettings};
use lockstep2d::world::{Config, World};

use crate::sweep;

const PHASES: i32 = 300;

fn space(tick_rate: u32) -> World {
    let solver = SolverSettings { restitution_threshold: fx!(0), ..SolverSettings::default() };
    World::new(Config { gravity: Vec2::ZERO, tick_rate, solver, ..Config::default() }).expect("valid")
}

fn rectangle(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid")).friction(fx!(0))
}

fn ball(radius: Fx) -> ShapeDef {
    ShapeDef::new(Geometry::circle(radius).expect("valid")).friction(fx!(0))
}

/// A fraction of a tick that differs between phases.
fn fraction(phase: i32, factor: Fx) -> Fx {
    fx_mul(factor, Fx::from(phase)).frac()
}

/// A wall stands on a floor, so that its lower end is flush with the surface of the floor. An elastic ball is thrown
/// into the corner, hits first the floor, then the wall, and flies back. If the ball met the lower end of the wall on
/// its path through the floor, a tenth of the throws would end in another direction.
#[test]
fn a_ball_returns_from_a_corner() {
    let cases = [(30, fx!(10)), (60, fx!(10)), (60, fx!(20)), (60, fx!(40)), (120, fx!(40))];
    let cases = cases.into_iter().flat_map(|case| (0..PHASES).map(move |phase| (case, phase)));
    sweep::for_each(sweep::sample(cases, 7), |((rate, speed), phase)| {
        let mut world = space(rate);
        for (half, at) in
            [((fx!(10), fx!(0.1)), (fx!(0), fx!(-0.1))), ((fx!(0.1), fx!(1)), (fx!(5.1), fx!(1)))]
        {
            let slab = rectangle(half.0, half.1).restitution(fx!(1));
            world.spawn(&BodyDef::fixed().position(at), &[slab]).expect("valid");
        }
        let degrees = fx!(10) + Fx::from(phase * 37 % PHASES) * 70 / i64::from(PHASES);
        let direction: Vec2<Fx> = Angle::from_degrees(-degrees).direction().widen();
        let (radius, per_tick) = (fx!(0.1), speed / i64::from(rate));
        // The ball meets the floor at most a tick of its path before the wall.
        let before = fx_mul(fx_mul(per_tick, fraction(phase, fx!(0.618))), direction.x);
        let start = fx!(1.5) + fx_mul(per_tick, fraction(phase, fx!(0.414)));
        let at_floor = Vec2::new(fx!(4.9) - before, radius);
        let def =
            BodyDef::dynamic().position(at_floor - direction.scale(start)).velocity(direction.scale(speed));
        let id = world.spawn(&def, &[ball(radius).restitution(fx!(1))]).expect("valid");
        let ticks = (fx!(3) / speed * i64::from(rate)).to_num::<u32>() + 4;
        (0..ticks).for_each(|_| world.step());
        let ball = world.body(id).expect("there");
        // Steep throws leave above the wall.
        let error = (ball.velocity() + direction.scale(speed)).length() / speed;
        assert!(
            ball.position().y > 2 || error < fx!(0.01),
            "{rate} Hz, {speed} m/s, phase {phase}: {error} v"
        );
    });
}

/// A ball hits a fixed wall of 5 cm. If the solver also saw the light body behind the wall, up to a tenth of the throws
/// would push it.
#[test]
fn nothing_behind_a_wall_is_pushed() {
    let cases = [(30, fx!(20)), (30, fx!(50)), (60, fx!(50))];
    let cases = cases.into_iter().flat_map(|case| (0..PHASES).map(move |phase| (case, phase)));
    sweep::for_each(sweep::sample(cases, 5), |((rate, speed), phase)| {
        let mut world = space(rate);
        world.spawn(&BodyDef::fixed(), &[rectangle(fx!(10), fx!(0.025))]).expect("valid");
        let gap = fx!(0.005) + fraction(phase, fx!(0.277)) / 10;
        let aside = fraction(phase, fx!(0.733)) - fx!(0.5);
        let behind = BodyDef::dynamic().position((aside, fx!(-0.225) - gap));
        let behind = world.spawn(&behind, &[rectangle(fx!(0.2), fx!(0.2))]).expect("valid");
        let degrees = Fx::from(phase * 37 % PHASES) * 110 / i64::from(PHASES) - fx!(145);
        let direction: Vec2<Fx> = Angle::from_degrees(degrees).direction().widen();
        let start = fx!(0.7) + fx_mul(speed / i64::from(rate), fraction(phase, fx!(0.618)));
        let def = BodyDef::dynamic().position(Vec2::new(fx!(0), fx!(0.225)) - direction.scale(start));
        let thrown = ball(fx!(0.2)).density(fx!(8)).restitution(fx!(0.5));
        world.spawn(&def.velocity(direction.scale(speed)), &[thrown]).expect("valid");
        (0..10 + rate / 6).for_each(|_| world.step());
        let speed_behind = world.body(behind).expect("there").velocity().length();
        assert!(speed_behind < fx!(0.01), "{rate} Hz, {speed} m/s, phase {phase}: {speed_behind} m/s");
    });
}

/// A hammer on a hinge hits a post near its head. Its rotation stops, and the hinge holds. If the impact were solved
/// after the joints, as that of a free body, the hammer would turn back at up to four times its speed for a tick.
#[test]
fn a_hammer_on_a_hinge_stops_at_a_post() {
    for (half_length, arm) in [(fx!(1), fx!(1)), (fx!(0.25), fx!(2))] {
        for (rate, omega) in [(30, fx!(3)), (60, fx!(3)), (60, fx!(10)), (120, fx!(3))] {
            for phase in 0..16 {
                let mut world = space(rate);
                let ground = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
                let angle = fx!(-0.6) - omega / i64::from(rate) * phase / 16;
                let angle = Angle::from_radians(angle);
                let place: Vec2<Fx> = angle.direction().widen().scale(arm);
                let def = BodyDef::dynamic().position(place).angle(angle).angular_velocity(omega);
                let def = def.velocity(place.perp().scale(omega));
                let hammer = world.spawn(&def, &[rectangle(half_length, fx!(0.1))]).expect("valid");
                let hinge = JointDef::new(ground, hammer, Revolute::new()).anchor_b((-arm, fx!(0)));
                world.add_joint(&hinge).expect("valid");
                let post = (arm + half_length - fx!(0.15), fx!(0.2));
                world.spawn(&BodyDef::fixed().position(post), &[ball(fx!(0.1))]).expect("valid");
                let (mut back, mut gap) = (fx!(0), fx!(0));
                for _ in 0..(fx!(1.2) / omega * i64::from(rate)).to_num::<u32>() + rate / 4 {
                    world.step();
                    let body = world.body(hammer).expect("there");
                    back = back.max(-body.angular_velocity() / omega);
                    let end: Vec2<Fx> = body.position() - body.angle().direction().widen().scale(arm);
                    gap = gap.max(end.length());
                }
                let what = format!("{rate} Hz, {omega} rad/s, arm {arm} m, phase {phase}");
                // Distance by which the head moves in a sub-step.
                let per_sub_step = fx_mul(omega, arm) / i64::from(4 * rate);
                let holds = gap < per_sub_step * 3;
                assert!(back < fx!(0.9) && holds, "{what}: back at {back} w, gap {gap} m");
            }
        }
    }
}

/// A box falls on two tiles as on a floor in one piece: no tile hides the other one.
#[test]
fn a_box_lands_on_tiles_as_on_a_floor() {
    for speed in [fx!(5), fx!(10), fx!(20)] {
        for phase in 0..32i32 {
            let deepest = |tiles: &[(Fx, Fx)]| {
                let mut world = World::default();
                for &(x, half_width) in tiles {
                    let tile = rectangle(half_width, fx!(0.5));
                    world.spawn(&BodyDef::fixed().position((x, fx!(-0.5))), &[tile]).expect("valid");
                }
                let height = fx!(0.8) + speed / 60 * i64::from(phase) / 32;
                let angle = Angle::from_degrees(Fx::from(phase % 5 - 2));
                let def = BodyDef::dynamic().position((fx!(0.1), height)).angle(angle);
                let def = def.velocity((fx!(0), -speed));
                world.spawn(&def, &[rectangle(fx!(0.5), fx!(0.5))]).expect("valid");
                let mut deepest = fx!(0);
                for _ in 0..30 {
                    world.step();
                    deepest = deepest.max(crate::deepest(&world));
                }
                deepest
            };
            let (one, two) =
                (deepest(&[(fx!(0), fx!(5))]), deepest(&[(fx!(-2.5), fx!(2.5)), (fx!(2.5), fx!(2.5))]));
            assert!(two <= one + fx!(0.01), "{speed} m/s, phase {phase}: {two} m deep, {one} m on one floor");
        }
    }
}
