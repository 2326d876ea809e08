//! The rules, through the public interface.

use lockstep2d::lockstep::Game;
use lockstep2d_shove::{Bot, Pad, Phase, Setup, Shove, UnplayableSetup};

fn game(seats: u8, rounds: u8) -> Shove {
    Shove::new(&Setup { seats, rounds, seed: 3 }).expect("the setup should be valid")
}

/// Steps until `done` holds, at most for a minute of game time.
fn step_until(game: &mut Shove, pads: &[Pad], done: impl Fn(&Shove) -> bool) {
    for _ in 0..3600 {
        if done(game) {
            return;
        }
        game.step(pads);
    }
    panic!("the condition should hold within one minute");
}

fn alive(game: &Shove) -> usize {
    game.players_in_order().filter(|player| player.is_alive()).count()
}

fn scores(game: &Shove) -> Vec<u32> {
    game.players_in_order().map(|player| player.score).collect()
}

const NONE: Pad = Pad(0);

#[test]
fn setups_out_of_range_are_refused() {
    for seats in [0, 1, 5, 255] {
        let setup = Setup { seats, ..Setup::default() };
        assert_eq!(setup.check(), Err(UnplayableSetup::Seats { seats }));
        assert!(Shove::new(&setup).is_err());
    }
    for rounds in [0, 100] {
        let setup = Setup { rounds, ..Setup::default() };
        assert_eq!(setup.check(), Err(UnplayableSetup::Rounds { rounds }));
    }
}

#[test]
fn who_runs_off_the_platform_falls_and_the_others_score() {
    let mut game = game(3, 99);
    step_until(&mut game, &[NONE; 3], |game| game.phase() == Phase::Fight);
    // This pad pushes the player straight outwards.
    let out = Pad::towards(game.player(1).expect("the seat should exist").position);
    step_until(&mut game, &[NONE, out, NONE], |game| alive(game) == 2);
    assert_eq!(scores(&game), [1, 0, 1]);
    assert!(!game.player(1).expect("the seat should exist").is_alive());
    let out = Pad::towards(game.player(0).expect("the seat should exist").position);
    step_until(&mut game, &[out, NONE, NONE], |game| game.phase() == Phase::Pause);
    assert_eq!(scores(&game), [1, 0, 2]);
    let won: Vec<_> = game.players_in_order().map(|player| player.won).collect();
    assert_eq!(won, [0, 0, 1]);
    let claims = [("score 1".into(), 1), ("score 2".into(), 0), ("score 3".into(), 2)];
    assert_eq!(game.claims(), claims);
}

#[test]
fn nobody_moves_before_a_round() {
    let mut game = game(2, 99);
    game.step(&[Pad::UP; 2]);
    let before = game.player(0).expect("the seat should exist").position;
    for _ in 0..30 {
        game.step(&[Pad::UP.with(Pad::DASH); 2]);
    }
    assert_eq!(
        (game.phase(), game.player(0).expect("the seat should exist").position),
        (Phase::Ready, before)
    );
}

#[test]
fn a_dash_has_to_charge() {
    let mut game = game(2, 99);
    step_until(&mut game, &[NONE; 2], |game| game.phase() == Phase::Fight);
    let pad = Pad::towards(-game.player(0).expect("the seat should exist").position).with(Pad::DASH);
    let speed = |game: &Shove| game.player(0).expect("the seat should exist").velocity.length();
    game.step(&[pad, NONE]);
    let first = speed(&game);
    assert!(first > 7, "{first}");
    game.step(&[pad, NONE]);
    assert!(speed(&game) < first.saturating_add(first / 8), "a second dash should not be possible yet");
    assert!(game.player(0).expect("the seat should exist").recharge > 0);
}

#[test]
fn who_leaves_takes_the_body_along_and_comes_back_with_the_next_round() {
    let mut game = game(3, 99);
    step_until(&mut game, &[NONE; 3], |game| game.phase() == Phase::Fight);
    game.step(&[NONE, Pad::ABSENT, NONE]);
    let player = game.player(1).expect("the seat should exist");
    assert!(!player.present && !player.is_alive());
    assert_eq!((alive(&game), scores(&game)), (2, vec![0, 0, 0]));
    game.step(&[NONE; 3]);
    assert!(
        game.player(1).expect("the seat should exist").present && alive(&game) == 2,
        "a returning player should get no body within the round"
    );
    let round = game.round();
    step_until(&mut game, &[NONE; 3], |game| game.round() > round);
    assert_eq!(alive(&game), 3);
}

#[test]
fn who_is_alone_practises_until_somebody_comes() {
    let mut game = game(2, 99);
    for _ in 0..200 {
        game.step(&[Pad::ABSENT; 2]);
    }
    assert_eq!((alive(&game), game.round()), (0, 0));
    game.step(&[NONE, Pad::ABSENT]);
    assert_eq!((alive(&game), game.round()), (1, 0), "practice should begin at once");
    step_until(&mut game, &[Pad::UP, Pad::ABSENT], |game| alive(game) == 0);
    step_until(&mut game, &[Pad::UP, Pad::ABSENT], |game| alive(game) == 1);
    assert_eq!(game.round(), 0, "practice rounds should not count");
    game.step(&[NONE; 2]);
    assert_eq!(
        (alive(&game), game.round(), game.phase()),
        (2, 1, Phase::Ready),
        "the first round should begin at once"
    );
    assert_eq!(scores(&game), [0, 0]);
}

#[test]
fn the_platform_crumbles_and_a_match_ends() {
    let mut game = game(2, 2);
    step_until(&mut game, &[NONE; 2], |game| game.radius() < 10);
    step_until(&mut game, &[NONE; 2], |game| game.round() == 2);
    assert_eq!(game.radius(), 12);
    step_until(&mut game, &[NONE; 2], |game| game.phase() == Phase::Over);
    let (scores_then, round) = (scores(&game), game.round());
    for _ in 0..2000 {
        game.step(&[Pad::LEFT; 2]);
    }
    assert_eq!((scores(&game), game.round(), game.phase()), (scores_then, round, Phase::Over));
}

#[test]
fn bots_finish_rounds_and_differ() {
    let (mut rounds, mut draws) = (0, 0);
    for seed in 0..5 {
        let setup = Setup { seed, ..Setup::default() };
        let mut game = Shove::new(&setup).expect("the setup should be valid");
        let mut bots = Bot::each(&setup);
        for _ in 0..3600 {
            let pads: Vec<_> = bots.iter_mut().map(|bot| bot.pad(&game)).collect();
            assert!(pads.iter().all(|pad| pad.0 < 32), "bots should press only defined buttons");
            game.step(&pads);
        }
        rounds += game.round();
        let scores = scores(&game);
        draws += u8::from(scores.iter().all(|score| *score == scores[0]));
    }
    assert!(rounds >= 15 && draws <= 1, "{rounds} rounds, {draws} matches without a winner");
}
