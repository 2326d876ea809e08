//! The other side of [`super::catch_up`]: what somebody who wants to join is given.

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::time::Duration;

use super::catch_up::PIECE_BYTES;
use super::{NetError, Peer};
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::EncodedInputs;
use crate::net::packet::{Nonce, Packet, Refused};
use crate::net::session::{Session, seat_bit};
use crate::net::terms::Terms;
use crate::net::transport::{PACKET_BYTES_AIM, Transport};
use crate::net::wire::{Address, NetGame};

/// Most peers that may be on their way in, or watch, at a time.
const JOINERS_MAX: usize = 32;
/// Bytes that a packet needs besides inputs.
const INPUTS_HEAD: usize = 100;
/// Bytes of a list's length.
const LENGTH_BYTES: usize = 8;

/// Somebody who wants to take part, or watches.
pub(super) struct Joiner<A> {
    pub(super) address: A,
    nonce: Nonce,
    pub(super) wanted: Option<u32>,
    watch: bool,
    tick: u64,
    hash: StateHash,
    /// The state after `tick` ticks; empty before the first, which everybody has.
    state: Arc<[u8]>,
    heard: Duration,
    /// Has caught up.
    pub(super) ready: bool,
}

impl<G: NetGame, A: Address, T: Transport<A>> Peer<G, A, T> {
    pub(super) fn greet(&mut self, from: &A, nonce: Nonce, terms: &Terms, seat: Option<u32>, watch: bool) {
        if self.catch_up.is_some() {
            return;
        }
        if let Err(_mismatch) = self.terms.agree(terms) {
            return self.say(&Packet::Refused { nonce, why: Refused::Terms(self.terms.clone()) }, from);
        }
        // Who may play is decided by one alone.
        if !watch
            && let Some(session) = &self.session
            && !session.roster.leads()
            && let Some((_, leader)) = session.roster.others.first()
        {
            let packet = Packet::Redirect { nonce, to: leader.clone() };
            return self.say(&packet, from);
        }
        let joiner = match self.joiners.iter().position(|known| known.nonce == nonce) {
            Some(known) => known,
            None => match self.invite(from, nonce, seat, watch) {
                Ok(()) => self.joiners.len() - 1,
                Err(why) => return self.say(&Packet::Refused { nonce, why }, from),
            },
        };
        let Joiner { tick, hash, state, .. } = &self.joiners[joiner];
        let welcome = Packet::Welcome { nonce, tick: *tick, hash: *hash, length: state.len() as u64 };
        self.say(&welcome, from);
    }

    fn invite(&mut self, from: &A, nonce: Nonce, wanted: Option<u32>, watch: bool) -> Result<(), Refused> {
        // An earlier attempt of the same peer.
        self.joiners.retain(|known| known.address != *from);
        if self.joiners.len() >= JOINERS_MAX || !watch && self.free_seats() == 0 {
            return Err(Refused::Full);
        }
        let tick = self.driver.committed();
        let Some(moment) = self.driver.history().get(tick) else {
            return Err(Refused::Other("no state to begin with".into()));
        };
        let state = if tick == 0 { Vec::new() } else { codec::encode(&moment.save) };
        self.joiners.push(Joiner {
            address: from.clone(),
            nonce,
            wanted,
            watch,
            tick,
            hash: moment.hash,
            state: state.into(),
            heard: self.now,
            ready: false,
        });
        Ok(())
    }

    /// The seats that nobody has, as bits.
    pub(super) fn free_seats(&self) -> u64 {
        let seats = (0..self.terms.players).fold(0, |mask, seat| mask | seat_bit(seat));
        let taken = self.next.as_ref().or(self.session.as_ref()).map_or(1, |session| session.roster.mask());
        seats & !taken
    }

    fn joiner(&mut self, from: &A, nonce: Nonce) -> Option<&mut Joiner<A>> {
        let now = self.now;
        let known = |joiner: &&mut Joiner<A>| joiner.nonce == nonce && joiner.address == *from;
        let joiner = self.joiners.iter_mut().find(known)?;
        joiner.heard = now;
        Some(joiner)
    }

    pub(super) fn give_state(&mut self, from: &A, nonce: Nonce, offset: u64) {
        let Some(joiner) = self.joiner(from, nonce) else { return };
        let state = joiner.state.clone();
        let Ok(start) = usize::try_from(offset) else { return };
        let end = start.saturating_add(PIECE_BYTES).min(state.len());
        let Some(piece) = state.get(start..end) else { return };
        self.say(&Packet::State { nonce, offset, bytes: piece.to_vec() }, from);
    }

    pub(super) fn give_inputs(&mut self, from: &A, nonce: Nonce, tick: u64) {
        if self.joiner(from, nonce).is_none() {
            return;
        }
        // Once a session is entered, nothing before it changes any more.
        let base = self.session.as_ref().map_or(0, |session| session.roster.base);
        let committed = self.driver.committed().max(base);
        let mut ticks = Vec::new();
        let mut room = PACKET_BYTES_AIM - INPUTS_HEAD;
        for tick in tick..committed {
            let Some(bytes) = self.driver.inputs_of(tick).map(EncodedInputs::bytes) else { break };
            if !ticks.is_empty() && bytes.len() + LENGTH_BYTES > room {
                break;
            }
            room = room.saturating_sub(bytes.len() + LENGTH_BYTES);
            ticks.push(bytes.to_vec());
        }
        self.say(&Packet::Inputs { nonce, from: tick, ticks, committed }, from);
    }

    pub(super) fn take_ready(&mut self, from: &A, nonce: Nonce, tick: u64, hash: StateHash) {
        let ours = self.driver.history().get(tick).map(|moment| moment.hash);
        let Some(joiner) = self.joiner(from, nonce) else { return };
        match ours {
            Some(ours) if ours == hash => joiner.ready = !joiner.watch,
            Some(_) => self.say(&Packet::Refused { nonce, why: Refused::Diverged { tick } }, from),
            // Too long ago to tell: it is not up to date.
            None => {}
        }
    }

    /// Looks after those who want to join: forgets the silent, and seats those who have caught up.
    pub(super) fn admit(&mut self) -> Result<(), NetError> {
        let patience = 2 * self.options.timeout;
        let now = self.now;
        self.joiners.retain(|joiner| now <= joiner.heard + patience);
        // Who has entered asks for nothing more.
        if let Some(session) = self.session.as_ref().filter(|session| session.is_established()) {
            let plays = |joiner: &Joiner<A>| session.roster.seat_of(&joiner.address).is_some();
            self.joiners.retain(|joiner| !plays(joiner));
        }
        let idle = self.next.is_none() && self.leaving.is_none() && self.catch_up.is_none();
        let ready = self.joiners.iter().filter(|joiner| joiner.ready).count();
        let wanted = match &self.session {
            None => usize::try_from(self.options.start_with.saturating_sub(1)).unwrap_or(usize::MAX),
            Some(session) if session.roster.leads() && session.is_established() => 1,
            Some(_) => usize::MAX,
        };
        if idle && ready >= wanted && (ready > 0 || self.session.is_none()) {
            self.plan_for_joiners()?;
        }
        self.repeat_plan();
        Ok(())
    }
}

impl<G: NetGame, A: Address> Session<G, A> {
    /// Where a plan is sent to.
    pub(super) fn addresses(&self) -> Vec<A> {
        self.roster.others.iter().map(|(_, address)| address.clone()).collect()
    }
}
