//! A sealed match, and an attacker that sends all packets of the match again.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use lockstep2d::math::Rng;
use lockstep2d::peer::{LinkConditions, Network, Peer, PeerEvent, PeerOptions, Port, Sealed, Transport};
use lockstep2d::session::Address;

use super::pushers::{Pushers, Setup, bot};

/// Packets that were sent since the attacker last took them.
type Heard = Rc<RefCell<Vec<Vec<u8>>>>;

struct Tapped {
    port: Port,
    heard: Heard,
}

impl Transport for Tapped {
    fn send(&mut self, packet: &[u8], to: &Address) {
        self.heard.borrow_mut().push(packet.to_vec());
        self.port.send(packet, to);
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        self.port.receive()
    }
}

/// The attacker sends every packet again, from another address to a random peer: once unchanged, and once with a
/// flipped bit.
#[test]
fn a_sealed_match_ignores_strangers() {
    let network = Network::new(LinkConditions::latency(Duration::from_millis(20)), 1);
    let heard = Heard::default();
    let transport = |number| {
        let tapped = Tapped { port: network.port(number), heard: Rc::clone(&heard) };
        Sealed::with_sender(tapped, [9; 32], number.into())
    };
    let options = PeerOptions::lockstep();
    let mut peers: [Peer<Pushers, Sealed<Tapped>>; 2] = [
        Peer::host(&Setup::default(), options, super::identity(0), transport(0)).expect("valid"),
        Peer::join(&Setup::default(), options, super::identity(1), transport(1), Network::address(0))
            .expect("valid"),
    ];
    let mut stranger = network.port(9);
    let mut rng = Rng::new(1);
    let mut attacks = 0;
    for ms in 0..6000 {
        let now = Duration::from_millis(ms);
        network.set_time(now);
        for peer in &mut peers {
            peer.update(now).expect("valid");
            while peer.is_due() {
                let tick = peer.tick();
                let inputs: Vec<u8> = peer.seats().iter().map(|&seat| bot(seat, tick)).collect();
                peer.advance(&inputs).expect("valid");
            }
            while let Some(event) = peer.next_event() {
                assert!(!matches!(event, PeerEvent::Desync(_)));
            }
        }
        for mut packet in heard.take() {
            attacks += 1;
            let to = Network::address(rng.below(2));
            stranger.send(&packet, &to);
            // Flips a bit of the first 32 bytes, which every sealed packet has.
            let at = usize::try_from(rng.below(32)).expect("valid");
            packet[at] ^= 1 << rng.below(8);
            stranger.send(&packet, &to);
        }
        // No peer answers the attacker.
        assert_eq!(stranger.receive(), None);
    }
    assert!(attacks > 500, "{attacks}");
    assert!(peers.iter().all(|peer| peer.confirmed() > 240), "{:?}", peers.each_ref().map(Peer::confirmed));
}
