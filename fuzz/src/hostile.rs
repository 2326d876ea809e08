//! Forges packets of an attacker that can read all packets of a match: any packet with fields that are correct, nearly
//! correct, or at a limit of their range.

use std::collections::VecDeque;

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::net::HandshakeParameters;

use crate::forge::mutate;
use crate::source::Source;
use crate::wire::{Body, Input, Message, Packet, Plan, Refused};

/// An address that no peer has.
pub const STRANGER: u32 = 9;
/// Maximum numbers of packets, and of values of each kind, that are kept.
const PACKETS: usize = 64;
const NUMBERS: usize = 8;
const EDGES: [u64; 8] = [0, 1, u64::MAX, u64::MAX - 1, 1 << 63, (1 << 63) - 1, 1 << 32, (1 << 31) - 1];

/// Values seen by an eavesdropper that reads all packets.
#[derive(Debug, Default)]
pub struct Known {
    /// The last packets: sender, receiver, bytes.
    pub packets: VecDeque<(u32, u32, Vec<u8>)>,
    sessions: Vec<u64>,
    nonces: Vec<u64>,
    ticks: Vec<u64>,
    hashes: Vec<StateHash>,
    frames: Vec<i32>,
    pings: Vec<u128>,
    words: Vec<u32>,
    /// Senders of GGRS messages, with their magic numbers.
    magics: Vec<(u32, u16)>,
    parameters: Vec<HandshakeParameters>,
}

fn note<T: PartialEq>(list: &mut Vec<T>, value: T) {
    if !list.contains(&value) {
        if list.len() == NUMBERS {
            list.remove(0);
        }
        list.push(value);
    }
}

impl Known {
    /// Records a packet.
    pub fn receive(&mut self, from: u32, to: u32, bytes: &[u8]) {
        if self.packets.len() == PACKETS {
            self.packets.pop_front();
        }
        self.packets.push_back((from, to, bytes.to_vec()));
        match Packet::read(bytes) {
            Some(Packet::Hello { nonce, parameters, .. }) => {
                note(&mut self.nonces, nonce);
                note(&mut self.parameters, parameters);
            }
            Some(Packet::Welcome { tick, hash, .. } | Packet::Ready { tick, hash, .. }) => {
                note(&mut self.ticks, tick);
                note(&mut self.hashes, hash);
            }
            Some(Packet::Inputs { committed, .. }) => note(&mut self.ticks, committed),
            Some(Packet::Plan { plan, .. }) => {
                note(&mut self.sessions, plan.session);
                note(&mut self.ticks, plan.base);
            }
            Some(Packet::Session { session, message }) => {
                note(&mut self.sessions, session);
                if let Ok(message) = codec::decode(&message) {
                    self.hear_message(from, &message);
                }
            }
            _ => {}
        }
    }

    fn hear_message(&mut self, from: u32, message: &Message) {
        note(&mut self.magics, (from, message.magic));
        match &message.body {
            Body::SyncRequest(word) | Body::SyncReply(word) => note(&mut self.words, *word),
            Body::Input(input) => note(&mut self.frames, input.start_frame),
            Body::InputAck(frame) => note(&mut self.frames, *frame),
            Body::ChecksumReport { frame, .. } => note(&mut self.frames, *frame),
            Body::QualityReport { ping, .. } | Body::QualityReply { pong: ping } => {
                note(&mut self.pings, *ping);
            }
            Body::KeepAlive => {}
        }
    }
}

/// Makes packets from recorded values.
pub struct Forger<'a, 'b> {
    /// Source of decisions.
    pub source: &'a mut Source<'b>,
    /// The recorded values.
    pub known: &'a Known,
    /// The claimed sender.
    pub from: u32,
    /// The receiver.
    pub to: u32,
}

impl Forger<'_, '_> {
    /// A recorded value, mostly one of the newest.
    fn recall<T: Clone>(&mut self, list: &[T]) -> Option<T> {
        let back = self.source.below(list.len().min(3)) + 1;
        if self.source.one_in(10) { None } else { list.get(list.len().checked_sub(back)?).cloned() }
    }

    fn number(&mut self) -> u64 {
        match self.source.below(3) {
            0 => self.source.pick(&EDGES),
            1 => u64::from(self.source.byte()),
            _ => self.source.word() >> self.source.below(64),
        }
    }

    fn session(&mut self) -> u64 {
        let known = self.known;
        self.recall(&known.sessions).unwrap_or_else(|| self.number())
    }

    fn nonce(&mut self) -> u64 {
        let known = self.known;
        self.recall(&known.nonces).unwrap_or_else(|| self.number())
    }

    fn tick(&mut self) -> u64 {
        let known = self.known;
        let nearby = i64::from(self.source.byte() as i8);
        match self.recall(&known.ticks) {
            Some(tick) => tick.saturating_add_signed(nearby / 2),
            None => self.number(),
        }
    }

    fn frame(&mut self) -> i32 {
        let known = self.known;
        let nearby = i32::from(self.source.byte() as i8);
        match self.recall(&known.frames) {
            Some(frame) => frame.saturating_add(nearby / 2),
            None => self.number() as i32,
        }
    }

    /// A state of the game.
    fn state(&mut self) -> u64 {
        self.source.below(3) as u64
    }

    fn hash(&mut self) -> StateHash {
        let known = self.known;
        if self.source.one_in(2) {
            return StateHash::of(&self.state());
        }
        self.recall(&known.hashes).unwrap_or(StateHash(u128::from(self.number())))
    }

    fn seat(&mut self) -> u32 {
        self.source.pick(&[0, 1, 2, 3, 31, 32, 63, 64, u32::MAX])
    }

    fn parameters(&mut self) -> Option<HandshakeParameters> {
        let known = self.known;
        let mut parameters = known.parameters.last()?.clone();
        match self.source.below(12) {
            0 => parameters.semantics = self.number() as u32,
            1 => parameters.rules = "x".repeat(self.source.below(300)),
            2 => parameters.tick_rate = self.number() as u32,
            3 => parameters.players = self.number() as u32,
            4 => parameters.setup = self.hash(),
            _ => {}
        }
        Some(parameters)
    }

    fn bytes(&mut self) -> Vec<u8> {
        match self.source.below(4) {
            0 => codec::encode(&self.state()),
            1 => vec![self.source.byte(); self.source.pick(&[1024, 1023, 1025, 2300])],
            2 => vec![1, 2, 3],
            _ => (0..self.source.below(16)).map(|_| self.source.byte()).collect(),
        }
    }

    fn address(&mut self) -> u32 {
        self.source.pick(&[0, 1, 2, STRANGER, 10])
    }

    fn plan(&mut self) -> Plan {
        let others = match self.source.below(3) {
            0 => {
                let seats = 0..self.source.pick(&[3, 4, 64]);
                let strangers = seats.map(|seat| (seat, Some(100 + seat)));
                strangers.filter(|_| self.source.one_in(2)).collect()
            }
            1 => (0..self.source.below(5)).map(|_| (self.seat(), Some(self.address()))).collect(),
            _ => {
                let others = [0, 1, 2].into_iter().filter(|seat| *seat != self.to);
                others.map(|seat| (seat, (seat != self.from).then_some(seat))).collect()
            }
        };
        let seat = if self.source.one_in(4) { self.seat() } else { self.to };
        let session = if self.source.one_in(4) { self.session() } else { self.number() };
        Plan { session, base: self.tick(), seat, others }
    }

    /// Any packet.
    pub fn packet(&mut self) -> Packet {
        let nonce = self.nonce();
        match self.source.below(20) {
            0 | 1 => {
                let Some(parameters) = self.parameters() else {
                    return Packet::Agreed { plan: self.session() };
                };
                let seat = self.source.one_in(2).then(|| self.seat());
                let nonce = if self.source.one_in(2) { self.number() } else { nonce };
                Packet::Hello { nonce, parameters, seat, watch: self.source.one_in(2) }
            }
            2 => Packet::Refused { nonce, why: self.why() },
            3 => Packet::Redirect { nonce, to: self.address() },
            4 | 5 => {
                let length = [0, 8, 1, 1024, 1025, 3000, 64 << 20, (64 << 20) + 1, u64::MAX];
                let length = self.source.pick(&length);
                Packet::Welcome { nonce, tick: self.tick(), hash: self.hash(), length }
            }
            6 => Packet::WantState { nonce, offset: self.offset() },
            7 | 8 => Packet::State { nonce, offset: self.offset(), bytes: self.bytes() },
            9 => Packet::WantInputs { nonce, from: self.tick() },
            10 | 11 => self.inputs(nonce),
            12 => Packet::Ready { nonce, tick: self.tick(), hash: self.hash() },
            13 => Packet::Plan { parent: self.session(), plan: self.plan() },
            14 => Packet::Agreed { plan: self.session() },
            15 => {
                let gone = self.source.pick(&[0, 1, 2, 4, 6, 3, 5, 7, 8, u64::MAX]);
                let (session, settled) = (self.session(), self.source.one_in(2));
                Packet::Gone { session, gone, ticks: self.tick(), settled }
            }
            16 => Packet::Bye { session: self.session() },
            _ => Packet::Session { session: self.session(), message: self.message() },
        }
    }

    fn why(&mut self) -> Refused {
        match (self.source.below(4), self.parameters()) {
            (0, Some(parameters)) => Refused::HandshakeParameters(parameters),
            (1, _) => Refused::Full,
            (2, _) => Refused::Diverged { tick: self.tick() },
            _ => Refused::Other("x".repeat(self.source.below(300))),
        }
    }

    fn offset(&mut self) -> u64 {
        if self.source.one_in(4) { self.number() } else { 1024 * self.source.below(3) as u64 }
    }

    fn inputs(&mut self, nonce: u64) -> Packet {
        let inputs = match self.source.below(3) {
            0 => vec![self.bytes()],
            1 => vec![Vec::new(); self.source.pick(&[1, 40, 280])],
            _ => vec![codec::encode(&[1u8, 2, 255]); 1 + self.source.below(40)],
        };
        Packet::Inputs { nonce, from: self.tick(), ticks: inputs, committed: self.tick() }
    }

    /// Any GGRS message, possibly with changed bytes.
    fn message(&mut self) -> Vec<u8> {
        let magics = self.known.magics.iter().rev();
        let magic = magics.filter(|(from, _)| *from == self.from).map(|(_, magic)| *magic).next();
        let magic = if self.source.one_in(8) { self.number() as u16 } else { magic.unwrap_or(1) };
        let known = self.known;
        let body = match self.source.below(14) {
            0 => Body::SyncRequest(self.number() as u32),
            1 => Body::SyncReply(self.recall(&known.words).unwrap_or(0)),
            2 => Body::InputAck(self.frame()),
            3 => {
                let ping = self.recall(&known.pings).unwrap_or(u128::MAX);
                Body::QualityReport { frame_advantage: self.number() as i16, ping }
            }
            4 => Body::QualityReply { pong: self.recall(&known.pings).unwrap_or(u128::MAX) },
            5 | 6 => Body::ChecksumReport { checksum: self.hash().0, frame: self.frame() },
            7 => Body::KeepAlive,
            _ => Body::Input(self.input()),
        };
        let mut bytes = codec::encode(&Message { magic, body });
        if self.source.one_in(16) {
            mutate(self.source, &mut bytes);
        }
        bytes
    }

    fn input(&mut self) -> Input {
        let mut input = self.heard_input().unwrap_or_default();
        for _ in 0..=self.source.below(3) {
            match self.source.below(6) {
                0 => input.start_frame = self.frame(),
                1 => input.ack_frame = self.frame(),
                2 => {
                    let players = self.source.pick(&[2, 3, 0, 1, 4, 40]);
                    input.connections = (0..players).map(|_| (self.source.one_in(4), self.frame())).collect();
                }
                3 => input.disconnect_requested = !input.disconnect_requested,
                4 => mutate(self.source, &mut input.bytes),
                _ => input.bytes = self.frames(),
            }
        }
        input
    }

    /// The last inputs sent from the claimed sender to the receiver.
    fn heard_input(&self) -> Option<Input> {
        let way = |packet: &&(u32, u32, Vec<u8>)| (packet.0, packet.1) == (self.from, self.to);
        self.known.packets.iter().rev().filter(way).find_map(|(_, _, bytes)| {
            let Packet::Session { message, .. } = Packet::read(bytes)? else { return None };
            match codec::decode::<Message>(&message).ok()?.body {
                Body::Input(input) => Some(input),
                _ => None,
            }
        })
    }

    /// Encoded inputs of some frames: a run of zeros or ones, or uncompressed inputs of some length.
    fn frames(&mut self) -> Vec<u8> {
        if self.source.one_in(3) {
            let length =
                self.source.pick(&[2, 27, 54, 2 * 96, 27 * 100, 65_535, 65_536, 65_537, 1 << 20, 1 << 25]);
            return varint(length << 2 | self.source.below(2) << 1 | 1);
        }
        let length = self.source.pick(&[25, 25, 25, 0, 1, 24, 26, 50, 65_535]);
        let count = self.source.pick(&[1, 2, 3, 5, 20, 60, 70]);
        let mut bytes = Vec::new();
        for _ in 0..count {
            bytes.extend_from_slice(&(length as u16).to_le_bytes());
            bytes.resize(bytes.len() + length.min(60), self.source.pick(&[0, 0, 1, 255]));
        }
        [varint(bytes.len() << 1), bytes].concat()
    }
}

/// Encodes seven bits per byte, lowest bits first.
fn varint(mut value: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value >= 128 {
        bytes.push(value as u8 | 128);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}
