//! [`Session`]: a range of ticks played by the same players, on top of a GGRS session.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::mem;
use core::time::Duration;
use std::sync::{Mutex, PoisonError};

use ggrs::{DesyncDetection, GgrsError, GgrsEvent, Message, NonBlockingSocket, P2PSession};
use ggrs::{PlayerType, SessionBuilder};

use super::driver::Driver;
use super::liveness::Liveness;
use super::message_validator::MessageValidator;
use super::options::NetOptions;
use super::packet::SessionId;
use super::peer::NetError;
use super::wire::{Address, ChecksumReport, GgrsConfig, NetGame};
use crate::hash::StateHash;

/// Membership of a session, and its first tick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Membership<A> {
    pub(super) session: SessionId,
    /// First tick.
    pub(super) base: u64,
    /// Seat of this peer.
    pub(super) seat: u32,
    /// The other players, in ascending order of seats.
    pub(super) others: Vec<(u32, A)>,
}

impl<A: Address> Membership<A> {
    /// Derives the id of the session that follows `parent`: peers that agree on the arguments get the same id.
    pub(super) fn id(parent: SessionId, base: u64, seats: u64, salt: u64) -> SessionId {
        let hash = StateHash::of(&(parent, base, seats, salt)).0;
        SessionId(u64::try_from(hash & u128::from(u64::MAX)).unwrap_or(0))
    }

    /// All seats, in ascending order: the index in this list is the GGRS player handle.
    pub(super) fn seats(&self) -> Vec<u32> {
        let mut seats: Vec<_> = self.others.iter().map(|(seat, _)| *seat).chain([self.seat]).collect();
        seats.sort_unstable();
        seats
    }

    /// All seats, as bits.
    pub(super) fn mask(&self) -> u64 {
        self.seats().iter().fold(0, |mask, seat| mask | seat_bit(*seat))
    }

    pub(super) fn seat_of(&self, address: &A) -> Option<u32> {
        self.others.iter().find(|(_, other)| other == address).map(|(seat, _)| *seat)
    }

    /// Whether this peer is the leader, which decides about joins.
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

/// An event of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum SessionEvent {
    /// A peer has answered one of the handshake messages that GGRS exchanges before the first tick.
    Answered,
    /// No messages arrive from this seat.
    Interrupted(u32),
    /// Messages arrive again.
    Resumed(u32),
    /// No messages have arrived for the whole timeout. Reported repeatedly.
    Lost(u32),
    /// The peer of this seat has reported a hash.
    Said(u32, ChecksumReport),
}

pub(super) struct Session<G: NetGame, A: Address> {
    pub(super) membership: Membership<A>,
    p2p: P2PSession<GgrsConfig<G, A>>,
    mail: Arc<Mutex<Mail<A>>>,
    validators: BTreeMap<A, MessageValidator>,
    liveness: BTreeMap<A, Liveness>,
    timeout: Duration,
    /// Time of the last poll.
    polled: Duration,
    synchronised: BTreeSet<A>,
    /// Whether a player was lost. From then on GGRS's confirmed frames leave out that player.
    lost: bool,
    /// Number of ticks simulated with the confirmed inputs of all players.
    confirmed: u64,
}

/// Disconnect timeout of GGRS: disabled, because [`Liveness`] detects lost players.
const NEVER: Duration = Duration::from_secs(u32::MAX as u64);

/// In-memory socket handed to GGRS.
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
    pub(super) fn new(
        membership: Membership<A>,
        options: &NetOptions,
        tick_rate: u32,
    ) -> Result<Self, GgrsError> {
        let seats = membership.seats();
        let mut builder = SessionBuilder::new()
            .with_num_players(seats.len())?
            .with_max_prediction_window(options.window().into())
            .with_input_delay(options.delay().into())
            .with_desync_detection_mode(DesyncDetection::On { interval: options.check_interval.max(1) })
            .with_disconnect_timeout(NEVER)
            .with_disconnect_notify_delay(NEVER)
            .with_fps(usize::try_from(tick_rate).unwrap_or(usize::MAX))?;
        for (handle, seat) in seats.iter().enumerate() {
            let address = membership.others.iter().find(|(other, _)| other == seat);
            let player =
                address.map_or(PlayerType::Local, |(_, address)| PlayerType::Remote(address.clone()));
            builder = builder.add_player(player, handle)?;
        }
        let mail = Arc::new(Mutex::new(Mail { incoming: Vec::new(), outgoing: Vec::new() }));
        let p2p = builder.start_p2p_session(Mailbox(mail.clone()))?;
        let others = membership.others.iter().map(|(_, address)| address.clone());
        Ok(Session {
            validators: others.clone().map(|address| (address, MessageValidator::new(seats.len()))).collect(),
            liveness: others.map(|address| (address, Liveness::default())).collect(),
            timeout: options.timeout,
            polled: Duration::ZERO,
            synchronised: BTreeSet::new(),
            lost: false,
            confirmed: membership.base,
            membership,
            p2p,
            mail,
        })
    }

    /// Receives a GGRS message from a peer.
    pub(super) fn receive(&mut self, from: &A, message: &[u8]) {
        let frame = self.p2p.current_frame();
        let Some(message) =
            self.validators.get_mut(from).and_then(|validator| validator.receive(message, frame))
        else {
            return;
        };
        if let Some(liveness) = self.liveness.get_mut(from) {
            liveness.receive();
        }
        lock(&self.mail).incoming.push((from.clone(), message));
    }

    /// The messages to send.
    pub(super) fn send(&mut self, now: Duration) -> Vec<(A, Vec<u8>)> {
        let outgoing = mem::take(&mut lock(&self.mail).outgoing);
        let validators = &mut self.validators;
        let bytes = |(to, message): (A, Message)| {
            let bytes = validators.get_mut(&to)?.send(&message, now)?;
            Some((to, bytes))
        };
        let mut packets: Vec<_> = outgoing.into_iter().filter_map(bytes).collect();
        let again = validators
            .iter_mut()
            .filter_map(|(to, validator)| Some((to.clone(), validator.send_again(now)?)));
        packets.extend(again);
        packets
    }

    /// Lets GGRS process received messages and create new ones.
    pub(super) fn poll(&mut self, now: Duration) -> Vec<SessionEvent> {
        self.p2p.poll_remote_clients();
        let mut events = self.events();
        let passed = now.saturating_sub(self.polled);
        self.polled = now;
        // `departure.rs` waits for peers that have not answered yet: with high packet loss the handshake takes long.
        let others = self.membership.others.iter().filter(|(_, address)| self.synchronised.contains(address));
        for (seat, address) in others {
            let liveness = self.liveness.get_mut(address);
            events.extend(liveness.and_then(|liveness| liveness.listen(*seat, passed, self.timeout)));
        }
        events
    }

    fn events(&mut self) -> Vec<SessionEvent> {
        let mut events = Vec::new();
        for event in self.p2p.events().collect::<Vec<_>>() {
            let of = |address: &A| self.membership.seat_of(address);
            match event {
                GgrsEvent::Synchronized { addr } => {
                    self.synchronised.insert(addr);
                }
                GgrsEvent::Disconnected { addr } => {
                    self.lost = true;
                    events.extend(of(&addr).map(SessionEvent::Lost));
                }
                GgrsEvent::DesyncDetected { frame, remote_checksum, addr, .. } => {
                    let tick = self.membership.base + u64::try_from(frame).unwrap_or(0);
                    let checksum = ChecksumReport { tick, hash: StateHash(remote_checksum) };
                    events.extend(of(&addr).map(|seat| SessionEvent::Said(seat, checksum)));
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

    /// The seats that have not answered yet, as bits.
    pub(super) fn silent(&self) -> u64 {
        let silent =
            self.membership.others.iter().filter(|(_, address)| !self.synchronised.contains(address));
        silent.fold(0, |mask, (seat, _)| mask | seat_bit(*seat))
    }

    /// Plays a tick, if possible. `driver` has to be in this session.
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
        // All rollbacks for the received inputs have been made at this point.
        if !self.lost {
            let known = u64::try_from(self.p2p.confirmed_frame() + 1).unwrap_or(0);
            self.confirmed = self.confirmed.max((self.membership.base + known).min(driver.tick()));
        }
        Ok(events)
    }

    /// Number of ticks, counted from the start of the game, simulated with the confirmed inputs of all players.
    pub(super) const fn confirmed(&self) -> u64 {
        self.confirmed
    }

    /// Whether all peers play in this session, so that none is left in the previous one.
    pub(super) const fn is_established(&self) -> bool {
        self.confirmed > self.membership.base
    }

    /// Number of ticks that this peer is ahead of the slowest other peer.
    pub(super) fn ahead(&self) -> u32 {
        u32::try_from(self.p2p.frames_ahead()).unwrap_or(0)
    }
}
