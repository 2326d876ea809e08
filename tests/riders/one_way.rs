//! Characters on ground that is solid from one side only and that rises, turns or bends.

use lockstep2d::body::{BodyDef, BodyId, Chain, Filter, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{Mover, MoverState, QueryFilter, World};

use super::{RATES, at, fall, shapes, world};

const LENGTH: Fx = fx!(2);

/// One-way and one-sided platforms with their tops at height 0.
fn platforms() -> [Vec<ShapeDef>; 2] {
    let slab = Polygon::rectangle(LENGTH, fx!(0.1)).expect("valid");
    let slab = ShapeDef::new(slab).offset((fx!(0), fx!(-0.1))).one_way(Angle::QUARTER);
    let ends = [at(LENGTH, fx!(0)), at(-LENGTH, fx!(0))];
    [vec![slab], Chain::new(&ends).one_sided().links().expect("valid")]
}

/// Steps the world, in which the platform rises by `platform.1` metres, and moves the character.
fn tick(world: &mut World, platform: (BodyId, Fx), mover: &Mover, state: &MoverState) -> MoverState {
    let rate = world.config().tick_rate;
    if platform.1 != 0 {
        let y = world.body(platform.0).expect("there").position().y;
        world.move_to(platform.0, at(fx!(0), y + platform.1), Angle::ZERO).expect("valid");
    }
    world.step();
    let velocity = state.velocity - Vec2::new(fx!(0), fall(rate));
    world.move_character(mover, &MoverState { velocity, ..*state }, QueryFilter::default()).state
}

fn feet(state: &MoverState) -> Fx {
    state.position.y - fx!(0.7)
}

/// Characters that start 4 to 33 cm above a platform which rises by up to 10 cm in a tick land on it and stay on it.
#[test]
fn characters_land_on_rising_platforms() {
    for ((name, shape), platform) in shapes().into_iter().flat_map(|shape| platforms().map(|p| (shape, p))) {
        for (rise, moves) in [(fx!(0.02), true), (fx!(0.1), true), (fx!(0.05), false)] {
            for start in 1..10 {
                let mut world = world(60);
                let speed = if moves { fx!(0) } else { rise * 60 };
                let def = BodyDef::kinematic().velocity((fx!(0), speed));
                let body = world.spawn(&def, &platform).expect("valid");
                let mover = Mover::new(shape).expect("valid");
                let mut state = MoverState::at(at(fx!(0.1), fx!(0.7) + fx!(0.037) * start));
                for number in 0..60 {
                    let rise = if moves { rise } else { fx!(0) };
                    state = tick(&mut world, (body, rise), &mover, &state);
                    let above = feet(&state) - world.body(body).expect("there").position().y;
                    let case = format!("{name}, {rise} m a tick, start {start}, tick {number}");
                    assert!(above >= 0, "{case}: the feet are {above} m above the platform");
                }
                assert!(state.is_on_ground(), "{name}, {rise} m a tick, start {start}");
            }
        }
    }
}

#[test]
fn characters_stay_on_planks_that_turn() {
    for ((name, shape), platform) in shapes().into_iter().flat_map(|shape| platforms().map(|p| (shape, p))) {
        for (rate, spin) in RATES.into_iter().flat_map(|rate| [fx!(0.5), fx!(-0.5)].map(|spin| (rate, spin)))
        {
            let mut world = world(rate);
            let def = BodyDef::kinematic().angular_velocity(spin);
            let body = world.spawn(&def, &platform).expect("valid");
            let mover = Mover::new(shape).expect("valid");
            let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
            // The plank turns by 40 degrees. Slopes up to 45 degrees are ground.
            for number in 0..rate * 14 / 10 {
                state = tick(&mut world, (body, fx!(0)), &mover, &state);
                let case = format!("{name}, {rate} Hz, {spin} rad/s, tick {number}");
                assert!(state.is_on_ground() || number < 2, "{case}: {state:?}");
            }
        }
    }
}

/// At each vertex of the valley, the ground turns by only 1e-4 rad. A cast stops at a small gap from the ground, and at
/// first the next link rises by less than this gap.
#[test]
fn characters_walk_through_flat_valleys() {
    let height = |x: Fx| x * x / 2000;
    let points: Vec<_> = (-500..=500).rev().map(|i| Fx::from_num(i) / 10).map(|x| at(x, height(x))).collect();
    for (name, shape) in shapes() {
        let mut world = world(60);
        let links = Chain::new(&points).one_sided().links().expect("valid");
        world.spawn(&BodyDef::fixed(), &links).expect("valid");
        let mover = Mover::new(shape).expect("valid");
        let mut state = MoverState::at(at(fx!(0), fx!(0.75)));
        for number in 0..1800 {
            world.step();
            state.velocity = at(fx!(1), state.velocity.y - fall(60));
            state = world.move_character(&mover, &state, QueryFilter::default()).state;
            let above = feet(&state) - height(state.position.x);
            assert!(above > fx!(-0.005), "{name}, tick {number}: {above} m at {}", state.position.x);
        }
        assert!(state.position.x > fx!(25), "{name}: {state:?}");
    }
}

/// The highest points of the jumps are below, inside and above the platform. A character falls back if its feet do not
/// rise above the top of the platform. Its state is encoded and decoded in every tick.
#[test]
fn characters_turn_round_inside_platforms() {
    for ((name, shape), platform) in shapes().into_iter().flat_map(|shape| platforms().map(|p| (shape, p))) {
        for speed in 10..60 {
            let mut world = world(60);
            let body = world.spawn(&BodyDef::fixed(), &platform).expect("valid");
            let mover = Mover::new(shape).expect("valid");
            let speed = Fx::from_num(speed) / 8;
            // The head begins 10 cm below the platform.
            let mut state = MoverState::at(at(fx!(0.1), fx!(-1)));
            state.velocity.y = speed;
            let mut highest = Fx::MIN;
            let mut last = state.position.y;
            for _ in 0..120 {
                let mut next = tick(&mut world, (body, fx!(0)), &mover, &state);
                // No platform throws the character up.
                assert!(
                    next.position.y - last <= speed / 60,
                    "{name} at {speed} m/s: from {last} to {next:?}"
                );
                next = lockstep2d::codec::decode(&lockstep2d::codec::encode(&next)).expect("its own bytes");
                (last, state) = (next.position.y, next);
                highest = highest.max(feet(&state));
            }
            let lands = highest > 0;
            assert_eq!(state.is_on_ground(), lands, "{name} at {speed} m/s: highest at {highest}, {state:?}");
        }
    }
}

/// A mask that leaves the platform out for a few ticks lets the character drop through it.
#[test]
fn characters_drop_through_platforms() {
    for ((name, shape), platform) in shapes().into_iter().flat_map(|shape| platforms().map(|p| (shape, p))) {
        for masked in [4, 10, 20] {
            let mut world = world(60);
            let dropped =
                platform.iter().map(|part| part.filter(Filter { category: 2, ..Filter::default() }));
            world.spawn(&BodyDef::fixed(), &dropped.collect::<Vec<_>>()).expect("valid");
            let mover = Mover::new(shape).expect("valid");
            let mut state = MoverState::at(at(fx!(0.1), fx!(0.7001)));
            for number in 0..60 {
                world.step();
                let mask = if number < masked { !2 } else { u64::MAX };
                let velocity = state.velocity - Vec2::new(fx!(0), fall(60));
                let filter = QueryFilter { mask, ..QueryFilter::default() };
                state = world.move_character(&mover, &MoverState { velocity, ..state }, filter).state;
            }
            assert!(feet(&state) < fx!(-2), "{name}, masked for {masked} ticks: {state:?}");
        }
    }
}

/// A character whose chest is inside a one-way ledge is lifted by a platform that comes up through the floor. The
/// character passes through the ledge, but not through the platform.
#[test]
fn characters_inside_a_ledge_are_lifted_by_platforms() {
    for ((name, shape), platform) in shapes().into_iter().flat_map(|shape| platforms().map(|p| (shape, p))) {
        for (rise, masked) in [(fx!(0.025), false), (fx!(0.025), true), (fx!(0.08), false)] {
            let mut world = world(60);
            let block = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(1)).expect("valid"));
            world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[block]).expect("valid");
            let ledge = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.1)).expect("valid"));
            let category = if masked { 2 } else { 1 };
            let ledge = ledge.one_way(Angle::QUARTER).filter(Filter { category, ..Filter::default() });
            world.spawn(&BodyDef::fixed().position((fx!(0), fx!(1))), &[ledge]).expect("valid");
            let lift = BodyDef::kinematic().position((fx!(0), fx!(-0.21)));
            let lift = world.spawn(&lift, &platform).expect("valid");
            let mover = Mover::new(shape).expect("valid");
            let filter = QueryFilter { mask: if masked { !2 } else { u64::MAX }, ..QueryFilter::default() };
            // The character has jumped into the ledge from below.
            let mut state = MoverState::at(at(fx!(0.1), fx!(-0.7999)));
            let jump = MoverState { velocity: at(fx!(0), fx!(90)), ..state };
            let inside = QueryFilter { mask: 0, ..filter };
            state = world.move_character(&mover, &jump, inside).state;
            state.velocity = Vec2::ZERO;
            for number in 0..60 {
                let place = world.body(lift).expect("there").position();
                world.move_to(lift, place + at(fx!(0), rise), Angle::ZERO).expect("near");
                world.step();
                let velocity = at(fx!(0), state.velocity.y - fall(60));
                state = world.move_character(&mover, &MoverState { velocity, ..state }, filter).state;
                let case = format!("{name}, {rise} m a tick, masked: {masked}, tick {number}: {state:?}");
                let top = world.body(lift).expect("there").position().y.max(fx!(0));
                let above = feet(&state) - top;
                assert!((fx!(0)..fx!(0.001)).contains(&above), "{case}: {above} m above");
            }
        }
    }
}

/// A lift passes fixed one-way floors. A character that jumps on it lands on it, also inside a floor.
#[test]
fn characters_that_jump_on_a_lift_stay_on_it_among_one_way_floors() {
    for ((name, shape), platform) in shapes().into_iter().flat_map(|shape| platforms().map(|p| (shape, p))) {
        let mut world = world(60);
        for level in 1..20 {
            let height = Fx::from_num(level) * 4 / 5;
            world.spawn(&BodyDef::fixed().position((fx!(0), height)), &platforms()[0]).expect("valid");
        }
        let lift = BodyDef::kinematic().velocity((fx!(0), fx!(1.5)));
        let lift = world.spawn(&lift, &platform).expect("valid");
        let mover = Mover::new(shape).expect("valid");
        let mut state = MoverState::at(at(fx!(0.1), fx!(0.7001)));
        for number in 0..480 {
            if number % 40 == 20 && state.is_on_ground() {
                state.velocity.y = fx!(1);
            }
            state = tick(&mut world, (lift, fx!(0)), &mover, &state);
            let above = feet(&state) - world.body(lift).expect("there").position().y;
            let case = format!("{name}, tick {number}: {state:?}");
            assert!(above >= 0, "{case}: {above} m above the lift");
        }
    }
}

/// A character that turns round inside a one-sided chain falls back through it while it moves along the chain.
#[test]
fn characters_fall_back_through_chains_that_they_run_along() {
    let points: Vec<_> = (-100..=100).rev().map(|i| at(Fx::from_num(i) / 5, fx!(0))).collect();
    let links = Chain::new(&points).one_sided().links().expect("valid");
    for (name, shape) in shapes() {
        // A character at 8 m/s comes to a new link within every two ticks.
        for (speed, jump) in
            [fx!(3), fx!(-8)].into_iter().flat_map(|speed| (10..40).map(move |jump| (speed, jump)))
        {
            let mut world = world(60);
            let chain = world.spawn(&BodyDef::fixed(), &links).expect("valid");
            let mover = Mover::new(shape).expect("valid");
            let mut state = MoverState::at(at(fx!(0.1), fx!(-1)));
            state.velocity.y = Fx::from_num(jump) / 8;
            let mut highest = Fx::MIN;
            for number in 0..90 {
                state.velocity.x = speed;
                let from = state.position.x;
                state = tick(&mut world, (chain, fx!(0)), &mover, &state);
                let moved = state.position.x - from;
                let case = format!("{name}, {speed} m/s, jump {jump}, tick {number}: {state:?}");
                assert!((moved - speed / 60).abs() < fx!(0.001), "{case}: moved by {moved} m");
                highest = highest.max(feet(&state));
            }
            assert_eq!(state.is_on_ground(), highest > 0, "{name}, {speed} m/s, jump {jump}: {state:?}");
        }
    }
}
