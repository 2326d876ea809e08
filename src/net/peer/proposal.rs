//! Session changes: proposed by the leader, acknowledged by all peers, entered at a fixed tick.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;
use core::time::Duration;

use super::{Event, NetError, Peer, RESEND, random};
use crate::net::error::DriverError;
use crate::net::packet::{Packet, Plan, SessionId};
use crate::net::session::{Membership, Session, seat_bit};
use crate::net::transport::Transport;
use crate::net::wire::{Address, NetGame};

/// A proposed session that not all peers have acknowledged.
pub(super) struct ProposedSession<A> {
    parent: SessionId,
    session: SessionId,
    waiting: BTreeSet<A>,
    said: Option<Duration>,
}

/// Time in seconds between the proposal of a session and its first tick.
const LEAD_SECONDS: u64 = 1;

impl<G: NetGame, A: Address, T: Transport<A>> Peer<G, A, T> {
    /// Proposes a session of the current players and the joiners that have caught up.
    pub(super) fn plan_for_joiners(&mut self) -> Result<(), NetError> {
        let (parent, seat, mut others) = match (&self.session, self.initial_session_id) {
            (Some(session), _) => {
                (session.membership.session, session.membership.seat, session.membership.others.clone())
            }
            (None, Some(root)) => (root, 0, Vec::new()),
            (None, None) => return Ok(()),
        };
        let mut free = self.free_seats();
        for joiner in self.joiners.iter().filter(|joiner| joiner.ready) {
            if free == 0 || others.iter().any(|(_, address)| *address == joiner.address) {
                continue;
            }
            let wanted = joiner.wanted.filter(|seat| free & seat_bit(*seat) != 0);
            let seat = wanted.unwrap_or(free.trailing_zeros());
            free &= !seat_bit(seat);
            others.push((seat, joiner.address.clone()));
        }
        if let Some(session) = &self.session
            && others.len() == session.membership.others.len()
        {
            return Ok(());
        }
        others.sort_by_key(|(seat, _)| *seat);
        let lead =
            if self.session.is_some() { LEAD_SECONDS * u64::from(self.parameters.tick_rate) } else { 0 };
        let base = self.driver.tick() + lead;
        let mut membership = Membership { session: parent, base, seat, others };
        membership.session = Membership::<A>::id(parent, base, membership.mask(), random());
        let waiting = membership.others.iter().map(|(_, address)| address.clone()).collect();
        self.proposed = Some(ProposedSession { parent, session: membership.session, waiting, said: None });
        self.next = Some(Session::new(membership, &self.options, self.parameters.tick_rate)?);
        Ok(())
    }

    /// Retransmits the proposal to peers that have not acknowledged it.
    pub(super) fn repeat_plan(&mut self) {
        let Some(proposed) = &mut self.proposed else { return };
        let of = |session: &&Session<G, A>| session.membership.session == proposed.session;
        let Some(session) = self.next.iter().chain(&self.session).find(of) else {
            self.proposed = None;
            return;
        };
        if proposed.said.is_some_and(|said| self.now < said + RESEND) {
            return;
        }
        proposed.said = Some(self.now);
        let Membership { session, base, seat: own, others } = &session.membership;
        let mut packets = Vec::new();
        for to in &proposed.waiting {
            let Some((seat, _)) = others.iter().find(|(_, address)| address == to) else { continue };
            let rest = others.iter().filter(|(other, _)| other != seat);
            let mut rest: Vec<_> = rest.map(|(seat, address)| (*seat, Some(address.clone()))).collect();
            rest.push((*own, None));
            rest.sort_by_key(|(seat, _)| *seat);
            let plan = Plan { session: *session, base: *base, seat: *seat, others: rest };
            packets.push((to.clone(), Packet::Plan { parent: proposed.parent, plan }));
        }
        for (to, packet) in packets {
            self.send(&packet, &to);
        }
    }

    pub(super) fn hear_agreed(&mut self, from: &A, plan: SessionId) {
        if let Some(proposed) = self.proposed.as_mut().filter(|proposed| proposed.session == plan) {
            proposed.waiting.remove(from);
        }
    }

    pub(super) fn hear_plan(&mut self, from: &A, parent: SessionId, plan: Plan<A>) -> Result<(), NetError> {
        let known = [&self.session, &self.next].into_iter().flatten();
        if known.map(|session| session.membership.session).any(|known| known == plan.session) {
            self.send(&Packet::Agreed { plan: plan.session }, from);
            return Ok(());
        }
        let may_plan = match (&self.catch_up, &self.session) {
            (Some(joining), _) => joining.contact() == from,
            (None, Some(session)) => {
                let leader = session.membership.others.first();
                let leads =
                    leader.is_some_and(|(seat, leader)| leader == from && *seat < session.membership.seat);
                leads && session.membership.session == parent && self.leaving.is_none()
            }
            (None, None) => false,
        };
        let Some(membership) = self.membership_of(from, plan).filter(|_| may_plan) else { return Ok(()) };
        self.send(&Packet::Agreed { plan: membership.session }, from);
        self.next = Some(Session::new(membership, &self.options, self.parameters.tick_rate)?);
        Ok(())
    }

    /// The membership of a proposed session, if it is valid.
    fn membership_of(&self, from: &A, plan: Plan<A>) -> Option<Membership<A>> {
        let Plan { session, base, seat, others } = plan;
        let others: Vec<_> = others
            .into_iter()
            .map(|(seat, address)| (seat, address.unwrap_or_else(|| from.clone())))
            .collect();
        let players = self.parameters.players;
        let ascending = others.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let seated = others.iter().all(|(other, _)| *other < players && *other != seat) && seat < players;
        let addresses: BTreeSet<_> = others.iter().map(|(_, address)| address).collect();
        let distinct = addresses.len() == others.len();
        (ascending && seated && distinct).then_some(Membership { session, base, seat, others })
    }

    /// Enters the next session when its first tick is reached.
    pub(super) fn enter_next(&mut self) -> Result<(), NetError> {
        self.drop_past();
        let Some(next) = &self.next else { return Ok(()) };
        let known = match (&self.session, &self.catch_up) {
            (_, Some(_)) => self.driver.tick(),
            (Some(session), None) => session.confirmed(),
            (None, None) => self.driver.tick(),
        };
        if known < next.membership.base || self.leaving.is_some() {
            return Ok(());
        }
        if let Some(next) = self.next.take() {
            self.past = None;
            let old = self.enter(next)?;
            self.past = old;
        }
        Ok(())
    }

    /// Replaces the current session and returns it.
    pub(super) fn enter(&mut self, next: Session<G, A>) -> Result<Option<Session<G, A>>, NetError> {
        let Membership { base: tick, .. } = next.membership;
        // Committed ticks are in the replay and cannot be rolled back. Correct peers never propose an earlier tick.
        if tick < self.driver.committed() {
            return Err(DriverError::NoState { tick }.into());
        }
        self.driver.restart(tick, next.membership.seats())?;
        let before = self.session.as_ref().map_or(0, |session| session.membership.mask());
        let after = next.membership.mask();
        for seat in 0..self.parameters.players {
            match (before & seat_bit(seat) != 0, after & seat_bit(seat) != 0) {
                (false, true) => self.events.push_back(Event::Joined { seat, tick }),
                (true, false) => self.events.push_back(Event::Left { seat, tick }),
                _ => {}
            }
        }
        self.catch_up = None;
        self.initial_session_id = None;
        self.awaited_since = self.now;
        self.next_tick = self.now;
        Ok(self.session.replace(next))
    }

    /// Drops the previous session when all peers play in the current one.
    fn drop_past(&mut self) {
        if self.session.as_ref().is_some_and(Session::is_established) {
            self.past = None;
        }
    }
}
