//! A match in simulated time. Links delay, drop, duplicate and reorder packets, and fail for a while.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use lockstep2d::session::{Config, Event, Key, PACKET_BYTES_MAX, PeerId, Role, Session, Tick, View};

use super::game::{Game, START, mix};

pub(crate) type Us = u64;
pub(crate) const MS: Us = 1000;
pub(crate) const S: Us = 1_000_000;

#[derive(Clone, Debug)]
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11
    }

    /// Random number from `low` to `high`, both included.
    pub(crate) fn range(&mut self, low: u64, high: u64) -> u64 {
        low + self.next() % (high - low + 1)
    }

    pub(crate) fn percent(&mut self, percent: u64) -> bool {
        self.next() % 100 < percent
    }

    pub(crate) fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.range(0, values.len() as u64 - 1) as usize]
    }
}

/// One direction of a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinkConditions {
    pub(crate) exists: bool,
    pub(crate) latency: Us,
    /// Largest addition to the latency.
    pub(crate) jitter: Us,
    pub(crate) loss: u64,
    /// Time until which the link is cut. Packets that are sent earlier are lost.
    pub(crate) cut_until: Us,
}

#[derive(Debug)]
pub(crate) struct Peer {
    pub(crate) session: Session,
    pub(crate) game: Game,
    pub(crate) on: bool,
    pub(crate) started: bool,
    pub(crate) leaves: bool,
    pub(crate) kicked: bool,
    pub(crate) spectator: bool,
    pub(crate) stopped_until: Us,
    /// Speed of the peer's clock, in thousandths of the speed of simulated time.
    pub(crate) skew: u64,
    pub(crate) queue: Vec<Vec<u8>>,
    pub(crate) lost_seats: u32,
    /// Whether the game shows a menu and does not advance.
    pub(crate) in_menu: bool,
    /// Peers for which the session reported that it waits. The flag tells whether the session hears the peer, also
    /// through others.
    pub(crate) waiting: Vec<(PeerId, bool)>,
    pub(crate) desyncs: u32,
    /// Pauses and lags that the session reported.
    pub(crate) events: Vec<Event>,
    bytes: u64,
    pub(crate) finished: Option<(Tick, u64)>,
    pub(crate) was_leaving: bool,
    pub(crate) left_at: Us,
    pub(crate) seen_view: u32,
    pub(crate) seen_final: Tick,
    pub(crate) seen_confirmed: Tick,
    /// Issued inputs of each of the peer's spans, by the number of the span.
    pub(crate) issued: BTreeMap<usize, Vec<Vec<u8>>>,
    input: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Look(usize),
    Packet(usize),
    Crash(usize),
}

pub(crate) struct Sim {
    pub(crate) now: Us,
    pub(crate) rng: Rng,
    heap: BinaryHeap<Reverse<(Us, u64, Kind)>>,
    sequence: u64,
    packets: Vec<Option<(usize, Vec<u8>)>>,
    free: Vec<usize>,
    pub(crate) peers: Vec<Peer>,
    pub(crate) links: Vec<Vec<LinkConditions>>,
    /// Percentage of very late packets.
    pub(crate) late: u64,
    /// Percentage of packets that arrive twice.
    pub(crate) doubled: u64,
    /// Percentage of new views at which a peer crashes.
    pub(crate) assassin: u64,
    pub(crate) look: Us,
    /// State before each tick, shared by all peers.
    pub(crate) history: Vec<u64>,
    pub(crate) views: BTreeMap<u32, View>,
    pub(crate) failure: Option<String>,
    pub(crate) sent: u64,
    pub(crate) bytes: u64,
    pub(crate) expects_conflicts: bool,
    /// Size of an input. All bytes but the first are random.
    pub(crate) input_bytes: u64,
}

pub(crate) fn id(index: usize) -> PeerId {
    PeerId((index as u32 + 1).wrapping_mul(0x9e37_79b1))
}

pub(crate) fn key(index: usize) -> Key {
    Key(index as u64 + 100)
}

impl Sim {
    pub(crate) fn new(seed: u64, count: usize) -> Self {
        let link = LinkConditions { exists: true, latency: 0, jitter: 0, loss: 0, cut_until: 0 };
        Sim {
            now: 0,
            rng: Rng(seed | 1),
            heap: BinaryHeap::new(),
            sequence: 0,
            packets: Vec::new(),
            free: Vec::new(),
            peers: Vec::new(),
            links: vec![vec![link; count]; count],
            late: 0,
            doubled: 2,
            assassin: 0,
            look: 50 * MS,
            history: vec![START],
            views: BTreeMap::new(),
            failure: None,
            sent: 0,
            bytes: 0,
            expects_conflicts: false,
            input_bytes: 1,
        }
    }

    pub(crate) fn add(&mut self, config: Config, role: Role, first: &View, skew: u64) -> usize {
        let index = self.peers.len();
        let seed = self.rng.next();
        let session =
            Session::new(config, id(index), key(index), role, first.clone(), seed).expect("a valid config");
        self.views.entry(first.number).or_insert_with(|| first.clone());
        self.peers.push(Peer {
            session,
            game: Game::new(),
            on: false,
            started: false,
            leaves: false,
            kicked: false,
            spectator: role == Role::Spectator,
            stopped_until: 0,
            skew,
            queue: Vec::new(),
            lost_seats: 0,
            in_menu: false,
            waiting: Vec::new(),
            desyncs: 0,
            events: Vec::new(),
            bytes: 0,
            finished: None,
            was_leaving: false,
            left_at: 0,
            seen_view: first.number,
            seen_final: 0,
            seen_confirmed: 0,
            issued: BTreeMap::new(),
            input: seed,
        });
        index
    }

    pub(crate) fn start(&mut self, index: usize, at: Us) {
        self.peers[index].on = true;
        self.peers[index].started = true;
        self.push(at, Kind::Look(index));
    }

    pub(crate) fn crash_at(&mut self, index: usize, at: Us) {
        self.push(at, Kind::Crash(index));
    }

    /// Makes two peers known to each other, as a join does.
    pub(crate) fn introduce(&mut self, a: usize, b: usize) {
        self.peers[a].session.attach(id(b), Some(key(b)));
        self.peers[b].session.attach(id(a), Some(key(a)));
    }

    pub(crate) fn fail(&mut self, what: String) {
        let at = self.now / MS;
        self.failure.get_or_insert_with(|| format!("{at} ms: {what}"));
    }

    fn push(&mut self, at: Us, kind: Kind) {
        self.sequence += 1;
        self.heap.push(Reverse((at, self.sequence, kind)));
    }

    /// Simulates until a time, or to the first failure.
    pub(crate) fn run(&mut self, until: Us) {
        while let Some(&Reverse((at, _, kind))) = self.heap.peek() {
            if at > until || self.failure.is_some() {
                break;
            }
            self.heap.pop();
            self.now = at;
            match kind {
                Kind::Look(peer) => self.look(peer),
                Kind::Crash(peer) => self.peers[peer].on = false,
                Kind::Packet(place) => {
                    let Some((to, bytes)) = self.packets[place].take() else { continue };
                    self.free.push(place);
                    self.deliver(to, bytes);
                }
            }
        }
        self.now = until;
    }

    fn deliver(&mut self, to: usize, bytes: Vec<u8>) {
        let now = self.now;
        let peer = &mut self.peers[to];
        if !peer.on {
            return;
        }
        if peer.stopped_until > now {
            if peer.queue.len() < 200 {
                peer.queue.push(bytes);
            }
            return;
        }
        let local = now * peer.skew / 1000;
        peer.session.receive(local, &bytes);
        self.check(to);
    }

    fn look(&mut self, index: usize) {
        let now = self.now;
        let look = self.look;
        let peer = &mut self.peers[index];
        if !peer.on {
            return;
        }
        if peer.stopped_until > now {
            let at = peer.stopped_until;
            self.push(at, Kind::Look(index));
            return;
        }
        let local = now * peer.skew / 1000;
        for bytes in std::mem::take(&mut peer.queue) {
            peer.session.receive(local, &bytes);
        }
        peer.session.update(local);
        let mut turns = 0;
        while !peer.in_menu && peer.session.is_due(local) && turns < 8 {
            turns += 1;
            let seats = peer.session.seats().count_ones() as u64;
            let first = |seat| (mix(peer.input, seat) % 5) as u8;
            let random = |seat, at| mix(mix(local, seat), at) as u8;
            let size = self.input_bytes;
            let one = |seat| std::iter::once(first(seat)).chain((1..size).map(move |at| random(seat, at)));
            let input: Vec<u8> = (0..seats).flat_map(one).collect();
            let spans = peer.session.view().spans.iter().enumerate();
            let own = spans.filter(|(_, span)| span.owner == id(index) && span.is_open());
            let own: Vec<(usize, u8)> = own.map(|(number, span)| (number, span.seat)).collect();
            if peer.session.advance(local, &input) == Ok(true) {
                for &(number, seat) in &own {
                    let place = own.iter().filter(|(_, other)| *other < seat).count();
                    let issued =
                        input.chunks_exact(size as usize).nth(place).expect("an input for each seat");
                    peer.issued.entry(number).or_default().push(issued.to_vec());
                }
                // The first byte of each seat's input depends on `peer.input`, which counts up, and jumps to a random
                // number at each multiple of 3.
                peer.input =
                    if peer.input.is_multiple_of(3) { mix(peer.input, local) } else { peer.input + 1 };
            }
            if let Err(what) = peer.game.fulfil(&mut peer.session) {
                self.fail(format!("peer {index}: {what}"));
                return;
            }
        }
        let Peer { game, session, .. } = &mut self.peers[index];
        if let Err(what) = game.fulfil(session) {
            self.fail(format!("peer {index}: {what}"));
            return;
        }
        self.check(index);
        self.send(index);
        if self.peers[index].session.status().is_closed() {
            self.peers[index].on = false;
            self.check_goodbye(index);
            return;
        }
        let peer = &self.peers[index];
        let at = now + look * 1000 / peer.skew.max(1);
        self.push(at, Kind::Look(index));
    }

    fn send(&mut self, from: usize) {
        while let Some((to, bytes)) = self.peers[from].session.next_packet() {
            let Some(to) = (0..self.peers.len()).find(|&index| id(index) == to) else { continue };
            if bytes.len() > PACKET_BYTES_MAX {
                return self.fail(format!("{from} sends a packet of {} bytes", bytes.len()));
            }
            self.sent += 1;
            self.bytes += bytes.len() as u64;
            self.peers[from].bytes += bytes.len() as u64;
            let link = self.links[from][to];
            let lost = !link.exists || self.now < link.cut_until || self.rng.percent(link.loss);
            if lost {
                continue;
            }
            if self.doubled > 0 && self.rng.percent(self.doubled) {
                self.carry(to, bytes.clone(), link);
            }
            self.carry(to, bytes, link);
        }
    }

    fn carry(&mut self, to: usize, bytes: Vec<u8>, link: LinkConditions) {
        let mut at = self.now + link.latency + self.rng.range(0, link.jitter);
        if self.late > 0 && self.rng.percent(self.late) {
            at += self.rng.range(0, 2500) * MS;
        }
        let place = self.free.pop().unwrap_or_else(|| {
            self.packets.push(None);
            self.packets.len() - 1
        });
        self.packets[place] = Some((to, bytes));
        self.push(at, Kind::Packet(place));
    }

    pub(crate) fn bytes_from(&self, index: usize) -> u64 {
        self.peers[index].bytes
    }

    /// Bit set of the running peers that `from` can reach, also through others.
    pub(crate) fn reach(&self, from: usize) -> u64 {
        let mut seen = 1_u64 << from;
        for _ in 0..self.peers.len() {
            for (a, links) in self.links.iter().enumerate() {
                for (b, link) in links.iter().enumerate() {
                    let both =
                        self.peers.get(a).is_some_and(|a| a.on) && self.peers.get(b).is_some_and(|b| b.on);
                    if both && link.exists && seen >> a & 1 == 1 {
                        seen |= 1 << b;
                    }
                }
            }
        }
        seen
    }

    /// Newest view that any peer has installed.
    pub(crate) fn newest_view(&self) -> &View {
        self.views.last_key_value().expect("the first view").1
    }

    /// Bit set of the places of peers among the voters of a view, to test for quorums.
    pub(crate) fn voters_among(view: &View, peers: impl Iterator<Item = usize>) -> u64 {
        peers.filter_map(|index| view.voter(id(index))).fold(0, |set, index| set | 1 << index)
    }
}
