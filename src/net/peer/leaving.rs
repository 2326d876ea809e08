//! Players who leave: the others agree on the last tick that all of them know, and go on from there.
//!
//! GGRS would let each peer decide alone after which input a player has left, and with three or more they may decide
//! differently, as the last packets reach some and not others. Here, who misses a player stops and tells the others up
//! to which tick it has everybody's inputs. They stop and do the same. When all have said so of the same players, the
//! smallest of these ticks is the first of a session without them. Every peer remembers the state before it.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::time::Duration;

use super::{NetError, Peer, RESEND};
use crate::net::packet::{Packet, SessionId};
use crate::net::session::{Roster, Session, seat_bit};
use crate::net::transport::Transport;
use crate::net::wire::{Address, NetGame};

/// The way out of a session that somebody has left.
pub(super) struct Leaving {
    /// The seats that are empty, as bits.
    gone: u64,
    /// Ticks that are known here.
    ticks: u64,
    /// What the others have said: seats that are empty, ticks that they know.
    heard: BTreeMap<u32, (u64, u64)>,
    since: Duration,
    said: Option<Duration>,
}

/// What was said last of a session that is over, for those who have not heard it.
pub(super) struct Settled {
    session: SessionId,
    gone: u64,
    /// The first tick of the session that followed.
    base: u64,
}

/// How many times a leaving player says so.
const BYES: usize = 3;

impl<G: NetGame, A: Address, T: Transport<A>> Peer<G, A, T> {
    /// Stops the session because these seats are empty.
    pub(super) fn begin_leaving(&mut self, gone: u64) {
        let Some(session) = &self.session else { return };
        match &mut self.leaving {
            Some(leaving) => leaving.gone |= gone,
            None => {
                let (ticks, since) = (session.confirmed(), self.now);
                self.leaving = Some(Leaving { gone, ticks, heard: BTreeMap::new(), since, said: None });
                // Who was about to join will ask again.
                self.abandoned = self.next.take().map(|next| next.roster.session).or(self.abandoned);
                self.planned = None;
            }
        }
    }

    pub(super) fn say_bye(&mut self) {
        let Some(session) = &self.session else { return };
        let packet = Packet::Bye { session: session.roster.session };
        for to in session.addresses() {
            for _ in 0..BYES {
                self.say(&packet, &to);
            }
        }
    }

    pub(super) fn hear_bye(&mut self, from: &A, session: SessionId) {
        let current = self.session.as_ref().filter(|current| current.roster.session == session);
        if let Some(seat) = current.and_then(|current| current.roster.seat_of(from)) {
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
            let Settled { gone, base, .. } = *known;
            if !settled {
                self.say(&Packet::Gone { session, gone, ticks: base, settled: true }, from);
            }
            return Ok(());
        }
        if self.abandoned == Some(session) && !settled {
            self.say(&Packet::Gone { session, gone: u64::MAX, ticks: 0, settled: true }, from);
            return Ok(());
        }
        self.fall_back(session);
        let Some(current) = self.session.as_ref().filter(|current| current.roster.session == session) else {
            return Ok(());
        };
        let Some(seat) = current.roster.seat_of(from) else { return Ok(()) };
        if gone & seat_bit(current.roster.seat) != 0 {
            return match &self.past {
                // The others have not entered it after all.
                Some(past) if settled && !current.is_established() => {
                    let past = past.roster.session;
                    self.fall_back(past);
                    Ok(())
                }
                _ => Err(NetError::Dropped),
            };
        }
        self.begin_leaving(gone & current.roster.mask());
        let Some(leaving) = &mut self.leaving else { return Ok(()) };
        if settled && ticks <= leaving.ticks {
            // It has heard all whom it has gone on with, and we may have missed one of them.
            leaving.gone = gone;
            return self.go_on_without(ticks);
        }
        leaving.heard.insert(seat, (gone, ticks));
        Ok(())
    }

    /// Returns to the session before, if somebody has not come along and not everybody plays in this one.
    fn fall_back(&mut self, session: SessionId) {
        let established = self.session.as_ref().is_some_and(Session::is_established);
        let is_past = self.past.as_ref().is_some_and(|past| past.roster.session == session);
        if is_past && !established {
            self.abandoned = self.session.as_ref().map(|session| session.roster.session);
            self.session = self.past.take();
            self.leaving = None;
        }
    }

    /// Looks for players who have not come along, and ends the session when everybody has said what they know.
    pub(super) fn settle(&mut self) -> Result<(), NetError> {
        let timeout = self.options.timeout;
        let Some(session) = &self.session else { return Ok(()) };
        if self.leaving.is_none() && !session.is_running() && self.now > self.awaited_since + 2 * timeout {
            let silent = session.silent();
            self.begin_leaving(silent);
        }
        let (Some(leaving), Some(session)) = (&mut self.leaving, &self.session) else { return Ok(()) };
        let roster = &session.roster;
        let unheard = |leaving: &Leaving| {
            let others = roster.others.iter().map(|(seat, _)| *seat);
            let left = others.filter(|seat| leaving.gone & seat_bit(*seat) == 0);
            let agrees = |seat: &u32| leaving.heard.get(seat).is_some_and(|(gone, _)| *gone == leaving.gone);
            left.filter(|seat| !agrees(seat)).fold(0, |mask, seat| mask | seat_bit(seat))
        };
        // Who says that somebody is gone has to be believed, or the peers would never agree.
        leaving.gone =
            leaving.heard.values().fold(leaving.gone, |mask, (gone, _)| mask | gone & roster.mask());
        if leaving.gone & seat_bit(roster.seat) != 0 {
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
        let Leaving { gone, ticks, .. } = *leaving;
        let packet = Packet::Gone { session: session.roster.session, gone, ticks, settled: false };
        // Those who are gone hear it too: they may only have been silent.
        for to in session.addresses() {
            self.say(&packet, &to);
        }
    }

    /// Begins a session without those who are gone at `base`, the first tick that somebody does not know.
    fn go_on_without(&mut self, base: u64) -> Result<(), NetError> {
        // Once more for those who wait for it.
        if let Some(leaving) = &mut self.leaving {
            leaving.said = None;
        }
        self.say_gone();
        let (Some(leaving), Some(session)) = (self.leaving.take(), &self.session) else { return Ok(()) };
        let Roster { session: parent, seat, others, .. } = session.roster.clone();
        let left: Vec<_> =
            others.into_iter().filter(|(seat, _)| leaving.gone & seat_bit(*seat) == 0).collect();
        let mut roster = Roster { session: parent, base, seat, others: left };
        roster.session = Roster::<A>::id(parent, base, roster.mask(), 0);
        self.settled = Some(Settled { session: parent, gone: leaving.gone, base });
        let next = Session::new(roster, &self.options, self.terms.tick_rate)?;
        self.past = None;
        self.enter(next)?;
        Ok(())
    }
}
