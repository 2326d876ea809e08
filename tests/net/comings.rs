//! Late joins, rejoins, spectators, and joins that are refused.

use lockstep2d::net::{Event, LinkConditions, NetError, NetOptions, Peer};
use lockstep2d::replay::Verdict;

use super::matches::{MODES, STORM, verdict};
use super::pushers::Setup;
use super::sweep;
use super::table::Table;

fn joins(table: &Table, at: usize, seat: u32) -> Option<u64> {
    table.events[at].iter().find_map(|event| match event {
        Event::Joined { seat: joined, tick } if *joined == seat && *tick > 0 => Some(*tick),
        _ => None,
    })
}

fn check_late(options: fn() -> NetOptions, conditions: LinkConditions, seed: u64) {
    let mut table = Table::of(3, options(), conditions, seed);
    assert!(table.play(40, |table| table.all_confirmed(sweep::size(200, 80))), "{}", table.describe());
    table.sit(table.guest(9, options()));
    assert!(
        table.play(40, |table| table.peers[3].as_ref().unwrap().seat().is_some()),
        "{}",
        table.describe()
    );
    // Each peer changes to the new session at its own time, but at the same tick.
    let all = table.play(10, |table| (0..4).all(|at| joins(table, at, 3).is_some()));
    assert!(all, "{}", table.describe());
    let tick = joins(&table, 0, 3).unwrap();
    assert!((0..4).all(|at| joins(&table, at, 3) == Some(tick)), "{}", table.describe());
    let end = tick + sweep::size(100, 60);
    let mut compared = 0;
    let ended = table.play(60, |table| {
        let known = table.peers.iter().flatten().map(|peer| peer.confirmed()).min().unwrap();
        let hashes = table.hashes(known);
        assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "tick {known}");
        compared += usize::from(known > tick && hashes.len() == 4);
        table.all_confirmed(end)
    });
    assert!(ended && compared > 20, "{compared}: {}", table.describe());
    let replays = table.finish(end);
    assert!(matches!(verdict(&replays[0]), Verdict::Match { .. }));
    assert!(replays[1..3].iter().all(|replay| *replay == replays[0]), "replays differ");
    assert!(replays[3].is_empty(), "a replay without its beginning");
}

#[test]
fn a_peer_joins_late_and_has_the_same_states() {
    let weathers = [(LinkConditions::default(), 11), (STORM, 12)];
    let cases =
        MODES.into_iter().flat_map(|options| weathers.map(|(conditions, seed)| (options, conditions, seed)));
    sweep::at_once(cases, |(options, conditions, seed)| check_late(options, conditions, seed));
}

#[test]
fn a_peer_comes_back_to_its_seat() {
    let mut table = Table::of(3, NetOptions::rollback(), LinkConditions::default(), 13);
    assert!(table.play(40, |table| table.all_confirmed(60)));
    table.kill(1).finish(0).unwrap();
    assert!(table.play(20, |table| table.peers[0].as_ref().unwrap().seats() == [0, 2]));
    let again =
        Peer::join(&Setup::default(), NetOptions::rollback(), table.network.port(1), 0, Some(1)).unwrap();
    table.peers[1] = Some(again);
    let back = table.play(20, |table| table.peers[0].as_ref().unwrap().seats() == [0, 1, 2]);
    assert!(back, "{}", table.describe());
    let tick = table.peers[0].as_ref().unwrap().tick() + 60;
    assert!(table.play(20, |table| table.all_confirmed(tick)), "{}", table.describe());
    assert_eq!(table.peers[1].as_ref().unwrap().seat(), Some(1));
}

#[test]
fn a_new_host_admits_players() {
    let mut table = Table::of(3, NetOptions::rollback(), LinkConditions::default(), 14);
    assert!(table.play(40, |table| table.all_confirmed(60)));
    table.kill(0).finish(0).unwrap();
    assert!(table.play(20, |table| table.peers[2].as_ref().unwrap().seats() == [1, 2]));
    // The contact is not the host, so it redirects the joining peer to the host.
    let port = table.network.port(7);
    let late = Peer::join(&Setup::default(), NetOptions::rollback(), port, 2, None).unwrap();
    table.sit(late);
    let seated = table.play(20, |table| table.peers[1].as_ref().unwrap().seats() == [0, 1, 2]);
    assert!(seated, "{}", table.describe());
}

#[test]
fn a_spectator_sees_the_same() {
    sweep::at_once(MODES, |options| {
        let mut table = Table::of(2, options(), STORM, 15);
        assert!(table.play(40, |table| table.all_confirmed(100)));
        let port = table.network.port(8);
        table.sit(Peer::watch(&Setup::default(), options(), port, 1).unwrap());
        let mut compared = 0;
        let seen = table.play(40, |table| {
            let tick = table.peers[2].as_ref().unwrap().tick();
            let hashes = table.hashes(tick);
            assert!(tick == 0 || hashes.windows(2).all(|pair| pair[0] == pair[1]), "tick {tick}");
            compared += usize::from(hashes.len() == 3);
            tick > 300
        });
        assert!(seen && compared > 20, "{compared}: {}", table.describe());
    });
}

#[test]
fn who_plays_something_else_is_told_what() {
    let cases: [(Setup, NetOptions, &str); 4] = [
        (Setup { seed: 2, ..Setup::default() }, NetOptions::lockstep(), "setup"),
        (
            Setup { tick_rate: 30, ..Setup::default() },
            NetOptions::lockstep(),
            "tick rate 30 here and 60 there",
        ),
        (Setup { players: 2, ..Setup::default() }, NetOptions::lockstep(), "seats 2 here and 4 there"),
        (Setup::default(), NetOptions::rollback(), "mode rollback by up to 8 ticks here and lockstep there"),
    ];
    for (setup, options, what) in cases {
        let mut table = Table::of(1, NetOptions::lockstep(), LinkConditions::default(), 16);
        let port = table.network.port(1);
        table.sit(Peer::join(&setup, options, port, 0, None).unwrap());
        assert!(table.play(5, |table| table.errors[1].is_some()), "{}", table.describe());
        let Some(NetError::HandshakeParameters(mismatch)) = &table.errors[1] else {
            panic!("{}", table.describe())
        };
        assert!(mismatch.to_string().contains(what), "{mismatch}");
    }
}

#[test]
fn there_are_only_so_many_seats() {
    let mut table = Table::of(4, NetOptions::rollback(), LinkConditions::default(), 17);
    assert!(table.play(20, |table| table.all_confirmed(10)));
    table.sit(table.guest(5, NetOptions::rollback()));
    assert!(table.play(5, |table| table.errors[4] == Some(NetError::Full)), "{}", table.describe());
}

#[test]
fn nobody_waits_for_ever() {
    let table = Table::new(LinkConditions::default(), 18);
    let mut table = table;
    table.sit(table.guest(1, NetOptions::rollback()));
    assert!(table.play(20, |table| table.errors[0] == Some(NetError::NoAnswer)), "{}", table.describe());
}
