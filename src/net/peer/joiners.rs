//! Serves joining peers and spectators: the counterpart of [`super::catch_up`].

use alloc::sync::Arc;
use alloc::vec::Vec;
use core::time::Duration;

use super::catch_up::PIECE_BYTES;
use super::{NetError, Peer};
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::EncodedInputs;
use crate::net::handshake::HandshakeParameters;
use crate::net::packet::{Nonce, Packet, Refused};
use crate::net::session::{Session, seat_bit};
use crate::net::transport::{PACKET_BYTES_AIM, Transport};
use crate::net::wire::{Address, NetGame};

/// Maximum number of joining and watching peers at a time.
const JOINERS_MAX: usize = 32;
/// Bytes of a packet in addition to inputs.
const INPUTS_HEAD: usize = 100;
/// Maximum number of packets with inputs per request: distant peers receive more ticks than they play in a round trip.
const PACKETS_AT_ONCE: usize = 4;
/// Bytes of the length of a list.
const LENGTH_BYTES: usize = 8;

/// A peer that is joining or watching.
pub(super) struct Joiner<A> {
    pub(super) address: A,
    nonce: Nonce,
    pub(super) wanted: Option<u32>,
    watch: bool,
    tick: u64,
    hash: StateHash,
    /// The state after `tick` ticks; empty before the first tick, which every peer has.
    state: Arc<[u8]>,
    heard: Duration,
    /// Whether the peer has caught up.
    pub(super) ready: bool,
}

impl<G: NetGame, A: Address, T: Transport<A>> Peer<G, A, T> {
    pub(super) fn greet(
        &mut self,
        from: &A,
        nonce: Nonce,
        parameters: &HandshakeParameters,
        seat: Option<u32>,
        watch: bool,
    ) {
        // A player that asks for a seat has reconnected before its disconnection was noticed. It gets its seat after
        // the timeout.
        let plays = |session: &Session<G, A>| session.membership.seat_of(from).is_some();
        if self.catch_up.is_some() || self.session.as_ref().is_some_and(plays) {
            return;
        }
        if let Err(_mismatch) = self.parameters.agree(parameters) {
            return self.send(
                &Packet::Refused { nonce, why: Refused::HandshakeParameters(self.parameters.clone()) },
                from,
            );
        }
        // Only the leader decides about requests to play.
        if !watch
            && let Some(session) = &self.session
            && !session.membership.leads()
            && let Some((_, leader)) = session.membership.others.first()
        {
            let packet = Packet::Redirect { nonce, to: leader.clone() };
            return self.send(&packet, from);
        }
        let joiner = match self.joiners.iter().position(|known| known.nonce == nonce) {
            Some(known) => known,
            None => match self.invite(from, nonce, seat, watch) {
                Ok(()) => self.joiners.len() - 1,
                Err(why) => return self.send(&Packet::Refused { nonce, why }, from),
            },
        };
        let Joiner { tick, hash, state, .. } = &self.joiners[joiner];
        let welcome = Packet::Welcome { nonce, tick: *tick, hash: *hash, length: state.len() as u64 };
        self.send(&welcome, from);
    }

    fn invite(&mut self, from: &A, nonce: Nonce, wanted: Option<u32>, watch: bool) -> Result<(), Refused> {
        // Drops an earlier attempt of the same peer.
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

    /// The free seats, as bits.
    pub(super) fn free_seats(&self) -> u64 {
        let seats = (0..self.parameters.players).fold(0, |mask, seat| mask | seat_bit(seat));
        let taken =
            self.next.as_ref().or(self.session.as_ref()).map_or(1, |session| session.membership.mask());
        seats & !taken
    }

    /// Whether the peer with this address plays, or is about to.
    fn is_seated(&self, address: &A) -> bool {
        let sessions = [&self.session, &self.next].into_iter().flatten();
        sessions.into_iter().any(|session| session.membership.seat_of(address).is_some())
    }

    fn joiner(&mut self, from: &A, nonce: Nonce) -> Option<&mut Joiner<A>> {
        let now = self.now;
        let known = |joiner: &&mut Joiner<A>| joiner.nonce == nonce && joiner.address == *from;
        let joiner = self.joiners.iter_mut().find(known)?;
        joiner.heard = now;
        Some(joiner)
    }

    pub(super) fn give_state(&mut self, from: &A, nonce: Nonce, offset: u64) {
        let Some(joiner) = self.joiner(from, nonce) else { return self.say_forgotten(from, nonce) };
        let state = joiner.state.clone();
        let Ok(start) = usize::try_from(offset) else { return };
        let end = start.saturating_add(PIECE_BYTES).min(state.len());
        let Some(piece) = state.get(start..end) else { return };
        self.send(&Packet::State { nonce, offset, bytes: piece.to_vec() }, from);
    }

    pub(super) fn give_inputs(&mut self, from: &A, nonce: Nonce, tick: u64) {
        let Some(joiner) = self.joiner(from, nonce) else { return self.say_forgotten(from, nonce) };
        let watch = joiner.watch;
        // Once all peers have entered a session, the ticks before it are final. A peer that is about to enter needs all
        // of them.
        let entered = self.session.as_ref().filter(|session| !watch || session.is_established());
        let base = entered.map_or(0, |session| session.membership.base);
        let committed = self.driver.committed().max(base);
        if tick < committed && self.driver.inputs_of(tick).is_none() {
            return self.say_forgotten(from, nonce);
        }
        let mut from_tick = tick;
        for _ in 0..PACKETS_AT_ONCE {
            let ticks = self.inputs_between(from_tick, committed);
            let next = from_tick + ticks.len() as u64;
            self.send(&Packet::Inputs { nonce, from: from_tick, ticks, committed }, from);
            if next >= committed {
                return;
            }
            from_tick = next;
        }
    }

    /// The inputs of as many ticks as fit into a packet, but of at least one.
    fn inputs_between(&self, first: u64, end: u64) -> Vec<Vec<u8>> {
        let mut ticks = Vec::new();
        let mut room = PACKET_BYTES_AIM - INPUTS_HEAD;
        for tick in first..end {
            let Some(bytes) = self.driver.inputs_of(tick).map(EncodedInputs::bytes) else { break };
            if !ticks.is_empty() && bytes.len() + LENGTH_BYTES > room {
                break;
            }
            room = room.saturating_sub(bytes.len() + LENGTH_BYTES);
            ticks.push(bytes.to_vec());
        }
        ticks
    }

    fn say_forgotten(&mut self, to: &A, nonce: Nonce) {
        self.send(
            &Packet::Refused { nonce, why: Refused::Other("silent or behind for too long".into()) },
            to,
        );
    }

    /// Tells joining and watching peers that this peer leaves.
    pub(super) fn say_bye_to_joiners(&mut self) {
        let why = || Refused::Other("the contacted player has left".into());
        let packet = |joiner: &Joiner<A>| {
            (joiner.address.clone(), Packet::Refused { nonce: joiner.nonce, why: why() })
        };
        let packets: Vec<_> = self.joiners.iter().map(packet).collect();
        for (to, packet) in packets {
            self.send(&packet, &to);
        }
    }

    pub(super) fn take_ready(&mut self, from: &A, nonce: Nonce, tick: u64, hash: StateHash) {
        let ours = self.driver.history().get(tick).map(|moment| moment.hash);
        // Another peer may have taken the last seat.
        let late = self.free_seats() == 0 && !self.is_seated(from);
        let Some(joiner) = self.joiner(from, nonce) else { return };
        match ours {
            _ if late && !joiner.watch => {
                joiner.ready = false;
                self.send(&Packet::Refused { nonce, why: Refused::Full }, from);
            }
            Some(ours) if ours == hash => joiner.ready = !joiner.watch,
            Some(_) => self.send(&Packet::Refused { nonce, why: Refused::Diverged { tick } }, from),
            // The tick is too old to compare: the peer is not up to date.
            None => {}
        }
    }

    /// Removes silent joiners, and proposes a session for those that have caught up.
    pub(super) fn admit(&mut self) -> Result<(), NetError> {
        let patience = 2 * self.options.timeout;
        let now = self.now;
        self.joiners.retain(|joiner| now <= joiner.heard + patience);
        // A peer that has entered the session sends no more requests.
        if let Some(session) = self.session.as_ref().filter(|session| session.is_established()) {
            let plays = |joiner: &Joiner<A>| session.membership.seat_of(&joiner.address).is_some();
            self.joiners.retain(|joiner| !plays(joiner));
        }
        let idle = self.next.is_none() && self.leaving.is_none() && self.catch_up.is_none();
        let ready = self.joiners.iter().filter(|joiner| joiner.ready).count();
        let wanted = match &self.session {
            None => usize::try_from(self.options.start_with.saturating_sub(1)).unwrap_or(usize::MAX),
            Some(session) if session.membership.leads() && session.is_established() => 1,
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
    /// Addresses of the other players, to which a proposed session is sent.
    pub(super) fn addresses(&self) -> Vec<A> {
        self.membership.others.iter().map(|(_, address)| address.clone()).collect()
    }
}
