//! Landings on moving platforms and near edges.

use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx};
use lockstep2d::world::{Mover, MoverState, QueryFilter};

use super::{RATES, at, fall, shapes, world};

/// A character that jumps straight up on a platform lands at rest on the platform, whether the platform has a velocity
/// or `World::move_to` moves it.
#[test]
fn a_jump_in_a_train_ends_at_rest_in_the_train() {
    for ((name, shape), rate) in shapes().into_iter().flat_map(|shape| RATES.map(|rate| (shape, rate))) {
        for (speed, by_target) in
            [fx!(5), fx!(-3)].into_iter().flat_map(|speed| [(speed, false), (speed, true)])
        {
            let case = format!("{name}, {rate} Hz, {speed} m/s, moved to a target: {by_target}");
            let mut world = world(rate);
            let train = BodyDef::kinematic().position((fx!(0), fx!(-0.5)));
            let train = if by_target { train } else { train.velocity((speed, fx!(0))) };
            let plate = ShapeDef::new(Polygon::rectangle(fx!(3), fx!(0.5)).expect("valid"));
            let train = world.spawn(&train, &[plate]).expect("valid");
            let mover = Mover::new(shape).expect("valid");
            let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
            let mut on_train = fx!(0);
            for tick in 0..2 * rate {
                if by_target {
                    let place = world.body(train).expect("there").position();
                    world
                        .move_to(train, place + at(speed / i64::from(rate), fx!(0)), Angle::ZERO)
                        .expect("near");
                }
                world.step();
                let jumps = tick == 5;
                state.velocity.y = if jumps { fx!(5) } else { state.velocity.y - fall(rate) };
                state = world.move_character(&mover, &state, QueryFilter::default()).state;
                let from_train = state.position.x - world.body(train).expect("there").position().x;
                // At the start, the character is at rest in the world and not on the train, so slipping is measured
                // from tick 3 on.
                if tick == 3 {
                    on_train = from_train;
                }
                let slipped = from_train - on_train;
                assert!(
                    tick < 3 || slipped.abs() < fx!(0.001),
                    "{case}, tick {tick}: {slipped} m, {state:?}"
                );
            }
            assert!(state.is_on_ground() && state.velocity.length() < fx!(0.001), "{case}: {state:?}");
        }
    }
}

/// A character that lands on an edge and slides off it in the same tick falls only by the rest of its translation.
#[test]
fn a_character_that_lands_on_an_edge_does_not_fall_twice() {
    let mut world = world(60);
    let ledge = ShapeDef::new(Polygon::rectangle(fx!(5), fx!(5)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(-5), fx!(-5))), &[ledge]).expect("valid");
    let mover = Mover::new(shapes()[1].1).expect("valid");
    // The box is 0.6 m wide. When it meets the ledge, 5 cm of it are over the ledge.
    let start = at(fx!(0.15), fx!(0.85));
    let falling = MoverState { velocity: at(fx!(12), fx!(-18)), ..MoverState::at(start) };
    let state = world.move_character(&mover, &falling, QueryFilter::default()).state;
    assert!(!state.is_on_ground() && state.position.x > fx!(0.3), "{state:?}");
    let fallen: Fx = start.y - state.position.y;
    assert!(fallen > fx!(0.14) && fallen <= fx!(0.3), "{fallen} m");
}
