//! Tests of the encodings of packets, numbers and start states, and of damaged and forged packets.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::bytes::{Reader, Write};
use super::config::Config;
use super::event::Event;
use super::id::{Key, NEVER, PeerId};
use super::join_packet::{JoinPacket, RefusalReason};
use super::link::{Link, stamp};
use super::packet::{Composer, Header, Packet, checksum, seed};
use super::routes::Routes;
use super::row::{Ballot, Removal, Row, SeatWant};
use super::start_state::StartState;
use super::state::{CHANGES_KEPT, Random, Role, Session};
use super::view::{Change, Join, SEATS_MAX, SPANS_MAX, Span, View};

fn change() -> Change {
    let join = Join { id: PeerId(7), key: Key(8), seats: 0b110 };
    Change {
        cut: 300,
        end: Some(900),
        begun: true,
        leaves: 5,
        tie_holder: PeerId(3),
        joins: [join].into(),
        from: 310,
    }
}

fn row() -> Row {
    let mut row = Row::new(4);
    row.version = 70_000;
    (row.fin, row.ack, row.played) = (500, 497, 503);
    row.have = [(0, 505), (1, 500), (9, 700), (10, 501)].into();
    row.hears = u64::MAX;
    row.hears_others = [PeerId(1), PeerId(u32::MAX)].into();
    (row.connected, row.paused) = (true, true);
    row.promised = Some(Ballot { round: 9, proposer: PeerId(2) });
    row.accepted = Some((Ballot { round: 8, proposer: PeerId(2) }, Arc::new(change())));
    row.wants.seats = Some(SeatWant { seats: 2, key: Key(77), which: 6 });
    (row.wants.leave, row.wants.end) = (true, Some(1000));
    row.wants.removals = [Removal::Without(PeerId(5)), Removal::Kick(Key(6))].into();
    row.hash = Some((496, 0x1234_5678_9abc_def0_1234));
    row
}

fn packet_bytes() -> Vec<u8> {
    let header = Header { sender: PeerId(11), sequence: 12, sent: 13, echo: Some(14) };
    let mut own = Vec::new();
    row().write(&mut own);
    let mut composer = Composer::new(&header, &own);
    composer.changes(4, [&change(), &change()]);
    composer.runs(2, 4, [(0, 500, &[1, 2, 1, 2, 3, 4][..]), (9, 77, &[0; 128])]);
    composer.foreign([(PeerId(21), &row())]);
    composer.finish(5, PeerId(31))
}

#[test]
fn what_is_written_is_read_again() {
    let bytes = packet_bytes();
    let packet = Packet::read(&bytes[4..], 2).unwrap();
    assert_eq!(packet.header, Header { sender: PeerId(11), sequence: 12, sent: 13, echo: Some(14) });
    assert_eq!((packet.row, packet.foreign), (row(), [(PeerId(21), row())].into()));
    assert_eq!(packet.changes, (4, [change(), change()].into()));
    assert_eq!(packet.runs.iter().map(|run| (run.span, run.start)).collect::<Vec<_>>(), [(0, 500), (9, 77)]);
    assert_eq!(&packet.inputs[..6], [1, 2, 1, 2, 3, 4]);
}

#[test]
fn a_packet_of_eight_players_is_small() {
    let mut row = Row::new(7);
    (row.version, row.fin, row.ack, row.played) = (60_000, 60_000, 60_003, 60_004);
    row.have = (0..8).map(|span| (span, 60_005)).collect();
    (row.hears, row.connected) = (0xff, true);
    let mut own = Vec::new();
    row.write(&mut own);
    assert_eq!(own.len(), 21);
    let header = Header { sender: PeerId(11), sequence: 12, sent: 13, echo: Some(14) };
    let mut composer = Composer::new(&header, &own);
    composer.runs(1, 4, [(0, 60_000, &[3; 8][..])]);
    assert_eq!(composer.finish(5, PeerId(31)).len(), 45);
}

/// Flipped bits, prefixes and additional bytes cause no panic. The decoder rejects prefixes and additional bytes.
#[test]
fn no_bytes_panic() {
    let bytes = packet_bytes();
    let body = &bytes[4..];
    let mut accepted = 0;
    for bit in 0..body.len() * 8 {
        let mut flipped = body.to_vec();
        flipped[bit / 8] ^= 1 << (bit % 8);
        accepted += u32::from(Packet::read(&flipped, 2).is_ok());
    }
    assert!(accepted > 100, "flips of values are accepted, flips of lengths are not: {accepted}");
    for length in 0..body.len() {
        assert!(Packet::read(&body[..length], 2).is_err(), "a packet that ends after {length} bytes");
        let _ = JoinPacket::read(&body[..length]);
        let _ = StartState::decode(&body[..length]);
    }
    let longer: Vec<u8> = body.iter().copied().chain([0]).collect();
    assert!(Packet::read(&longer, 2).is_err(), "a byte after the end");
}

/// The session of the third of three players.
fn session() -> Session {
    let mut view = View::opened_by(PeerId(11), Key(1), 1, true);
    view.found(PeerId(21), Key(2), 1, 2);
    view.found(PeerId(31), Key(3), 1, 4);
    let config = Config { input_bytes: 2, ..Config::new(5, 4) };
    Session::new(config, PeerId(31), Key(3), Role::Player { seats: 1 }, view, 9).unwrap()
}

/// A packet of the first player.
fn packet(row: &Row, first: u32, changes: &[Change]) -> Vec<u8> {
    let mut own = Vec::new();
    row.write(&mut own);
    let header = Header { sender: PeerId(11), sequence: 1, sent: 1, echo: None };
    let mut composer = Composer::new(&header, &own);
    composer.changes(first, changes);
    composer.finish(5, PeerId(31))
}

#[test]
fn forged_changes_do_not_fill_the_memory() {
    let mut session = session();
    let change = Change {
        cut: 0,
        from: 0,
        end: None,
        leaves: 0,
        tie_holder: PeerId(11),
        joins: [].into(),
        ..change()
    };
    let kept = u32::from(CHANGES_KEPT);
    let last = 3 * kept;
    for number in 1..=last {
        session.receive(0, &packet(&Row::new(0), number, core::slice::from_ref(&change)));
    }
    assert_eq!((session.view().number, session.changes.list.len()), (last, usize::from(CHANGES_KEPT)));
    assert_eq!(session.changes.since(last), [change]);
    assert_eq!(session.changes.since(last - kept + 1).len(), usize::from(CHANGES_KEPT));
    assert!(session.changes.since(last - kept).is_empty());
}

/// Peers keep only the last `CHANGES_KEPT` changes, and cannot send older ones to a peer that lacks them.
#[test]
fn a_peer_that_missed_too_many_changes_knows_it() {
    for (missed, is_too_far) in [(0, false), (1, true)] {
        let mut session = session();
        for step in 1..60_u32 {
            let mut row = Row::new(u32::from(CHANGES_KEPT) + missed);
            row.version = step;
            let now = u64::from(step) * 16_000;
            session.receive(now, &packet(&row, 0, &[]));
            session.update(now);
        }
        let events: Vec<Event> = core::iter::from_fn(|| session.next_event()).collect();
        assert!(events.contains(&Event::Waiting { peer: PeerId(11), heard: true }), "{events:?}");
        assert_eq!(events.contains(&Event::TooFarBehind), is_too_far, "{events:?}");
    }
}

#[test]
fn forged_packets_do_not_panic_and_do_not_fill_the_memory() {
    let mut random = random();
    for _ in 0..300 {
        let mut session = session();
        for step in 0..40_u64 {
            let mut bytes = packet_bytes();
            for _ in 0..random.below(6) {
                let bit = usize::try_from(random.below(8 * bytes.len() as u64 - 32)).unwrap() + 32;
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
            let sum = checksum(seed(5, PeerId(31)), &bytes[4..]);
            bytes[..4].copy_from_slice(&sum);
            session.receive(step * 16_000, &bytes);
            session.update(step * 16_000);
            while session.is_due(step * 16_000) && session.advance(step * 16_000, &[1, 2]).unwrap_or(false) {}
            while session.next_request().is_some() {}
            while session.next_packet().is_some() {}
        }
        let statistics = session.statistics();
        assert!(statistics.peers < 200 && statistics.input_bytes < 100_000, "{statistics:?}");
    }
}

fn random() -> Random {
    Random::new(77)
}

#[test]
fn numbers_have_one_form() {
    for value in [0, 1, 127, 128, 16_383, 16_384, u64::from(u32::MAX), u64::MAX] {
        let mut bytes = Vec::new();
        bytes.put_var64(value);
        assert_eq!(Reader::new(&bytes).var64(), Ok(value));
    }
    for long in [&[0x80, 0][..], &[0xff, 0x80, 0], &[0xff; 10], &[0x80; 11]] {
        assert!(Reader::new(long).var64().is_err(), "{long:?}");
    }
    for (value, base) in [(5, 9), (9, 5), (0, u32::MAX), (u32::MAX, 0), (7, 7)] {
        let mut bytes = Vec::new();
        bytes.put_near(value, base);
        assert_eq!(Reader::new(&bytes).near(base), Ok(value));
    }
}

#[test]
fn a_start_state_survives_and_an_unsound_view_is_refused() {
    let mut view = View::opened_by(PeerId(11), Key(1), 0b11, true);
    view.found(PeerId(21), Key(2), 9, 0b100);
    let address = super::address::Address::new(&[1, 2, 3]).unwrap();
    let start =
        StartState { view, addresses: [(PeerId(11), address)].into(), tick: 70, state: [9; 50].into() };
    assert_eq!(StartState::decode(&start.encode()), Ok(start.clone()));
    let unsound = [
        |view: &mut View| view.tie_holder = PeerId(99),
        |view: &mut View| view.voters.push(view.voters[0]),
        |view: &mut View| view.spans.push(view.spans[0]),
        |view: &mut View| view.spans[0].seat = 64,
        |view: &mut View| view.spans[0].owner = PeerId(99),
        |view: &mut View| view.spans[0].from = NEVER,
        |view: &mut View| view.end = Some(60),
    ];
    for (number, spoil) in unsound.into_iter().enumerate() {
        let mut wrong = start.clone();
        spoil(&mut wrong.view);
        let decoded = StartState::decode(&wrong.encode());
        assert!(decoded.is_err() || number == 5, "{number}: {decoded:?}");
    }
}

#[test]
fn join_packets_survive() {
    let packets = [
        JoinPacket::Hello { nonce: 1, key: Key(2), cookie: 3, offer: [4; 512].into() },
        JoinPacket::Challenge { nonce: 1, cookie: 2 },
        JoinPacket::Refused { nonce: 1, reason: RefusalReason::Full, offer: [1].into() },
        JoinPacket::Welcome { nonce: 1, tick: 2, hash: 3, length: u64::MAX },
        JoinPacket::Want { hash: 1, next: 2, window: 3, masks: [4; 16].into() },
        JoinPacket::Chunk { hash: 1, index: 2, bytes: [3; 1152].into() },
        JoinPacket::Probe { token: 1 },
        JoinPacket::Pong { token: 1 },
    ];
    for packet in packets {
        let bytes = packet.encode(5, PeerId(6));
        assert!(bytes.len() <= super::packet::PACKET_BYTES_MAX, "{packet:?}");
        assert_eq!(JoinPacket::read(&bytes[4..]), Ok((PeerId(6), packet)));
    }
}

/// During an outage of ten minutes, a peer sends more than half as many packets as it has sequence numbers.
#[test]
fn a_link_is_measured_again_after_an_outage_of_any_length() {
    for missed in [300_u32, 37_000, 65_000] {
        let mut link = Link::default();
        let mut arrive = |number: u32| {
            let now = u64::from(number) * 16_384;
            let [low, high, ..] = number.to_le_bytes();
            link.arrived(u16::from_le_bytes([low, high]), stamp(now), Some(stamp(now - 4096)), 50, now);
            link.echo(now + 128)
        };
        let first = 1000;
        (first..first + 200).for_each(|number| _ = arrive(number));
        let again = first + 200 + missed;
        for number in again..again + 200 {
            let sent = u64::from(number) * 16_384;
            assert_eq!(arrive(number), Some(stamp(sent + 128)), "{missed} missed, packet {number}");
        }
        assert_eq!((link.loss_per_mille, link.round_trip), (0, 4096), "{missed} missed");
    }
}

/// The sender of a packet may forge its source address. The address of a third party then gets few probes. An address
/// from the list of another peer gets more, and so does one from which packets continue to arrive.
#[test]
fn one_packet_causes_few_probes_of_its_source_address() {
    let probes = |hear: &dyn Fn(u64) -> bool, suggest: bool| {
        let mut routes = Routes::default();
        let address = super::address::Address::new(&[9]).unwrap();
        if suggest {
            routes.suggest(PeerId(1), address);
        }
        let mut count = 0;
        for step in 0..1000 {
            if hear(step) {
                routes.heard(PeerId(1), address, step * 16_000);
            }
            count += routes.probes(step * 16_000).len();
        }
        count
    };
    assert_eq!(probes(&|step| step == 0, false), 3);
    assert_eq!(probes(&|step| step == 0 || step == 500, false), 6);
    assert!(probes(&|_| true, false) > 50);
    assert_eq!(probes(&|_| false, true), 40);
}

/// Spans are never removed. After the largest number of spans, no peer gets a seat.
#[test]
fn a_peer_knows_that_a_match_has_no_room_for_further_players() {
    let past = |number: usize| {
        let tick = u32::try_from(number).unwrap();
        Span { seat: 1, owner: PeerId(9), key: Key(9), since: 0, from: tick, until: tick }
    };
    for (spans, is_used_up) in [(SPANS_MAX - SEATS_MAX - 2, false), (SPANS_MAX - SEATS_MAX - 1, true)] {
        let mut view = View::opened_by(PeerId(11), Key(1), 1, true);
        view.spans.extend((0..spans).map(past));
        let config = Config { input_bytes: 2, ..Config::new(5, 4) };
        let mut session =
            Session::new(config, PeerId(31), Key(3), Role::Player { seats: 1 }, view, 9).unwrap();
        session.receive(0, &packet(&Row::new(0), 0, &[]));
        session.update(0);
        assert_eq!(session.is_match_used_up(), is_used_up, "{spans} spans before");
    }
}
