//! A match depends only on its inputs.

use lockstep2d::check::{CheckOptions, check};
use lockstep2d::lockstep::Game;
use lockstep2d::math::Rng;
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, Recording, verify};
use my_game::{Input, MyGame, Setup};

/// State hash after 600 ticks. If a change of the rules changes this hash, raise the version of the rules.
const GOLDEN: &str = "621d889f2e803eaa07536dddb610306e";

/// Inputs of both players for each tick. The directions are random, and change twice a second.
fn inputs(ticks: usize) -> Vec<Vec<Input>> {
    let mut rng = Rng::new(1);
    let mut axis = || i8::try_from(rng.below(3)).map_or(0, |number| number - 1);
    let mut held = [Input::default(); 2];
    let each = (0..ticks).map(|tick| {
        if tick % 30 == 0 {
            held = [0, 1].map(|_| Input { x: axis(), y: axis() });
        }
        held.to_vec()
    });
    each.collect()
}

#[test]
fn every_way_to_play_gives_the_same_states() {
    if let Err(failure) = check::<MyGame>(&Setup::default(), &inputs(300), &CheckOptions::default()) {
        panic!("{failure}");
    }
}

#[test]
fn the_match_is_the_same_as_ever() {
    let mut game = MyGame::new(&Setup::default()).expect("a valid setup");
    inputs(600).iter().for_each(|inputs| game.step(inputs));
    assert_eq!(game.state_hash().to_string(), GOLDEN, "raise the version of the rules, then change GOLDEN");
}

#[test]
fn a_recorded_match_verifies() {
    let mut recording =
        Recording::<MyGame>::start(&Setup::default(), CHECKPOINT_INTERVAL).expect("a valid setup");
    inputs(600).iter().for_each(|inputs| recording.step(inputs).expect("inputs of two players"));
    let file = recording.finish().expect("a replay");
    let verdict = verify::<MyGame>(&file, &Limits::default());
    assert!(verdict.is_match(), "{verdict}");
}
