//! Sends changed packets to peers of a match: to two peers that play from the start, and to a third one that begins to
//! join after 20 ticks.
//!
//! The input sets the number of ticks before the attacks, 20 to 39, and then describes each attack. Each attack changes
//! one of the last 64 packets and sends it.

use lockstep2d::session::{Address, Config, Endpoint, Identity, Key, PeerId, Request, Role};

use crate::forge::mutate;
use crate::source::Source;

const TAG: u64 = 5;
/// Largest number of attacks of an input.
const ATTACKS: usize = 24;
const COUNT: usize = 3;

struct Match {
    endpoints: Vec<Endpoint>,
    now: u64,
    seen: Vec<(usize, usize, Vec<u8>)>,
}

fn address(index: usize) -> Address {
    Address::new(&[index as u8]).expect("an address of one byte")
}

fn identity(index: usize) -> Identity {
    let number = index as u32 + 1;
    Identity { id: PeerId(number), key: Key(number.into()), offer: vec![1], secret: [7, number.into()] }
}

impl Match {
    fn new() -> Self {
        let mut config = Config::new(TAG, 4);
        (config.guess, config.save_interval, config.check_interval) = (3, 1, 4);
        let role = Role::Player { seats: 1 };
        let host = Endpoint::host(config.clone(), identity(0), 1);
        let join = |index: usize| Endpoint::join(config.clone(), identity(index), role, address(0));
        let endpoints = [host, join(1), join(2)].map(|endpoint| endpoint.expect("a valid config")).into();
        Match { endpoints, now: 0, seen: Vec::new() }
    }

    /// Simulates a tick. Packets arrive at its end.
    fn step(&mut self, active: usize) {
        self.now += 16_667;
        let mut sent = Vec::new();
        for (from, endpoint) in self.endpoints.iter_mut().enumerate().take(active) {
            endpoint.update(self.now);
            while endpoint.next_event().is_some() {}
            if endpoint.wants_state() {
                let tick = endpoint.session().map_or(0, |session| session.confirmed());
                endpoint.offer_state(tick, vec![9; 3000]);
            }
            if let Some(session) = endpoint.session_mut() {
                play(session, self.now);
            }
            endpoint.flush();
            while let Some((to, bytes)) = endpoint.next_packet() {
                sent.push((from, usize::from(to.bytes().first().copied().unwrap_or(0)), bytes));
            }
        }
        for (from, to, bytes) in sent {
            if let Some(endpoint) = self.endpoints.get_mut(to) {
                endpoint.receive(self.now, address(from), &bytes);
            }
            self.seen.push((from, to, bytes));
        }
        let old = self.seen.len().saturating_sub(64);
        self.seen.drain(..old);
    }
}

fn play(session: &mut lockstep2d::session::Session, now: u64) {
    for _ in 0..4 {
        if !session.is_due(now) {
            break;
        }
        let input = vec![(now >> 18) as u8; session.seats().count_ones() as usize];
        session.advance(now, &input).expect("inputs of the right size");
    }
    while let Some(request) = session.next_request() {
        if let Request::Checksum { tick } = request {
            session.report_hash(tick, tick.into());
        }
    }
    while session.next_event().is_some() {}
}

/// Corrects the checksum of a packet to `receiver`, for the match with the tag `tag`. The checksum of packets for joining
/// does not depend on the receiver.
pub fn repair(tag: u64, receiver: PeerId, bytes: &mut [u8]) {
    let is_join_packet = bytes.get(8).is_some_and(|&kind| kind >= 0x80);
    let seed = if is_join_packet { tag } else { tag ^ u64::from(receiver.0) };
    if let Some((sum, body)) = bytes.split_first_chunk_mut::<4>() {
        let digest = twox_hash::XxHash3_128::oneshot_with_seed(seed, body).to_le_bytes();
        sum.copy_from_slice(&digest[..4]);
    }
}

/// Simulates the match and the attacks of an input. Returns whether all three endpoints have a session that has played
/// more than 20 ticks.
pub fn run(bytes: &[u8]) -> bool {
    let mut game = Match::new();
    let mut source = Source::new(bytes);
    let start = 20 + source.below(20);
    (0..start).for_each(|step| game.step(if step < 20 { 2 } else { COUNT }));
    for _ in 0..ATTACKS {
        if source.is_empty() {
            break;
        }
        let taken = game.seen.get(source.below(game.seen.len())).cloned();
        let Some((mut from, mut to, mut packet)) = taken else { break };
        for _ in 0..=source.below(3) {
            mutate(&mut source, &mut packet);
        }
        let how = source.byte();
        if how & 2 == 0 {
            (from, to) = (source.below(COUNT + 1), source.below(COUNT));
        }
        if how & 1 == 0 {
            repair(TAG, identity(to).id, &mut packet);
        }
        if let Some(endpoint) = game.endpoints.get_mut(to) {
            endpoint.receive(game.now, address(from), &packet);
        }
        if how & 12 == 0 {
            game.step(COUNT);
        }
    }
    (0..10).for_each(|_| game.step(COUNT));
    let bounded = |endpoint: &Endpoint| {
        endpoint.session().is_none_or(|session| session.statistics().input_bytes < 1 << 20)
    };
    assert!(game.endpoints.iter().all(bounded), "inputs fill the memory");
    game.endpoints.iter().all(|endpoint| endpoint.session().is_some_and(|session| session.played() > 20))
}
