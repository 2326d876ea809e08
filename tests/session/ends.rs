//! A match may end at a tick that a peer has already passed, or before a peer has played all ticks.

use lockstep2d::session::{Config, Role, Status};

use super::net::Net;
use super::pace::{link, players};
use super::sim::{MS, S};

#[test]
fn ticks_after_the_end_are_taken_back() {
    for guess in [0, 8] {
        let mut sim = players(2, link(50 * MS), |config| {
            (config.guess, config.save_interval) = (guess, 1);
            config.delay_min = u16::from(guess > 0);
        });
        sim.run(5 * S);
        let end = sim.peers[0].session.played();
        sim.peers[0].session.end_at(end);
        sim.run(6500 * MS);
        for peer in &sim.peers {
            let Some((ticks, _)) = peer.finished else { panic!("{:?}", peer.session.status()) };
            assert!(ticks >= end);
            assert_eq!((peer.session.played(), peer.game.states.len()), (ticks, ticks as usize + 1));
        }
        assert_eq!(sim.failure, None);
    }
}

/// The guest does not hear the host from 5 s to 9 s, and the host leaves at 5.5 s. The inputs that the guest then lacks
/// take several packets.
#[test]
fn a_peer_that_leaves_answers_until_the_others_have_its_inputs() {
    let mut sim = players(2, link(MS), |config| {
        config.input_bytes = 512;
        (config.delay_min, config.delay_max) = (16, 16);
    });
    sim.run(5 * S);
    sim.links[0][1].cut_until = 9 * S;
    sim.run(5500 * MS);
    sim.peers[0].leaves = true;
    sim.peers[0].session.leave();
    sim.run(30 * S);
    assert_eq!((sim.failure.clone(), sim.peers[0].on), (None, false));
    let guest = &sim.peers[1].session;
    assert_eq!((guest.status(), guest.view().voters.len()), (Status::Playing, 1));
    assert!(guest.played() > 60 * 20, "{}", guest.played());
}

#[test]
fn a_closed_session_plays_the_final_ticks() {
    let mut sim = players(2, link(30 * MS), |_| ());
    let first = sim.peers[0].session.view().clone();
    sim.links = vec![vec![link(30 * MS); 3]; 3];
    sim.add(Config::new(5, 2), Role::Spectator, &first, 1000);
    sim.introduce(2, 0);
    sim.start(2, 0);
    sim.run(2 * S);
    sim.peers[2].in_menu = true;
    sim.peers[0].session.end_at(400);
    sim.run(20 * S);
    let spectator = &mut sim.peers[2];
    assert_eq!(spectator.session.status(), Status::Closed);
    let before = spectator.session.played();
    assert!(before < 200, "{before}");
    for step in 0..100 {
        let now = sim.now + step * 16 * MS;
        while spectator.session.is_due(now) {
            assert_eq!(spectator.session.advance(now, &[]), Ok(false));
            spectator.game.fulfil(&mut spectator.session).expect("valid");
        }
    }
    assert_eq!((spectator.session.played(), spectator.game.states.len()), (400, 401));
}

/// The guest is cut off for 6 s. It loses its vote, and the host plays the last second alone. The guest returns when the
/// host has finished.
#[test]
fn an_outage_at_the_end_costs_nobody_the_end() {
    let mut sim = players(2, link(30 * MS), |_| ());
    sim.peers[0].session.end_at(600);
    sim.run(7 * S);
    (sim.links[0][1].cut_until, sim.links[1][0].cut_until) = (15 * S, 15 * S);
    sim.run(14 * S);
    assert_eq!(sim.newest_view().voters.len(), 1);
    sim.run(18 * S);
    for peer in &sim.peers {
        assert!(peer.finished.is_some_and(|(ticks, _)| ticks == 600), "{:?}", peer.session.status());
    }
    sim.run(30 * S);
    assert_eq!(sim.failure, None);
    assert!(sim.peers.iter().all(|peer| peer.session.status() == Status::Closed));
}

/// A player that left is not waited for, and one that crashed for at most `linger_max`.
#[test]
fn a_match_that_some_have_left_or_that_somebody_crashed_in_closes() {
    for (crashes, closed_at) in [(false, 14 * S), (true, 26 * S)] {
        let mut sim = players(3, link(30 * MS), |_| ());
        sim.peers[0].session.end_at(600);
        sim.run(5 * S);
        if crashes {
            sim.peers[2].on = false;
        } else {
            sim.peers[2].leaves = true;
            sim.peers[2].session.leave();
        }
        sim.run(closed_at);
        assert_eq!(sim.failure, None);
        assert!(sim.peers[..2].iter().all(|peer| peer.session.status() == Status::Closed), "{crashes}");
    }
}

/// A spectator requests an end, and becomes a player about tick 360.
#[test]
fn a_request_from_before_the_seat_ends_the_match_only_if_its_tick_is_still_ahead() {
    for (request, end) in [(200, None), (700, Some(700))] {
        let mut net = Net::new(20 * MS, 0, 1000);
        net.host();
        let guest = net.join(Role::Spectator, 1);
        net.run(S);
        net.nodes[guest].endpoint.session_mut().expect("valid").end_at(request);
        net.run(6 * S);
        net.nodes[guest].endpoint.session_mut().expect("valid").set_role(Role::Player { seats: 1 });
        net.run(10 * S + 500 * MS);
        let session = net.nodes[guest].endpoint.session_mut().expect("valid");
        assert_eq!((session.seats(), session.view().end), (0b10, end));
        session.end_at(800);
        net.run(16 * S);
        let ticks = end.unwrap_or(800);
        assert_eq!([0, guest].map(|index| net.nodes[index].tick), [ticks; 2]);
    }
}
