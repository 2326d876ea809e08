//! Requested seats, and seats of peers that have left.

use std::time::Duration;

use lockstep2d::peer::{Network, Peer, PeerDesync, PeerError, PeerEvent, PeerOptions};
use lockstep2d::replay::Limits;
use lockstep2d::report::DesyncReport;
use lockstep2d::world::BodyField;

use super::pushers::{FAULT, Fault, Pushers, Setup};
use super::{Table, conditions, identity};

/// A joining player requests at least one seat, so `seats: 0` stands for 1 here.
#[test]
fn a_joining_player_gets_the_first_seat_that_it_names() {
    let options = PeerOptions { start_with: 1, ..PeerOptions::lockstep() };
    let mut table = Table::new(10, 0);
    table.host(options);
    table.join(PeerOptions { seats: 0, first_seat: Some(2), ..options }, 0);
    table.play(2000);
    assert_eq!(table.peer(1).seats(), [2]);
    let (me, port) = table.next();
    let taken = PeerOptions { seats: 0, first_seat: Some(0), ..options };
    let mut peer =
        Peer::<Pushers, _>::join(&Setup::default(), taken, me, port, Network::address(0)).expect("valid");
    let error = (0..2000).find_map(|_| {
        table.play(1);
        peer.update(table.network.time()).err()
    });
    assert_eq!(error, Some(PeerError::SeatTaken { seat: 0 }));
}

#[test]
fn a_report_has_the_hash_of_a_peer_that_has_left() {
    let mut table = Table::new(20, 0);
    table.host(PeerOptions::lockstep());
    FAULT.set(Some(Fault { tick: 70, disc: 1, field: BodyField::ALL[0], bit: 9 }));
    table.join(PeerOptions::lockstep(), 0);
    table.play(3000);
    let found: Option<PeerDesync> = table.events[0].iter().find_map(|event| match event {
        PeerEvent::Desync(desync) => Some(*desync),
        _ => None,
    });
    let desync = found.expect("a desync");
    table.peer(1).leave();
    table.play(1500);
    assert!(table.peer(0).seats_of(identity(1).id).is_empty());
    let bytes = table.peer(0).report(&desync).expect("valid");
    let report = DesyncReport::from_bytes(&bytes, &Limits::default()).expect("valid");
    assert_eq!((report.seats(), report.hashes()[1]), (&[0][..], Some(desync.theirs)));
    assert_eq!(report.hashes()[2..], [None, None]);
}

#[test]
fn the_largest_time_overflows_nothing() {
    let network = Network::new(conditions(1, 0), 3);
    let (options, setup) = (PeerOptions { start_with: 1, ..PeerOptions::lockstep() }, Setup::default());
    let host = Peer::<Pushers, _>::host(&setup, options, identity(0), network.port(0));
    let contact = Network::address(0);
    let guest = Peer::<Pushers, _>::join(&setup, options, identity(1), network.port(1), contact);
    for mut peer in [host.expect("valid"), guest.expect("valid")] {
        for _ in 0..3 {
            peer.update(Duration::MAX).expect("valid");
            while peer.is_due() {
                peer.advance(&[0]).expect("valid");
            }
        }
        assert!(peer.tick() < 60);
    }
}
