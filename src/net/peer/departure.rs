//! Departure of players: the other peers agree on the last tick for which all of them have all inputs, and continue
//! from there.
//!
//! With GGRS alone, each peer would decide after which input a player has left, and with three or more peers the
//! decisions may differ, as the last packets reach only some of them. Here, a peer that misses a player stops and tells
//! the others the tick up to which it has the inputs of all players. They stop and do the same. When all have reported
//! the same departed players, the smallest of these ticks is the first tick of a session without them. Every peer keeps
//! the state before it.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::time::Duration;

use super::{NetError, Peer, RESEND};
use crate::net::packet::{Packet, SessionId};
use crate::net::session::{Membership, Session, seat_bit};
use crate::net::transport::Transport;
use crate::net::wire::{Address, NetGame};

/// State of the departure agreement of a session.
pub(super) struct DepartureAgreement {
    /// The departed seats, as bits.
    gone: u64,
    /// Number of ticks with confirmed inputs at this peer.
    ticks: u64,
    /// Reports of the other peers: departed seats, and ticks with confirmed inputs.
    heard: BTreeMap<u32, (u64, u64)>,
    since: Duration,
    said: Option<Duration>,
}

/// Result of the last departure agreement, for peers that have not received it.
pub(super) struct AgreedDeparture {
    session: SessionId,
    gone: u64,
    /// First tick of the following session.
    base: u64,
}

/// Number of times a leaving player sends its goodbye.
const BYES: usize = 3;

impl<G: NetGame, A: Address, T: Transport<A>> Peer<G, A, T> {
    /// Stops the session because these seats have departed.
    pub(super) fn begin_leaving(&mut self, gone: u64) {
        let Some(session) = &self.session else { return };
        match &mut self.leaving {
            Some(leaving) => leaving.gone |= gone,
            None => {
                let (ticks, since) = (session.confirmed(), self.now);
                self.leaving =
                    Some(DepartureAgreement { gone, ticks, heard: BTreeMap::new(), since, said: None });
                // Joining peers will ask again.
                self.abandoned = self.next.take().map(|next| next.membership.session).or(self.abandoned);
                self.proposed = None;
            }
        }
    }

    pub(super) fn say_bye(&mut self) {
        let Some(session) = &self.session else { return };
        let packet = Packet::Bye { session: session.membership.session };
        for to in session.addresses() {
            for _ in 0..BYES {
                self.send(&packet, &to);
            }
        }
    }

    pub(super) fn hear_bye(&mut self, from: &A, session: SessionId) {
        let current = self.session.as_ref().filter(|current| current.membership.session == session);
        if let Some(seat) = current.and_then(|current| current.membership.seat_of(from)) {
            self.begin_leaving(seat_bit(seat));
        }
    }

    pub(super) fn hear_gone(
        &mut self,
        from: &A,
        session: SessionId,
        gone: u64,
        ticks: u64,
        settled: bool,
    ) -> Result<(), NetError> {
        if let Some(known) = self.settled.as_ref().filter(|known| known.session == session) {
            let AgreedDeparture { gone, base, .. } = *known;
            if !settled {
                self.send(&Packet::Gone { session, gone, ticks: base, settled: true }, from);
            }
            return Ok(());
        }
        if self.abandoned == Some(session) && !settled {
            self.send(&Packet::Gone { session, gone: u64::MAX, ticks: 0, settled: true }, from);
            return Ok(());
        }
        self.fall_back(session);
        let Some(current) = self.session.as_ref().filter(|current| current.membership.session == session)
        else {
            return Ok(());
        };
        let Some(seat) = current.membership.seat_of(from) else { return Ok(()) };
        if gone & seat_bit(current.membership.seat) != 0 {
            return match &self.past {
                // The other peers have not entered the session after all.
                Some(past) if settled && !current.is_established() => {
                    let past = past.membership.session;
                    self.fall_back(past);
                    Ok(())
                }
                _ => Err(NetError::Dropped),
            };
        }
        self.begin_leaving(gone & current.membership.mask());
        let Some(leaving) = &mut self.leaving else { return Ok(()) };
        if settled && ticks <= leaving.ticks {
            // The sender has the reports of all peers it continued with. One of them may not have reached this peer.
            leaving.gone = gone;
            return self.go_on_without(ticks);
        }
        leaving.heard.insert(seat, (gone, ticks));
        Ok(())
    }

    /// Returns to the previous session, if the peers have not all entered the current one.
    fn fall_back(&mut self, session: SessionId) {
        let established = self.session.as_ref().is_some_and(Session::is_established);
        let is_past = self.past.as_ref().is_some_and(|past| past.membership.session == session);
        if is_past && !established {
            self.abandoned = self.session.as_ref().map(|session| session.membership.session);
            self.session = self.past.take();
            self.leaving = None;
        }
    }

    /// Detects players that did not enter the session, and ends the session when all reports agree.
    pub(super) fn settle(&mut self) -> Result<(), NetError> {
        let timeout = self.options.timeout;
        let Some(session) = &self.session else { return Ok(()) };
        if self.leaving.is_none() && !session.is_running() && self.now > self.awaited_since + 2 * timeout {
            let silent = session.silent();
            self.begin_leaving(silent);
        }
        let (Some(leaving), Some(session)) = (&mut self.leaving, &self.session) else { return Ok(()) };
        let membership = &session.membership;
        let unheard = |leaving: &DepartureAgreement| {
            let others = membership.others.iter().map(|(seat, _)| *seat);
            let left = others.filter(|seat| leaving.gone & seat_bit(*seat) == 0);
            let agrees = |seat: &u32| leaving.heard.get(seat).is_some_and(|(gone, _)| *gone == leaving.gone);
            left.filter(|seat| !agrees(seat)).fold(0, |mask, seat| mask | seat_bit(seat))
        };
        // Reports about departed players have to be trusted, because the peers could not agree otherwise.
        leaving.gone =
            leaving.heard.values().fold(leaving.gone, |mask, (gone, _)| mask | gone & membership.mask());
        if leaving.gone & seat_bit(membership.seat) != 0 {
            return Err(NetError::Dropped);
        }
        if self.now > leaving.since + timeout {
            leaving.gone |= unheard(leaving);
            leaving.since = self.now;
        }
        if unheard(leaving) == 0 {
            let left = |seat: &u32| leaving.gone & seat_bit(*seat) == 0;
            let said = leaving.heard.iter().filter(|(seat, _)| left(seat));
            let base = said.fold(leaving.ticks, |base, (_, (_, ticks))| base.min(*ticks));
            return self.go_on_without(base);
        }
        self.say_gone();
        Ok(())
    }

    fn say_gone(&mut self) {
        let (Some(leaving), Some(session)) = (&mut self.leaving, &self.session) else { return };
        if leaving.said.is_some_and(|said| self.now < said + RESEND) {
            return;
        }
        leaving.said = Some(self.now);
        let DepartureAgreement { gone, ticks, .. } = *leaving;
        let packet = Packet::Gone { session: session.membership.session, gone, ticks, settled: false };
        // The departed peers receive it, too: they may only have been silent.
        for to in session.addresses() {
            self.send(&packet, &to);
        }
    }

    /// Begins a session without the departed players at `base`, the first tick that a peer has no inputs for.
    fn go_on_without(&mut self, base: u64) -> Result<(), NetError> {
        // Reports once more, for peers that are still waiting.
        if let Some(leaving) = &mut self.leaving {
            leaving.said = None;
        }
        self.say_gone();
        let (Some(leaving), Some(session)) = (self.leaving.take(), &self.session) else { return Ok(()) };
        let Membership { session: parent, seat, others, .. } = session.membership.clone();
        let left: Vec<_> =
            others.into_iter().filter(|(seat, _)| leaving.gone & seat_bit(*seat) == 0).collect();
        let mut membership = Membership { session: parent, base, seat, others: left };
        membership.session = Membership::<A>::id(parent, base, membership.mask(), 0);
        self.settled = Some(AgreedDeparture { session: parent, gone: leaving.gone, base });
        let next = Session::new(membership, &self.options, self.parameters.tick_rate)?;
        self.past = None;
        self.enter(next)?;
        Ok(())
    }
}
