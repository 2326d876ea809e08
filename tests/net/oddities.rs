//! Unusual matches: one player or eight, extreme tick rates, windows and input delays, clocks that jump.

use std::thread;
use std::time::Duration;

use lockstep2d::net::{Event, LinkConditions, Mode, NetOptions, Peer};
use lockstep2d::replay::Verdict;

use super::matches::{MODES, STORM, verdict};
use super::pushers::Setup;
use super::sweep;
use super::table::Table;

/// Creates a match in which each peer has its own options.
fn open(setup: &Setup, options: &[NetOptions], conditions: LinkConditions, seed: u64) -> Table {
    let mut table = Table::new(conditions, seed);
    for (address, options) in (0..).zip(options) {
        let port = table.network.port(address);
        let options = options.start_with(setup.players);
        table.sit(match address {
            0 => Peer::host(setup, options, port).unwrap(),
            _ => Peer::join(setup, options, port, 0, None).unwrap(),
        });
    }
    table
}

/// Plays to a tick without divergences or departures, and expects equal replays that verify.
fn check(mut table: Table, ticks: u64, mut each_turn: impl FnMut(&mut Table)) {
    let done = table.play(40, |table| {
        each_turn(table);
        table.all_confirmed(ticks)
    });
    assert!(done, "{}", table.describe());
    let bad = |event: &Event| matches!(event, Event::Diverged(_) | Event::Left { .. });
    assert!(!table.events.iter().flatten().any(bad), "{}", table.describe());
    let replays = table.finish(ticks);
    assert!(matches!(verdict(&replays[0]), Verdict::Match { .. }), "{}", verdict(&replays[0]));
    assert!(replays.iter().all(|replay| *replay == replays[0]), "replays differ");
}

#[test]
fn one_player_and_eight() {
    let cases = [1, 8].into_iter().flat_map(|players| (31..).zip(MODES).map(move |mode| (players, mode)));
    sweep::at_once(cases, |(players, (seed, options))| {
        let setup = Setup { players, ..Setup::default() };
        check(open(&setup, &vec![options(); players as usize], STORM, seed), 100, |_| ());
    });
}

#[test]
fn any_tick_rate() {
    thread::scope(|scope| {
        for (tick_rate, ticks) in [(1, 6), (10, 40), (120, 300), (240, 600)] {
            for (seed, options) in (33..).zip(MODES) {
                let setup = Setup { tick_rate, players: 2, ..Setup::default() };
                scope.spawn(move || {
                    check(open(&setup, &[options(); 2], LinkConditions::default(), seed), ticks, |_| ())
                });
            }
        }
    });
}

#[test]
fn any_window_and_delay() {
    thread::scope(|scope| {
        for window in [0, 1, 32, 255] {
            for delays in [[0, 0], [0, 15], [15, 1], [255, 0]] {
                let options = move |input_delay| NetOptions {
                    mode: Mode::Rollback { window },
                    input_delay,
                    ..NetOptions::rollback()
                };
                let setup = Setup { players: 2, ..Setup::default() };
                scope.spawn(move || check(open(&setup, &delays.map(options), STORM, 35), 150, |_| ()));
            }
        }
        for delays in [[0, 0], [0, 15]] {
            let options = |input_delay| NetOptions { input_delay, ..NetOptions::lockstep() };
            let setup = Setup { players: 2, ..Setup::default() };
            scope.spawn(move || check(open(&setup, &delays.map(options), STORM, 36), 60, |_| ()));
        }
    });
}

#[test]
fn who_looks_rarely_plays_all_the_same() {
    sweep::at_once((37..).zip(MODES), |(seed, options)| {
        let setup = Setup { players: 2, ..Setup::default() };
        let table = open(&setup, &[options(); 2], LinkConditions::default(), seed);
        check(table, 100, |table| table.now += Duration::from_millis(100));
    });
}

#[test]
fn a_clock_that_jumps_is_survived() {
    sweep::at_once((39..).zip(MODES), |(seed, options)| {
        let setup = Setup { players: 2, ..Setup::default() };
        let table = open(&setup, &[options(); 2], LinkConditions::default(), seed);
        let mut jumped = false;
        check(table, 200, |table| {
            if !jumped && table.all_confirmed(60) {
                jumped = true;
                table.now += Duration::from_secs(10);
            }
        });
    });
}

#[test]
fn who_plays_alone_is_joined() {
    sweep::at_once((41..).zip(MODES), |(seed, options)| {
        let mut table = Table::of(1, options(), LinkConditions::default(), seed);
        assert!(table.play(10, |table| table.all_confirmed(100)), "{}", table.describe());
        table.sit(table.guest(5, options()));
        let tick = 300;
        let both = |table: &mut Table| table.all_confirmed(tick) && table.hashes(tick).len() == 2;
        assert!(table.play(20, both), "{}", table.describe());
        assert!(table.hashes(tick).windows(2).all(|pair| pair[0] == pair[1]));
    });
}

#[test]
fn two_matches_do_not_mix() {
    let mut table = Table::of(3, NetOptions::rollback(), LinkConditions::default(), 43);
    assert!(table.play(20, |table| table.all_confirmed(60)));
    // A second match at the same addresses, which still receives packets of the first one.
    let late = LinkConditions { latency: Duration::from_millis(400), ..LinkConditions::default() };
    table.network.set_conditions(late);
    table.play(1, |_| false);
    table.network.set_conditions(LinkConditions::default());
    table.peers.clear();
    let setup = Setup::default();
    let options = NetOptions::rollback().start_with(3);
    for address in 0..3 {
        let port = table.network.port(address);
        table.peers.push(Some(match address {
            0 => Peer::host(&setup, options, port).unwrap(),
            _ => table.guest(address, options),
        }));
    }
    assert!(table.play(20, |table| table.all_confirmed(120)), "{}", table.describe());
    assert!(table.hashes(110).windows(2).all(|pair| pair[0] == pair[1]), "{}", table.describe());
}
