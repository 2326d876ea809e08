//! The contract of [`Game`]: the same pads give the same hashes, regardless of saves, loads and encodings in between.

use lockstep2d::check::{self, CheckOptions, Phases};
use lockstep2d::codec::{decode, encode};
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::math::Rng;
use lockstep2d_shove::{Bot, Pad, Save, Setup, Shove};

/// Pads of bots, and the hash after each tick.
fn played(setup: &Setup, ticks: u64) -> Vec<(Vec<Pad>, StateHash)> {
    let mut bots = Bot::each(setup);
    played_by(setup, ticks, |_, game| bots.iter_mut().map(|bot| bot.pad(game)).collect())
}

fn played_by(
    setup: &Setup,
    ticks: u64,
    mut players: impl FnMut(u64, &Shove) -> Vec<Pad>,
) -> Vec<(Vec<Pad>, StateHash)> {
    let mut game = Shove::new(setup).expect("the setup should be valid");
    let mut log = Vec::new();
    for tick in 0..ticks {
        let pads = players(tick, &game);
        game.step(&pads);
        log.push((pads, game.state_hash()));
    }
    log
}

/// Plays a log again, calls `before` before each tick, and checks every hash.
fn play_again(
    setup: &Setup,
    log: &[(Vec<Pad>, StateHash)],
    mut before: impl FnMut(usize, &mut Shove),
) -> Shove {
    let mut game = Shove::new(setup).expect("the setup should be valid");
    for (tick, (pads, hash)) in log.iter().enumerate() {
        before(tick, &mut game);
        game.step(pads);
        assert_eq!(game.state_hash(), *hash, "tick {tick}");
    }
    game
}

fn hostile(rng: &mut Rng) -> Pad {
    Pad(u8::try_from(rng.below(256)).expect("below 256"))
}

fn hostile_log(setup: &Setup, ticks: u64) -> Vec<(Vec<Pad>, StateHash)> {
    let mut rng = Rng::new(setup.seed);
    played_by(setup, ticks, |_, _| (0..setup.seats).map(|_| hostile(&mut rng)).collect())
}

/// Bots join and leave at random ticks, sometimes all at once.
fn restless_log(setup: &Setup, ticks: u64) -> Vec<(Vec<Pad>, StateHash)> {
    let mut rng = Rng::new(setup.seed);
    let mut bots = Bot::each(setup);
    let mut there = vec![false; bots.len()];
    played_by(setup, ticks, |_, game| {
        for there in &mut there {
            *there ^= rng.chance(1, 100);
        }
        if rng.chance(1, 300) {
            there.fill(false);
        }
        let pads = there.iter().zip(&mut bots);
        pads.map(|(&there, bot)| if there { bot.pad(game) } else { Pad::ABSENT }).collect()
    })
}

fn setups() -> impl Iterator<Item = Setup> {
    (2..=4).map(|seats| Setup { seats, seed: u64::from(seats) + 7, ..Setup::default() })
}

fn logs() -> impl Iterator<Item = (Setup, Vec<(Vec<Pad>, StateHash)>)> {
    setups().flat_map(|setup| {
        let logs = [played(&setup, 1000), hostile_log(&setup, 600), restless_log(&setup, 1000)];
        logs.map(|log| (setup, log))
    })
}

#[test]
fn the_same_pads_give_the_same_hashes() {
    for (setup, log) in logs() {
        play_again(&setup, &log, |_, game| assert_eq!(game.world().faults(), 0));
    }
}

#[test]
fn caches_do_not_matter() {
    for (setup, log) in logs() {
        let mut saved = None;
        // Loading the current state must not change later ticks.
        play_again(&setup, &log, |tick, game| {
            let save = game.save();
            if tick % 7 == 0 {
                game.load(&save);
            }
            saved = Some(save);
        });
        assert!(saved.is_some());
    }
}

#[test]
fn a_save_survives_as_bytes_in_another_game() {
    for (setup, log) in logs() {
        play_again(&setup, &log, |tick, game| {
            if tick % 10 == 0 {
                let bytes = encode(&game.save());
                let save: Save = decode(&bytes).expect("the bytes of a save should decode");
                let mut other = Shove::new(&setup).expect("the setup should be valid");
                other.load(&save);
                assert_eq!(other.state_hash(), game.state_hash(), "tick {tick}");
                assert_eq!(encode(&other.save()), bytes, "tick {tick}");
                *game = other;
            }
        });
    }
}

#[test]
fn damaged_saves_are_refused_or_played_without_panic() {
    let setup = Setup::default();
    let log = played(&setup, 200);
    let bytes = encode(&play_again(&setup, &log, |_, _| ()).save());
    let mut rng = Rng::new(5);
    let mut played = 0;
    for _ in 0..2000 {
        let mut bytes = bytes.clone();
        // Three of four changes are in the last 80 bytes of the save, which belong to the rules.
        let back = if rng.chance(3, 4) { 80 } else { bytes.len() };
        let at = bytes.len()
            - 1
            - usize::try_from(rng.below(u32::try_from(back).expect("the save should be shorter than 4 GiB")))
                .expect("the save should be shorter than 4 GiB");
        bytes[at] = rng.next_u32().to_le_bytes()[0];
        let Ok(save) = decode::<Save>(&bytes) else { continue };
        let mut game = Shove::new(&setup).expect("the setup should be valid");
        game.load(&save);
        for _ in 0..5 {
            let pads: Vec<_> = (0..4).map(|_| hostile(&mut rng)).collect();
            game.step(&pads);
        }
        let _ = (game.claims(), game.state_hash(), Bot::new(1, 0).pad(&game));
        played += 1;
    }
    assert!(played > 100, "{played}");
}

/// Plays a few ticks with wrongly predicted pads, loads the save, and plays the same ticks with the right pads.
#[test]
fn rolling_back_leaves_no_trace() {
    for (setup, log) in logs() {
        let mut rng = Rng::new(setup.seed);
        let mut tick = 0;
        let mut game = Shove::new(&setup).expect("the setup should be valid");
        while tick < log.len() {
            let depth = 1 + usize::try_from(rng.below(8)).expect("below 8");
            let save = game.save();
            for _ in 0..depth {
                let pads: Vec<_> = (0..setup.seats).map(|_| hostile(&mut rng)).collect();
                game.step(&pads);
            }
            game.load(&save);
            for (pads, hash) in log.iter().skip(tick).take(depth) {
                game.step(pads);
                assert_eq!(game.state_hash(), *hash);
            }
            tick += depth;
        }
    }
}

#[test]
fn missing_and_surplus_pads_are_no_trouble() {
    let setup = Setup { seats: 2, ..Setup::default() };
    let mut game = Shove::new(&setup).expect("the setup should be valid");
    for tick in 0..300 {
        game.step(&vec![Pad::RIGHT; tick % 6]);
    }
    let (two, four) = ([Pad::UP; 2], [Pad::UP; 4]);
    let mut other = game.clone();
    game.step(&two);
    other.step(&four);
    assert_eq!(game.state_hash(), other.state_hash());
}

/// Runs `check` on pads of bots and on random pads.
#[test]
fn every_way_to_play_comes_to_the_same() {
    for setup in setups() {
        let by_bots: Vec<_> = played(&setup, 60).into_iter().map(|(pads, _)| pads).collect();
        let options = CheckOptions { phases: Phases::Compared, ..CheckOptions::default() };
        check::check::<Shove>(&setup, &by_bots, &options).expect("the game should pass the check");
        let random = check::random_inputs::<Shove>(setup.seats.into(), 200, &mut Rng::new(setup.seed));
        let checked = check::check::<Shove>(&setup, &random, &CheckOptions::default().every(4))
            .expect("the game should pass the check");
        assert_eq!(checked.ticks, 200);
    }
}
