//! Walls that hang over a floor, and steps below ceilings.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Mover, MoverState, QueryFilter, World};

use super::{RATES, at, fall, shapes, world};

/// A character that walks against an obstacle which hangs lower than the character's head stays on the floor. If the
/// floor under the overhang counted as a step, the character would hop by `v / tick_rate` for ever.
#[test]
fn a_character_does_not_climb_what_hangs_over_its_floor() {
    let undersides = [fx!(0.05), fx!(0.35), fx!(0.5), fx!(0.9), fx!(1.2)];
    let cases = shapes().into_iter().flat_map(|shape| undersides.map(|underside| (shape, underside)));
    for ((name, shape), underside) in cases {
        for (tick_rate, speed) in RATES.into_iter().flat_map(|rate| [2, 4, 8].map(|speed| (rate, speed))) {
            let mut world = world(tick_rate);
            block(&mut world, at(fx!(0), fx!(-1)), at(fx!(50), fx!(1)));
            block(&mut world, at(fx!(4), underside + fx!(0.2)), at(fx!(2), fx!(0.2)));
            let mover = Mover::new(shape).expect("valid").step_height(fx!(0.3)).snap_distance(fx!(0.3));
            let mut state = MoverState::at(at(fx!(0), fx!(0.7)));
            for tick in 0..2 * tick_rate {
                world.step();
                state.velocity = at(Fx::from(speed), state.velocity.y - fall(tick_rate));
                state = world.move_character(&mover, &state, QueryFilter::default()).state;
                let feet = state.position.y - fx!(0.7);
                let case =
                    format!("{name} at {speed} m/s, {tick_rate} Hz, underside {underside} m, tick {tick}");
                assert!(feet < fx!(0.001) && state.position.x < fx!(4), "{case}: the feet are at {feet} m");
            }
        }
    }
}

/// A step is like a wall if the character does not fit between the step and the ceiling.
#[test]
fn a_character_does_not_climb_a_step_without_headroom() {
    for ((name, shape), tick_rate) in shapes().into_iter().flat_map(|shape| RATES.map(|rate| (shape, rate))) {
        for (height, room) in [(fx!(0.1), false), (fx!(0.25), false), (fx!(0.1), true), (fx!(0.25), true)] {
            // The ball is left out, because its widest part meets the ceiling before the step.
            if name == "ball" {
                continue;
            }
            let mut world = world(tick_rate);
            // A box climbs above the step by up to its displacement in a tick, so it needs more room than its height.
            let ceiling = height + if room { fx!(1.6) } else { fx!(1.35) };
            block(&mut world, at(fx!(0), fx!(-1)), at(fx!(50), fx!(1)));
            block(&mut world, at(fx!(7), height / 2), at(fx!(2), height / 2));
            block(&mut world, at(fx!(7), ceiling + fx!(1)), at(fx!(2), fx!(1)));
            let mover = Mover::new(shape).expect("valid").step_height(fx!(0.3)).snap_distance(fx!(0.3));
            let mut state = MoverState::at(at(fx!(3), fx!(0.7)));
            let mut highest = fx!(0);
            for _ in 0..2 * tick_rate {
                world.step();
                state.velocity = at(fx!(4), state.velocity.y - fall(tick_rate));
                state = world.move_character(&mover, &state, QueryFilter::default()).state;
                highest = highest.max(state.position.y - fx!(0.7));
            }
            let case =
                format!("{name}, {tick_rate} Hz, step of {height} m, ceiling at {ceiling} m: {highest} m");
            assert!(room || highest < height + fx!(0.002), "{case}");
            assert!(state.is_on_ground(), "{case}");
            assert_eq!(state.position.x > fx!(5.5), room, "{case}, {:?}", state.position);
        }
    }
}

fn block(world: &mut World, centre: Vec2<Fx>, half: Vec2<Fx>) {
    let shape = ShapeDef::new(Polygon::rectangle(half.x, half.y).expect("valid"));
    world.spawn(&BodyDef::fixed().position(centre), &[shape]).expect("valid");
}

/// The geometry of this character is 2 m beside its position. A wall between position and geometry does not hinder a
/// step.
#[test]
fn a_character_beside_its_position_climbs_steps() {
    let mut world = world(60);
    block(&mut world, at(fx!(0), fx!(-1)), at(fx!(50), fx!(1)));
    block(&mut world, at(fx!(0.75), fx!(1.5)), at(fx!(0.25), fx!(1.5)));
    block(&mut world, at(fx!(8), fx!(0)), at(fx!(5), fx!(0.2)));
    let beside = at(fx!(2), fx!(0.7));
    let pill = Geometry::capsule(beside - at(fx!(0), fx!(0.4)), beside + at(fx!(0), fx!(0.4)), fx!(0.3));
    let mover = Mover::new(pill.expect("valid")).expect("valid").step_height(fx!(0.3));
    let mut state = MoverState::at(at(fx!(0.2), fx!(0.0001)));
    for _ in 0..60 {
        state.velocity = at(fx!(2), state.velocity.y - fall(60));
        state = world.move_character(&mover, &state, QueryFilter::default()).state;
    }
    assert!(state.is_on_ground() && (state.position.y - fx!(0.2001)).abs() < fx!(0.0001), "{state:?}");
}
