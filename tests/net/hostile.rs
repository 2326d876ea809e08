//! Malicious packets with valid checksums. `fuzz/src/bytes/packet.rs` sends arbitrary ones.

use std::time::Duration;

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::net::{DriverError, LinkConditions, NetError, NetOptions, Network, Peer, Port, Transport};
use serde::{Serialize, de::DeserializeOwned};

use super::pushers::{Pushers, Setup};
use super::table::Table;

const CHECKSUM_BYTES: usize = 8;
/// Packet variants.
const WELCOME: u32 = 3;
const STATE: u32 = 5;
const GONE: u32 = 11;
const SESSION: u32 = 13;

/// Sends a packet: a variant, and its fields.
fn send(from: u32, to: u32, network: &Network, packet: impl Serialize) {
    let body = codec::encode(&packet);
    let checksum = StateHash::of_bytes(&body).0.to_le_bytes();
    network.port(from).send(&[&checksum[..CHECKSUM_BYTES], &body].concat(), &to);
}

/// Returns the first packet waiting at `port` that satisfies `is`.
fn receive<T: DeserializeOwned>(port: &mut Port, is: impl Fn(&T) -> bool) -> T {
    let packets = std::iter::from_fn(|| port.receive());
    let read = |(_, bytes): (u32, Vec<u8>)| {
        let end = (CHECKSUM_BYTES + size_of::<u32>() + size_of::<u64>()).min(bytes.len());
        codec::decode(&bytes[CHECKSUM_BYTES..end]).ok()
    };
    packets.filter_map(read).find(is).unwrap()
}

#[test]
fn nobody_begins_at_the_end_of_time() {
    // Regression: adding to a tick near the limit overflowed.
    for tick in [u64::MAX, u64::MAX - 3, 1 << 63] {
        let network = Network::new(LinkConditions::default(), 1);
        let setup = Setup::default();
        let mut peer =
            Peer::<Pushers, _, _>::join(&setup, NetOptions::rollback(), network.port(1), 0, None).unwrap();
        peer.update(Duration::ZERO).unwrap();
        let (_, nonce) = receive::<(u32, u64)>(&mut network.port(0), |_| true);
        let game = Pushers::new(&setup).unwrap();
        let state = codec::encode(&game.save());
        send(0, 1, &network, (WELCOME, nonce, tick, game.state_hash(), state.len() as u64));
        for (piece, bytes) in state.chunks(1024).enumerate() {
            send(0, 1, &network, (STATE, nonce, piece as u64 * 1024, bytes));
        }
        let refused = peer.update(Duration::from_millis(1));
        assert!(matches!(refused, Err(NetError::State { .. })), "{refused:?}");
    }
}

#[test]
fn what_is_in_the_replay_is_not_taken_back() {
    // Regression: the states were rolled back, but the replay was not.
    let mut table = Table::of(2, NetOptions::rollback(), LinkConditions::default(), 1);
    assert!(table.play(40, |table| table.all_confirmed(100)), "{}", table.describe());
    drop(table.kill(1));
    table.play(1, |_| true);
    let (_, session) = receive::<(u32, u64)>(&mut table.network.port(1), |(kind, _)| *kind == SESSION);
    let known = table.peers[0].as_ref().unwrap().confirmed();
    send(1, 0, &table.network, (GONE, session, 0u64, known - 40, false));
    table.play(5, |table| table.errors[0].is_some());
    let tick = known - 40;
    assert_eq!(table.errors[0], Some(NetError::Driver(DriverError::NoState { tick })));
}
