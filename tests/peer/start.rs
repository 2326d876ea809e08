//! The first seconds of a match.

use lockstep2d::peer::PeerOptions;
use lockstep2d::session::Status;

use super::{Table, identity};

/// The latency was measured while the second player joined, so the input delay fits it from the first tick on.
#[test]
fn lockstep_plays_at_full_speed_from_the_start() {
    let options = PeerOptions { start_with: 2, ..PeerOptions::lockstep() };
    let mut table = Table::new(150, 0);
    table.host(options);
    table.join(options, 0);
    while table.peer(0).status() != Some(Status::Playing) || table.peer(0).tick() == 0 {
        table.play(10);
    }
    let delays = [0, 1].map(|at| table.peer(at).session().expect("valid").delay());
    table.play(2000);
    assert!(table.peer(0).tick() >= 120, "{} ticks in 2 s, delays {delays:?}", table.peer(0).tick());
}

/// A game can list the players with their keys, seats and round-trip times.
#[test]
fn keys_and_round_trips_of_all_players_are_known() {
    let mut table = Table::new(30, 0);
    table.host(PeerOptions::rollback());
    table.join(PeerOptions::rollback(), 0);
    table.play(3000);
    let session = table.peer(0).session().expect("valid");
    let spans = session.view().spans.iter().filter(|span| span.is_open());
    let round_trip = |owner| session.link(owner).map_or(0, |link| link.round_trip / 1000);
    let players: Vec<_> = spans.map(|span| (span.key, span.seat, round_trip(span.owner))).collect();
    let [(host, 0, 0), (guest, 1, ping)] = players[..] else { panic!("{players:?}") };
    assert_eq!([host, guest], [0, 1].map(|number| identity(number).key));
    // In each direction: 30 ms of latency, up to 4 ms of jitter, and up to 1 ms until the packet is read.
    assert!((60..=70).contains(&ping), "{ping}");
}
