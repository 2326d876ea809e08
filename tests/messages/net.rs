//! Messages about peers, and the UDP socket.

use std::net::SocketAddr;
use std::thread::sleep;
use std::time::Duration;

use ggrs::GgrsError;
use lockstep2d::net::{DriverError, HandshakeDifference, HandshakeMismatch, Mode, NetError, Transport, Udp};
use lockstep2d::replay::RecordError;

use crate::says;

#[test]
fn drivers() {
    says([
        (DriverError::NoState { tick: 12 }, "the state after 12 ticks is not kept"),
        (DriverError::Players { seated: 2, inputs: 3 }, "3 inputs for 2 seated players"),
        (DriverError::Record(RecordError::TickRate), "the replay cannot be continued: a tick rate of zero"),
    ]);
}

#[test]
fn peers() {
    let different = |what, ours: &str, theirs: &str| HandshakeDifference {
        what,
        ours: ours.into(),
        theirs: theirs.into(),
    };
    let differences = vec![different("semantics", "3", "2"), different("players", "4", "2")];
    let too_far = GgrsError::SpectatorTooFarBehind.to_string();
    assert_eq!(NetError::from(GgrsError::SpectatorTooFarBehind).to_string(), too_far);
    says([
        (NetError::from(RecordError::TickRate), "a tick rate of zero"),
        (NetError::from(DriverError::NoState { tick: 12 }), "the state after 12 ticks is not kept"),
        (
            NetError::HandshakeParameters(HandshakeMismatch { differences }),
            "the peers have different handshake parameters: semantics 3 here and 2 there, players 4 here and 2 there",
        ),
        (NetError::Full, "all seats are taken"),
        (NetError::Diverged { tick: 60 }, "the state after tick 60 differs from that of the other peers"),
        (NetError::State { why: "a bad tag".into() }, "the received state cannot be used: a bad tag"),
        (NetError::Refused { why: "all seats are taken".into() }, "refused: all seats are taken"),
        (NetError::NoAnswer, "no answer"),
        (NetError::Dropped, "the other peers have continued without this one, which was silent for too long"),
    ]);
    says([(Mode::Lockstep, "lockstep"), (Mode::Rollback { window: 8 }, "rollback by up to 8 ticks")]);
}

/// Waits for a packet for up to a second.
fn wait_for(socket: &mut Udp) -> Option<(SocketAddr, Vec<u8>)> {
    (0..1000).find_map(|_| {
        let packet = socket.receive();
        if packet.is_none() {
            sleep(Duration::from_millis(1));
        }
        packet
    })
}

#[test]
fn a_socket_carries_packets_both_ways() {
    let mut sockets = [(); 2].map(|()| Udp::bind("127.0.0.1:0").expect("a free port"));
    let [a, b] = &mut sockets;
    let (at_a, at_b) = (a.local_address().expect("bound"), b.local_address().expect("bound"));
    assert!(format!("{a:?}").contains(&at_a.port().to_string()), "{a:?}");
    assert_eq!(a.receive(), None, "expected `receive` to return at once without a packet");
    a.send(b"to and", &at_b);
    assert_eq!(wait_for(b), Some((at_a, b"to and".to_vec())));
    b.send(b"fro", &at_a);
    assert_eq!(wait_for(a), Some((at_b, b"fro".to_vec())));
}

#[test]
fn what_cannot_be_sent_is_lost() {
    let mut socket = Udp::bind("127.0.0.1:0").expect("a free port");
    let here = socket.local_address().expect("bound");
    let gone = Udp::bind("127.0.0.1:0").expect("a free port").local_address().expect("bound");
    socket.send(b"nobody is there", &gone);
    socket.send(&vec![0; 100_000], &here);
    socket.send(b"arrives", &here);
    assert_eq!(wait_for(&mut socket), Some((here, b"arrives".to_vec())));
    assert!(Udp::bind(here).is_err(), "expected binding a used port to fail");
}
