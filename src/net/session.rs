//! [`Session`]: a stretch of ticks that the same players play, with GGRS inside.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::mem;
use core::time::Duration;
use std::sync::{Mutex, PoisonError};

use ggrs::{DesyncDetection, GgrsError, GgrsEvent, Message, NonBlockingSocket, P2PSession};
use ggrs::{PlayerType, SessionBuilder};

use super::driver::Driver;
use super::gate::Gate;
use super::options::Options;
use super::packet::SessionId;
use super::peer::NetError;
use super::presence::Presence;
use super::wire::{Address, Echo, GgrsConfig, NetGame};
use crate::hash::StateHash;

/// Who plays from which tick on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Roster<A> {
    pub(super) session: SessionId,
    /// The first tick.
    pub(super) base: u64,
    /// Our own seat.
    pub(super) seat: u32,
    /// The others, in ascending order of seats.
    pub(super) others: Vec<(u32, A)>,
}

impl<A: Address> Roster<A> {
    /// Names the session that follows `parent`: all who agree on these numbers come to the same name.
    pub(super) fn id(parent: SessionId, base: u64, seats: u64, salt: u64) -> SessionId {
        let hash = StateHash::of(&(parent, base, seats, salt)).0;
        SessionId(u64::try_from(hash & u128::from(u64::MAX)).unwrap_or(0))
    }

    /// All seats, in ascending order: the place in this list is the handle of GGRS.
    pub(super) fn seats(&self) -> Vec<u32> {
        let mut seats: Vec<_> = self.others.iter().map(|(seat, _)| *seat).chain([self.seat]).collect();
        seats.sort_unstable();
        seats
    }

    /// All seats as bits.
    pub(super) fn mask(&self) -> u64 {
        self.seats().iter().fold(0, |mask, seat| mask | seat_bit(*seat))
    }

    pub(super) fn seat_of(&self, address: &A) -> Option<u32> {
        self.others.iter().find(|(_, other)| other == address).map(|(seat, _)| *seat)
    }

    /// The player who decides who may join.
    pub(super) fn leads(&self) -> bool {
        self.others.first().is_none_or(|(seat, _)| self.seat < *seat)
    }
}

pub(super) const fn seat_bit(seat: u32) -> u64 {
    match 1u64.checked_shl(seat) {
        Some(bit) => bit,
        None => 0,
    }
}

/// What has happened in a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum SessionEvent {
    /// Somebody has answered once more, of the few times that it takes before ticks can be played.
    Answered,
    /// Nothing comes from this seat.
    Interrupted(u32),
    /// Something comes again.
    Resumed(u32),
    /// Nothing has come for too long. Said again and again.
    Lost(u32),
    /// The peer of this seat has another hash after some tick.
    Said(u32, Echo),
}

pub(super) struct Session<G: NetGame, A: Address> {
    pub(super) roster: Roster<A>,
    p2p: P2PSession<GgrsConfig<G, A>>,
    mail: Arc<Mutex<Mail<A>>>,
    gates: BTreeMap<A, Gate>,
    presences: BTreeMap<A, Presence>,
    timeout: Duration,
    /// When it was last listened to.
    polled: Duration,
    synchronised: BTreeSet<A>,
    /// A player was lost: from then on what GGRS calls confirmed is without them.
    lost: bool,
    /// Ticks that have been played with everybody's true inputs.
    confirmed: u64,
}

/// When GGRS may say that a player is gone: that is for [`Presence`] to say.
const NEVER: Duration = Duration::from_secs(u32::MAX as u64);

/// What GGRS takes for a socket.
struct Mail<A> {
    incoming: Vec<(A, Message)>,
    outgoing: Vec<(A, Message)>,
}

struct Mailbox<A>(Arc<Mutex<Mail<A>>>);

impl<A: Address> NonBlockingSocket<A> for Mailbox<A> {
    fn send_to(&mut self, message: &Message, to: &A) {
        lock(&self.0).outgoing.push((to.clone(), message.clone()));
    }

    fn receive_all_messages(&mut self) -> Vec<(A, Message)> {
        mem::take(&mut lock(&self.0).incoming)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<G: NetGame, A: Address> Session<G, A> {
    pub(super) fn new(roster: Roster<A>, options: &Options, tick_rate: u32) -> Result<Self, GgrsError> {
        let seats = roster.seats();
        let mut builder = SessionBuilder::new()
            .with_num_players(seats.len())?
            .with_max_prediction_window(options.window().into())
            .with_input_delay(options.delay().into())
            .with_desync_detection_mode(DesyncDetection::On { interval: options.check_interval.max(1) })
            .with_disconnect_timeout(NEVER)
            .with_disconnect_notify_delay(NEVER)
            .with_fps(usize::try_from(tick_rate).unwrap_or(usize::MAX))?;
        for (handle, seat) in seats.iter().enumerate() {
            let address = roster.others.iter().find(|(other, _)| other == seat);
            let player =
                address.map_or(PlayerType::Local, |(_, address)| PlayerType::Remote(address.clone()));
            builder = builder.add_player(player, handle)?;
        }
        let mail = Arc::new(Mutex::new(Mail { incoming: Vec::new(), outgoing: Vec::new() }));
        let p2p = builder.start_p2p_session(Mailbox(mail.clone()))?;
        let others = roster.others.iter().map(|(_, address)| address.clone());
        Ok(Session {
            gates: others.clone().map(|address| (address, Gate::new(seats.len()))).collect(),
            presences: others.map(|address| (address, Presence::default())).collect(),
            timeout: options.timeout,
            polled: Duration::ZERO,
            synchronised: BTreeSet::new(),
            lost: false,
            confirmed: roster.base,
            roster,
            p2p,
            mail,
        })
    }

    /// Takes a message of GGRS from a peer.
    pub(super) fn receive(&mut self, from: &A, message: &[u8]) {
        let frame = self.p2p.current_frame();
        let Some(message) = self.gates.get_mut(from).and_then(|gate| gate.receive(message, frame)) else {
            return;
        };
        if let Some(presence) = self.presences.get_mut(from) {
            presence.hear();
        }
        lock(&self.mail).incoming.push((from.clone(), message));
    }

    /// The messages that are to be sent.
    pub(super) fn send(&mut self, now: Duration) -> Vec<(A, Vec<u8>)> {
        let outgoing = mem::take(&mut lock(&self.mail).outgoing);
        let gates = &mut self.gates;
        let bytes = |(to, message): (A, Message)| {
            let bytes = gates.get_mut(&to)?.send(&message, now)?;
            Some((to, bytes))
        };
        let mut packets: Vec<_> = outgoing.into_iter().filter_map(bytes).collect();
        let again = gates.iter_mut().filter_map(|(to, gate)| Some((to.clone(), gate.send_again(now)?)));
        packets.extend(again);
        packets
    }

    /// Lets GGRS read its messages and write new ones.
    pub(super) fn poll(&mut self, now: Duration) -> Vec<SessionEvent> {
        self.p2p.poll_remote_clients();
        let mut events = self.events();
        let passed = now.saturating_sub(self.polled);
        self.polled = now;
        // Who has not yet answered is waited for in another way: that takes long in bad weather.
        let others = self.roster.others.iter().filter(|(_, address)| self.synchronised.contains(address));
        for (seat, address) in others {
            let presence = self.presences.get_mut(address);
            events.extend(presence.and_then(|presence| presence.listen(*seat, passed, self.timeout)));
        }
        events
    }

    fn events(&mut self) -> Vec<SessionEvent> {
        let mut events = Vec::new();
        for event in self.p2p.events().collect::<Vec<_>>() {
            let of = |address: &A| self.roster.seat_of(address);
            match event {
                GgrsEvent::Synchronized { addr } => {
                    self.synchronised.insert(addr);
                }
                GgrsEvent::Disconnected { addr } => {
                    self.lost = true;
                    events.extend(of(&addr).map(SessionEvent::Lost));
                }
                GgrsEvent::DesyncDetected { frame, remote_checksum, addr, .. } => {
                    let tick = self.roster.base + u64::try_from(frame).unwrap_or(0);
                    let echo = Echo { tick, hash: StateHash(remote_checksum) };
                    events.extend(of(&addr).map(|seat| SessionEvent::Said(seat, echo)));
                }
                GgrsEvent::Synchronizing { .. } => events.push(SessionEvent::Answered),
                GgrsEvent::NetworkInterrupted { .. }
                | GgrsEvent::NetworkResumed { .. }
                | GgrsEvent::WaitRecommendation { .. } => {}
            }
        }
        events
    }

    /// Whether all peers have answered, so that ticks can be played.
    pub(super) fn is_running(&self) -> bool {
        self.p2p.current_state() == ggrs::SessionState::Running
    }

    /// The seats that have not answered yet.
    pub(super) fn silent(&self) -> u64 {
        let silent = self.roster.others.iter().filter(|(_, address)| !self.synchronised.contains(address));
        silent.fold(0, |mask, (seat, _)| mask | seat_bit(*seat))
    }

    /// Plays a tick, if one can be played. `driver` has to be at this session.
    pub(super) fn advance(
        &mut self,
        driver: &mut Driver<G>,
        input: G::Input,
    ) -> Result<Vec<SessionEvent>, NetError> {
        let handles = self.p2p.local_player_handles();
        for handle in handles {
            self.p2p.add_local_input(handle, driver.local_input(input))?;
        }
        let requests = self.p2p.advance_frame()?;
        driver.fulfil(requests)?;
        let events = self.events();
        // Only now have rollbacks been made for all that has come.
        if !self.lost {
            let known = u64::try_from(self.p2p.confirmed_frame() + 1).unwrap_or(0);
            self.confirmed = self.confirmed.max((self.roster.base + known).min(driver.tick()));
        }
        Ok(events)
    }

    /// How many ticks, from the first of the game on, have been played with everybody's true inputs.
    pub(super) const fn confirmed(&self) -> u64 {
        self.confirmed
    }

    /// Whether everybody plays: then nobody is left in the session before.
    pub(super) const fn is_established(&self) -> bool {
        self.confirmed > self.roster.base
    }

    /// How many ticks this peer is ahead of the slowest other.
    pub(super) fn ahead(&self) -> u32 {
        u32::try_from(self.p2p.frames_ahead()).unwrap_or(0)
    }
}
