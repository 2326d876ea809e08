//! Peers that have gone leave no traffic and take no room.

use lockstep2d::session::{Role, Status};

use super::net::{Net, address};
use super::sim::{MS, S, id};

#[test]
fn nothing_is_sent_to_a_peer_that_has_gone() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    let spectator = net.join(Role::Spectator, 1);
    net.run(6 * S);
    net.assert_all_play();
    net.nodes[spectator].on = false;
    net.run(12 * S);
    let sent = net.sent_to[3];
    net.run(20 * S);
    assert_eq!(net.sent_to[3], sent, "5 s after its last packet, nothing is sent to it");
}

/// The contact dies before it has sent a packet of the match.
#[test]
fn nothing_is_sent_to_a_contact_that_has_gone() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    let contact = net.join(Role::Spectator, 1);
    net.run(6 * S);
    let newcomer = net.join(Role::Player { seats: 1 }, 3);
    while net.nodes[newcomer].joined_at.is_none() {
        net.run(net.now + MS);
    }
    net.nodes[contact].on = false;
    net.run(net.now + 12 * S);
    net.assert_all_play();
    let sent = net.sent_to[3];
    net.run(net.now + 10 * S);
    assert_eq!(net.sent_to[3], sent);
}

/// As many processes as a peer may know have joined and gone.
#[test]
fn a_match_that_many_have_left_admits_more() {
    let mut net = Net::new(5 * MS, 0, 100);
    net.host();
    for _ in 0..4 {
        let first = net.nodes.len();
        (0..50).for_each(|_| _ = net.join(Role::Spectator, 1));
        net.run(net.now + S);
        for node in &mut net.nodes[first..] {
            assert!(node.joined_at.is_some());
            node.on = false;
        }
        net.run(net.now + 5 * S);
    }
    let newcomer = net.join(Role::Player { seats: 1 }, 1);
    net.run(net.now + 3 * S);
    net.assert_all_play();
    let session = |net: &Net, at: usize| net.nodes[at].endpoint.session().expect("valid").clone();
    assert_eq!(session(&net, newcomer).seats(), 0b10);
    let sent = |net: &Net| session(net, 0).link(id(newcomer)).expect("valid").packets_sent;
    let before = sent(&net);
    net.run(net.now + S);
    assert!(sent(&net) >= before + 55, "those who have gone do not slow down the packets of a small match");
}

/// The contact knows the spectator and its old session.
#[test]
fn a_spectator_that_asks_again_is_back() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    let spectator = net.join(Role::Spectator, 1);
    net.run(6 * S);
    net.nodes[spectator].endpoint.ask(address(1));
    net.run(10 * S);
    net.assert_all_play();
}

#[test]
fn a_dropped_player_that_asks_again_is_back() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.join(Role::Player { seats: 1 }, 1);
    net.run(4 * S);
    net.blocked = vec![(1, 3), (3, 1), (2, 3), (3, 2)];
    net.run(10 * S);
    assert_eq!(net.nodes[0].endpoint.session().expect("valid").view().voters.len(), 2);
    net.blocked.clear();
    net.nodes[2].endpoint.ask(address(1));
    net.run(15 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[0].endpoint.session().expect("valid").view().voters.len(), 3);
    // A player with a vote loses its seat for a second.
    net.nodes[2].endpoint.ask(address(2));
    net.run(20 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[2].endpoint.session().expect("valid").seats().count_ones(), 1);
}

#[test]
fn a_closed_peer_admits_nobody() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    net.nodes[1].endpoint.session_mut().expect("valid").leave();
    net.run(12 * S);
    assert_eq!(net.status(1), Some(Status::Closed));
    let newcomer = net.join(Role::Player { seats: 1 }, 2);
    net.run(15 * S);
    assert!(net.status(newcomer).is_none() && net.nodes[newcomer].events.is_empty());
    net.nodes[newcomer].endpoint.ask(address(1));
    net.run(18 * S);
    assert_eq!(net.status(newcomer), Some(Status::Playing));
}
