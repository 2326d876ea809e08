//! [`Network`]: a network in memory, as bad as one likes, for tests.

use alloc::collections::{BTreeMap, BTreeSet, VecDeque};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::time::Duration;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::transport::Transport;
use crate::math::Rng;

/// What a network does to packets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Weather {
    /// How long a packet takes at least.
    pub latency: Duration,
    /// How much longer it may take; packets overtake each other.
    pub jitter: Duration,
    /// Of a hundred packets, how many are lost.
    pub loss: u32,
    /// Of a hundred packets, how many arrive twice.
    pub doubled: u32,
}

/// A network in memory. Its time is what it is told.
///
/// ```
/// use core::time::Duration;
/// use lockstep2d::net::{Network, Transport, Weather};
///
/// let weather = Weather { latency: Duration::from_millis(100), ..Weather::default() };
/// let network = Network::new(weather, 7);
/// let (mut alice, mut bob) = (network.port(1), network.port(2));
/// alice.send(b"hello", &2);
/// assert_eq!(bob.receive(), None);
/// network.set_time(Duration::from_millis(100));
/// assert_eq!(bob.receive(), Some((1, b"hello".to_vec())));
/// ```
#[derive(Clone, Debug)]
pub struct Network(Arc<Mutex<Air>>);

#[derive(Debug)]
struct Air {
    weather: Weather,
    /// From whom to whom nothing comes.
    cut: BTreeSet<(u32, u32)>,
    rng: Rng,
    now: Duration,
    /// Packets on their way, by the time of their arrival and the order in which they were sent.
    flying: BTreeMap<(Duration, u64), Letter>,
    sent: u64,
    arrived: BTreeMap<u32, VecDeque<(u32, Vec<u8>)>>,
}

#[derive(Clone, Debug)]
struct Letter {
    from: u32,
    to: u32,
    bytes: Vec<u8>,
}

/// An end of a [`Network`], with a number for an address.
#[derive(Clone, Debug)]
pub struct Port {
    network: Network,
    address: u32,
}

impl Network {
    /// A network of which the seed decides what is lost.
    #[must_use]
    pub fn new(weather: Weather, seed: u64) -> Self {
        Network(Arc::new(Mutex::new(Air {
            weather,
            cut: BTreeSet::new(),
            rng: Rng::new(seed),
            now: Duration::ZERO,
            flying: BTreeMap::new(),
            sent: 0,
            arrived: BTreeMap::new(),
        })))
    }

    /// The end with this address.
    #[must_use]
    pub fn port(&self, address: u32) -> Port {
        Port { network: self.clone(), address }
    }

    /// Lets it be `now`.
    pub fn set_time(&self, now: Duration) {
        self.air().now = now;
    }

    /// Changes the weather, for packets that are sent from now on.
    pub fn set_weather(&self, weather: Weather) {
        self.air().weather = weather;
    }

    /// Loses all packets that are sent from one address to another, until [`Network::mend`].
    pub fn cut(&self, from: u32, to: u32) {
        self.air().cut.insert((from, to));
    }

    /// Lets packets pass everywhere again.
    pub fn mend(&self) {
        self.air().cut.clear();
    }

    fn air(&self) -> MutexGuard<'_, Air> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Air {
    fn send(&mut self, letter: &Letter) {
        if self.cut.contains(&(letter.from, letter.to)) {
            return;
        }
        let Weather { latency, jitter, loss, doubled } = self.weather;
        let copies = if self.rng.below(100) < doubled { 2 } else { 1 };
        for _ in 0..copies {
            if self.rng.below(100) < loss {
                continue;
            }
            let jitter = u32::try_from(jitter.as_micros()).unwrap_or(u32::MAX - 1);
            let late = Duration::from_micros(self.rng.below(jitter + 1).into());
            self.flying.insert((self.now + latency + late, self.sent), letter.clone());
            self.sent += 1;
        }
    }

    fn deliver(&mut self) {
        while let Some(next) = self.flying.first_entry() {
            if next.key().0 > self.now {
                return;
            }
            let Letter { from, to, bytes } = next.remove();
            self.arrived.entry(to).or_default().push_back((from, bytes));
        }
    }
}

impl Transport<u32> for Port {
    fn send(&mut self, packet: &[u8], to: &u32) {
        let letter = Letter { from: self.address, to: *to, bytes: packet.to_vec() };
        self.network.air().send(&letter);
    }

    fn receive(&mut self) -> Option<(u32, Vec<u8>)> {
        let mut air = self.network.air();
        air.deliver();
        air.arrived.get_mut(&self.address)?.pop_front()
    }
}
