//! A dedicated server in ticks without players.

use lockstep2d::session::{Config, Role, Status, View};

use super::pace::link;
use super::sim::{MS, S, Sim, id, key};

const SERVER: usize = 0;
const PLAYER: usize = 1;
const VISITOR: usize = 2;
const SPECTATOR: usize = 3;

/// The server and the player begin. The spectator follows them, and the visitor joins later.
fn server() -> Sim {
    let mut sim = Sim::new(5, 4);
    (sim.look, sim.doubled) = (MS, 0);
    sim.links = vec![vec![link(30 * MS); 4]; 4];
    let mut first = View::opened_by(id(SERVER), key(SERVER), 0, true);
    first.found(id(PLAYER), key(PLAYER), 1, 1);
    for index in [SERVER, PLAYER, VISITOR, SPECTATOR] {
        let role = match index {
            PLAYER | VISITOR => Role::Player { seats: 1 },
            _ => Role::Spectator,
        };
        sim.add(Config::new(5, 2), role, &first, 1000);
        sim.introduce(index, SERVER);
    }
    for index in [SERVER, PLAYER, SPECTATOR] {
        sim.start(index, 0);
    }
    sim
}

fn cut_off(sim: &mut Sim, index: usize, until: u64) {
    for other in (0..4).filter(|&other| other != index) {
        sim.links[index][other].cut_until = until;
        sim.links[other][index].cut_until = until;
    }
}

fn leave(sim: &mut Sim, index: usize) {
    sim.peers[index].leaves = true;
    sim.peers[index].session.leave();
}

fn status(sim: &Sim, index: usize) -> Status {
    sim.peers[index].session.status()
}

/// After their outages, player and spectator learn at the same time that the visitor came and that it left. Before the
/// visitor came, there were ticks without players.
#[test]
fn an_outage_may_last_longer_than_a_visit() {
    let mut sim = server();
    sim.run(2 * S);
    cut_off(&mut sim, PLAYER, 14 * S);
    sim.run(6 * S);
    cut_off(&mut sim, SPECTATOR, 14 * S);
    sim.start(VISITOR, sim.now);
    sim.run(10 * S);
    leave(&mut sim, VISITOR);
    sim.run(13 * S);
    let spans: Vec<_> = sim.newest_view().spans.iter().map(|span| (span.from, span.until)).collect();
    assert!(spans.len() == 2 && spans[0].1 < spans[1].0 && spans[1].1 > spans[1].0 + 100, "{spans:?}");
    sim.run(18 * S);
    assert_eq!(sim.failure, None);
    assert_eq!((status(&sim, PLAYER), sim.peers[PLAYER].session.seats()), (Status::Playing, 1));
    let played = [SERVER, PLAYER, SPECTATOR].map(|index| sim.peers[index].session.played());
    assert!(played.iter().all(|&ticks| ticks > spans[1].1 + 120), "{played:?} after {spans:?}");
}

/// The end is decided 2 s ahead. Then the only player leaves or crashes.
#[test]
fn a_match_whose_players_are_gone_ends() {
    for crashes in [false, true] {
        let mut sim = server();
        sim.peers[SERVER].session.end_at(400);
        sim.run(5 * S);
        assert!(sim.newest_view().end.is_some() && sim.peers[SERVER].session.final_tick() < 320);
        if crashes {
            sim.peers[PLAYER].on = false;
        } else {
            leave(&mut sim, PLAYER);
        }
        sim.run(20 * S);
        assert_eq!(sim.failure, None);
        for index in [SERVER, SPECTATOR] {
            let session = &sim.peers[index].session;
            assert_eq!((session.status(), session.confirmed()), (Status::Closed, 400), "{index} {crashes}");
        }
    }
}
