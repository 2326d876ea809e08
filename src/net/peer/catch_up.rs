//! Late join: requests a seat, loads a state, and plays the inputs since then faster than real time.

use alloc::collections::VecDeque;
use alloc::string::ToString;
use alloc::vec;
use alloc::vec::Vec;
use core::time::Duration;

use super::{NetError, Peer, RESEND};
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::EncodedInputs;
use crate::net::driver::Driver;
use crate::net::packet::{Nonce, Packet, Refused};
use crate::net::transport::Transport;
use crate::net::wire::{Address, NetGame};

/// Size of a piece of a state in one packet, in bytes.
pub(super) const PIECE_BYTES: usize = 1024;
/// Maximum size of a state in bytes: bounds the memory that an untrusted peer can make this one allocate.
const STATE_BYTES_MAX: u64 = 64 << 20;
/// Number of pieces of a state that are requested at a time.
const PIECES_AT_ONCE: usize = 32;
/// A peer that is at most this number of ticks behind the final ticks counts as up to date.
const ALMOST: u64 = 4;
/// Number of ticks that a spectator stays behind, to avoid stutter.
const WATCH_BEHIND: usize = 12;
/// Maximum number of queued ticks; no more are requested. Each arrived in a packet, so they take 32 MiB at most.
const QUEUE_MAX: usize = 2000;
/// Maximum tick of a match, so that sums of ticks do not overflow.
const TICK_MAX: u64 = 1 << 48;
/// Number of timeouts without an answer after which the contact counts as gone.
const PATIENCE: u32 = 4;

/// State of a peer without a seat.
pub(super) struct CatchUp<A> {
    contact: A,
    nonce: Nonce,
    seat: Option<u32>,
    watch: bool,
    stage: Stage,
    asked: Option<Duration>,
    heard: Option<Duration>,
}

enum Stage {
    Asking,
    Loading { tick: u64, hash: StateHash, bytes: Vec<u8>, missing: VecDeque<usize> },
    Following { queue: VecDeque<Vec<u8>>, committed: u64 },
}

impl<A: Address> CatchUp<A> {
    pub(super) fn play(contact: A, nonce: Nonce, seat: Option<u32>) -> Self {
        CatchUp { contact, nonce, seat, watch: false, stage: Stage::Asking, asked: None, heard: None }
    }

    pub(super) fn watch(contact: A, nonce: Nonce) -> Self {
        CatchUp { watch: true, ..Self::play(contact, nonce, None) }
    }

    /// Whether the first tick of the match is still unknown to this peer.
    pub(super) fn is_loading(&self) -> bool {
        !matches!(self.stage, Stage::Following { .. })
    }

    pub(super) fn contact(&self) -> &A {
        &self.contact
    }
}

impl<G: NetGame, A: Address, T: Transport<A>> Peer<G, A, T> {
    /// Requests what is missing, and plays what has arrived.
    pub(super) fn catch_up(&mut self) -> Result<(), NetError> {
        let Some(joining) = &mut self.catch_up else { return Ok(()) };
        let heard = *joining.heard.get_or_insert(self.now);
        if self.now > heard + PATIENCE * self.options.timeout {
            return Err(NetError::NoAnswer);
        }
        if let Stage::Following { .. } = joining.stage {
            self.follow()?;
        }
        self.ask();
        Ok(())
    }

    fn ask(&mut self) {
        let Some(joining) = &mut self.catch_up else { return };
        if joining.asked.is_some_and(|asked| self.now < asked + RESEND) {
            return;
        }
        joining.asked = Some(self.now);
        let nonce = joining.nonce;
        let mut packets = Vec::new();
        match &joining.stage {
            Stage::Asking => {
                let parameters = self.parameters.clone();
                packets.push(Packet::Hello { nonce, parameters, seat: joining.seat, watch: joining.watch });
            }
            Stage::Loading { missing, .. } => {
                let piece = |piece: &usize| Packet::WantState { nonce, offset: (piece * PIECE_BYTES) as u64 };
                packets.extend(missing.iter().take(PIECES_AT_ONCE).map(piece));
            }
            Stage::Following { queue, committed } => {
                let tick = self.driver.tick();
                packets.push(Packet::WantInputs { nonce, from: tick + queue.len() as u64 });
                let up_to_date = queue.is_empty() && tick + ALMOST >= *committed;
                if up_to_date && !joining.watch && self.next.is_none() {
                    let hash = self.driver.game().state_hash();
                    packets.push(Packet::Ready { nonce, tick, hash });
                }
            }
        }
        let contact = joining.contact.clone();
        for packet in packets {
            self.send(&packet, &contact);
        }
    }

    pub(super) fn hear_contact(&mut self, from: &A, packet: Packet<A>) -> Result<(), NetError> {
        let Some(joining) = &mut self.catch_up else { return Ok(()) };
        let nonce = joining.nonce;
        if *from != joining.contact {
            return Ok(());
        }
        match packet {
            Packet::Refused { nonce: to, why } if to == nonce => return Err(self.refusal(why)),
            Packet::Redirect { nonce: to, to: contact } if to == nonce => joining.contact = contact,
            Packet::Welcome { nonce: to, tick, hash, length } if to == nonce => {
                if matches!(joining.stage, Stage::Asking) {
                    self.begin_with(tick, hash, length)?;
                }
            }
            Packet::State { nonce: to, offset, bytes } if to == nonce => self.load_piece(offset, &bytes)?,
            Packet::Inputs { nonce: to, from, ticks, committed } if to == nonce => {
                self.queue_inputs(from, ticks, committed);
            }
            _ => return Ok(()),
        }
        if let Some(joining) = &mut self.catch_up {
            joining.heard = Some(self.now);
        }
        Ok(())
    }

    fn refusal(&self, why: Refused) -> NetError {
        match why {
            Refused::HandshakeParameters(theirs) => match self.parameters.agree(&theirs) {
                Err(mismatch) => NetError::HandshakeParameters(mismatch),
                Ok(()) => NetError::Refused { why: "terms".to_string() },
            },
            Refused::Full => NetError::Full,
            Refused::Diverged { tick } => NetError::Diverged { tick },
            Refused::Other(why) => NetError::Refused { why },
        }
    }

    fn begin_with(&mut self, tick: u64, hash: StateHash, length: u64) -> Result<(), NetError> {
        let Some(joining) = &mut self.catch_up else { return Ok(()) };
        if length > STATE_BYTES_MAX {
            return Err(NetError::State { why: alloc::format!("{length} bytes") });
        }
        if tick > TICK_MAX {
            return Err(NetError::State { why: alloc::format!("after {tick} ticks") });
        }
        if length == 0 {
            if tick != self.driver.tick() || hash != self.driver.game().state_hash() {
                return Err(NetError::Diverged { tick });
            }
            joining.stage = Stage::Following { queue: VecDeque::new(), committed: tick };
        } else {
            let length = usize::try_from(length).unwrap_or(usize::MAX);
            let missing = (0..length.div_ceil(PIECE_BYTES)).collect();
            joining.stage = Stage::Loading { tick, hash, bytes: vec![0; length], missing };
        }
        joining.asked = None;
        Ok(())
    }

    fn load_piece(&mut self, offset: u64, piece: &[u8]) -> Result<(), NetError> {
        let Some(joining) = &mut self.catch_up else { return Ok(()) };
        let Stage::Loading { tick, hash, bytes, missing } = &mut joining.stage else { return Ok(()) };
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let Some(at) = missing.iter().position(|number| number * PIECE_BYTES == offset) else {
            return Ok(());
        };
        let end = bytes.len().min(offset + PIECE_BYTES);
        if piece.len() != end - offset {
            return Ok(());
        }
        bytes[offset..end].copy_from_slice(piece);
        missing.remove(at);
        if !missing.is_empty() {
            // When half of the requested pieces have arrived, there is room to request more, while the others may be
            // under way.
            if missing.len() % (PIECES_AT_ONCE / 2) == 0 {
                joining.asked = None;
            }
            return Ok(());
        }
        let save: G::Save =
            codec::decode(bytes).map_err(|error| NetError::State { why: error.to_string() })?;
        let (tick, hash) = (*tick, *hash);
        joining.stage = Stage::Following { queue: VecDeque::new(), committed: tick };
        joining.asked = None;
        self.resume(tick, hash, &save)
    }

    fn resume(&mut self, tick: u64, hash: StateHash, save: &G::Save) -> Result<(), NetError> {
        let setup = codec::decode(&self.setup).map_err(|error| NetError::State { why: error.to_string() })?;
        let mut game = G::new(&setup).map_err(|error| NetError::State { why: error.why })?;
        game.load(save);
        if game.state_hash() != hash {
            return Err(NetError::Diverged { tick });
        }
        let mut driver = Driver::resume(game, tick);
        driver.set_memory(self.options.memory());
        if self.options.window() == 0 {
            driver = driver.with_echo(self.options.check_interval.into());
        }
        self.driver = driver;
        Ok(())
    }

    fn queue_inputs(&mut self, from: u64, ticks: Vec<Vec<u8>>, known: u64) {
        let tick = self.driver.tick();
        let Some(joining) = &mut self.catch_up else { return };
        let Stage::Following { queue, committed } = &mut joining.stage else { return };
        *committed = known.max(*committed);
        if from == tick + queue.len() as u64 && !ticks.is_empty() && queue.len() < QUEUE_MAX {
            queue.extend(ticks);
            joining.asked = None;
        }
    }

    /// Plays queued ticks: up to the limit per update when catching up, and in real time as a spectator.
    fn follow(&mut self) -> Result<(), NetError> {
        let period = Duration::from_secs(1) / self.parameters.tick_rate;
        let until = self.next.as_ref().map_or(u64::MAX, |next| next.membership.base);
        for _ in 0..self.options.catch_up.max(1) {
            let Some(joining) = &mut self.catch_up else { return Ok(()) };
            let Stage::Following { queue, .. } = &mut joining.stage else { return Ok(()) };
            if joining.watch && queue.len() <= WATCH_BEHIND {
                if self.now < self.next_tick {
                    return Ok(());
                }
                self.next_tick = (self.next_tick + period).max(self.now.saturating_sub(period));
            }
            if self.driver.tick() >= until {
                return Ok(());
            }
            let doubt = if joining.watch { 0 } else { self.options.doubt() };
            let Some(bytes) = queue.pop_front() else { return Ok(()) };
            let inputs = EncodedInputs::from_bytes(bytes, self.driver.game().players())
                .map_err(|error| NetError::State { why: error.to_string() })?;
            self.driver.step_encoded(inputs);
            self.driver.commit(self.driver.tick().saturating_sub(doubt))?;
        }
        Ok(())
    }
}
