//! Characters overlap no shape, do not fall through ground, and obey their settings.

use lockstep2d::body::{BodyDef, BodyId, Chain, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul};
use lockstep2d::world::{Mover, MoverState, QueryFilter, World};
use lockstep2d_scenes::Scene;

fn at(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

/// A capsule 1.4 m high, centred at the origin.
fn pill() -> Mover {
    let pill = Geometry::capsule(at(fx!(0), fx!(-0.4)), at(fx!(0), fx!(0.4)), fx!(0.3)).expect("valid");
    Mover::new(pill).expect("valid")
}

fn chain(points: &[(Fx, Fx)]) -> World {
    let points: Vec<_> = points.iter().map(|&(x, y)| at(x, y)).collect();
    let mut world = World::default();
    world.spawn(&BodyDef::fixed(), &Chain::new(&points).links().expect("valid")).expect("valid");
    world
}

/// Distance of a mover from the nearest shape.
fn clearance(world: &World, mover: &Mover, position: Vec2<Fx>) -> Fx {
    let probe = mover.probe(position);
    let distances = world.shapes().map(|(id, _)| world.probe_distance(&probe, id).expect("there").distance);
    distances.min().expect("a level")
}

/// Walks at `speed` m/s under gravity (10 m/s² at 60 ticks a second), and returns the state after each tick. Expects
/// that the mover touches no shape.
fn walk(world: &World, mover: &Mover, from: MoverState, speed: Fx, ticks: u32) -> Vec<MoverState> {
    let mut state = from;
    let step = |_| {
        state.velocity = at(speed, state.velocity.y - fx!(1 / 6));
        state = world.move_character(mover, &state, QueryFilter::default()).state;
        let gap = clearance(world, mover, state.position);
        assert!(gap > fx!(0.00009), "{gap} at {state:?}");
        state
    };
    (0..ticks).map(step).collect()
}

#[test]
fn the_character_of_the_scene_enters_nothing() {
    let scene = Scene::find("character").expect("a scene");
    let mut game = Sandbox::new(&scene.setup(1)).expect("valid");
    let id = game.world().bodies().next().expect("the character").0;
    let (mut least, mut way, mut highest) = (Fx::MAX, (Fx::MAX, Fx::MIN), Fx::MIN);
    let mut trace = vec![];
    for tick in 0..scene.ticks {
        let commands = scene.commands(tick, &game);
        game.step(&[commands]);
        let world = game.world();
        let own = world.body(id).expect("there").shapes()[0];
        let others = world.shapes().filter(|(shape, _)| *shape != own);
        let gap = others.map(|(other, _)| world.distance(own, other).expect("there").distance).min();
        least = least.min(gap.expect("a level"));
        let position = world.body(id).expect("there").position();
        way = (way.0.min(position.x), way.1.max(position.x));
        highest = highest.max(position.y);
        trace.push(position);
    }
    assert_eq!(game.refused(), 0);
    assert!(least > fx!(0.00005), "{least}");
    // The character has reached the left wall, and has jumped past the foot of the steep slope, which is at 20 m.
    assert!((way.0 - fx!(-9.7)).abs() < fx!(0.001), "{way:?}");
    assert!(way.1 > fx!(19.7) && way.1 < fx!(20.6), "{way:?}");
    assert!(trace[595].y < trace[560].y - fx!(0.1), "expected the character to slide down: {:?}", trace[595]);
    // The character has climbed the steps again.
    assert!(trace[870].x < fx!(5), "{:?}", trace[870]);
}

/// The dynamic character stands, jumps, pushes the first crate, and reaches the upper floor.
#[test]
fn the_character_on_a_spring_leg_gets_about() {
    let scene = Scene::find("spring_leg").expect("a scene");
    let mut game = Sandbox::new(&scene.setup(1)).expect("valid");
    let ids: Vec<_> = game.world().bodies().map(|(id, _)| id).collect();
    let crates_at = |game: &Sandbox| game.world().body(ids[3]).expect("there").position().x;
    let (mut trace, mut pushed) = (vec![], Fx::MIN);
    for tick in 0..scene.ticks {
        let commands = scene.commands(tick, &game);
        game.step(&[commands]);
        pushed = pushed.max(crates_at(&game));
        trace.push(game.world().body(ids[0]).expect("there").position());
    }
    assert_eq!(game.refused(), 0);
    // At rest the origin of the body is 0.8 m above the ground: the centre of mass is at 0.9 m, and the origin is 0.1 m
    // below it.
    let rest = trace[25];
    assert!((rest.y - fx!(0.8)).abs() < fx!(0.005), "at rest above the floor: {rest:?}");
    let jump = trace[30..60].iter().map(|place| place.y).max().expect("some");
    // A jump at 5.5 m/s rises by 1.5 m from 0.8 m. The spring leg changes this a little.
    assert!((fx!(2.1)..fx!(2.5)).contains(&jump), "{jump}");
    assert!(pushed > fx!(10.5), "the first crate is pushed: {pushed}");
    let furthest = trace.iter().max_by_key(|place| place.x).expect("some");
    assert!(
        furthest.x > fx!(20) && (furthest.y - fx!(2.8)).abs() < fx!(0.1),
        "the upper floor: {furthest:?}"
    );
}

#[test]
fn slopes_up_to_the_limit_are_ground_and_steeper_ones_are_walls() {
    for degrees in [10, 30, 44, 45, 46, 60, 80] {
        let angle = Angle::from_degrees(Fx::from_num(degrees));
        let top = Rot::from_angle(angle).apply_wide(at(fx!(20), fx!(0)));
        let world = chain(&[(fx!(-20), fx!(0)), (fx!(0), fx!(0)), (top.x, top.y)]);
        let mover = pill().snap_distance(fx!(0.2));
        let start = MoverState::at(at(fx!(-3), fx!(0.7)));
        let states = walk(&world, &mover, start, fx!(3), 180);
        let end = states[179];
        assert!(end.is_on_ground(), "{degrees}: {end:?}");
        if degrees <= 45 {
            // The character walks 3 m on the level and then 6 m up the slope, a little less because its round foot cuts
            // the corner at the bottom.
            let up = end.position.y - fx!(0.7);
            let expected = fx_mul(fx!(6), Fx::from_num(angle.sin()));
            assert!((up - expected).abs() < fx!(0.3), "{degrees}: {up} {expected}");
            // The character stands without sliding, and walks down without leaving the ground.
            let still = walk(&world, &mover, end, fx!(0), 120)[119];
            assert!(still.position.distance(end.position) < fx!(0.0005), "{degrees}: {still:?} {end:?}");
            let down = walk(&world, &mover, still, fx!(-3), 120);
            assert!(down.iter().all(MoverState::is_on_ground), "{degrees}");
        } else {
            assert!(end.position.y < fx!(0.72), "{degrees}: {end:?}");
            // Placed on the slope, the character slides down.
            let middle = at(top.x / 2, top.y / 2) + Rot::from_angle(angle).apply_wide(at(fx!(0), fx!(0.71)));
            let mut state = MoverState::at(middle);
            for _ in 0..60 {
                state.velocity.y -= fx!(1 / 6);
                state = world.move_character(&mover, &state, QueryFilter::default()).state;
            }
            // The character slides without friction, so its downward acceleration is `g sin²` of the slope's angle.
            let sin = Fx::from_num(angle.sin());
            let expected = fx_mul(fx!(5), fx_mul(sin, sin));
            let fallen = middle.y - state.position.y;
            assert!((fallen - expected).abs() < fx!(0.6), "{degrees}: {fallen} {expected}");
        }
    }
}

#[test]
fn steps_are_taken_up_to_their_height() {
    let mut points = vec![(fx!(-20), fx!(0))];
    let (mut x, mut y) = (fx!(0), fx!(0));
    for _ in 0..10 {
        points.extend([(x, y), (x, y + fx!(0.25))]);
        (x, y) = (x + fx!(0.5), y + fx!(0.25));
    }
    points.push((fx!(200), y));
    let world = chain(&points);
    let box_mover = Mover::new(Polygon::rectangle(fx!(0.3), fx!(0.7)).expect("valid")).expect("valid");
    for (mover, what) in [(pill(), "pill"), (box_mover, "box")] {
        for speed in [fx!(0.5), fx!(2), fx!(8)] {
            let start = MoverState::at(at(fx!(-1), fx!(0.71)));
            let ticks = 120 + (fx!(480) / speed).to_num::<u32>();
            let high =
                walk(&world, &mover.step_height(fx!(0.26)).snap_distance(fx!(0.3)), start, speed, ticks);
            let end = high[high.len() - 1];
            assert!(end.position.y > fx!(3.19), "{what} at {speed}: {end:?}");
            let low = walk(&world, &mover.step_height(fx!(0.24)), start, speed, ticks);
            assert!(low[low.len() - 1].position.y < fx!(0.75), "{what} at {speed}: {:?}", low[low.len() - 1]);
            // On the way down, a box leaves the edge of each step before it falls to the next, so it is off the ground
            // in some ticks.
            let down =
                walk(&world, &mover.step_height(fx!(0.26)).snap_distance(fx!(0.3)), end, -speed, ticks);
            assert!(down[down.len() - 1].position.y < fx!(0.71), "{what} at {speed}");
            let flying = down.iter().filter(|state| !state.is_on_ground()).count();
            assert!(flying == 0 || what == "box" && flying < down.len() / 4, "{what} at {speed}: {flying}");
        }
    }
}

#[test]
fn a_flat_chain_is_walked_without_a_bump() {
    let points: Vec<_> = (0..=100).map(|i| (Fx::from_num(i) / 5, fx!(0))).collect();
    let world = chain(&points);
    let states = walk(&world, &pill(), MoverState::at(at(fx!(1), fx!(0.7001))), fx!(5), 200);
    for (tick, state) in states.iter().enumerate() {
        assert!((state.position.y - fx!(0.7001)).abs() < fx!(0.000005), "{tick}: {state:?}");
        let expected = fx!(1) + Fx::from_num(tick + 1) / 12;
        assert!((state.position.x - expected).abs() < fx!(0.0001), "{tick}: {state:?} {expected}");
    }
}

#[test]
fn jumps_end_at_ceilings_and_pass_platforms_from_below() {
    let mut world = chain(&[(fx!(-20), fx!(0)), (fx!(20), fx!(0))]);
    let platform = [at(fx!(2), fx!(1.5)), at(fx!(-2), fx!(1.5))];
    let links = Chain::new(&platform).one_sided().links().expect("valid");
    world.spawn(&BodyDef::fixed(), &links).expect("valid");
    let ceiling = ShapeDef::new(Polygon::rectangle(fx!(3), fx!(0.5)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(5))), &[ceiling]).expect("valid");
    let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
    state.velocity.y = fx!(12);
    let mut highest = Fx::MIN;
    for tick in 0..200 {
        state.velocity.y -= fx!(1 / 6);
        state = world.move_character(&pill(), &state, QueryFilter::default()).state;
        highest = highest.max(state.position.y);
        assert!(
            highest < fx!(3.7998) || state.velocity.y <= 0,
            "tick {tick}: expected the ceiling to stop the jump"
        );
    }
    assert!((highest - fx!(3.7999)).abs() < fx!(0.0001), "{highest}");
    assert!(state.is_on_ground() && (state.position.y - fx!(2.2001)).abs() < fx!(0.00001), "{state:?}");
}

#[test]
fn one_way_shapes_are_jumped_through_and_stood_upon() {
    let mut world = chain(&[(fx!(-20), fx!(0)), (fx!(20), fx!(0))]);
    let slab = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.25)).expect("valid")).one_way(Angle::QUARTER);
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(1.5))), &[slab]).expect("valid");
    let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
    // At 3 m/s, the jump ends inside the slab and the character falls back to the chain.
    for (speed, end) in [(fx!(3), fx!(0.7001)), (fx!(8), fx!(2.4501))] {
        state.velocity.y = speed;
        for _ in 0..150 {
            state.velocity.y -= fx!(1 / 6);
            state = world.move_character(&pill(), &state, QueryFilter::default()).state;
        }
        assert!(state.is_on_ground() && (state.position.y - end).abs() < fx!(0.00001), "{state:?}");
    }
}

/// Random walks through random levels.
#[test]
fn random_walks_enter_nothing() {
    let mut rng = Rng::new(3);
    let mut least = Fx::MAX;
    let mut met = 0;
    for _ in 0..60 {
        let mut world = World::default();
        let walls: [(Fx, Fx, Fx, Fx); 4] = [
            (fx!(0), fx!(-11), fx!(12), fx!(1)),
            (fx!(0), fx!(11), fx!(12), fx!(1)),
            (fx!(-11), fx!(0), fx!(1), fx!(12)),
            (fx!(11), fx!(0), fx!(1), fx!(12)),
        ];
        for (x, y, w, h) in walls {
            let wall = ShapeDef::new(Polygon::rectangle(w, h).expect("valid"));
            world.spawn(&BodyDef::fixed().position((x, y)), &[wall]).expect("valid");
        }
        for _ in 0..30 {
            let def = BodyDef::fixed().position((rng.range(fx!(-10), fx!(10)), rng.range(fx!(-10), fx!(10))));
            let shape = random_shape(&mut rng);
            world.spawn(&def.angle(rng.angle()), &[ShapeDef::new(shape)]).expect("valid");
        }
        let mover = pill().step_height(rng.range(fx!(0), fx!(0.5))).snap_distance(fx!(0.2));
        let mut position = at(fx!(0), fx!(0));
        while clearance(&world, &mover, position) < fx!(0.0001) {
            position = at(rng.range(fx!(-9), fx!(9)), rng.range(fx!(-9), fx!(9)));
        }
        let mut state = MoverState::at(position);
        let mut speed = fx!(0);
        for tick in 0..600 {
            if tick % 40 == 0 {
                speed = rng.range(fx!(-30), fx!(30));
                state.velocity.y = rng.range(fx!(-10), fx!(30));
            }
            state.velocity = at(speed, state.velocity.y - fx!(1 / 6));
            let moved = world.move_character(&mover, &state, QueryFilter::default());
            met += moved.met.len();
            state = moved.state;
            least = least.min(clearance(&world, &mover, state.position));
            assert!(least > fx!(0.00009), "{least}: {state:?} at {tick}");
        }
    }
    assert!(met > 20_000, "{met}");
}

fn random_shape(rng: &mut Rng) -> Geometry {
    let end = at(rng.range(fx!(0.1), fx!(2)), rng.range(fx!(-1), fx!(1)));
    match rng.below(4) {
        0 => Geometry::circle(rng.range(fx!(0.1), fx!(1))).expect("valid"),
        1 => Geometry::segment(-end, end).expect("valid"),
        2 => Geometry::capsule(-end, end, fx!(0.2)).expect("valid"),
        _ => Polygon::rectangle(end.x, fx!(0.5)).expect("valid").into(),
    }
}

/// A shape that moves into a character pushes the character out.
#[test]
fn a_lift_that_comes_up_takes_the_character_along() {
    let mut world = chain(&[(fx!(-20), fx!(0)), (fx!(20), fx!(0))]);
    let plate = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.5)).expect("valid"));
    let lift: BodyId =
        world.spawn(&BodyDef::kinematic().position((fx!(0), fx!(-0.5))), &[plate]).expect("valid");
    let mover = pill();
    let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
    for tick in 1..=120_i64 {
        let height = Fx::from_num(tick) / 60;
        world.move_to(lift, at(fx!(0), height - fx!(0.5)), Angle::ZERO).expect("near");
        world.step();
        state.velocity.y -= fx!(1 / 6);
        state = world.move_character(&mover, &state, QueryFilter::default()).state;
        assert!((state.position.y - height - fx!(0.7001)).abs() < fx!(0.00001), "{tick}: {state:?}");
        assert!(state.is_on_ground(), "{tick}");
    }
}

/// A rider need not be moved in every tick: the next move carries it by the whole displacement of the platform since
/// the last one. A jump then starts with the velocity of the platform.
#[test]
fn a_rider_that_was_not_moved_for_some_ticks_keeps_the_speed_of_the_platform() {
    for (waits, teleport) in [(0, None), (1, None), (29, None), (0, Some(fx!(-20)))] {
        let mut world = World::default();
        let slab = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.5)).expect("valid"));
        let platform = BodyDef::kinematic().position((fx!(0), fx!(-0.5))).velocity((fx!(3), fx!(0)));
        let platform = world.spawn(&platform, &[slab]).expect("valid");
        let mut state = MoverState::at(at(fx!(0), fx!(0.71)));
        for _ in 0..5 {
            world.step();
            state.velocity.y = fx!(-1);
            state = world.move_character(&pill(), &state, QueryFilter::default()).state;
        }
        assert!(state.is_on_ground(), "{state:?}");
        for _ in 0..=waits {
            world.step();
        }
        if let Some(x) = teleport {
            world.set_transform(platform, (x, fx!(-0.5)), Angle::ZERO).expect("there");
        }
        state.velocity = at(fx!(0), fx!(5));
        let jumped = world.move_character(&pill(), &state, QueryFilter::default()).state;
        assert_eq!(jumped.velocity, at(fx!(3), fx!(5)), "{waits} ticks, to {teleport:?}");
    }
}

#[test]
fn extreme_characters_do_not_panic() {
    let world = chain(&[(fx!(-20), fx!(0)), (fx!(20), fx!(0))]);
    let extremes = [Fx::MIN, Fx::MAX, fx!(0), fx!(1073741824), -Fx::DELTA];
    for x in extremes {
        for y in extremes {
            for speed in extremes {
                let mover = pill().step_height(speed).snap_distance(x);
                let state = MoverState { velocity: at(speed, y), ..MoverState::at(at(x, y)) };
                let moved = world.move_character(&mover, &state, QueryFilter::default());
                let again = world.move_character(&mover, &moved.state, QueryFilter::default());
                let _ = (moved, again);
            }
        }
    }
}
