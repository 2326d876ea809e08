#[cfg(test)]
mod tests;
use alloc::collections::{BTreeMap, BTreeSet, VecDeque};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::time::Duration;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::transport::Transport;
use crate::math::Rng;
use crate::session::Address;

/// Additional delay of a reordered packet.
const REORDER_DELAY: Duration = Duration::from_millis(20);
/// Maximum number of packets that wait at a receiver. Further packets are lost.
const QUEUE_MAX: usize = 8192;

/// Conditions of a link in one direction. The default has no delay or loss.
///
/// ```
/// use core::time::Duration;
/// use lockstep2d::peer::{LinkConditions, Network, Transport};
/// // The conditions of a mobile connection in a train.
/// let train = LinkConditions { jitter: Duration::from_millis(60), loss: 10, ..LinkConditions::default() };
/// let network = Network::new(train, 1);
/// let (mut phone, mut server) = (network.port(1), network.port(2));
/// (0..100).for_each(|number| phone.send(&[number], &server.address()));
/// network.set_time(Duration::from_millis(60));
/// let arrived = std::iter::from_fn(|| server.receive()).count();
/// assert!(arrived > 80 && arrived < 100, "{arrived}");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkConditions {
    /// Smallest time from sending to receiving.
    pub latency: Duration,
    /// Largest additional time, random for each packet. Jitter does not change the order of packets.
    pub jitter: Duration,
    /// Lost packets in percent.
    pub loss: u8,
    /// Packets that are duplicated, in percent. Each copy may be lost.
    pub duplication: u8,
    /// Packets that are delayed by another 20 ms, in percent. Later packets may overtake them.
    pub reordering: u8,
}

impl LinkConditions {
    /// A link with a latency and no other impairment.
    #[must_use]
    pub const fn latency(latency: Duration) -> Self {
        LinkConditions { latency, jitter: Duration::ZERO, loss: 0, duplication: 0, reordering: 0 }
    }
}

/// A network in memory for tests. The caller sets its time. The seed and the sequence of calls determine delays and
/// losses.
///
/// ```
/// use core::time::Duration;
/// use lockstep2d::peer::{LinkConditions, Network, Transport};
///
/// let network = Network::new(LinkConditions::latency(Duration::from_millis(100)), 7);
/// let (mut alice, mut bob) = (network.port(1), network.port(2));
/// alice.send(b"hello", &bob.address());
/// assert_eq!(bob.receive(), None);
/// network.set_time(Duration::from_millis(100));
/// assert_eq!(bob.receive(), Some((alice.address(), b"hello".to_vec())));
/// ```
#[derive(Clone, Debug)]
pub struct Network(Arc<Mutex<State>>);

/// The socket of a participant in a [`Network`].
///
/// ```
/// use lockstep2d::peer::{LinkConditions, Network, Port, Transport};
/// let network = Network::new(LinkConditions::default(), 1);
/// let [mut phone, mut server]: [Port; 2] = [1, 2].map(|number| network.port(number));
/// // The phone receives packets of the server, but the server receives none of the phone.
/// network.cut(1, 2);
/// phone.send(b"lost", &server.address());
/// server.send(b"heard", &phone.address());
/// assert!(server.receive().is_none());
/// assert_eq!(phone.receive(), Some((server.address(), b"heard".to_vec())));
/// ```
#[derive(Clone, Debug)]
pub struct Port {
    network: Network,
    number: u32,
}

#[derive(Debug)]
struct State {
    conditions: LinkConditions,
    /// Individual conditions, by sender and receiver.
    links: BTreeMap<(u32, u32), LinkConditions>,
    /// Links that lose all packets.
    cut: BTreeSet<(u32, u32)>,
    rng: Rng,
    now: Duration,
    sent: u64,
    /// Arrival time of the last packet of a link, without [`REORDER_DELAY`]. Later packets of the link arrive no
    /// earlier, so jitter keeps the order of packets.
    last: BTreeMap<(u32, u32), Duration>,
    /// Packets in flight, by arrival time and order of sending.
    flying: BTreeMap<(Duration, u64), Datagram>,
    arrived: BTreeMap<u32, VecDeque<(u32, Vec<u8>)>>,
}

#[derive(Debug)]
struct Datagram {
    from: u32,
    to: u32,
    bytes: Vec<u8>,
}

impl Network {
    /// A network with these conditions on all links. The seed determines random delays and losses.
    #[must_use]
    pub fn new(conditions: LinkConditions, seed: u64) -> Self {
        Network(Arc::new(Mutex::new(State {
            conditions,
            links: BTreeMap::new(),
            cut: BTreeSet::new(),
            rng: Rng::new(seed),
            now: Duration::ZERO,
            sent: 0,
            last: BTreeMap::new(),
            flying: BTreeMap::new(),
            arrived: BTreeMap::new(),
        })))
    }

    /// The socket with this number. Sockets with the same number share a receive queue.
    #[must_use]
    pub fn port(&self, number: u32) -> Port {
        Port { network: self.clone(), number }
    }

    /// The address of the socket with this number.
    #[must_use]
    pub fn address(number: u32) -> Address {
        Address::new(&number.to_le_bytes()).unwrap_or_else(Address::nowhere)
    }

    /// Sets the time. An earlier time has no effect.
    pub fn set_time(&self, now: Duration) {
        let state = &mut *self.state();
        state.now = state.now.max(now);
    }

    /// The current time of the network.
    #[must_use]
    pub fn time(&self) -> Duration {
        self.state().now
    }

    /// Changes the conditions of links without individual conditions, for packets sent later.
    pub fn set_conditions(&self, conditions: LinkConditions) {
        self.state().conditions = conditions;
    }

    /// Changes the conditions of one link in one direction, for packets sent later.
    pub fn set_link(&self, from: u32, to: u32, conditions: LinkConditions) {
        self.state().links.insert((from, to), conditions);
    }

    /// Drops packets sent from one socket to another until [`mend`](Network::mend).
    pub fn cut(&self, from: u32, to: u32) {
        self.state().cut.insert((from, to));
    }

    /// Undoes all calls of [`cut`](Network::cut).
    pub fn mend(&self) {
        self.state().cut.clear();
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn chance(&mut self, percent: u8) -> bool {
        self.rng.below(100) < u32::from(percent)
    }

    fn send(&mut self, from: u32, to: u32, bytes: &[u8]) {
        let link = (from, to);
        if self.cut.contains(&link) {
            return;
        }
        let conditions = self.links.get(&link).copied().unwrap_or(self.conditions);
        let LinkConditions { latency, jitter, loss, duplication, reordering } = conditions;
        let copies = if self.chance(duplication) { 2 } else { 1 };
        for _ in 0..copies {
            if self.chance(loss) {
                continue;
            }
            let jitter = u32::try_from(jitter.as_micros()).unwrap_or(u32::MAX - 1);
            let jitter = Duration::from_micros(self.rng.below(jitter.saturating_add(1)).into());
            let last = self.last.entry(link).or_default();
            *last = (*last).max(self.now.saturating_add(latency).saturating_add(jitter));
            let mut arrival = *last;
            if self.chance(reordering) {
                arrival = arrival.saturating_add(REORDER_DELAY);
            }
            self.flying.insert((arrival, self.sent), Datagram { from, to, bytes: bytes.to_vec() });
            self.sent += 1;
        }
    }

    fn deliver(&mut self) {
        while let Some(next) = self.flying.first_entry() {
            if next.key().0 > self.now {
                return;
            }
            let Datagram { from, to, bytes } = next.remove();
            let queue = self.arrived.entry(to).or_default();
            if queue.len() < QUEUE_MAX {
                queue.push_back((from, bytes));
            }
        }
    }
}

impl Port {
    /// The address of this socket.
    #[must_use]
    pub fn address(&self) -> Address {
        Network::address(self.number)
    }
}

impl Transport for Port {
    fn send(&mut self, packet: &[u8], to: &Address) {
        if let Ok(to) = to.bytes().try_into() {
            self.network.state().send(self.number, u32::from_le_bytes(to), packet);
        }
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        let mut state = self.network.state();
        state.deliver();
        let (from, bytes) = state.arrived.get_mut(&self.number)?.pop_front()?;
        Some((Network::address(from), bytes))
    }
}
