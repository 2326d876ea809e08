//! A peer that cannot continue.

use std::time::Duration;

use lockstep2d::peer::{Network, Peer, PeerError, PeerOptions, Port, Transport};
use lockstep2d::session::Address;

use super::pushers::Setup;
use super::{Pushers, Table};

/// A port that counts the packets sent.
struct Counted {
    port: Port,
    sent: u32,
}

impl Transport for Counted {
    fn send(&mut self, packet: &[u8], to: &Address) {
        self.sent += 1;
        self.port.send(packet, to);
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        self.port.receive()
    }
}

#[test]
fn a_peer_whose_update_fails_sends_packets_so_that_it_can_leave() {
    let mut table = Table::new(10, 0);
    table.host(PeerOptions::lockstep());
    let (me, port) = table.next();
    let options = PeerOptions { first_seat: Some(0), ..PeerOptions::lockstep() };
    let counted = Counted { port, sent: 0 };
    let mut peer = Peer::<Pushers, _>::join(&Setup::default(), options, me, counted, Network::address(0))
        .expect("valid");
    let mut error = None;
    while error.is_none() && table.network.time() < Duration::from_secs(5) {
        table.play(1);
        error = peer.update(table.network.time()).err();
    }
    assert_eq!(error, Some(PeerError::SeatTaken { seat: 0 }));
    peer.leave();
    let before = peer.transport_mut().sent;
    for _ in 0..500 {
        table.play(1);
        let _same_error = peer.update(table.network.time());
    }
    assert!(peer.transport_mut().sent > before + 5, "{} packets", peer.transport_mut().sent - before);
}
