//! Endpoints that join a match, in simulated time.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use lockstep2d::session::{
    Address, Config, Endpoint, Event, Identity, JoinEvent, Request, Role, Status, Tick,
};

use super::game::{START, mix_inputs};
use super::sim::{MS, Rng, S, Us, id, key};

/// An endpoint and its game. The state of the game is a hash, followed by bytes that make it larger.
pub(super) struct Node {
    pub(super) endpoint: Endpoint,
    pub(super) address: u8,
    /// Time of the node's clock at the start of the simulation.
    pub(super) origin: Us,
    pub(super) on: bool,
    pub(super) tick: Tick,
    pub(super) state: u64,
    pub(super) saved: Vec<(Tick, u64)>,
    pub(super) events: Vec<JoinEvent>,
    pub(super) joined_at: Option<Us>,
    pub(super) desynced: bool,
    /// Longest time between two ticks, measured after the first two seconds. Tests reset it to 0.
    pub(super) stall: Us,
    pub(super) last_tick: Us,
}

/// Arrival time, number, sender, receiver and bytes.
pub(super) type Datagram = (Us, u64, u8, u8, Vec<u8>);

pub(super) struct Net {
    pub(super) now: Us,
    pub(super) rng: Rng,
    pub(super) nodes: Vec<Node>,
    pub(super) heap: BinaryHeap<Reverse<Datagram>>,
    pub(super) sequence: u64,
    pub(super) latency: Us,
    pub(super) loss: u64,
    pub(super) state_bytes: usize,
    /// Number of bytes sent to each address.
    pub(super) sent_to: [u64; 256],
    /// Number of bytes received from each address.
    pub(super) received_from: [u64; 256],
    pub(super) blocked: Vec<(u8, u8)>,
    /// Links that a NAT blocks until a packet is sent in the other direction.
    pub(super) shut: Vec<(u8, u8)>,
}

pub(super) fn address(number: u8) -> Address {
    Address::new(&[10, 0, 0, number]).expect("valid")
}

pub(super) fn identity(index: usize) -> Identity {
    let secret = [index as u64 * 77 + 1, 12345];
    Identity { id: id(index), key: key(index), offer: vec![1, 2, 3], secret }
}

pub(super) fn config() -> Config {
    let mut config = Config::new(9, 4);
    (config.save_interval, config.check_interval) = (4, 8);
    config
}

impl Net {
    pub(super) fn new(latency: Us, loss: u64, state_bytes: usize) -> Self {
        Net {
            now: 0,
            rng: Rng(77),
            nodes: Vec::new(),
            heap: BinaryHeap::new(),
            sequence: 0,
            latency,
            loss,
            state_bytes,
            sent_to: [0; 256],
            received_from: [0; 256],
            blocked: Vec::new(),
            shut: Vec::new(),
        }
    }

    pub(super) fn add(&mut self, endpoint: Endpoint) -> usize {
        let number = self.nodes.len() as u8 + 1;
        self.nodes.push(Node {
            endpoint,
            address: number,
            origin: 0,
            on: true,
            tick: 0,
            state: START,
            saved: vec![(0, START)],
            events: Vec::new(),
            joined_at: None,
            desynced: false,
            stall: 0,
            last_tick: 0,
        });
        self.nodes.len() - 1
    }

    pub(super) fn host(&mut self) -> usize {
        self.add(Endpoint::host(config(), identity(self.nodes.len()), 1).expect("valid"))
    }

    pub(super) fn join(&mut self, role: Role, contact: u8) -> usize {
        self.add(Endpoint::join(config(), identity(self.nodes.len()), role, address(contact)).expect("valid"))
    }

    pub(super) fn run(&mut self, until: Us) {
        while self.now < until {
            self.now += MS;
            while self.heap.peek().is_some_and(|Reverse(packet)| packet.0 <= self.now) {
                let Reverse((_, _, from, to, bytes)) = self.heap.pop().expect("valid");
                let node = self.nodes.iter_mut().find(|node| node.address == to && node.on);
                if let Some(node) = node {
                    self.received_from[from as usize] += bytes.len() as u64;
                    node.endpoint.receive(self.now + node.origin, address(from), &bytes);
                }
            }
            for index in 0..self.nodes.len() {
                if self.nodes[index].on {
                    self.step(index);
                    self.send(index);
                }
            }
        }
    }

    pub(super) fn step(&mut self, index: usize) {
        let state_bytes = self.state_bytes;
        let node = &mut self.nodes[index];
        let now = self.now + node.origin;
        node.endpoint.update(now);
        while let Some(event) = node.endpoint.next_event() {
            if let JoinEvent::State { tick, bytes } = &event {
                node.tick = *tick;
                node.saved.clear();
                node.state = u64::from_le_bytes(bytes[..8].try_into().expect("valid"));
                assert!(bytes[8..].iter().all(|&byte| byte == 7), "the bytes that were sent");
                node.joined_at = Some(self.now);
            }
            node.events.push(event);
        }
        if node.endpoint.wants_state() {
            let confirmed = node.endpoint.session().expect("valid").confirmed();
            if let Some(&(tick, state)) = node.saved.iter().rev().find(|(tick, _)| *tick <= confirmed) {
                let mut bytes = state.to_le_bytes().to_vec();
                bytes.resize(8 + state_bytes, 7);
                node.endpoint.offer_state(tick, bytes);
            }
        }
        let mut turns = 0;
        while let Some(session) = node.endpoint.session_mut() {
            let due = session.is_due(now) && turns < 8;
            if due {
                let input = vec![(now / 100_000 % 7) as u8; session.seats().count_ones() as usize];
                session.advance(now, &input).expect("valid");
                turns += 1;
            }
            while let Some(request) = session.next_request() {
                match request {
                    Request::Save { tick } => {
                        node.saved.retain(|(saved, _)| *saved < tick);
                        node.saved.push((tick, node.state));
                    }
                    Request::Load { tick } => {
                        (node.tick, node.state) =
                            *node.saved.iter().find(|(saved, _)| *saved == tick).expect("valid");
                    }
                    Request::Advance { tick, inputs } => {
                        assert_eq!(tick, node.tick);
                        node.state = mix_inputs(node.state, &inputs);
                        node.tick += 1;
                        if node.last_tick > 0 && now > 2 * S {
                            node.stall = node.stall.max(now - node.last_tick);
                        }
                        node.last_tick = now;
                    }
                    Request::Checksum { tick } => {
                        let &(_, state) = node.saved.iter().find(|(saved, _)| *saved == tick).expect("valid");
                        session.report_hash(tick, u128::from(state));
                    }
                    Request::Forget { tick } => node.saved.retain(|(saved, _)| *saved >= tick),
                }
            }
            while let Some(event) = session.next_event() {
                node.desynced |= matches!(event, Event::Desync { .. } | Event::Conflict { .. });
            }
            if !due {
                break;
            }
        }
        node.endpoint.flush();
    }

    pub(super) fn send(&mut self, index: usize) {
        while let Some((to, bytes)) = self.nodes[index].endpoint.next_packet() {
            let (from, to) = (self.nodes[index].address, to.bytes()[3]);
            self.sent_to[to as usize] += bytes.len() as u64;
            self.shut.retain(|link| *link != (to, from));
            let closed = self.blocked.iter().chain(&self.shut).any(|link| *link == (from, to));
            let lost = self.rng.percent(self.loss) || closed;
            if !lost {
                self.post(from, to, bytes);
            }
        }
    }

    pub(super) fn post(&mut self, from: u8, to: u8, bytes: Vec<u8>) {
        self.sequence += 1;
        let at = self.now + self.latency + self.rng.range(0, 2 * MS);
        self.heap.push(Reverse((at, self.sequence, from, to, bytes)));
    }

    pub(super) fn status(&self, index: usize) -> Option<Status> {
        self.nodes[index].endpoint.session().map(|session| session.status())
    }

    pub(super) fn assert_all_play(&self) {
        let lead = self.nodes.iter().filter(|node| node.on).map(|node| node.tick).max().expect("valid");
        for (index, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.on) {
            let status = self.status(index);
            assert!(matches!(status, Some(Status::Playing | Status::Watching)), "{index}: {status:?}");
            assert!(node.tick + 60 > lead, "{index}: {} of {lead}", node.tick);
            assert!(!node.desynced, "{index}");
        }
    }
}
