//! Session changes: proposed by the leader, acknowledged by all peers, entered at a fixed tick.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;
use core::time::Duration;

use super::{Event, NetError, Peer, RESEND, random};
use crate::net::error::DriverError;
use crate::net::packet::{Packet, Plan, SessionId};
use crate::net::session::{Roster, Session, seat_bit};
use crate::net::transport::Transport;
use crate::net::wire::{Address, NetGame};

/// A proposed session that not all peers have acknowledged.
pub(super) struct Planned<A> {
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
        let (parent, seat, mut others) = match (&self.session, self.root) {
            (Some(session), _) => {
                (session.roster.session, session.roster.seat, session.roster.others.clone())
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
            && others.len() == session.roster.others.len()
        {
            return Ok(());
        }
        others.sort_by_key(|(seat, _)| *seat);
        let lead = if self.session.is_some() { LEAD_SECONDS * u64::from(self.terms.tick_rate) } else { 0 };
        let base = self.driver.tick() + lead;
        let mut roster = Roster { session: parent, base, seat, others };
        roster.session = Roster::<A>::id(parent, base, roster.mask(), random());
        let waiting = roster.others.iter().map(|(_, address)| address.clone()).collect();
        self.planned = Some(Planned { parent, session: roster.session, waiting, said: None });
        self.next = Some(Session::new(roster, &self.options, self.terms.tick_rate)?);
        Ok(())
    }

    /// Retransmits the proposal to peers that have not acknowledged it.
    pub(super) fn repeat_plan(&mut self) {
        let Some(planned) = &mut self.planned else { return };
        let of = |session: &&Session<G, A>| session.roster.session == planned.session;
        let Some(session) = self.next.iter().chain(&self.session).find(of) else {
            self.planned = None;
            return;
        };
        if planned.said.is_some_and(|said| self.now < said + RESEND) {
            return;
        }
        planned.said = Some(self.now);
        let Roster { session, base, seat: own, others } = &session.roster;
        let mut packets = Vec::new();
        for to in &planned.waiting {
            let Some((seat, _)) = others.iter().find(|(_, address)| address == to) else { continue };
            let rest = others.iter().filter(|(other, _)| other != seat);
            let mut rest: Vec<_> = rest.map(|(seat, address)| (*seat, Some(address.clone()))).collect();
            rest.push((*own, None));
            rest.sort_by_key(|(seat, _)| *seat);
            let plan = Plan { session: *session, base: *base, seat: *seat, others: rest };
            packets.push((to.clone(), Packet::Plan { parent: planned.parent, plan }));
        }
        for (to, packet) in packets {
            self.say(&packet, &to);
        }
    }

    pub(super) fn hear_agreed(&mut self, from: &A, plan: SessionId) {
        if let Some(planned) = self.planned.as_mut().filter(|planned| planned.session == plan) {
            planned.waiting.remove(from);
        }
    }

    pub(super) fn hear_plan(&mut self, from: &A, parent: SessionId, plan: Plan<A>) -> Result<(), NetError> {
        let known = [&self.session, &self.next].into_iter().flatten();
        if known.map(|session| session.roster.session).any(|known| known == plan.session) {
            self.say(&Packet::Agreed { plan: plan.session }, from);
            return Ok(());
        }
        let may_plan = match (&self.catch_up, &self.session) {
            (Some(joining), _) => joining.contact() == from,
            (None, Some(session)) => {
                let leader = session.roster.others.first();
                let leads =
                    leader.is_some_and(|(seat, leader)| leader == from && *seat < session.roster.seat);
                leads && session.roster.session == parent && self.leaving.is_none()
            }
            (None, None) => false,
        };
        let Some(roster) = self.roster_of(from, plan).filter(|_| may_plan) else { return Ok(()) };
        self.say(&Packet::Agreed { plan: roster.session }, from);
        self.next = Some(Session::new(roster, &self.options, self.terms.tick_rate)?);
        Ok(())
    }

    /// The membership of a proposed session, if it is valid.
    fn roster_of(&self, from: &A, plan: Plan<A>) -> Option<Roster<A>> {
        let Plan { session, base, seat, others } = plan;
        let others: Vec<_> = others
            .into_iter()
            .map(|(seat, address)| (seat, address.unwrap_or_else(|| from.clone())))
            .collect();
        let players = self.terms.players;
        let ascending = others.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let seated = others.iter().all(|(other, _)| *other < players && *other != seat) && seat < players;
        let addresses: BTreeSet<_> = others.iter().map(|(_, address)| address).collect();
        let distinct = addresses.len() == others.len();
        (ascending && seated && distinct).then_some(Roster { session, base, seat, others })
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
        if known < next.roster.base || self.leaving.is_some() {
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
        let Roster { base: tick, .. } = next.roster;
        // Committed ticks are in the replay and cannot be rolled back. Correct peers never propose an earlier tick.
        if tick < self.driver.committed() {
            return Err(DriverError::NoState { tick }.into());
        }
        self.driver.restart(tick, next.roster.seats())?;
        let before = self.session.as_ref().map_or(0, |session| session.roster.mask());
        let after = next.roster.mask();
        for seat in 0..self.terms.players {
            match (before & seat_bit(seat) != 0, after & seat_bit(seat) != 0) {
                (false, true) => self.events.push_back(Event::Joined { seat, tick }),
                (true, false) => self.events.push_back(Event::Left { seat, tick }),
                _ => {}
            }
        }
        self.catch_up = None;
        self.root = None;
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
