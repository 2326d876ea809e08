//! Peers that have gone cause no traffic, and new peers can take their places.

use std::cmp::Reverse;

use lockstep2d::session::{Endpoint, Identity, Role, Session, Status};

use super::net::{Net, address, config, identity};
use super::sim::{MS, S, id, key};

fn session(net: &mut Net, index: usize) -> &mut Session {
    net.nodes[index].endpoint.session_mut().expect("valid")
}

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

/// The contact is the peer through which the newcomer joins. It crashes before it has sent the newcomer a packet of the
/// match.
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

/// Before the last join, as many processes have joined and gone as a peer may know at a time.
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
    assert_eq!(session(&mut net, newcomer).seats(), 0b10);
    let sent = |net: &mut Net| session(net, 0).link(id(newcomer)).expect("valid").packets_sent;
    let before = sent(&mut net);
    net.run(net.now + S);
    assert!(
        sent(&mut net) >= before + 55,
        "those who have gone do not slow down the packets of a small match"
    );
}

/// When the spectator asks to join again, its contact still knows it and its old session.
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

/// The server was cut off and has lost its vote. It knows the player that joins last only through the other players,
/// which then leave.
#[test]
fn a_dropped_server_whose_contacts_leave_finds_another() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.add(Endpoint::host(config(), identity(0), 0).expect("valid"));
    (0..2).for_each(|_| _ = net.join(Role::Player { seats: 1 }, 1));
    net.run(4 * S);
    net.blocked = vec![(1, 2), (2, 1), (1, 3), (3, 1)];
    net.run(9 * S);
    net.blocked.clear();
    net.run(12 * S);
    let last = net.join(Role::Player { seats: 1 }, 2);
    net.run(15 * S);
    for index in 1..3 {
        session(&mut net, index).leave();
        net.run(net.now + 5 * S);
        assert_eq!(net.status(index), Some(Status::Closed));
    }
    net.run(net.now + 5 * S);
    assert_eq!((net.status(0), net.status(last)), (Some(Status::Dropped), Some(Status::Playing)));
    let ticks = [0, last].map(|index| net.nodes[index].tick);
    assert!(ticks[1] > 60 * 20 && ticks[0] + 60 > ticks[1], "{ticks:?}");
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
    // If a player that has a vote asks to join again, it loses its seat for a second.
    net.nodes[2].endpoint.ask(address(2));
    net.run(20 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[2].endpoint.session().expect("valid").seats().count_ones(), 1);
}

/// The spectator has become a player, with new bounds of its input delay.
#[test]
fn a_peer_that_asks_again_keeps_its_role_and_its_delay() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    let player = net.join(Role::Spectator, 1);
    net.run(3 * S);
    session(&mut net, player).set_role(Role::Player { seats: 1 });
    session(&mut net, player).set_delay(9, 12);
    for until in [7 * S, 12 * S] {
        net.run(until);
        net.assert_all_play();
        assert_eq!((session(&mut net, player).seats(), session(&mut net, player).delay()), (0b10, 9));
        net.nodes[player].endpoint.ask(address(1));
    }
}

/// Two matches with the hosts 0 and 2. Peer 1 plays in the first match, which has run for 5 s when the second one
/// begins.
fn two_matches(state_bytes: usize) -> Net {
    let mut net = Net::new(20 * MS, 0, state_bytes);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(5 * S);
    net.assert_all_play();
    net.host();
    net.run(6 * S);
    net
}

/// The host of the first match still sends packets to the player that has gone to the second match. Both matches have
/// the same tag, which therefore does not tell their packets apart.
#[test]
fn nothing_of_a_match_reaches_the_next_one() {
    let mut net = two_matches(1000);
    net.nodes[1].endpoint.ask(address(3));
    for until in [7 * S, 9 * S, 14 * S] {
        net.run(until);
        assert!(net.nodes.iter().all(|node| !node.desynced), "{until}");
    }
    assert!(net.nodes[1].tick.abs_diff(net.nodes[2].tick) < 20);
    assert_eq!((net.status(1), session(&mut net, 1).seats()), (Some(Status::Playing), 0b10));
    assert!(session(&mut net, 1).link(id(0)).is_none());
}

/// The contact of the guest changes to another match while the guest downloads the state.
#[test]
fn a_guest_gets_no_state_of_a_match_that_its_contact_has_left() {
    let mut net = two_matches(4 << 20);
    let guest = net.join(Role::Player { seats: 1 }, 2);
    net.run(net.now + 500 * MS);
    assert!(net.nodes[guest].endpoint.download().is_some_and(|(received, _)| received > 0));
    net.nodes[1].endpoint.ask(address(3));
    net.run(net.now + 15 * S);
    assert!(session(&mut net, guest).view().voter(id(2)).is_some());
    assert_eq!([1, 2, guest].map(|index| net.status(index)), [Some(Status::Playing); 3]);
}

#[test]
fn a_peer_without_a_session_wants_no_state() {
    let mut net = two_matches(1000);
    net.join(Role::Player { seats: 1 }, 2);
    net.run(net.now + 55 * MS);
    // The hello with the cookie is in flight, and arrives now.
    for Reverse((at, _, from, _, bytes)) in net.heap.iter().filter(|packet| packet.0.3 == 2) {
        net.nodes[1].endpoint.receive(*at, address(*from), bytes);
    }
    assert!(net.nodes[1].endpoint.wants_state());
    net.nodes[1].endpoint.ask(address(3));
    assert!(!net.nodes[1].endpoint.wants_state());
}

/// The process of a kicked player is started again.
#[test]
fn a_key_that_is_kicked_gets_no_seat_and_knows_it() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    session(&mut net, 0).kick(key(1));
    net.run(5 * S);
    assert_eq!(net.status(1), Some(Status::Kicked));
    let again = Identity { key: key(1), ..identity(5) };
    let again = Endpoint::join(config(), again, Role::Player { seats: 1 }, address(1)).expect("valid");
    let again = net.add(again);
    net.run(8 * S);
    assert_eq!([1, again].map(|index| net.status(index)), [Some(Status::Kicked); 2]);
    // A kicked key may still watch, because spectators have no seats.
    session(&mut net, again).set_role(Role::Spectator);
    net.run(9 * S);
    assert_eq!(net.status(again), Some(Status::Watching));
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
