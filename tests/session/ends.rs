//! A match may end at a tick that a peer has already passed, or before a peer has played all ticks.

use lockstep2d::session::{Config, Role, Status};

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
