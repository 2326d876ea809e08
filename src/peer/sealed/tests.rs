use super::*;
use crate::peer::{LinkConditions, Network, Port};

const KEY: [u8; 32] = [3; 32];

fn sealed(network: &Network, number: u32) -> Sealed<Port> {
    Sealed::with_sender(network.port(number), KEY, u64::from(number))
}

/// A network, two members, and a packet from the first to the second.
fn on_the_way() -> (Network, Sealed<Port>, Sealed<Port>, Vec<u8>) {
    let network = Network::new(LinkConditions::default(), 1);
    let (mut alice, bob) = (sealed(&network, 1), sealed(&network, 2));
    alice.send(b"inputs of a tick", &Network::address(2));
    let bytes = network.port(2).receive().expect("it was sent").1;
    (network, alice, bob, bytes)
}

#[test]
fn a_packet_arrives_once_and_is_not_readable() {
    let (network, _, mut bob, bytes) = on_the_way();
    assert_eq!(bytes.len(), 16 + SEALED_OVERHEAD);
    assert!(!bytes.windows(6).any(|part| part == b"inputs"));
    for _ in 0..3 {
        network.port(1).send(&bytes, &Network::address(2));
    }
    assert_eq!(bob.receive(), Some((Network::address(1), b"inputs of a tick".to_vec())));
    assert_eq!(bob.receive(), None, "replayed");
}

#[test]
fn changed_truncated_and_forged_packets_are_dropped() {
    let (network, _, mut bob, bytes) = on_the_way();
    for at in 0..bytes.len() * 8 {
        let mut changed = bytes.clone();
        changed[at / 8] ^= 1 << (at % 8);
        network.port(1).send(&changed, &Network::address(2));
        assert_eq!(bob.receive(), None, "bit {at}");
    }
    for length in 0..bytes.len() {
        network.port(1).send(&bytes[..length], &Network::address(2));
        assert_eq!(bob.receive(), None, "{length} bytes");
    }
    let mut stranger = Sealed::with_sender(network.port(3), [4; 32], 3);
    stranger.send(b"inputs of a tick", &Network::address(2));
    assert_eq!(bob.receive(), None, "another key");
    network.port(1).send(&bytes, &Network::address(2));
    assert!(bob.receive().is_some(), "none of these keeps the genuine packet out");
}

#[test]
fn a_reflected_packet_is_dropped() {
    let (network, mut alice, _, bytes) = on_the_way();
    network.port(2).send(&bytes, &Network::address(1));
    assert_eq!(alice.receive(), None);
}

#[test]
fn the_window_admits_what_is_late_and_nothing_twice() {
    let mut window = Window::new(1);
    for counter in [5, 3, 4, 2000, 0, 2100, 60] {
        assert!(window.is_new(counter), "{counter}");
        window.note(counter);
        assert!(!window.is_new(counter), "{counter}");
    }
    assert!(!window.is_new(52), "too old to know");
    assert!(window.is_new(53) && window.is_new(1999) && !window.is_new(2000));
    window.note(1 << 40);
    assert!(!window.is_new(2100) && window.is_new((1 << 40) - 2047));
    assert!(!window.is_new(u64::MAX));
}

#[test]
fn the_silent_sender_gives_way() {
    let network = Network::new(LinkConditions::default(), 1);
    let mut bob = sealed(&network, 2);
    for number in 10..2000 {
        sealed(&network, number).send(b"x", &Network::address(2));
        assert!(bob.receive().is_some());
    }
    assert_eq!(bob.windows.len(), SENDERS_MAX);
}

/// A peer has other work to do than to reject forged packets.
#[test]
fn a_call_rejects_a_bounded_number_of_packets() {
    let (network, _, mut bob, bytes) = on_the_way();
    let mut forged = bytes.clone();
    forged[20] ^= 1;
    let mut port = network.port(1);
    (0..REJECTED_MAX + 7).for_each(|_| port.send(&forged, &Network::address(2)));
    port.send(&bytes, &Network::address(2));
    assert_eq!(bob.receive(), None);
    assert!(bob.receive().is_some(), "the next call goes on");
}
