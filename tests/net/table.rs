//! Peers around an in-memory network with simulated time. The time passes as fast as real time, since GGRS retransmits
//! by the real clock, but more slowly on a machine that cannot keep up.

use std::time::{Duration, Instant};

use lockstep2d::hash::StateHash;
use lockstep2d::net::{Event, LinkConditions, NetError, NetOptions, Network, Peer, Port};

use super::pushers::{Pushers, Setup, bot};

pub(crate) type Player = Peer<Pushers, u32, Port>;

pub(crate) struct Table {
    pub(crate) network: Network,
    pub(crate) peers: Vec<Option<Player>>,
    pub(crate) events: Vec<Vec<Event>>,
    pub(crate) errors: Vec<Option<NetError>>,
    pub(crate) replays: Vec<Vec<u8>>,
    /// Simulated time that all peers see.
    pub(crate) now: Duration,
    last_turn: Instant,
}

/// Largest simulated duration of a turn: a turn that takes longer in real time causes no timeouts.
const TURN_MAX: Duration = Duration::from_millis(20);

impl Table {
    pub(crate) fn new(conditions: LinkConditions, seed: u64) -> Self {
        let network = Network::new(conditions, seed);
        Table {
            network,
            peers: vec![],
            events: vec![],
            errors: vec![],
            replays: vec![],
            now: Duration::ZERO,
            last_turn: Instant::now(),
        }
    }

    /// Creates a host and `count - 1` guests; peer `n` has the address `n`.
    pub(crate) fn of(count: u32, options: NetOptions, conditions: LinkConditions, seed: u64) -> Self {
        let mut table = Table::new(conditions, seed);
        let setup = Setup::default();
        let options = options.start_with(count);
        table.sit(Peer::host(&setup, options, table.network.port(0)).unwrap());
        for address in 1..count {
            table.sit(table.guest(address, options));
        }
        table
    }

    pub(crate) fn guest(&self, address: u32, options: NetOptions) -> Player {
        Peer::join(&Setup::default(), options, self.network.port(address), 0, None).unwrap()
    }

    pub(crate) fn sit(&mut self, peer: Player) {
        self.peers.push(Some(peer));
        self.events.push(vec![]);
        self.errors.push(None);
        self.replays.push(vec![]);
    }

    /// Removes a peer without a departure message.
    pub(crate) fn kill(&mut self, at: usize) -> Player {
        self.peers[at].take().unwrap()
    }

    /// Plays until `done` returns true, for at most `seconds`.
    pub(crate) fn play(&mut self, seconds: u64, done: impl FnMut(&mut Table) -> bool) -> bool {
        self.play_until(self.now + Duration::from_secs(seconds), done)
    }

    /// Plays for a duration.
    pub(crate) fn play_for(&mut self, time: Duration) {
        self.play_until(self.now + time, |_| false);
    }

    fn play_until(&mut self, end: Duration, mut done: impl FnMut(&mut Table) -> bool) -> bool {
        while self.now < end {
            self.turn();
            if done(self) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        false
    }

    fn turn(&mut self) {
        self.now += self.last_turn.elapsed().min(TURN_MAX);
        self.last_turn = Instant::now();
        let now = self.now;
        self.network.set_time(now);
        for at in 0..self.peers.len() {
            let Some(peer) = &mut self.peers[at] else { continue };
            if self.errors[at].is_some() {
                continue;
            }
            let mut turn = || {
                peer.update(now)?;
                while peer.is_due() {
                    let input = bot(peer.seat().unwrap_or(0), peer.tick());
                    if !peer.advance(input)? {
                        break;
                    }
                }
                Ok(())
            };
            self.errors[at] = turn().err();
            self.replays[at].extend(peer.take_replay());
            while let Some(event) = peer.next_event() {
                self.events[at].push(event);
            }
        }
    }

    /// Returns whether all peers have confirmed everything up to a tick.
    pub(crate) fn all_confirmed(&self, tick: u64) -> bool {
        self.peers.iter().flatten().all(|peer| peer.confirmed() >= tick)
    }

    pub(crate) fn describe(&self) -> String {
        let peer = |peer: &Player| (peer.tick(), peer.confirmed(), peer.seats());
        let peers: Vec<_> = self.peers.iter().map(|p| p.as_ref().map(peer)).collect();
        format!("{peers:?} {:?} {:?}", self.errors, self.events)
    }

    /// Returns the hashes after a tick of all peers that still have it in their history.
    pub(crate) fn hashes(&self, tick: u64) -> Vec<StateHash> {
        let peers = self.peers.iter().flatten();
        peers.filter_map(|peer| Some(peer.history().get(tick)?.hash)).collect()
    }

    /// Ends all replays after a tick and returns them.
    pub(crate) fn finish(mut self, tick: u64) -> Vec<Vec<u8>> {
        for (peer, replay) in self.peers.iter_mut().zip(&mut self.replays) {
            if let Some(peer) = peer.take() {
                replay.extend(peer.finish(tick).unwrap());
            }
        }
        self.replays
    }
}
