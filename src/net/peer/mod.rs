//! [`Peer`]: one participant of a match, from the handshake to the finished replay.

mod catch_up;
mod departure;
mod error;
mod joiners;
mod proposal;

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::time::Duration;
use std::hash::{BuildHasher, RandomState};

pub use error::NetError;

use catch_up::CatchUp;
use departure::{AgreedDeparture, DepartureAgreement};
use joiners::Joiner;
use proposal::ProposedSession;

use super::driver::{Divergence, Driver};
use super::handshake::HandshakeParameters;
use super::options::NetOptions;
use super::packet::{Nonce, Packet, SessionId};
use super::session::{Session, SessionEvent};
use super::transport::Transport;
use super::wire::{Address, NetGame};
use crate::codec;
use crate::lockstep::History;

/// Retransmission interval.
const RESEND: Duration = Duration::from_millis(50);
/// Maximum number of packets read in one update; the rest is read in the next.
const PACKETS_PER_UPDATE: usize = 2000;

/// An event that a peer reports to its game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// From this tick on, the player of this seat takes part.
    Joined {
        /// The seat.
        seat: u32,
        /// First tick.
        tick: u64,
    },
    /// From this tick on, this seat is empty. All peers report the same tick.
    Left {
        /// The seat.
        seat: u32,
        /// First tick.
        tick: u64,
    },
    /// No messages have arrived from this seat for a while.
    Interrupted {
        /// The seat.
        seat: u32,
    },
    /// Messages from this seat arrive again.
    Resumed {
        /// The seat.
        seat: u32,
    },
    /// Another peer has another state. Write [`Peer::report`] to a file: it contains the data needed to find the cause.
    Diverged(Divergence),
}

/// One participant of a match: hosts it, joins it, or watches it.
///
/// It owns the game and decides when a tick can be played; the caller owns the clock and the transport. Call
/// [`Peer::update`] often, and [`Peer::advance`] whenever [`Peer::is_due`] returns true.
///
/// The host has the lowest seat at first, and admits players to free seats at any time. When it leaves, the player with
/// the next lowest seat takes over, so no single player is required.
pub struct Peer<G: NetGame, A: Address, T: Transport<A>> {
    transport: T,
    options: NetOptions,
    parameters: HandshakeParameters,
    /// Canonical bytes of the setup.
    setup: Vec<u8>,
    driver: Driver<G>,
    now: Duration,
    /// Time at which the next tick is due.
    next_tick: Duration,
    /// State of a peer that has no seat yet, or a spectator.
    catch_up: Option<CatchUp<A>>,
    /// Initial session id of a host that has no session yet.
    initial_session_id: Option<SessionId>,
    session: Option<Session<G, A>>,
    /// Time at which the session was entered, or, while not all peers have entered it, of the last answer: with high
    /// packet loss this takes long.
    awaited_since: Duration,
    /// The agreed session that has not been entered yet.
    next: Option<Session<G, A>>,
    proposed: Option<ProposedSession<A>>,
    /// The previous session, while other peers may still be in it.
    past: Option<Session<G, A>>,
    leaving: Option<DepartureAgreement>,
    settled: Option<AgreedDeparture>,
    /// The last session that was agreed upon but is not played.
    abandoned: Option<SessionId>,
    joiners: Vec<Joiner<A>>,
    events: VecDeque<Event>,
}

impl<G: NetGame, A: Address, T: Transport<A>> Peer<G, A, T> {
    /// Opens a match and waits for [`NetOptions::start_with`] players.
    ///
    /// # Errors
    /// [`NetError`] when the setup cannot start a game.
    pub fn host(setup: &G::Setup, options: NetOptions, transport: T) -> Result<Self, NetError> {
        let mut peer = Self::new(setup, options, transport)?;
        peer.initial_session_id = Some(SessionId(random()));
        Ok(peer)
    }

    /// Asks the peer at `contact` for a seat. `seat` is preferred if it is free.
    ///
    /// # Errors
    /// [`NetError`] when the setup cannot start a game.
    pub fn join(
        setup: &G::Setup,
        options: NetOptions,
        transport: T,
        contact: A,
        seat: Option<u32>,
    ) -> Result<Self, NetError> {
        let mut peer = Self::new(setup, options, transport)?;
        peer.catch_up = Some(CatchUp::play(contact, Nonce(random()), seat));
        Ok(peer)
    }

    /// Asks the peer at `contact` to watch.
    ///
    /// # Errors
    /// [`NetError`] when the setup cannot start a game.
    pub fn watch(setup: &G::Setup, options: NetOptions, transport: T, contact: A) -> Result<Self, NetError> {
        let mut peer = Self::new(setup, options, transport)?;
        peer.catch_up = Some(CatchUp::watch(contact, Nonce(random())));
        Ok(peer)
    }

    fn new(setup: &G::Setup, options: NetOptions, transport: T) -> Result<Self, NetError> {
        let mut driver = Driver::start(setup, options.checkpoint_interval)?;
        driver.set_memory(options.memory());
        if options.window() == 0 {
            driver = driver.with_echo(options.check_interval.into());
        }
        let parameters = HandshakeParameters::of(driver.game(), setup, &options);
        let options = options.start_with(options.start_with.min(parameters.players));
        Ok(Peer {
            transport,
            options,
            parameters,
            setup: codec::encode(setup),
            driver,
            now: Duration::ZERO,
            next_tick: Duration::ZERO,
            catch_up: None,
            initial_session_id: None,
            session: None,
            awaited_since: Duration::ZERO,
            next: None,
            proposed: None,
            past: None,
            leaving: None,
            settled: None,
            abandoned: None,
            joiners: Vec::new(),
            events: VecDeque::new(),
        })
    }

    /// Reads all received packets and sends what is due. `now` is the time since a fixed moment in the past.
    ///
    /// # Errors
    /// [`NetError`] when this peer cannot continue: it was refused or disconnected, or no peer answers.
    pub fn update(&mut self, now: Duration) -> Result<(), NetError> {
        self.now = self.now.max(now);
        for _ in 0..PACKETS_PER_UPDATE {
            let Some((from, bytes)) = self.transport.receive() else { break };
            if let Some(packet) = Packet::decode(&bytes) {
                self.receive(&from, packet)?;
            }
        }
        self.poll_sessions();
        self.catch_up()?;
        self.admit()?;
        self.settle()?;
        self.enter_next()?;
        self.send_sessions();
        Ok(())
    }

    fn receive(&mut self, from: &A, packet: Packet<A>) -> Result<(), NetError> {
        match packet {
            Packet::Session { session, message } => {
                // A session with departed players reads no more messages: they would pile up.
                let current = self.session.as_mut().filter(|_| self.leaving.is_none());
                let mut sessions = current.into_iter().chain(&mut self.next).chain(&mut self.past);
                let of = sessions.find(|known| known.membership.session == session);
                if let Some(session) = of {
                    session.receive(from, &message);
                }
            }
            Packet::Hello { nonce, parameters, seat, watch } => {
                self.greet(from, nonce, &parameters, seat, watch)
            }
            Packet::WantState { nonce, offset } => self.give_state(from, nonce, offset),
            Packet::WantInputs { nonce, from: tick } => self.give_inputs(from, nonce, tick),
            Packet::Ready { nonce, tick, hash } => self.take_ready(from, nonce, tick, hash),
            Packet::Refused { .. }
            | Packet::Redirect { .. }
            | Packet::Welcome { .. }
            | Packet::State { .. }
            | Packet::Inputs { .. } => self.hear_contact(from, packet)?,
            Packet::Plan { parent, plan } => self.hear_plan(from, parent, plan)?,
            Packet::Agreed { plan } => self.hear_agreed(from, plan),
            Packet::Gone { session, gone, ticks, settled } => {
                self.hear_gone(from, session, gone, ticks, settled)?;
            }
            Packet::Bye { session } => self.hear_bye(from, session),
        }
        Ok(())
    }

    fn poll_sessions(&mut self) {
        // Players of the previous session may still need messages of this peer. Its events do not matter any more.
        if let Some(past) = &mut self.past {
            past.poll(self.now);
        }
        if let Some(next) = &mut self.next {
            next.poll(self.now);
        }
        if self.leaving.is_none()
            && let Some(session) = &mut self.session
        {
            let events = session.poll(self.now);
            self.note(events);
        }
    }

    fn send_sessions(&mut self) {
        for session in [&mut self.past, &mut self.next, &mut self.session].into_iter().flatten() {
            let id = session.membership.session;
            for (to, message) in session.send(self.now) {
                let packet: Packet<A> = Packet::Session { session: id, message };
                self.transport.send(&packet.encode(), &to);
            }
        }
    }

    fn note(&mut self, events: Vec<SessionEvent>) {
        for event in events {
            match event {
                SessionEvent::Answered => self.awaited_since = self.now,
                SessionEvent::Lost(seat) => self.begin_leaving(super::session::seat_bit(seat)),
                SessionEvent::Interrupted(seat) => self.events.push_back(Event::Interrupted { seat }),
                SessionEvent::Resumed(seat) => self.events.push_back(Event::Resumed { seat }),
                SessionEvent::Said(seat, checksum) => self.driver.receive(seat, checksum),
            }
        }
        self.events.extend(self.driver.take_divergences().into_iter().map(Event::Diverged));
    }

    fn send(&mut self, packet: &Packet<A>, to: &A) {
        self.transport.send(&packet.encode(), to);
    }

    /// Whether it is time for the next tick.
    #[must_use]
    pub fn is_due(&self) -> bool {
        let plays = self.session.as_ref().is_some_and(Session::is_running) && self.leaving.is_none();
        plays && self.now >= self.next_tick
    }

    /// Plays a tick with the local player's input, if the inputs of the other peers allow it. Returns whether a tick
    /// was played.
    ///
    /// With rollback, earlier ticks may be played again. A peer that is ahead of others plays its ticks slightly
    /// slower, so that no peer has to stop abruptly. A peer that was held up catches up by up to eight ticks.
    ///
    /// # Errors
    /// [`NetError`] when the game or its replay cannot continue.
    pub fn advance(&mut self, input: G::Input) -> Result<bool, NetError> {
        if self.leaving.is_some() {
            return Ok(false);
        }
        let Some(session) = &mut self.session else { return Ok(false) };
        if !session.is_running() {
            return Ok(false);
        }
        let before = self.driver.tick();
        let events = session.advance(&mut self.driver, input)?;
        let played = self.driver.tick() > before;
        let period = Duration::from_secs(1) / self.parameters.tick_rate;
        let stretched = period + period * session.ahead().min(8) / 32;
        let wait = if played { stretched } else { period / 8 };
        self.next_tick = (self.next_tick + wait).max(self.now.saturating_sub(8 * period));
        let known = session.confirmed();
        self.driver.commit(known.saturating_sub(self.options.doubt()))?;
        self.note(events);
        self.enter_next()?;
        self.send_sessions();
        Ok(played)
    }

    /// The next event, oldest first.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// The current state of the game; with rollback it may depend on predicted inputs.
    #[must_use]
    pub const fn game(&self) -> &G {
        self.driver.game()
    }

    /// Number of ticks played, including predicted ones.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.driver.tick()
    }

    /// Number of ticks simulated with the confirmed inputs of all players.
    #[must_use]
    pub fn confirmed(&self) -> u64 {
        self.session.as_ref().map_or(self.driver.committed(), Session::confirmed)
    }

    /// The recent states.
    #[must_use]
    pub const fn history(&self) -> &History<G> {
        self.driver.history()
    }

    /// This peer's report of a divergence, as bytes for a file. The reports of any two peers tell which peer diverged,
    /// when and where: `lockstep2d diff`, or [`report::compare`](crate::report::compare).
    #[must_use]
    pub fn report(&self, divergence: &Divergence) -> Vec<u8> {
        let seats = self.seat().into_iter().collect();
        self.driver.report(divergence, seats, self.confirmed()).to_bytes()
    }

    /// The seat of this peer, once it has one.
    #[must_use]
    pub fn seat(&self) -> Option<u32> {
        self.session.as_ref().map(|session| session.membership.seat)
    }

    /// The seats that have players, in ascending order.
    #[must_use]
    pub fn seats(&self) -> Vec<u32> {
        self.session.as_ref().map(|session| session.membership.seats()).unwrap_or_default()
    }

    /// The transport.
    pub fn transport_mut(&mut self) -> &mut T {
        &mut self.transport
    }

    /// Takes the finished bytes of the replay, to be appended to its file. Every byte is returned once.
    ///
    /// A peer that joined the match after its first tick has no replay.
    #[must_use]
    pub fn take_replay(&mut self) -> Vec<u8> {
        // While loading, the recorded bytes may be the beginning of another match than the one being joined.
        let unsure = self.catch_up.as_ref().is_some_and(CatchUp::is_loading);
        if unsure { Vec::new() } else { self.driver.take_replay() }
    }

    /// Leaves the match and ends the replay after `ticks` ticks, or after the last tick with confirmed inputs of all
    /// players. Returns the bytes of the replay that have not been taken yet.
    ///
    /// # Errors
    /// [`NetError`] when the replay cannot be finished.
    pub fn finish(mut self, ticks: u64) -> Result<Vec<u8>, NetError> {
        self.say_bye();
        self.say_bye_to_joiners();
        let known = self.confirmed().min(ticks);
        self.driver.commit(known)?;
        Ok(self.driver.finish()?)
    }
}

/// A random number that is not part of any state.
fn random() -> u64 {
    RandomState::new().hash_one(0)
}
