//! Characters stay on their ground, at 30 to 240 ticks a second.

mod landings;
mod one_way;
mod overhangs;
mod pushed;

use lockstep2d::body::{BodyDef, BodyId, Chain, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2, fx_div, fx_mul};
use lockstep2d::world::{Config, Mover, MoverState, QueryFilter, World};
use lockstep2d_tests::sweep;

const RATES: [u32; 4] = [30, 60, 120, 240];

fn at(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

/// Names and shapes. The lowest points of the shapes are at `y = -0.7`.
fn shapes() -> [(&'static str, Geometry); 4] {
    let pill = Geometry::capsule(at(fx!(0), fx!(-0.4)), at(fx!(0), fx!(0.4)), fx!(0.3)).expect("valid");
    let sharp = Polygon::rectangle(fx!(0.3), fx!(0.7)).expect("valid");
    let round = Polygon::rectangle(fx!(0.25), fx!(0.65)).and_then(|polygon| polygon.rounded(fx!(0.05)));
    let ball = Geometry::circle(fx!(0.7)).expect("valid");
    [("pill", pill), ("box", sharp.into()), ("rounded box", round.expect("valid").into()), ("ball", ball)]
}

fn world(tick_rate: u32) -> World {
    World::new(Config { tick_rate, ..Config::default() }).expect("valid")
}

/// Change of velocity by gravity in a tick, in m/s.
fn fall(tick_rate: u32) -> Fx {
    fx!(10) / i64::from(tick_rate)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Platform {
    /// A platform that changes its velocity at random times.
    Lift,
    /// A platform that `World::move_to` moves along an ellipse.
    Ellipse,
    /// A platform that turns to and fro about its middle.
    Turning,
    /// Nine plates, side by side, that move together.
    Train,
    /// A wheel that turns to and fro below the character.
    Wheel,
    /// A conveyor belt that moves like a lift.
    Belt,
}

const PLATFORMS: [Platform; 6] =
    [Platform::Lift, Platform::Ellipse, Platform::Turning, Platform::Train, Platform::Wheel, Platform::Belt];

struct Ride {
    world: World,
    bodies: Vec<BodyId>,
    platform: Platform,
    rng: Rng,
    velocity: Vec2<Fx>,
    /// Half-axes of the ellipse in metres.
    size: Vec2<Fx>,
    /// Turns per second along the ellipse, or swings per second of a turning platform or wheel.
    turns: Fx,
}

impl Ride {
    fn new(platform: Platform, tick_rate: u32, seed: u64) -> Self {
        let mut rng = Rng::with_stream(seed, u64::from(tick_rate));
        let mut world = world(tick_rate);
        let plate = |half: Fx| Polygon::rectangle(half, fx!(0.25)).expect("valid");
        let belt = rng.range(fx!(-3), fx!(3));
        let bodies = match platform {
            Platform::Train => (-4..=4).map(|i| (Fx::from_num(i), ShapeDef::new(plate(fx!(0.5))))).collect(),
            Platform::Wheel => vec![(fx!(0), ShapeDef::new(Geometry::circle(fx!(6)).expect("valid")))],
            Platform::Belt => vec![(fx!(0), ShapeDef::new(plate(fx!(90))).surface_speed(belt))],
            _ => vec![(fx!(0), ShapeDef::new(plate(fx!(5))))],
        };
        let spawn = |(x, shape): (Fx, ShapeDef)| {
            let top = if platform == Platform::Wheel { fx!(6) } else { fx!(0.25) };
            world.spawn(&BodyDef::kinematic().position((x, -top)), &[shape]).expect("valid")
        };
        let bodies: Vec<_> = bodies.into_iter().map(spawn).collect();
        let size = at(rng.range(fx!(0.5), fx!(4)), rng.range(fx!(0.5), fx!(4)));
        let turns = rng.range(fx!(0.05), fx!(0.3));
        Ride { world, bodies, platform, rng, velocity: Vec2::ZERO, size, turns }
    }

    fn drive(&mut self, tick: u32, tick_rate: u32) {
        let phase = Angle::from_turns(fx_mul(self.turns, Fx::from_num(tick) / i64::from(tick_rate)));
        if tick.is_multiple_of(tick_rate / 2) {
            self.velocity = at(self.rng.range(fx!(-5), fx!(5)), self.rng.range(fx!(-5), fx!(5)));
        }
        let (sin, cos) = (Fx::from(phase.sin()), Fx::from(phase.cos()));
        // The platform swings by at most 20 degrees to each side.
        let swing = fx_mul(fx_mul(fx!(0.349), fx_mul(self.turns, fx!(6.2832))), cos);
        let (velocity, spin) = match self.platform {
            Platform::Lift | Platform::Train | Platform::Belt => (self.velocity, fx!(0)),
            Platform::Turning | Platform::Wheel => (self.velocity.scale(fx!(0.2)), swing),
            Platform::Ellipse => {
                let place = at(fx_mul(self.size.x, sin), fx_mul(self.size.y, fx!(1) - cos) - fx!(0.25));
                return self.world.move_to(self.bodies[0], place, Angle::ZERO).expect("near");
            }
        };
        for &body in &self.bodies {
            self.world.set_velocity(body, velocity, spin).expect("kinematic");
        }
    }
}

/// The character walks to and fro near the middle of the platform.
fn ride((platform, (name, geometry), tick_rate, seed): (Platform, (&str, Geometry), u32, u64)) {
    let what = format!("{platform:?}, {name}, {tick_rate} Hz, seed {seed}");
    let mut ride = Ride::new(platform, tick_rate, seed);
    let mover = Mover::new(geometry).expect("valid").snap_distance(fx!(0.2));
    let mut state = MoverState::at(at(fx!(0), fx!(0.7002)));
    let mut walk = fx!(0);
    for tick in 0..tick_rate * 6 {
        if tick >= 2 {
            ride.drive(tick, tick_rate);
        }
        let moved_first = seed.is_multiple_of(2);
        if !moved_first {
            ride.world.step();
        }
        let middle = ride.world.body(ride.bodies[ride.bodies.len() / 2]).expect("there").position().x;
        if tick.is_multiple_of(tick_rate / 3) {
            walk = ride.rng.range(fx!(-3), fx!(3));
        }
        let away = state.position.x - middle;
        if away.abs() > fx!(0.8) && platform != Platform::Belt {
            walk = if away > 0 { -walk.abs() } else { walk.abs() };
        }
        state.velocity = at(walk, state.velocity.y - fall(tick_rate));
        state = ride.world.move_character(&mover, &state, QueryFilter::default()).state;
        assert!(state.is_on_ground(), "{what}: in the air at tick {tick}: {state:?}");
        let probe = mover.probe(state.position);
        let gaps = ride.world.shapes().map(|(id, _)| ride.world.probe_distance(&probe, id).expect("there"));
        let gap = gaps.map(|gap| gap.distance).min().expect("a platform");
        assert!((fx!(0)..fx!(0.0002)).contains(&gap), "{what}: {gap} m above at tick {tick}");
        if moved_first {
            ride.world.step();
        }
    }
}

#[test]
fn moving_ground_carries_every_character() {
    let mut cases = vec![];
    for seed in 0..100 {
        for platform in PLATFORMS {
            for shape in shapes() {
                cases.extend(RATES.map(|rate| (platform, shape, rate, seed)));
            }
        }
    }
    sweep::for_each(sweep::sample(cases, 59), ride);
}

#[test]
fn a_rider_at_rest_stays_where_it_is_on_its_lift() {
    for rate in RATES {
        for velocity in [at(fx!(5), fx!(3)), at(fx!(-5), fx!(-3)), at(fx!(0), fx!(4))] {
            let mut world = world(rate);
            let plate = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.5)).expect("valid"));
            let lift = BodyDef::kinematic().position((fx!(0), fx!(-0.5))).velocity(velocity);
            let lift = world.spawn(&lift, &[plate]).expect("valid");
            let mover = Mover::new(shapes()[0].1).expect("valid");
            let mut state = MoverState::at(at(fx!(1), fx!(0.7001)));
            state.velocity.y = -fall(rate);
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
            for _ in 0..rate * 3 {
                world.step();
                state.velocity.y -= fall(rate);
                state = world.move_character(&mover, &state, QueryFilter::default()).state;
                let from_lift = state.position - world.body(lift).expect("there").position();
                assert!((from_lift - at(fx!(1), fx!(1.2001))).length() < fx!(0.000002), "{from_lift:?}");
                let ground = state.ground.expect("a lift");
                // Displacements are rounded, so velocities have errors of up to 1 µm times the tick rate.
                let error = (ground.velocity - velocity).length();
                assert!(ground.body == lift && error < fx!(0.000001) * i64::from(rate), "{error}");
            }
            // A jump starts with the lift's velocity.
            world.step();
            state.velocity = at(fx!(1), fx!(6));
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
            let error = (state.velocity - velocity - at(fx!(1), fx!(6))).length();
            assert!(!state.is_on_ground() && error < fx!(0.000001) * i64::from(rate), "{error}");
        }
    }
}

#[test]
fn a_belt_carries_at_its_speed() {
    for rate in RATES {
        let mut world = world(rate);
        let belt = ShapeDef::new(Polygon::rectangle(fx!(90), fx!(1)).expect("valid")).surface_speed(fx!(2));
        world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[belt]).expect("valid");
        for (name, shape) in shapes() {
            let mover = Mover::new(shape).expect("valid");
            let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
            state.velocity.y = -fall(rate);
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
            let start = state.position;
            for _ in 0..rate * 2 {
                state.velocity.y -= fall(rate);
                state = world.move_character(&mover, &state, QueryFilter::default()).state;
            }
            assert!((state.position.x - start.x - fx!(4)).abs() < fx!(0.0001), "{name} {rate}: {state:?}");
            assert_eq!(state.velocity.x, fx!(0));
        }
    }
}

/// Corners of stairs and slopes between two walls.
fn level(rng: &mut Rng) -> Vec<Vec2<Fx>> {
    let mut points = vec![at(fx!(-3), fx!(4)), at(fx!(-3), fx!(0)), at(fx!(0), fx!(0))];
    let (mut x, mut y) = (fx!(0), fx!(0));
    for _ in 0..3 + rng.below(4) {
        let up = if rng.chance(1, 2) { fx!(1) } else { fx!(-1) };
        if rng.chance(1, 2) {
            let (height, depth) = (rng.range(fx!(0.05), fx!(0.28)), rng.range(fx!(0.4), fx!(1.2)));
            for _ in 0..1 + rng.below(6) {
                y += fx_mul(height, up);
                points.push(at(x, y));
                x += depth;
                points.push(at(x, y));
            }
        } else {
            let (run, slope) = (rng.range(fx!(0.5), fx!(4)), rng.range(fx!(0.02), fx!(0.8)));
            x += run;
            y += fx_mul(fx_mul(slope, run), up);
            points.push(at(x, y));
        }
        // A level stretch. Without it, a step would be higher than its nominal height for feet that are still on the
        // slope.
        x += rng.range(fx!(0.8), fx!(3));
        points.push(at(x, y));
    }
    points.push(at(x, y + fx!(4)));
    points
}

/// The character walks to the right wall and back.
fn run((shape, tick_rate, speed, seed): ((&str, Geometry), u32, Fx, u64)) {
    let (name, geometry) = shape;
    let mut rng = Rng::new(seed);
    let points = level(&mut rng);
    let what = format!("{name}, {tick_rate} Hz, {speed} m/s, seed {seed}");
    let mut world = world(tick_rate);
    let links = Chain::new(&points).links().expect("valid");
    world.spawn(&BodyDef::fixed(), &links).expect("valid");
    let mover = Mover::new(geometry).expect("valid").step_height(fx!(0.3)).snap_distance(fx!(0.3));
    let mut state = MoverState::at(at(fx!(-1.5), fx!(0.7001)));
    state = world.move_character(&mover, &state, QueryFilter::default()).state;
    let end = points[points.len() - 1].x;
    for (direction, wall) in [(fx!(1), end), (fx!(-1), fx!(-3))] {
        let way = fx_div(end + fx!(9), speed).expect("a speed");
        // The time is twice that of a level path, because climbing adds to the path.
        let ticks = (way * i64::from(tick_rate) * 2).to_num::<u32>();
        for tick in 0..ticks {
            state.velocity = at(fx_mul(direction, speed), state.velocity.y - fall(tick_rate));
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
            assert!(state.is_on_ground(), "{what}: in the air at tick {tick}: {state:?} {points:?}");
        }
        let away = (state.position.x - wall).abs();
        assert!(away < fx!(0.72), "{what}: {away} m before the wall: {state:?} {points:?}");
        let still = state;
        for _ in 0..tick_rate / 4 {
            state.velocity = at(fx_mul(direction, speed), state.velocity.y - fall(tick_rate));
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
        }
        let crept = state.position.distance(still.position);
        assert!(crept < fx!(0.0002), "{what}: moves by {crept} m at the wall: {still:?} {state:?}");
    }
}

#[test]
fn stairs_and_slopes_are_walked_without_hops() {
    let mut cases = vec![];
    for seed in 0..100 {
        for shape in shapes() {
            for rate in RATES {
                cases.extend([fx!(1.5), fx!(4), fx!(8)].map(|speed| (shape, rate, speed, seed)));
            }
        }
    }
    sweep::for_each(sweep::sample(cases, 41), run);
}

#[test]
fn a_run_up_a_slope_ends_at_the_wall() {
    for (name, shape) in shapes() {
        let mut world = world(60);
        let points = [at(fx!(-9), fx!(0)), at(fx!(0), fx!(0)), at(fx!(6), fx!(3.464)), at(fx!(6), fx!(20))];
        world.spawn(&BodyDef::fixed(), &Chain::new(&points).links().expect("valid")).expect("valid");
        let mover = Mover::new(shape).expect("valid").snap_distance(fx!(0.3));
        let mut state = MoverState::at(at(fx!(-2), fx!(0.7001)));
        let mut highest = Fx::MIN;
        for tick in 0..120 {
            state.velocity = at(fx!(15), state.velocity.y - fall(60));
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
            assert!(state.is_on_ground(), "{name}: in the air at tick {tick}: {state:?}");
            highest = highest.max(state.position.y);
        }
        assert!(state.position.y == highest && highest < fx!(4.3), "{name}: {state:?} {highest}");
        assert!(state.position.x > fx!(5.2), "{name}: {state:?}");
    }
}

/// Between slopes of 60 degrees a character is not on ground, and can jump out.
#[test]
fn a_character_in_a_steep_v_is_wedged_and_can_jump_out() {
    for rate in RATES {
        for (name, shape) in shapes() {
            let mut world = world(rate);
            let points = [(-9, 1), (-3, 1), (0, -4), (3, 1), (9, 1)]
                .map(|(x, y)| at(Fx::from_num(x), Fx::from_num(y)));
            world.spawn(&BodyDef::fixed(), &Chain::new(&points).links().expect("valid")).expect("valid");
            let mover = Mover::new(shape).expect("valid");
            let mut state = MoverState::at(at(fx!(0.3), fx!(1)));
            let mut wedged = 0;
            for tick in 0..rate * 4 {
                state.velocity.y -= fall(rate);
                let moved = world.move_character(&mover, &state, QueryFilter::default());
                state = moved.state;
                wedged = if moved.is_wedged() { wedged + 1 } else { 0 };
                assert!(!state.is_on_ground(), "{name}, {rate} Hz, tick {tick}: {state:?}");
            }
            assert!(wedged > rate, "{name}, {rate} Hz: wedged for {wedged} ticks at the end: {state:?}");
            state.velocity.y = fx!(12);
            let bottom = state.position.y;
            let mut highest = Fx::MIN;
            for _ in 0..rate * 2 {
                state.velocity = at(fx!(0), state.velocity.y - fall(rate));
                state = world.move_character(&mover, &state, QueryFilter::default()).state;
                highest = highest.max(state.position.y);
            }
            assert!(highest > bottom + fx!(6.5), "{name}, {rate} Hz: {bottom} to {highest}");
        }
    }
}
