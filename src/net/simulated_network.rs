//! [`Network`]: a simulated network in memory with configurable link conditions, for tests.

use alloc::collections::{BTreeMap, BTreeSet, VecDeque};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::time::Duration;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::transport::Transport;
use crate::math::Rng;

/// Link conditions of a simulated network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkConditions {
    /// Minimum latency of a packet.
    pub latency: Duration,
    /// Maximum additional latency. Packets may be reordered.
    pub jitter: Duration,
    /// Packet loss in percent.
    pub loss: u32,
    /// Duplicated packets in percent.
    pub doubled: u32,
}

/// A simulated network in memory. The caller sets its time.
///
/// ```
/// use core::time::Duration;
/// use lockstep2d::net::{Network, Transport, LinkConditions};
///
/// let conditions = LinkConditions { latency: Duration::from_millis(100), ..LinkConditions::default() };
/// let network = Network::new(conditions, 7);
/// let (mut alice, mut bob) = (network.port(1), network.port(2));
/// alice.send(b"hello", &2);
/// assert_eq!(bob.receive(), None);
/// network.set_time(Duration::from_millis(100));
/// assert_eq!(bob.receive(), Some((1, b"hello".to_vec())));
/// ```
#[derive(Clone, Debug)]
pub struct Network(Arc<Mutex<NetworkState>>);

#[derive(Debug)]
struct NetworkState {
    conditions: LinkConditions,
    /// Pairs of sender and receiver between which all packets are lost.
    cut: BTreeSet<(u32, u32)>,
    rng: Rng,
    now: Duration,
    /// Packets under way, by time of arrival and order of sending.
    flying: BTreeMap<(Duration, u64), Datagram>,
    sent: u64,
    arrived: BTreeMap<u32, VecDeque<(u32, Vec<u8>)>>,
}

#[derive(Clone, Debug)]
struct Datagram {
    from: u32,
    to: u32,
    bytes: Vec<u8>,
}

/// An endpoint of a [`Network`], with a number as its address.
#[derive(Clone, Debug)]
pub struct Port {
    network: Network,
    address: u32,
}

impl Network {
    /// Creates a network. The seed determines the random losses and delays.
    #[must_use]
    pub fn new(conditions: LinkConditions, seed: u64) -> Self {
        Network(Arc::new(Mutex::new(NetworkState {
            conditions,
            cut: BTreeSet::new(),
            rng: Rng::new(seed),
            now: Duration::ZERO,
            flying: BTreeMap::new(),
            sent: 0,
            arrived: BTreeMap::new(),
        })))
    }

    /// The endpoint with this address.
    #[must_use]
    pub fn port(&self, address: u32) -> Port {
        Port { network: self.clone(), address }
    }

    /// Sets the time.
    pub fn set_time(&self, now: Duration) {
        self.state().now = now;
    }

    /// Changes the link conditions for packets sent from now on.
    pub fn set_conditions(&self, conditions: LinkConditions) {
        self.state().conditions = conditions;
    }

    /// Drops all packets from one address to another, until [`Network::mend`].
    pub fn cut(&self, from: u32, to: u32) {
        self.state().cut.insert((from, to));
    }

    /// Removes all cuts.
    pub fn mend(&self) {
        self.state().cut.clear();
    }

    fn state(&self) -> MutexGuard<'_, NetworkState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl NetworkState {
    fn send(&mut self, datagram: &Datagram) {
        if self.cut.contains(&(datagram.from, datagram.to)) {
            return;
        }
        let LinkConditions { latency, jitter, loss, doubled } = self.conditions;
        let copies = if self.rng.below(100) < doubled { 2 } else { 1 };
        for _ in 0..copies {
            if self.rng.below(100) < loss {
                continue;
            }
            let jitter = u32::try_from(jitter.as_micros()).unwrap_or(u32::MAX - 1);
            let late = Duration::from_micros(self.rng.below(jitter + 1).into());
            self.flying.insert((self.now + latency + late, self.sent), datagram.clone());
            self.sent += 1;
        }
    }

    fn deliver(&mut self) {
        while let Some(next) = self.flying.first_entry() {
            if next.key().0 > self.now {
                return;
            }
            let Datagram { from, to, bytes } = next.remove();
            self.arrived.entry(to).or_default().push_back((from, bytes));
        }
    }
}

impl Transport<u32> for Port {
    fn send(&mut self, packet: &[u8], to: &u32) {
        let datagram = Datagram { from: self.address, to: *to, bytes: packet.to_vec() };
        self.network.state().send(&datagram);
    }

    fn receive(&mut self) -> Option<(u32, Vec<u8>)> {
        let mut state = self.network.state();
        state.deliver();
        state.arrived.get_mut(&self.address)?.pop_front()
    }
}
