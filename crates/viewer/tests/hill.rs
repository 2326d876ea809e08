//! The example `hill`: a car that drives to the right reaches both goals, and the game is deterministic.

#[path = "../examples/hill/game.rs"]
mod game;

use game::{Drive, Hill};
use lockstep2d::check::{CheckOptions, check};
use lockstep2d::lockstep::Game;

/// Inputs that drive to the right for some ticks.
fn inputs(ticks: usize, fire: bool) -> Vec<Vec<Drive>> {
    vec![vec![Drive { gas: 1, fire }]; ticks]
}

#[test]
fn a_car_reaches_both_goals_if_it_does_not_shoot() {
    for seed in 0..10 {
        let mut game = Hill::new(&seed).unwrap();
        let reached = inputs(1800, false).iter().any(|inputs| {
            game.step(inputs);
            game.goals == 2
        });
        assert!(reached && game.planks_left() == 10, "seed {seed}: {} goals", game.goals);
    }
}

#[test]
fn shells_break_the_bridge_and_are_removed_in_the_end() {
    let mut game = Hill::new(&0).unwrap();
    let bodies = game.world().body_count();
    inputs(300, true).iter().for_each(|inputs| game.step(inputs));
    assert!(game.planks_left() < 10 && game.world().body_count() > bodies);
    (0..400).for_each(|_| game.step(&[Drive::default()]));
    assert_eq!(game.world().body_count(), bodies);
}

#[test]
fn the_game_is_deterministic() {
    if let Err(failure) = check::<Hill>(&1, &inputs(600, true), &CheckOptions::default()) {
        panic!("{failure}");
    }
}
