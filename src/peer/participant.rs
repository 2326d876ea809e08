use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::fmt;
use core::time::Duration;

use super::error::PeerError;
use super::event::{PeerDesync, PeerEvent};
use super::input_slot::InputSlot;
use super::options::{PeerIdentity, PeerOptions};
use super::parameters::PeerParameters;
use super::simulation::Simulation;
use super::transport::Transport;
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::{Game, History};
use crate::session::{
    Address, Endpoint, Event, Identity, JoinEvent, Key, Link, PeerId, RefusalReason, Role, Session, Status,
    Tick,
};

const PACKETS_PER_UPDATE: usize = 4096;

/// One participant of a match, with the game and the transport.
///
/// Call [`update`](Peer::update) every few milliseconds, and [`advance`](Peer::advance) while [`is_due`](Peer::is_due).
///
/// ```no_run
/// # use lockstep2d::{lockstep::Game, peer::{Peer, PeerIdentity, PeerOptions, Udp, socket_address}};
/// # fn join<MyGame: Game>(setup: &MyGame::Setup) -> Result<(), Box<dyn std::error::Error>> {
/// // A second player joins the match of a host.
/// let (options, me) = (PeerOptions::lockstep(), PeerIdentity::random());
/// let host = socket_address("203.0.113.5:7000".parse()?);
/// let mut peer = Peer::<MyGame, _>::join(setup, options, me, Udp::bind("0.0.0.0:0")?, host)?;
/// # Ok(())
/// # }
/// ```
pub struct Peer<G: Game, T> {
    transport: T,
    pub(super) endpoint: Endpoint,
    pub(super) simulation: Simulation<G>,
    parameters: PeerParameters,
    slot: InputSlot,
    now: u64,
    end: Option<u64>,
    /// Reused buffer for the bytes of a tick's inputs.
    inputs: Vec<u8>,
    events: VecDeque<PeerEvent>,
    /// Error that stopped the simulation. Until this peer joins again, updates return this error and only exchange
    /// packets.
    failure: Option<PeerError>,
}

impl<G: Game, T: fmt::Debug> fmt::Debug for Peer<G, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tick = self.simulation.tick;
        f.debug_struct("Peer")
            .field("transport", &self.transport)
            .field("tick", &tick)
            .finish_non_exhaustive()
    }
}

enum Entry {
    Host,
    Join(Role, Address),
}

impl<G: Game, T: Transport> Peer<G, T> {
    /// Opens a match, which starts once [`PeerOptions::start_with`] seats are taken. Without own seats
    /// ([`PeerOptions::seats`] is 0) the host is a dedicated server.
    ///
    /// # Errors
    /// [`PeerError`] if the setup or the options are invalid.
    pub fn host(
        setup: &G::Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: T,
    ) -> Result<Self, PeerError> {
        Self::new(setup, options, me, transport, Entry::Host)
    }

    /// Joins a match as a player. `contact` is the address of any participant. The peer plays once it has caught up and
    /// seats are free.
    ///
    /// # Errors
    /// As [`Peer::host`].
    pub fn join(
        setup: &G::Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: T,
        contact: Address,
    ) -> Result<Self, PeerError> {
        let options = PeerOptions { seats: options.seats.max(1), ..options };
        let role = Role::Player { seats: options.seats };
        Self::new(setup, options, me, transport, Entry::Join(role, contact))
    }

    /// Joins a match as a spectator. `contact` is the address of any participant.
    ///
    /// # Errors
    /// As [`Peer::host`].
    pub fn watch(
        setup: &G::Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: T,
        contact: Address,
    ) -> Result<Self, PeerError> {
        Self::new(setup, options, me, transport, Entry::Join(Role::Spectator, contact))
    }

    fn new(
        setup: &G::Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: T,
        entry: Entry,
    ) -> Result<Self, PeerError> {
        let slot = InputSlot::of::<G::Input>(options.input_bytes)?;
        let mut simulation = Simulation::<G>::start(setup, options.checkpoint_interval, slot)?;
        let config = options.config(&simulation.game, slot)?;
        simulation.set_memory(
            u32::from(config.history) + u32::from(config.guess) + 2 * u32::from(config.save_interval),
        );
        let parameters = PeerParameters::of(&simulation.game, setup, &config);
        let identity =
            Identity { id: me.id, key: me.key, offer: codec::encode(&parameters), secret: me.secret };
        let endpoint = match entry {
            Entry::Host => {
                let seats = 1_u64.checked_shl(options.seats.into()).map_or(u64::MAX, |above| above - 1);
                let first = options.first_seat.unwrap_or(0);
                Endpoint::host(config, identity, seats.checked_shl(first.into()).unwrap_or(0))?
            }
            Entry::Join(role, contact) => Endpoint::join(config, identity, role, contact)?,
        };
        let (now, end, inputs, events, failure) = (0, None, Vec::new(), VecDeque::new(), None);
        Ok(Peer { transport, endpoint, simulation, parameters, slot, now, end, inputs, events, failure })
    }

    /// Processes received packets, plays ticks again if their inputs have changed, and sends packets. `now` is the time
    /// since a fixed moment.
    ///
    /// # Errors
    /// [`PeerError`] if this peer cannot continue. Later updates still exchange packets, so that this peer can
    /// [`leave`](Peer::leave). The other peers wait for this peer until it has left.
    pub fn update(&mut self, now: Duration) -> Result<(), PeerError> {
        self.now = self.now.max(u64::try_from(now.as_micros()).unwrap_or(u64::MAX));
        for _ in 0..PACKETS_PER_UPDATE {
            let Some((from, bytes)) = self.transport.receive() else { break };
            self.endpoint.receive(self.now, from, &bytes);
        }
        if let (Some(end), Some(session)) = (self.end, self.endpoint.session_mut()) {
            session.end_at(Tick::try_from(end).unwrap_or(Tick::MAX));
        }
        self.endpoint.update(self.now);
        let outcome = self.carry_out();
        self.send();
        outcome
    }

    fn carry_out(&mut self) -> Result<(), PeerError> {
        self.take_join_events()?;
        if let Some(seat) = self.endpoint.session().and_then(Session::taken_seat) {
            return Err(PeerError::SeatTaken { seat });
        }
        if self.endpoint.session().is_some_and(Session::is_match_used_up) {
            return Err(PeerError::Refused { why: "the match has had too many players" });
        }
        if self.endpoint.wants_state() {
            let state = self.simulation.state_for(self.simulation.committed);
            if let Some((tick, bytes)) = state {
                self.endpoint.offer_state(Tick::try_from(tick).unwrap_or(Tick::MAX), bytes);
            }
        }
        self.fulfil()
    }

    fn take_join_events(&mut self) -> Result<(), PeerError> {
        while let Some(event) = self.endpoint.next_event() {
            match event {
                JoinEvent::State { tick, bytes } => {
                    let resumed = self.simulation.resume(tick.into(), &bytes);
                    self.failure = resumed.clone().err();
                    resumed?;
                    self.events.push_back(PeerEvent::Joined { tick: tick.into() });
                }
                JoinEvent::Refused { reason, offer } => match reason {
                    RefusalReason::Offer => {
                        let theirs = codec::decode::<PeerParameters>(&offer).ok();
                        let differences = theirs.map(|theirs| self.parameters.differences(&theirs));
                        return Err(PeerError::Parameters(differences.unwrap_or_default()));
                    }
                    RefusalReason::Full => {
                        return Err(PeerError::Refused { why: "too many peers are joining" });
                    }
                    RefusalReason::Taken => return Err(PeerError::Refused { why: "the identity is taken" }),
                    RefusalReason::NotReady => {}
                },
                JoinEvent::BadState => {}
            }
        }
        Ok(())
    }

    fn fulfil(&mut self) -> Result<(), PeerError> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let Some(session) = self.endpoint.session_mut() else { return Ok(()) };
        self.simulation.fulfil(session).inspect_err(|error| self.failure = Some(error.clone()))?;
        while let Some(event) = session.next_event() {
            self.events.push_back(match event {
                Event::Desync { peer, tick, ours, theirs } => PeerEvent::Desync(PeerDesync {
                    peer,
                    tick: tick.into(),
                    ours: StateHash(ours),
                    theirs: StateHash(theirs),
                }),
                event => PeerEvent::Session(event),
            });
        }
        Ok(())
    }

    fn send(&mut self) {
        self.endpoint.flush();
        while let Some((to, bytes)) = self.endpoint.next_packet() {
            self.transport.send(&bytes, &to);
        }
    }

    /// Whether to call [`advance`](Peer::advance): the next tick is due, and can be played or needs inputs of this
    /// peer.
    #[must_use]
    pub fn is_due(&self) -> bool {
        self.failure.is_none() && self.endpoint.session().is_some_and(|session| session.is_due(self.now))
    }

    /// Issues the inputs of this peer's seats, in the order of the seats, and plays a tick if possible. If this peer
    /// has no seats, `inputs` is ignored. Returns whether the inputs were issued. If not, the caller may pass them
    /// again.
    ///
    /// Each call that returns `true` issues the inputs of one tick. After such a call, clear the key presses collected
    /// so far. When the input delay grows, [`is_due`](Peer::is_due) remains true: further calls issue inputs of
    /// additional ticks, and then the next tick is played.
    ///
    /// # Errors
    /// [`PeerError`] if the number of inputs is not the number of own seats, if an input cannot be encoded, or if the
    /// game or its replay cannot continue, for example after an error of [`update`](Peer::update). If the inputs are
    /// not due yet, the result is `false` and no error.
    pub fn advance(&mut self, inputs: &[G::Input]) -> Result<bool, PeerError> {
        // If this peer issued inputs after a failure, the other peers would play on, although this peer no longer
        // plays.
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let Some(session) = self.endpoint.session_mut() else { return Ok(false) };
        let seats = usize::try_from(session.seats().count_ones()).unwrap_or(0);
        let inputs = if seats == 0 { &[] } else { inputs };
        if seats != inputs.len() {
            return Err(PeerError::InputCount { seats, inputs: inputs.len() });
        }
        self.inputs.clear();
        for input in inputs {
            self.slot.put(input, &mut self.inputs)?;
        }
        let issued = session
            .advance(self.now, &self.inputs)
            .map_err(|_| PeerError::InputCount { seats, inputs: inputs.len() })?;
        self.fulfil()?;
        self.send();
        Ok(issued)
    }

    /// The next event, oldest first.
    pub fn next_event(&mut self) -> Option<PeerEvent> {
        self.events.pop_front()
    }

    /// The current game, which may depend on guessed inputs.
    #[must_use]
    pub const fn game(&self) -> &G {
        &self.simulation.game
    }

    /// Number of ticks played, including guessed ones.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.simulation.tick
    }

    /// Number of ticks played with final inputs, and recorded if there is a replay.
    #[must_use]
    pub const fn confirmed(&self) -> u64 {
        self.simulation.committed
    }

    /// Recent states, kept for rollback and reports.
    #[must_use]
    pub const fn history(&self) -> &History<G> {
        &self.simulation.history
    }

    /// The session, once this peer takes part.
    #[must_use]
    pub fn session(&self) -> Option<&Session> {
        self.endpoint.session()
    }

    /// The session, for calls such as [`Session::pause`] or [`Session::set_role`].
    pub fn session_mut(&mut self) -> Option<&mut Session> {
        self.endpoint.session_mut()
    }

    /// Status of the session; `None` before the initial state has arrived.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        self.endpoint.session().map(Session::status)
    }

    /// The seats of this peer, ascending.
    #[must_use]
    pub fn seats(&self) -> Vec<u32> {
        self.endpoint.session().map_or_else(Vec::new, |session| self.seats_of(session.id()))
    }

    /// Bytes received and total bytes of the initial state, while it is downloaded.
    #[must_use]
    pub fn download(&self) -> Option<(u64, u64)> {
        self.endpoint.download()
    }

    /// Measurements of the network path to another peer.
    #[must_use]
    pub fn link(&self, peer: PeerId) -> Option<Link> {
        self.endpoint.session().and_then(|session| session.link(peer))
    }

    /// Votes to remove a peer, as [`Session::kick`] does.
    pub fn kick(&mut self, key: Key) {
        if let Some(session) = self.endpoint.session_mut() {
            session.kick(key);
        }
    }

    /// Sends the request to join to the participant with this address, for example if an earlier request was not
    /// answered. Discards a session in progress, its events, and the end that [`Peer::end_at`] has set for it. After a
    /// session or a refusal, this peer has another [`PeerId`].
    pub fn ask(&mut self, contact: Address) {
        self.failure = None;
        if self.endpoint.session().is_some() {
            self.end = None;
        }
        self.events.clear();
        self.endpoint.ask(contact);
    }

    /// Leaves the match: the other peers continue without this peer. Call [`update`](Peer::update) until
    /// [`Status::Closed`]. Before the initial state has arrived, drop the [`Peer`] instead.
    pub fn leave(&mut self) {
        if let Some(session) = self.endpoint.session_mut() {
            session.leave();
        }
    }

    /// Requests an end of the match after a number of ticks, as [`Session::end_at`] does.
    ///
    /// The request of one peer ends the match for all, and [`Peer::game`] may depend on wrong guesses, so decide by
    /// confirmed ticks. Here, the number of ticks after which a game was won is part of its state:
    ///
    /// ```
    /// # use lockstep2d::{lockstep::Game, peer::{Peer, Transport}};
    /// # trait Rules: Game { fn over_at(&self) -> Option<u64>; }
    /// # fn after_update<G: Rules, T: Transport>(peer: &mut Peer<G, T>) {
    /// if let Some(over_at) = peer.game().over_at() && over_at <= peer.confirmed() {
    ///     peer.end_at(over_at + 180);
    /// }
    /// # }
    /// ```
    pub const fn end_at(&mut self, ticks: u64) {
        self.end = Some(ticks);
    }

    /// The seats of a peer, ascending.
    #[must_use]
    pub fn seats_of(&self, peer: PeerId) -> Vec<u32> {
        let seats = self.endpoint.session().map_or(0, |session| session.view().seats_of(peer));
        (0..64).filter(|seat| seats >> seat & 1 == 1).collect()
    }

    /// The transport.
    pub fn transport_mut(&mut self) -> &mut T {
        &mut self.transport
    }
}
