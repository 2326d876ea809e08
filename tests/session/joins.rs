//! Joining a match.

use lockstep2d::session::{Endpoint, Identity, JoinEvent, Key, PeerId, RefusalReason, Role, Status};

use super::net::{Net, address, config, identity};
use super::sim::{MS, S, id, key};

#[test]
fn players_join_while_the_others_play_at_full_speed() {
    let mut net = Net::new(50 * MS, 2, 20_000);
    net.host();
    net.run(3 * S);
    net.join(Role::Player { seats: 1 }, 1);
    net.run(6 * S);
    net.assert_all_play();
    // The second peer is the contact of the third one, and sends it the address of the first peer.
    net.join(Role::Player { seats: 2 }, 2);
    net.run(10 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[2].endpoint.session().expect("valid").seats(), 0b1100);
    assert!(
        net.nodes[0].endpoint.address(id(2)).is_some(),
        "the host has found the address of the third one"
    );
    assert!(net.nodes[0].stall <= 60 * MS, "{} us", net.nodes[0].stall);
    // The match is full.
    net.join(Role::Player { seats: 1 }, 1);
    net.run(14 * S);
    assert_eq!(net.status(3), Some(Status::Joining));
}

#[test]
fn a_state_of_4_mb_takes_three_seconds_at_50_ms_and_5_percent_loss() {
    let mut net = Net::new(50 * MS, 0, 4 << 20);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(8 * S);
    net.assert_all_play();
    net.loss = 5;
    net.nodes.iter_mut().for_each(|node| node.stall = 0);
    let start = net.now;
    let newcomer = net.join(Role::Player { seats: 1 }, 1);
    net.run(14 * S);
    net.assert_all_play();
    let took = net.nodes[newcomer].joined_at.expect("valid") - start;
    assert!(took <= 3 * S, "{took} us");
    for node in &net.nodes[..2] {
        assert!(node.stall <= 50 * MS, "a stall of {} us", node.stall);
    }
}

/// Packets without inputs are smaller than others, so their mean size shows that they have none.
#[test]
fn a_peer_gets_no_inputs_while_it_downloads_a_state() {
    let mut net = Net::new(20 * MS, 0, 20 << 20);
    net.host();
    net.run(10 * S);
    let guest = net.join(Role::Spectator, 1);
    net.run(net.now + S);
    assert!(net.nodes[guest].endpoint.download().is_some_and(|(received, _)| received > 0));
    let sent = |net: &Net| {
        let session = net.nodes[0].endpoint.session().expect("valid");
        session.link(id(guest)).map_or((0, 0), |link| (link.bytes_sent, link.packets_sent))
    };
    let first = sent(&net);
    net.run(net.now + 10 * S);
    net.assert_all_play();
    let before = sent(&net);
    net.run(net.now + 2 * S);
    let after = sent(&net);
    let usual = (after.0 - before.0) / (after.1 - before.1);
    assert!(
        first.1 > 30 && first.0 / first.1 <= usual,
        "{first:?} bytes and packets, then {usual} bytes each"
    );
}

/// Links have a loss of 0 or 1 %.
#[test]
fn a_state_of_40_mb_takes_ten_seconds_at_20_ms() {
    for loss in [0, 1] {
        let mut net = Net::new(20 * MS, 0, 40 << 20);
        net.host();
        net.join(Role::Player { seats: 1 }, 1);
        net.run(15 * S);
        net.assert_all_play();
        net.loss = loss;
        net.nodes.iter_mut().for_each(|node| node.stall = 0);
        let start = net.now;
        let newcomer = net.join(Role::Player { seats: 1 }, 1);
        net.run(start + 15 * S);
        net.assert_all_play();
        let took = net.nodes[newcomer].joined_at.expect("valid") - start;
        assert!(took <= 10 * S, "{took} us at a loss of {loss} %");
        for node in &net.nodes[..2] {
            assert!(node.stall <= 50 * MS, "a stall of {} us", node.stall);
        }
    }
}

/// When the spectator's contact has gone, another player sends the following ticks. The spectator downloads no new
/// state.
#[test]
fn a_spectator_whose_contact_goes_finds_another() {
    let mut net = Net::new(20 * MS, 1, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(2 * S);
    net.join(Role::Player { seats: 1 }, 1);
    net.run(4 * S);
    let spectator = net.join(Role::Spectator, 2);
    net.run(6 * S);
    let states = net.nodes[spectator].events.len();
    net.nodes[1].on = false;
    net.run(14 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[spectator].events.len(), states, "no other state was needed");
}

#[test]
fn nothing_is_sent_to_an_address_that_has_not_answered() {
    let mut net = Net::new(10 * MS, 0, 50_000);
    net.host();
    net.run(S);
    // Forged hellos that give the victim's address as their sender.
    let mut forged = Endpoint::join(config(), identity(7), Role::Spectator, address(1)).expect("valid");
    let mut sent = 0;
    for _ in 0..100 {
        net.run(net.now + 250 * MS);
        forged.update(net.now);
        while let Some((_, bytes)) = forged.next_packet() {
            sent += bytes.len() as u64;
            net.post(200, 1, bytes);
        }
    }
    net.run(net.now + S);
    assert!(sent > 1000 && net.sent_to[200] <= sent, "{} bytes for {sent}", net.sent_to[200]);
    let session = net.nodes[0].endpoint.session().expect("valid");
    assert_eq!(session.statistics().peers, 1, "nothing is remembered");
}

#[test]
fn other_games_are_refused_with_what_is_expected() {
    let mut net = Net::new(10 * MS, 0, 100);
    net.host();
    let other = Identity { offer: vec![9], ..identity(1) };
    net.add(Endpoint::join(config(), other, Role::Spectator, address(1)).expect("valid"));
    net.run(2 * S);
    let expected = JoinEvent::Refused { reason: RefusalReason::Offer, offer: vec![1, 2, 3] };
    assert_eq!(net.nodes[1].events, [expected]);
}

/// A peer that was refused cannot tell whether another one would be admitted to the match.
#[test]
fn a_contact_outside_of_a_match_is_not_ready_whatever_the_offer() {
    let mut net = Net::new(10 * MS, 0, 100);
    net.host();
    let other = Identity { offer: vec![9], ..identity(1) };
    net.add(Endpoint::join(config(), other, Role::Spectator, address(1)).expect("valid"));
    net.run(S);
    let newcomer = net.join(Role::Player { seats: 1 }, 2);
    net.run(2 * S);
    let is_not_ready =
        |event: &JoinEvent| matches!(event, JoinEvent::Refused { reason: RefusalReason::NotReady, .. });
    let events = &net.nodes[newcomer].events;
    assert!(!events.is_empty() && events.iter().all(is_not_ready), "{events:?}");
    net.nodes[newcomer].endpoint.ask(address(1));
    net.run(5 * S);
    assert_eq!(net.status(newcomer), Some(Status::Playing));
}

#[test]
fn of_two_new_processes_with_one_key_one_gets_seats() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.run(2 * S);
    for number in [5, 6] {
        let twin = Identity { key: key(1), ..identity(number) };
        net.add(Endpoint::join(config(), twin, Role::Player { seats: 1 }, address(1)).expect("valid"));
    }
    net.run(6 * S);
    let session = |index: usize| net.nodes[index].endpoint.session().expect("valid");
    assert_eq!(session(0).view().voters.len(), 2, "{:?}", session(0).view());
    assert_eq!(session(1).seats() | session(2).seats(), 0b10);
}

/// Six spectators join through one another. Each is known only to its own contact.
#[test]
fn spectators_feed_spectators() {
    let mut net = Net::new(15 * MS, 1, 5000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    for contact in 2..8 {
        net.join(Role::Spectator, contact);
        net.run(net.now + 2 * S);
    }
    net.run(net.now + 3 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[0].endpoint.session().expect("valid").view().voters.len(), 2);
    // A player still finds a seat.
    net.join(Role::Player { seats: 1 }, 1);
    net.run(net.now + 4 * S);
    net.assert_all_play();
}

/// A NAT gives a player another port.
#[test]
fn an_address_may_change() {
    let mut net = Net::new(30 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(4 * S);
    net.nodes[1].address = 99;
    net.run(8 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[0].endpoint.address(id(1)), Some(address(99)));
    let session = net.nodes[0].endpoint.session().expect("valid");
    assert_eq!((session.view().voters.len(), session.view().number), (2, 1), "no seat was lost");
}

/// A NAT gives a player another port. It drops the packets from this port to one of the peers until that peer has sent
/// a packet to the port.
#[test]
fn a_changed_address_is_known_from_others() {
    let mut net = Net::new(30 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(2 * S);
    net.join(Role::Player { seats: 1 }, 1);
    net.run(5 * S);
    net.nodes[1].address = 99;
    net.shut = vec![(99, 3)];
    net.run(9 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[2].endpoint.address(id(1)), Some(address(99)));
}

/// Two of three peers cannot reach each other directly.
#[test]
fn somebody_in_between_relays() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.blocked = vec![(2, 3), (3, 2)];
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(2 * S);
    net.join(Role::Player { seats: 1 }, 1);
    net.run(8 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[0].endpoint.session().expect("valid").view().voters.len(), 3);
}

/// The restarted process is a new incarnation with the same key.
#[test]
fn a_restarted_process_gets_its_seat_back() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(2 * S);
    net.join(Role::Player { seats: 1 }, 1);
    net.run(4 * S);
    assert_eq!(net.nodes[1].endpoint.session().expect("valid").seats(), 0b10);
    net.nodes[1].on = false;
    net.run(4500 * MS);
    let again = Identity { key: key(1), ..identity(5) };
    let index =
        net.add(Endpoint::join(config(), again, Role::Player { seats: 1 }, address(1)).expect("valid"));
    net.run(10 * S);
    net.assert_all_play();
    assert_eq!(net.nodes[index].endpoint.session().expect("valid").seats(), 0b10);
}

/// The contact crashes during the download of the state.
#[test]
fn another_contact_can_be_asked() {
    let mut net = Net::new(20 * MS, 0, 40 << 20);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(6 * S);
    let newcomer = net.join(Role::Player { seats: 1 }, 1);
    net.run(7 * S);
    assert!(net.nodes[newcomer].endpoint.download().is_some());
    net.nodes[0].on = false;
    net.run(8 * S);
    net.nodes[newcomer].endpoint.ask(address(2));
    net.run(9 * S);
    assert_eq!(net.status(1), Some(Status::Paused), "the guest of two waits for its host");
    net.nodes[0].on = true;
    net.run(20 * S);
    net.assert_all_play();
}

/// The peer asks again before its game has fetched the state.
#[test]
fn a_peer_that_asks_again_gets_no_event_of_the_discarded_match() {
    let host = Endpoint::host(config(), identity(0), 1).expect("valid");
    let guest = Endpoint::join(config(), identity(1), Role::Player { seats: 1 }, address(1)).expect("valid");
    let (mut ends, mut now) = ([host, guest], 0);
    while ends[1].session().is_none() {
        now += 10 * MS;
        for own in 0..2 {
            ends[own].update(now);
            ends[own].offer_state(0, vec![1]);
            while let Some((_, packet)) = ends[own].next_packet() {
                ends[1 - own].receive(now, address(own as u8 + 1), &packet);
            }
        }
    }
    ends[1].ask(address(1));
    assert_eq!(ends[1].next_event(), None);
}

#[test]
fn an_incarnation_of_somebody_else_is_refused() {
    let mut net = Net::new(10 * MS, 0, 100);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    let copy = Identity { key: Key(999), id: PeerId(id(1).0), ..identity(6) };
    let index =
        net.add(Endpoint::join(config(), copy, Role::Player { seats: 1 }, address(1)).expect("valid"));
    net.run(5 * S);
    let refused = JoinEvent::Refused { reason: RefusalReason::Taken, offer: vec![1, 2, 3] };
    assert_eq!(net.nodes[index].events.first(), Some(&refused));
    // The next request has another incarnation.
    net.nodes[index].endpoint.ask(address(1));
    net.run(15 * S);
    net.assert_all_play();
}

#[test]
fn seats_and_offers_that_do_not_exist_are_errors() {
    let host = |offer: usize, seats| {
        let identity = Identity { offer: vec![1; offer], ..identity(0) };
        Endpoint::host(config(), identity, seats).err().map(|error| error.to_string())
    };
    assert_eq!(host(512, 0b1111), None);
    let error = |what| Some(format!("the session cannot start: {what}"));
    assert_eq!(host(513, 1), error("`bytes of the offer` is 0 to 512, not 513"));
    assert_eq!(host(1, 0b1_0000), error("`bits of the own seats` is 0 to 15, not 16"));
    let identity = Identity { offer: vec![1; 513], ..identity(0) };
    assert!(Endpoint::join(config(), identity, Role::Spectator, address(1)).is_err());
}

/// Sends the packets of a guest that asks a host to join: a hello, which the host answers with a challenge, and a hello
/// with the cookie of the challenge. Returns the refusal, if any.
fn ask(host: &mut Endpoint, guest: &mut Endpoint, number: u8, now: u64) -> Option<JoinEvent> {
    guest.update(now);
    for _ in 0..2 {
        while let Some((_, bytes)) = guest.next_packet() {
            host.receive(now, address(number), &bytes);
        }
        host.update(now);
        while let Some((to, bytes)) = host.next_packet() {
            if to == address(number) {
                guest.receive(now, address(1), &bytes);
            }
        }
        guest.update(now);
    }
    guest.next_event()
}

/// The program of the host never answers `wants_state`.
#[test]
fn guests_that_wait_for_a_state_and_go_make_room_for_others() {
    let guest = |number: u8| {
        let role = Role::Spectator;
        Endpoint::join(config(), identity(usize::from(number)), role, address(1)).expect("valid")
    };
    let mut host = Endpoint::host(config(), identity(0), 1).expect("valid");
    for number in 2..66 {
        assert_eq!(ask(&mut host, &mut guest(number), number, S), None);
    }
    let mut late = guest(66);
    let full = ask(&mut host, &mut late, 66, S);
    assert!(matches!(full, Some(JoinEvent::Refused { reason: RefusalReason::Full, .. })), "{full:?}");
    // A guest that continues to ask stays.
    let mut patient = guest(2);
    for now in (S..12 * S).step_by(200_000) {
        assert_eq!(ask(&mut host, &mut patient, 2, now), None);
        assert!(host.wants_state());
    }
    for number in 67..130 {
        assert_eq!(ask(&mut host, &mut guest(number), number, 12 * S), None);
    }
    host.update(18 * S);
    assert!(!host.wants_state());
}
