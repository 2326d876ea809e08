//! A network in memory that loses, doubles, delays and reorders packets, the same way in every run.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use lockstep2d::peer::Transport;
use lockstep2d::session::Address;

/// Packets on their way: when they arrive, to whom, from whom.
type Packets = Vec<(Duration, u8, u8, Vec<u8>)>;

#[derive(Default)]
struct State {
    now: Duration,
    random: u64,
    packets: Packets,
}

/// The network of a test.
#[derive(Clone, Default)]
pub struct Network(Arc<Mutex<State>>);

/// A socket of the network.
pub struct Socket {
    network: Network,
    own: u8,
}

/// The address of a socket.
pub fn address(number: u8) -> Address {
    Address::new(&[number]).expect("a byte is an address")
}

impl Network {
    pub fn socket(&self, own: u8) -> Socket {
        Socket { network: self.clone(), own }
    }

    pub fn pass(&self, time: Duration) {
        self.0.lock().unwrap().now += time;
    }
}

impl State {
    fn below(&mut self, bound: u64) -> u64 {
        self.random =
            self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 33) % bound
    }
}

impl Transport for Socket {
    fn send(&mut self, packet: &[u8], to: &Address) {
        let mut state = self.network.0.lock().unwrap();
        let to = to.bytes()[0];
        // One of eight is lost, one of sixteen comes twice, and all take 20 to 90 ms.
        let copies = match state.below(16) {
            0 | 1 => 0,
            2 => 2,
            _ => 1,
        };
        for _ in 0..copies {
            let at = state.now + Duration::from_millis(20 + state.below(70));
            state.packets.push((at, to, self.own, packet.to_vec()));
        }
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        let mut state = self.network.0.lock().unwrap();
        let now = state.now;
        let place = state.packets.iter().position(|(at, to, ..)| *to == self.own && *at <= now)?;
        let (_, _, from, packet) = state.packets.remove(place);
        Some((address(from), packet))
    }
}
