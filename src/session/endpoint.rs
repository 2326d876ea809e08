use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::address::Address;
use super::config::{Config, ConfigError, TIME_MAX};
use super::contacts::Contacts;
use super::guests::Guests;
use super::id::{Key, PeerId, Tick};
use super::join_packet::{ADDRESS_LIST_MAX, JoinPacket, OFFER_BYTES_MAX, RefusalReason};
use super::phase::Phase;
use super::routes::{Routes, token};
use super::siphash::Secret;
use super::start_state::StartState;
use super::state::{Role, Session};
use super::transfer::Pinned;
use super::view::View;

/// Largest accepted download in bytes: the game's state, the view and the addresses.
pub const STATE_BYTES_MAX: u64 = 256 << 20;
/// Time between attempts to reach the contact, in microseconds.
const HELLO_INTERVAL: u64 = 200_000;
/// Time without a new chunk after which a download restarts, in microseconds.
const DOWNLOAD_PATIENCE: u64 = 3_000_000;
/// Time between two packets with the addresses of peers, in microseconds.
const ADDRESS_LIST_INTERVAL: u64 = 500_000;
const PACKETS_MAX: usize = 8192;

/// An event of an endpoint while it joins a match. Events of its session are [`Event`](super::Event)s.
///
/// ```
/// use lockstep2d::session::{JoinEvent, RefusalReason};
/// /// A line of text for a player who waits to be admitted.
/// fn line(event: &JoinEvent) -> &'static str {
///     match event {
///         JoinEvent::Refused { reason: RefusalReason::Offer, .. } => "they play another version",
///         JoinEvent::Refused { .. } => "try again later",
///         JoinEvent::State { .. } => "here we go",
///         JoinEvent::BadState => "once more",
///     }
/// }
/// let refused = JoinEvent::Refused { reason: RefusalReason::Offer, offer: b"pucks, version 3".to_vec() };
/// assert_eq!(line(&refused), "they play another version");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JoinEvent {
    /// The contact refuses. After [`RefusalReason::NotReady`] the endpoint asks again, otherwise it waits for
    /// [`Endpoint::ask`].
    Refused {
        /// Reason.
        reason: RefusalReason,
        /// The contact's [offer](Identity::offer). A peer can join only with an equal offer.
        offer: Vec<u8>,
    },
    /// The initial state has arrived. The game restores it and then fulfils the requests of the session.
    State {
        /// Number of ticks played before this state.
        tick: Tick,
        /// The bytes that the contact passed to [`Endpoint::offer_state`].
        bytes: Vec<u8>,
    },
    /// The download is not a valid state and is requested again.
    BadState,
}

/// One participant of a match.
///
/// In a loop: pass packets to [`receive`](Endpoint::receive), call [`update`](Endpoint::update), offer a state while
/// [`wants_state`](Endpoint::wants_state), drive the [`session`](Endpoint::session) as described at [`Session`], and
/// send what [`next_packet`](Endpoint::next_packet) returns.
///
/// ```
/// use lockstep2d::session::{Address, Config, Endpoint, Identity, Key, PeerId, Role, Status};
/// let identity = |number: u32| Identity {
///     id: PeerId(number),
///     key: Key(number.into()),
///     offer: b"pucks, version 2, level 3".to_vec(),
///     secret: [number.into(), 7],
/// };
/// let config = Config { start_with: 2, ..Config::new(17, 2) };
/// let [at_host, at_guest] = [1, 2].map(|number| Address::new(&[number]).expect("a byte"));
/// let host = Endpoint::host(config.clone(), identity(1), 0b01)?;
/// let guest = Endpoint::join(config, identity(2), Role::Player { seats: 1 }, at_host)?;
/// let (mut ends, mut now) = ([(host, at_host), (guest, at_guest)], 0);
/// let is_playing = |end: &Endpoint| end.session().is_some_and(|it| it.status() == Status::Playing);
/// while !ends.iter().all(|(end, _)| is_playing(end)) {
///     now += 10_000;
///     for own in 0..2 {
///         let (end, address) = &mut ends[own];
///         end.update(now);
///         if end.wants_state() {
///             end.offer_state(0, b"the start of level 3".to_vec());
///         }
///         let (address, packets): (_, Vec<_>) = (*address, std::iter::from_fn(|| end.next_packet()).collect());
///         for (_, packet) in packets {
///             ends[1 - own].0.receive(now, address, &packet);
///         }
///     }
/// }
/// assert_eq!(ends[1].0.session().map(|session| session.seats()), Some(0b10));
/// # Ok::<(), lockstep2d::session::ConfigError>(())
/// ```
#[derive(Debug)]
pub struct Endpoint {
    pub(super) config: Config,
    pub(super) me: PeerId,
    pub(super) key: Key,
    pub(super) role: Role,
    pub(super) offer: Vec<u8>,
    pub(super) secret: Secret,
    pub(super) contact: Option<Address>,
    pub(super) phase: Phase,
    /// Number of requests to join.
    attempts: u64,
    pub(super) routes: Routes,
    pub(super) guests: Guests,
    pub(super) contacts: Contacts,
    pub(super) address_list_at: u64,
    pub(super) packets: VecDeque<(Address, Vec<u8>)>,
    pub(super) events: VecDeque<JoinEvent>,
}

/// Identifiers of a peer, its secret, and the offer that it sends in the handshake.
///
/// ```
/// use lockstep2d::session::{Config, Endpoint, Identity, Key, PeerId};
/// // A dedicated server: it has no seat, and others cannot guess its secret.
/// let [id, key, secret @ ..] = random();
/// let identity = Identity { id: PeerId(id as u32), key: Key(key), offer: b"pucks, version 2".to_vec(), secret };
/// let server = Endpoint::host(Config::new(17, 4), identity, 0)?;
/// assert_eq!(server.session().map(|session| session.seats()), Some(0));
/// /// Random numbers of the operating system.
/// fn random() -> [u64; 4] {
/// #     [1, 2, 3, 4]
///     // ...
/// }
/// # Ok::<(), lockstep2d::session::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Identity {
    /// A random number, new for each process.
    pub id: PeerId,
    /// The identity that outlives processes.
    pub key: Key,
    /// Handshake data that must be equal for all peers: versions, rules, setup. At most [`OFFER_BYTES_MAX`] bytes.
    pub offer: Vec<u8>,
    /// 16 random bytes, unknown to others: the key of handshake cookies and probe tokens.
    pub secret: [u64; 2],
}

fn in_range(field: &'static str, value: u64, max: u64) -> Result<(), ConfigError> {
    let error = ConfigError { field, value, min: 0, max, step: 1 };
    if value <= max { Ok(()) } else { Err(error) }
}

fn validate(config: &Config, identity: &Identity) -> Result<(), ConfigError> {
    config.validate()?;
    let bytes = u64::try_from(identity.offer.len()).unwrap_or(u64::MAX);
    in_range("bytes of the offer", bytes, OFFER_BYTES_MAX as u64)
}

impl Endpoint {
    fn new(config: Config, identity: Identity, role: Role, phase: Phase, contact: Option<Address>) -> Self {
        let Identity { id, key, offer, secret } = identity;
        Endpoint {
            config,
            me: id,
            key,
            role,
            offer,
            secret: Secret(secret),
            contact,
            phase,
            attempts: 0,
            routes: Routes::default(),
            guests: Guests::default(),
            contacts: Contacts::default(),
            address_list_at: 0,
            packets: VecDeque::new(),
            events: VecDeque::new(),
        }
    }

    /// Opens a match. `seats` has a bit for each seat of this peer; it is 0 for a dedicated server.
    ///
    /// # Errors
    /// [`ConfigError`] if a parameter is out of its range, or the match lacks one of the seats.
    pub fn host(config: Config, identity: Identity, seats: u64) -> Result<Self, ConfigError> {
        validate(&config, &identity)?;
        in_range("bits of the own seats", seats, config.seat_set())?;
        let begun = u32::from(config.start_with) <= seats.count_ones();
        let view = View::opened_by(identity.id, identity.key, seats, begun);
        let role = match u8::try_from(seats.count_ones()).unwrap_or(0) {
            0 => Role::Spectator,
            seats => Role::Player { seats },
        };
        let seed = identity.secret[0];
        let session = Session::new(config.clone(), identity.id, identity.key, role, view, seed)?;
        Ok(Endpoint::new(config, identity, role, Phase::InMatch(Box::new(session)), None))
    }

    /// Joins a match through a contact, a peer that already takes part in it.
    ///
    /// # Errors
    /// [`ConfigError`] if a parameter is out of its range.
    pub fn join(
        config: Config,
        identity: Identity,
        role: Role,
        contact: Address,
    ) -> Result<Self, ConfigError> {
        validate(&config, &identity)?;
        let mut endpoint = Endpoint::new(config, identity, role, Phase::UNASKED, Some(contact));
        endpoint.ask(contact);
        Ok(endpoint)
    }

    /// Requests to join through a contact at the next [`update`](Endpoint::update). Discards a session and its events.
    /// After a session or a refusal, the new session has another incarnation, but the same key, role, delay bounds and
    /// number of guessed ticks.
    pub fn ask(&mut self, contact: Address) {
        self.contact = Some(contact);
        self.events.clear();
        // The contact may be in another match, with other peers. It sends the addresses of its peers.
        (self.routes, self.contacts, self.guests) = Default::default();
        // Each attempt has another nonce, which tells the contact to begin a new handshake as well.
        self.attempts = self.attempts.wrapping_add(1);
        let was_refused = matches!(self.phase, Phase::Refused);
        if let Phase::InMatch(session) = &self.phase {
            (self.role, self.config) = (session.role, session.config.clone());
        }
        // A new incarnation: other peers have rows and inputs of the session that is discarded, or the contact has
        // refused this peer because another peer has its incarnation.
        if was_refused || self.session().is_some() {
            let [a, b, c, d, ..] = self.secret.hash(&self.attempts.to_le_bytes()).to_le_bytes();
            self.me = PeerId(u32::from_le_bytes([a, b, c, d]));
        }
        let nonce = token(self.secret, self.me, &contact).wrapping_add(self.attempts);
        self.phase = Phase::Asking { nonce, cookie: 0, next_at: 0 };
    }

    /// The session, once this peer takes part.
    #[must_use]
    pub fn session(&self) -> Option<&Session> {
        if let Phase::InMatch(session) = &self.phase { Some(session) } else { None }
    }

    /// The session, once this peer takes part.
    pub fn session_mut(&mut self) -> Option<&mut Session> {
        if let Phase::InMatch(session) = &mut self.phase { Some(session) } else { None }
    }

    /// Bytes received and total bytes of the state, while it is downloaded.
    #[must_use]
    pub fn download(&self) -> Option<(u64, u64)> {
        match &self.phase {
            Phase::Downloading(download) => Some(download.progress()),
            _ => None,
        }
    }

    /// The address of a peer, once a probe or the handshake has shown that the peer receives packets there.
    #[must_use]
    pub fn address(&self, peer: PeerId) -> Option<Address> {
        self.routes.address(peer)
    }

    /// Next packet to send, with its destination.
    pub fn next_packet(&mut self) -> Option<(Address, Vec<u8>)> {
        self.packets.pop_front()
    }

    /// Next event.
    pub fn next_event(&mut self) -> Option<JoinEvent> {
        self.events.pop_front()
    }

    pub(super) fn is_closed(&self) -> bool {
        self.session().is_some_and(|session| session.status().is_closed())
    }

    pub(super) fn send(&mut self, to: Address, packet: &JoinPacket) {
        let bytes = packet.encode(self.config.match_tag, self.me);
        self.packets.push_back((to, bytes));
    }

    fn hello(&mut self, to: Address, nonce: u64, cookie: u64) {
        self.send(to, &JoinPacket::Hello { nonce, key: self.key, cookie, offer: self.offer.clone() });
    }

    /// Whether a joining peer waits for a state from [`offer_state`](Endpoint::offer_state).
    #[must_use]
    pub fn wants_state(&self) -> bool {
        self.guests.anybody_waits() && !self.is_closed()
    }

    /// Offers the state after `tick` ticks to the peers that wait for one. If one of these ticks is not final, the call
    /// has no effect.
    pub fn offer_state(&mut self, tick: Tick, state: Vec<u8>) {
        let Phase::InMatch(session) = &self.phase else { return };
        if tick > session.final_tick() {
            return;
        }
        let addresses = self.routes.known(usize::MAX, |id| session.serves(id));
        let start = StartState { view: session.view().clone(), addresses, tick, state };
        self.guests.serve(&Arc::new(Pinned::new(tick, start.encode())));
    }

    /// Advances to the time `now` in microseconds: sends packets that are due and handles timeouts.
    pub fn update(&mut self, now: u64) {
        let now = now.min(TIME_MAX);
        match &mut self.phase {
            Phase::Asking { nonce, cookie, next_at } if now >= *next_at => {
                *next_at = now + HELLO_INTERVAL;
                let (nonce, cookie) = (*nonce, *cookie);
                if let Some(contact) = self.contact {
                    self.hello(contact, nonce, cookie);
                }
            }
            Phase::Downloading(download) => {
                if now >= download.moved_at.saturating_add(DOWNLOAD_PATIENCE) {
                    if let Some(contact) = self.contact {
                        self.ask(contact);
                    }
                } else if let (Some(want), Some(contact)) = (download.want(now), self.contact) {
                    self.send(contact, &want);
                }
            }
            Phase::InMatch(session) => {
                session.update(now);
                if session.status().is_closed() {
                    self.flush();
                } else {
                    self.search(now);
                    self.serve(now);
                }
            }
            Phase::Asking { .. } | Phase::Refused => {}
        }
        while self.packets.len() > PACKETS_MAX {
            self.packets.pop_front();
        }
    }

    /// If this peer has no vote and has lost contact with the majority, asks other peers to send it the match.
    fn search(&mut self, now: u64) {
        let Phase::InMatch(session) = &self.phase else { return };
        let nonce = |address: &Address| token(self.secret, self.me, address).wrapping_add(now);
        if let Some(asked) = self.contacts.update(now, session.needs_contact(), nonce) {
            self.hello(asked.address, asked.nonce, asked.cookie);
        }
    }

    fn serve(&mut self, now: u64) {
        let Phase::InMatch(session) = &mut self.phase else { return };
        for (id, packet) in self.guests.update(now, session) {
            if let Some(address) = self.routes.address(id) {
                self.send(address, &packet);
            }
        }
        for (id, address) in self.routes.probes(now) {
            let token = token(self.secret, id, &address);
            self.send(address, &JoinPacket::Probe { token });
        }
        if now >= self.address_list_at {
            self.address_list_at = now + ADDRESS_LIST_INTERVAL;
            let Phase::InMatch(session) = &self.phase else { return };
            self.routes.retain(|id| session.link(id).is_some());
            let addresses = self.routes.known(ADDRESS_LIST_MAX, |id| session.serves(id));
            for (_, address) in self.routes.known(usize::MAX, |id| session.serves(id)) {
                self.send(address, &JoinPacket::AddressList { addresses: addresses.clone() });
            }
        }
        self.flush();
    }

    /// Moves the session's packets to [`next_packet`](Endpoint::next_packet). Call it after [`Session::advance`].
    pub fn flush(&mut self) {
        let Phase::InMatch(session) = &mut self.phase else { return };
        while let Some((id, bytes)) = session.next_packet() {
            if let Some(address) = self.routes.address(id) {
                self.packets.push_back((address, bytes));
            }
        }
    }
}
