use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::agreement::Agreement;
use super::config::{Config, ConfigError};
use super::event::{Event, Status};
use super::id::{Key, PeerId, Tick};
use super::input_log::InputLog;
use super::lifecycle::Lifecycle;
use super::link::Link;
use super::pace::Pace;
use super::peers::Peers;
use super::play::{Play, Statistics};
use super::progress::Progress;
use super::request::Request;
use super::row::{REMOVALS_MAX, Removal, Wants};
use super::transmit::Outbox;
use super::view::{Change, View};

/// Role of a peer in a match.
///
/// ```
/// use lockstep2d::session::{Address, Config, Endpoint, Role};
/// # use lockstep2d::session::{Identity, Key, PeerId};
/// # let identity = Identity { id: PeerId(2), key: Key(2), offer: vec![], secret: [1, 2] };
/// let host = Address::new(&[1]).expect("a byte");
/// // The peer joins as a spectator. It may ask for a seat later, by `Session::set_role`.
/// let mut guest = Endpoint::join(Config::new(17, 2), identity, Role::Spectator, host)?;
/// guest.update(0);
/// // It sends its request at once, and has no session before the answer arrives.
/// assert!(guest.next_packet().is_some_and(|(to, _)| to == host) && guest.session().is_none());
/// # Ok::<(), lockstep2d::session::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Requests seats, and plays once it has them.
    Player {
        /// Number of seats, at least 1.
        seats: u8,
    },
    /// Requests no seat: a peer that watches final ticks, or a dedicated server.
    Spectator,
}

/// One peer of a match.
///
/// In a loop: pass received packets to [`receive`](Session::receive), call [`update`](Session::update), and call
/// [`advance`](Session::advance) while [`is_due`](Session::is_due). Fulfil the requests of
/// [`next_request`](Session::next_request) in order, then send the packets of [`next_packet`](Session::next_packet).
///
/// Times are microseconds since any fixed moment and never decrease.
///
/// ```
/// use lockstep2d::session::{Config, Key, PeerId, Role, Session, View};
/// // A lobby has assigned an identity to both peers; each has a seat from the first tick on.
/// let mut view = View::opened_by(PeerId(1), Key(1), 0b01, true);
/// view.found(PeerId(2), Key(2), 1, 0b10);
/// let peer = |number: u32| {
///     let (id, key) = (PeerId(number), Key(number.into()));
///     Session::new(Config::new(17, 2), id, key, Role::Player { seats: 1 }, view.clone(), 7)
/// };
/// let mut peers = [peer(1)?, peer(2)?];
/// for now in (0..1_000_000).step_by(5000) {
///     for at in 0..2 {
///         peers[at].update(now);
///         while peers[at].is_due(now) {
///             peers[at].advance(now, &[5]).expect("one byte");
///         }
///         // A game fulfils these requests, as in the example of `Request`.
///         while peers[at].next_request().is_some() {}
///         while let Some((_, packet)) = peers[at].next_packet() {
///             peers[1 - at].receive(now, &packet);
///         }
///     }
/// }
/// assert!(peers.iter().all(|peer| peer.final_tick() > 40));
/// # Ok::<(), lockstep2d::session::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Session {
    pub(super) config: Config,
    pub(super) me: PeerId,
    pub(super) key: Key,
    pub(super) clock: Clock,
    pub(super) random: Random,
    pub(super) view: View,
    pub(super) changes: Changes,
    pub(super) peers: Peers,
    pub(super) log: InputLog,
    pub(super) agreement: Agreement,
    pub(super) progress: Progress,
    pub(super) play: Play,
    pub(super) pace: Pace,
    pub(super) role: Role,
    pub(super) wants: Wants,
    pub(super) end_at: Option<Tick>,
    pub(super) paused: bool,
    pub(super) lifecycle: Lifecycle,
    pub(super) outbox: Outbox,
    pub(super) events: VecDeque<Event>,
}

/// The clocks of a session, in microseconds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    /// The latest time passed by the caller.
    pub(super) now: u64,
    /// Running time. It advances by at most [`Timing::step_max`](super::Timing) between two calls.
    pub(super) active: u64,
}

/// Pseudo-random numbers (SplitMix64). They delay ballots, so that peers do not start ballots at the same time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Random(u64);

impl Random {
    #[cfg(test)]
    pub(super) const fn new(seed: u64) -> Self {
        Random(seed)
    }

    pub(super) fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ mixed >> 31).checked_rem(bound).unwrap_or(0)
    }
}

/// Number of changes that are kept for peers that missed some.
pub(super) const CHANGES_KEPT: u16 = 1024;

/// The last decided changes.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    /// Number of the view to which the first change of `list` leads.
    pub(super) first: u32,
    pub(super) list: Vec<Change>,
}

impl Changes {
    pub(super) fn extend(&mut self, changes: &[Change]) {
        self.list.extend_from_slice(changes);
        let excess = self.list.len().saturating_sub(CHANGES_KEPT.into());
        self.list.drain(..excess);
        self.first = self.first.saturating_add(u32::try_from(excess).unwrap_or(0));
    }

    pub(super) fn since(&self, number: u32) -> &[Change] {
        let skipped = number.checked_sub(self.first).and_then(|skipped| usize::try_from(skipped).ok());
        skipped.and_then(|skipped| self.list.get(skipped..)).unwrap_or_default()
    }
}

impl Session {
    /// Creates a session from the first view of a match. This peer either is one of the voters, or follows the match
    /// from the first tick on without a vote. `me` must be random and new for each process. `seed` may be any number.
    ///
    /// # Errors
    /// [`ConfigError`] if a parameter is out of its range.
    pub fn new(
        config: Config,
        me: PeerId,
        key: Key,
        role: Role,
        first: View,
        seed: u64,
    ) -> Result<Self, ConfigError> {
        config.validate()?;
        let mut log = InputLog::new(config.input_bytes);
        log.follow(&first.spans);
        let mut peers = Peers::new(me, key);
        peers.follow(&first, 0);
        let changes = Changes { first: first.number.saturating_add(1), list: Vec::new() };
        let lifecycle = Lifecycle::new(role);
        let mut session = Session {
            me,
            key,
            clock: Clock::default(),
            random: Random(seed ^ u64::from(me.0)),
            changes,
            peers,
            log,
            agreement: Agreement::default(),
            progress: Progress::new(&first, 0),
            play: Play::new(0, config.seats),
            pace: Pace::new(&config),
            view: first,
            role,
            wants: Wants::default(),
            end_at: None,
            paused: false,
            lifecycle,
            outbox: Outbox::default(),
            events: VecDeque::new(),
            config,
        };
        session.settle();
        Ok(session)
    }

    /// Creates a session that continues from the state after `tick` final ticks.
    pub(super) fn resume(
        config: Config,
        me: PeerId,
        key: Key,
        role: Role,
        view: View,
        tick: Tick,
        seed: u64,
    ) -> Result<Self, ConfigError> {
        let mut session = Session::new(config, me, key, role, view, seed)?;
        session.log.start_at(&session.view.spans, tick);
        session.progress = Progress::new(&session.view, tick);
        session.play = Play::new(tick, session.config.seats);
        session.settle();
        Ok(session)
    }

    pub(super) fn has_row(&self, id: PeerId) -> bool {
        self.peers.find(id).is_some_and(|remote| remote.row.is_some())
    }

    /// Serves a peer without a vote: sends it rows, changes and inputs, until 5 s have passed since the last call and
    /// since the last packet from the peer. At a peer that joins, the caller attaches the peers that it knows.
    pub fn attach(&mut self, id: PeerId, key: Option<Key>) {
        let active = self.clock.active;
        if self.peers.has_room(id, &self.view, active) {
            self.peers.add(id, key, active);
        }
        if let Some(remote) = self.peers.find_mut(id) {
            remote.attached = Some(active);
        }
    }

    /// Stops serving a peer without a vote, for example when its connection is closed.
    pub fn detach(&mut self, id: PeerId) {
        if let Some(remote) = self.peers.find_mut(id) {
            remote.attached = None;
            remote.heard = None;
        }
    }

    /// Leaves the match: the other peers agree on a tick from which they continue without this peer. Call
    /// [`update`](Session::update) until [`Status::Closed`].
    pub fn leave(&mut self) {
        self.wants.leave = true;
    }

    /// Requests an end of the match after `ticks` ticks. This peer sends the request two seconds before that tick; from
    /// then on, further calls have no effect. Without a vote, the request waits until this peer gets a seat, and has no
    /// effect if its tick has passed by then. The request of one peer is enough and cannot be taken back, so make it
    /// when the ticks that it depends on are [confirmed](Session::confirmed). If several requests are known when a
    /// majority decides, the largest number counts. After the decision no peer gets a seat, and the end does not
    /// change.
    pub fn end_at(&mut self, ticks: Tick) {
        self.end_at = Some(ticks);
    }

    /// Requests a pause, or withdraws the request. If this peer has a vote, the other peers get [`Event::Pause`]. The
    /// session itself does not stop. During a pause, no game calls [`advance`](Session::advance), and all games call
    /// [`update`](Session::update).
    pub fn pause(&mut self, paused: bool) {
        self.paused = paused;
    }

    /// Votes to continue without a missing peer, which may return. The vote of the [tie-holder](View::tie_holder) is
    /// sufficient. The vote ends when the peer is heard again.
    pub fn go_on_without(&mut self, peer: PeerId) {
        if self.view.voter(peer).is_some() {
            self.remove(Removal::Without(peer));
        }
    }

    /// Votes to remove a peer, which gets no seat while enough votes count. The vote of the
    /// [tie-holder](View::tie_holder) is sufficient. A vote counts only while the peer that casts it is a voter of the
    /// view. A peer has at most eight votes, including those of [`go_on_without`](Session::go_on_without). A ninth vote
    /// replaces the oldest one, and the peer against which the oldest vote was cast may return.
    pub fn kick(&mut self, key: Key) {
        self.remove(Removal::Kick(key));
    }

    fn remove(&mut self, removal: Removal) {
        if !self.wants.removals.contains(&removal) {
            if self.wants.removals.len() == REMOVALS_MAX {
                self.wants.removals.remove(0);
            }
            self.wants.removals.push(removal);
        }
    }

    /// Changes the role. A spectator that becomes a player starts to request seats. A player without a seat that
    /// becomes a spectator no longer requests any.
    pub fn set_role(&mut self, role: Role) {
        self.role = role;
    }

    /// Sets the bounds of the input delay in ticks. `most` is limited to [`DELAY_MAX`](super::DELAY_MAX), and `least`
    /// is limited to `most`.
    pub fn set_delay(&mut self, least: u16, most: u16) {
        self.config.delay_max = most.min(super::config::DELAY_MAX);
        self.config.delay_min = least.min(self.config.delay_max);
    }

    /// Sets the number of ticks that may be played with guessed inputs, at most [`GUESS_MAX`](super::GUESS_MAX); 0 is
    /// lockstep.
    pub fn set_guess(&mut self, ticks: u16) {
        self.config.guess = ticks.min(super::config::GUESS_MAX);
    }

    /// Next event.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Next request to the game, to be fulfilled in order.
    pub fn next_request(&mut self) -> Option<Request> {
        self.play.requests.pop_front()
    }

    /// Next packet to send, and its receiver.
    pub fn next_packet(&mut self) -> Option<(PeerId, Vec<u8>)> {
        self.outbox.packets.pop_front()
    }

    /// The view in force.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The status of the session.
    #[must_use]
    pub fn status(&self) -> Status {
        self.lifecycle.status
    }

    /// Incarnation of this peer.
    #[must_use]
    pub fn id(&self) -> PeerId {
        self.me
    }

    /// Number of ticks whose inputs are known. The inputs beyond [`final_tick`](Session::final_tick) may still change.
    #[must_use]
    pub fn complete_tick(&self) -> Tick {
        self.progress.complete
    }

    /// Number of final ticks. Their inputs do not change any more.
    #[must_use]
    pub fn final_tick(&self) -> Tick {
        self.progress.fin
    }

    /// Number of ticks that the session has requested from the game.
    #[must_use]
    pub fn played(&self) -> Tick {
        self.play.played
    }

    /// Number of final ticks that the session has requested from the game with their final inputs.
    #[must_use]
    pub fn confirmed(&self) -> Tick {
        self.play.confirmed
    }

    /// Bit mask of this peer's own seats.
    #[must_use]
    pub fn seats(&self) -> u64 {
        self.view.seats_of(self.me)
    }

    /// The delay of this peer's inputs in ticks.
    #[must_use]
    pub fn delay(&self) -> u16 {
        self.pace.delay
    }

    /// Measurements of the network path to a peer.
    #[must_use]
    pub fn link(&self, peer: PeerId) -> Option<Link> {
        self.peers.find(peer).map(|remote| remote.link)
    }

    /// Statistics of the session so far.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        Statistics {
            replayed: self.play.replayed,
            replayed_max: self.play.replayed_max,
            input_bytes: self.log.bytes(),
            peers: self.peers.list.len(),
        }
    }
}
