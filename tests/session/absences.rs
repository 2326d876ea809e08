//! Votes against peers that are absent, and absences during many changes of the view.

use lockstep2d::session::{Config, Role, Span, Status, View};

use super::pace::{link, players};
use super::sim::{MS, S, Sim, id, key};

fn cut_off(sim: &mut Sim, index: usize, until: u64) {
    for other in (0..sim.peers.len()).filter(|&other| other != index) {
        sim.links[index][other].cut_until = until;
        sim.links[other][index].cut_until = until;
    }
}

/// The host is cut off and votes to go on without the others, who are connected to each other.
#[test]
fn a_vote_to_go_on_without_a_peer_ends_when_the_peer_is_back() {
    let mut sim = players(3, link(30 * MS), |config| config.timing.patience = u64::MAX);
    sim.run(6 * S);
    cut_off(&mut sim, 0, 12 * S);
    sim.run(9 * S);
    let still = sim.peers[0].session.played();
    (1..3).for_each(|other| sim.peers[0].session.go_on_without(id(other)));
    sim.run(14 * S);
    // The votes may start a ballot before the host hears all others again. The ballot removes nobody.
    let spans = &sim.newest_view().spans;
    assert!(spans.len() == 3 && spans.iter().all(Span::is_open), "{spans:?}");
    assert_eq!(sim.failure, None);
    assert!(sim.peers.iter().all(|peer| peer.session.played() > still + 60));
}

#[test]
fn a_vote_to_go_on_without_a_peer_that_stands_still_counts() {
    let mut sim = players(3, link(30 * MS), |_| ());
    sim.run(6 * S);
    sim.peers[2].in_menu = true;
    sim.run(9 * S);
    assert_eq!((sim.newest_view().number, sim.peers[0].session.waiting_for()), (0, Some(id(2))));
    sim.peers[0].session.go_on_without(id(2));
    sim.run(10 * S);
    assert_eq!((sim.failure.clone(), sim.peers[2].lost_seats), (None, 1));
}

/// A player with 62 seats loses them and returns, again and again. The spectator is cut off all the time.
#[test]
fn a_spectator_returns_after_hundreds_of_spans() {
    let mut sim = Sim::new(9, 4);
    (sim.look, sim.doubled) = (10 * MS, 0);
    sim.links = vec![vec![link(20 * MS); 4]; 4];
    let mut first = View::opened_by(id(0), key(0), 0b01, true);
    first.found(id(1), key(1), 1, 0b10);
    first.found(id(2), key(2), 1, !0b11);
    let player = |seats| Role::Player { seats };
    for (index, role) in [player(1), player(1), player(62), Role::Spectator].into_iter().enumerate() {
        sim.add(Config { tick_micros: 50_000, ..Config::new(5, 64) }, role, &first, 1000);
        sim.start(index, 0);
    }
    sim.introduce(3, 0);
    sim.run(5 * S);
    cut_off(&mut sim, 3, 65 * S);
    for second in (5..60).step_by(5) {
        cut_off(&mut sim, 2, (second + 3) * S);
        cut_off(&mut sim, 3, 65 * S);
        sim.run((second + 5) * S);
    }
    let spans = sim.newest_view().spans.len();
    assert!(spans >= 64 + 10 * 62, "{spans}");
    sim.run(75 * S);
    assert_eq!(sim.failure, None);
    let [lead, ticks] = [0, 3].map(|index| sim.peers[index].session.played());
    // Each of the eleven absences stops the players for less than three seconds.
    assert!(lead > 20 * 42 && ticks + 40 > lead, "{ticks} of {lead}");
    assert_eq!(sim.peers[3].session.status(), Status::Watching);
}
