//! Single scenarios.

use lockstep2d::session::{Config, Event, Role, Status, View};

use super::pace::{link, pace, players};
use super::sim::{MS, S, Sim, id, key};

fn cut(sim: &mut Sim, a: usize, b: usize, until: u64) {
    sim.links[a][b].cut_until = until;
    sim.links[b][a].cut_until = until;
}

fn played(sim: &Sim, index: usize) -> u32 {
    sim.peers[index].session.played()
}

fn status(sim: &Sim, index: usize) -> Status {
    sim.peers[index].session.status()
}

#[test]
fn of_two_players_the_host_goes_on_and_the_guest_returns() {
    let mut sim = players(2, link(30 * MS), |_| ());
    pace(&mut sim, 1);
    cut(&mut sim, 0, 1, 12 * S);
    sim.run(11 * S);
    assert_eq!((status(&sim, 0), status(&sim, 1)), (Status::Playing, Status::Paused));
    assert_eq!(sim.peers[0].session.view().voters.len(), 1);
    assert!(played(&sim, 0) > played(&sim, 1) + 120, "{} {}", played(&sim, 0), played(&sim, 1));
    sim.run(16 * S);
    assert_eq!((status(&sim, 0), status(&sim, 1)), (Status::Playing, Status::Playing));
    assert_eq!((sim.peers[0].session.seats(), sim.peers[1].session.seats()), (1, 2));
    assert!(played(&sim, 0).abs_diff(played(&sim, 1)) < 8);
    assert_eq!(sim.failure, None);
}

/// All peers wait until the host votes to go on without the missing one.
#[test]
fn with_infinite_patience_somebody_has_to_ask() {
    let mut sim = players(3, link(30 * MS), |config| config.timing.patience = u64::MAX);
    pace(&mut sim, 1);
    for other in [0, 1] {
        cut(&mut sim, other, 2, 40 * S);
    }
    sim.run(30 * S);
    let still = played(&sim, 0);
    assert!(still < 60 * 7);
    sim.peers[0].session.go_on_without(id(2));
    sim.run(32 * S);
    assert!(played(&sim, 0) > still + 60);
    sim.run(46 * S);
    assert_eq!((sim.failure.clone(), status(&sim, 2)), (None, Status::Playing));
}

#[test]
fn an_outage_of_all_that_is_shorter_than_the_patience_costs_nobody_a_seat() {
    let mut sim = players(4, link(60 * MS), |_| ());
    pace(&mut sim, 1);
    for a in 0..4 {
        (0..a).for_each(|b| cut(&mut sim, a, b, 7700 * MS));
    }
    sim.run(7700 * MS);
    let still = played(&sim, 0);
    sim.run(10 * S);
    assert!(played(&sim, 0) > still + 100);
    assert_eq!((sim.failure.clone(), sim.peers[0].session.view().number), (None, 0));
}

/// The inputs that a peer lacks after an outage do not fit in one packet.
#[test]
fn large_inputs_arrive_after_an_outage() {
    for (input_bytes, count) in [(512, 2), (200, 3), (64, 4)] {
        let mut sim = players(count, link(40 * MS), |config| config.input_bytes = input_bytes);
        sim.run(2 * S);
        for a in 0..count {
            (0..a).for_each(|b| cut(&mut sim, a, b, 2700 * MS));
        }
        sim.run(2700 * MS);
        let still = played(&sim, 0);
        sim.run(6 * S);
        assert!(played(&sim, 0) > still + 150, "{input_bytes} bytes: {} ticks", played(&sim, 0) - still);
        assert_eq!((sim.failure.clone(), sim.peers[0].session.view().number), (None, 0));
    }
}

/// Another peer relays the inputs of two peers that do not hear each other.
#[test]
fn large_inputs_are_relayed() {
    let mut sim = players(3, link(40 * MS), |config| config.input_bytes = 400);
    cut(&mut sim, 0, 1, 100 * S);
    sim.run(8 * S);
    assert!(
        (0..3).all(|index| played(&sim, index) > 300),
        "{:?}",
        [0, 1, 2].map(|index| played(&sim, index))
    );
    assert_eq!((sim.failure.clone(), sim.peers[0].session.view().number), (None, 0));
}

#[test]
fn a_crash_of_the_host_ends_no_match() {
    let mut sim = players(4, link(40 * MS), |_| ());
    pace(&mut sim, 1);
    sim.peers[0].on = false;
    sim.run(12 * S);
    assert!(played(&sim, 1) > 60 * 8);
    let view = sim.peers[1].session.view();
    assert_eq!((view.voters.len(), view.tie_holder), (3, id(1)));
    assert_eq!(sim.failure, None);
}

#[test]
fn somebody_who_is_kicked_does_not_return_and_knows_it() {
    let mut sim = players(3, link(30 * MS), |_| ());
    pace(&mut sim, 1);
    sim.peers[0].session.kick(key(2));
    sim.run(10 * S);
    assert_eq!(status(&sim, 2), Status::Kicked);
    assert_eq!(sim.peers[0].session.view().voters.len(), 2);
    assert!(played(&sim, 0) > 60 * 9 && sim.failure.is_none());
}

/// The host votes to kick the peer that is cut off, before or after the others go on without it.
#[test]
fn somebody_who_is_kicked_during_an_outage_knows_it_afterwards() {
    for vote in [7 * S, 11 * S] {
        let mut sim = players(3, link(30 * MS), |_| ());
        pace(&mut sim, 1);
        (0..2).for_each(|other| cut(&mut sim, other, 2, 12 * S));
        sim.run(vote);
        sim.peers[0].session.kick(key(2));
        sim.run(16 * S);
        assert_eq!((sim.failure.clone(), status(&sim, 2)), (None, Status::Kicked));
    }
}

/// Only one peer of five, which is not the host, votes to kick a player.
#[test]
fn a_vote_without_a_quorum_keeps_nobody_out() {
    let mut sim = players(5, link(30 * MS), |_| ());
    pace(&mut sim, 1);
    sim.peers[1].session.kick(key(4));
    sim.run(7 * S);
    (0..4).for_each(|other| cut(&mut sim, other, 4, 12 * S));
    sim.run(11 * S);
    assert_eq!(sim.newest_view().voters.len(), 4);
    sim.run(16 * S);
    assert_eq!((sim.failure.clone(), status(&sim, 4)), (None, Status::Playing));
}

/// Peer 0 is the `View::tie_holder` and could remove a peer alone. Other peers need a quorum of votes.
#[test]
fn two_votes_of_five_kick_nobody_and_three_do() {
    let mut sim = players(5, link(30 * MS), |_| ());
    pace(&mut sim, 1);
    for index in [1, 2] {
        sim.peers[index].session.kick(key(4));
    }
    sim.run(9 * S);
    assert_eq!(sim.peers[0].session.view().number, 0);
    sim.peers[3].session.kick(key(4));
    sim.run(12 * S);
    assert_eq!((sim.failure.clone(), status(&sim, 4)), (None, Status::Kicked));
}

#[test]
fn all_finish_at_the_same_tick_also_whoever_asked_for_another_one() {
    let mut sim = players(4, link(60 * MS), |_| ());
    pace(&mut sim, 1);
    sim.peers[1].session.end_at(500);
    sim.peers[2].session.end_at(520);
    sim.run(20 * S);
    let ends: Vec<_> = sim.peers.iter().map(|peer| peer.finished).collect();
    assert!(
        ends.iter().all(|end| end.is_some_and(|(ticks, _)| ticks == 500 || ticks == 520) && *end == ends[0])
    );
    assert!(sim.peers.iter().all(|peer| peer.session.status() == Status::Closed && !peer.on));
    assert_eq!(sim.failure, None);
}

/// Spectators take no seats.
#[test]
fn spectators_watch_through_one_another() {
    let count = 6;
    let mut sim = players(2, link(30 * MS), |config| config.seats = 2);
    sim.links = vec![vec![link(30 * MS); count]; count];
    let (first, config) = (sim.peers[0].session.view().clone(), Config::new(5, 2));
    for index in 2..count {
        sim.add(config.clone(), Role::Spectator, &first, 1000);
        // Each spectator knows only the previous peer.
        sim.introduce(index, index - 1);
        sim.start(index, (index as u64) * S);
    }
    sim.run(15 * S);
    for index in 2..count {
        assert_eq!(status(&sim, index), Status::Watching);
        assert!(
            played(&sim, index) + 60 > played(&sim, 0),
            "{index}: {} of {}",
            played(&sim, index),
            played(&sim, 0)
        );
    }
    assert_eq!(sim.failure, None);
}

/// All players start with tick 0.
#[test]
fn the_first_tick_waits_for_enough_players() {
    let configure = |config: &mut Config| (config.seats, config.start_with) = (4, 3);
    let mut sim = Sim::new(3, 3);
    sim.look = MS;
    sim.links = vec![vec![link(40 * MS); 3]; 3];
    let mut config = Config::new(5, 4);
    configure(&mut config);
    let first = View::opened_by(id(0), key(0), 1, false);
    for index in 0..3 {
        sim.add(config.clone(), Role::Player { seats: 1 }, &first, 1000);
        (0..index).for_each(|other| sim.introduce(index, other));
        sim.start(index, index as u64 * 2 * S);
    }
    sim.run(4 * S);
    assert_eq!((status(&sim, 0), status(&sim, 1), played(&sim, 0)), (Status::Waiting, Status::Waiting, 0));
    sim.run(8 * S);
    assert!((0..3).all(|index| status(&sim, index) == Status::Playing && played(&sim, index) > 60));
    let spans = &sim.peers[0].session.view().spans;
    assert_eq!(spans.iter().map(|span| (span.seat, span.from)).collect::<Vec<_>>(), [(0, 0), (1, 0), (2, 0)]);
    assert_eq!(sim.failure, None);
}

/// The guests would be content with two players. The host waits for four, and crashes.
#[test]
fn the_number_of_the_host_counts() {
    let mut sim = Sim::new(3, 3);
    sim.look = MS;
    sim.links = vec![vec![link(40 * MS); 3]; 3];
    let first = View::opened_by(id(0), key(0), 1, false);
    for index in 0..3 {
        let config = Config { start_with: if index == 0 { 4 } else { 2 }, ..Config::new(5, 4) };
        sim.add(config, Role::Player { seats: 1 }, &first, 1000);
        (0..index).for_each(|other| sim.introduce(index, other));
        sim.start(index, index as u64 * 2 * S);
    }
    sim.run(8 * S);
    assert!((0..3).all(|index| (status(&sim, index), played(&sim, index)) == (Status::Waiting, 0)));
    sim.peers[0].on = false;
    sim.run(14 * S);
    assert!((1..3).all(|index| status(&sim, index) == Status::Playing && played(&sim, index) > 60));
    assert_eq!(sim.failure, None);
}

/// An end that is requested at once neither starts the match nor shuts out players.
#[test]
fn a_match_whose_end_is_known_waits_for_its_players() {
    let mut sim = Sim::new(2, 2);
    sim.look = MS;
    sim.links = vec![vec![link(40 * MS); 2]; 2];
    let config = Config { start_with: 2, ..Config::new(5, 2) };
    let first = View::opened_by(id(0), key(0), 1, false);
    for index in 0..2 {
        sim.add(config.clone(), Role::Player { seats: 1 }, &first, 1000);
        (0..index).for_each(|other| sim.introduce(index, other));
        sim.start(index, index as u64 * 3 * S);
    }
    sim.peers[0].session.end_at(300);
    sim.run(3 * S);
    assert_eq!((status(&sim, 0), played(&sim, 0)), (Status::Waiting, 0));
    sim.run(20 * S);
    assert!(sim.peers.iter().all(|peer| peer.finished.is_some_and(|(ticks, _)| ticks == 300)));
    let spans = &sim.peers[0].session.view().spans;
    assert_eq!(spans.iter().map(|span| (span.seat, span.from)).collect::<Vec<_>>(), [(0, 0), (1, 0)]);
    assert_eq!(sim.failure, None);
}

#[test]
fn another_state_is_noticed_by_all_others() {
    let mut sim = players(3, link(30 * MS), |_| ());
    sim.peers[1].game.mistake = Some(70);
    sim.run(5 * S);
    assert_eq!((sim.peers[0].desyncs, sim.peers[2].desyncs), (1, 1));
    assert_eq!(sim.failure, None);
}

#[test]
fn somebody_who_leaves_costs_no_waiting() {
    let mut sim = players(3, link(60 * MS), |_| ());
    let before = pace(&mut sim, 1);
    assert!(before >= 5900);
    let start = played(&sim, 0);
    sim.peers[2].leaves = true;
    sim.peers[2].session.leave();
    sim.run(8 * S);
    assert!(played(&sim, 0) - start >= 118, "{} ticks in 2 s", played(&sim, 0) - start);
    sim.run(12 * S);
    assert_eq!(status(&sim, 2), Status::Closed);
    assert_eq!(sim.failure, None);
}

/// All 64 peers are players.
#[test]
fn sixty_four_peers_play() {
    let mut sim = players(64, link(40 * MS), |config| config.tick_micros = 33_333);
    sim.look = 5 * MS;
    sim.run(5 * S);
    let before = played(&sim, 0);
    sim.run(8 * S);
    assert_eq!(sim.failure, None);
    let ticks = sim.peers.iter().map(|peer| peer.session.confirmed()).min().expect("valid") - before;
    assert!(ticks >= 80, "{ticks} of 90 ticks");
}

#[test]
fn a_peer_that_was_away_for_too_long_knows_it() {
    let mut sim = players(3, link(30 * MS), |config| config.log_ticks = 128);
    pace(&mut sim, 1);
    (0..2).for_each(|other| cut(&mut sim, other, 2, 20 * S));
    sim.run(19 * S);
    assert_eq!(sim.peers[2].events, []);
    sim.run(26 * S);
    assert_eq!(sim.peers[2].events, [Event::TooFarBehind]);
    assert!(sim.peers[0].events.is_empty() && sim.failure.is_none());
}

/// While the spectator pauses, it stores the inputs of the ticks that it has not played. The other peers forget these
/// inputs.
#[test]
fn a_spectator_that_pauses_keeps_the_inputs() {
    let mut sim = players(2, link(30 * MS), |config| config.log_ticks = 128);
    sim.links = vec![vec![link(30 * MS); 3]; 3];
    let first = sim.peers[0].session.view().clone();
    let config = Config { log_ticks: 128, ..Config::new(5, 2) };
    sim.add(config, Role::Spectator, &first, 1000);
    sim.introduce(2, 0);
    sim.start(2, 0);
    sim.run(5 * S);
    sim.peers[2].in_menu = true;
    sim.run(30 * S);
    sim.peers[2].in_menu = false;
    sim.run(36 * S);
    assert_eq!(sim.failure, None);
    assert!(played(&sim, 2) + 60 > played(&sim, 0), "{} of {}", played(&sim, 2), played(&sim, 0));
}

#[test]
fn the_pause_of_a_player_ends_when_it_leaves() {
    let mut sim = players(3, link(30 * MS), |_| ());
    sim.peers[2].session.pause(true);
    pace(&mut sim, 1);
    sim.peers[2].leaves = true;
    sim.peers[2].session.leave();
    sim.run(10 * S);
    let peer = id(2);
    assert_eq!(sim.peers[0].events, [true, false].map(|paused| Event::Pause { peer, paused }));
}

/// A server without a seat and 63 players are all the voters that a match may have.
#[test]
fn a_match_with_64_voters_admits_no_other() {
    let mut sim = Sim::new(1, 65);
    sim.look = 20 * MS;
    let mut first = View::opened_by(id(0), key(0), 0, true);
    (1..64).for_each(|index| first.found(id(index), key(index), 1, 1 << index));
    let config = Config { tick_micros: 200_000, ..Config::new(5, 64) };
    for index in 0..65 {
        let role = if index == 0 { Role::Spectator } else { Role::Player { seats: 1 } };
        sim.add(config.clone(), role, &first, 1000);
        sim.start(index, 0);
    }
    (0..64).for_each(|index| sim.introduce(64, index));
    sim.run(6 * S);
    assert_eq!((sim.newest_view().number, status(&sim, 64)), (0, Status::Joining));
    assert_eq!(sim.failure, None);
}
