use super::id::{PeerId, Tick};

/// State of this peer in the match.
///
/// ```
/// use lockstep2d::session::Status;
/// /// The text that the screen shows over the game.
/// fn banner(status: Status) -> &'static str {
///     match status {
///         Status::Playing => "",
///         Status::Waiting => "waiting for players",
///         Status::Paused => "connection lost",
///         Status::Finished { .. } | Status::Left | Status::Closed => "the match is over",
///         _ => "one moment",
///     }
/// }
/// assert_eq!(banner(Status::Finished { ticks: 3600 }), "the match is over");
/// assert_eq!(banner(Status::Joining), "one moment");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Follows the match and asks for a seat.
    Joining,
    /// Follows the match and asks for no seat.
    Watching,
    /// Has a seat, or is a dedicated server. Too few seats are taken to begin.
    Waiting,
    /// Takes part in a match that has begun, with a seat or as a dedicated server.
    Playing,
    /// No recent status records of a majority have arrived, and only a majority can continue the match.
    Paused,
    /// The other peers continue without this peer. A player requests a seat again.
    Dropped,
    /// The other peers removed this peer, or refuse it a seat because they removed its [`Key`](super::Key).
    Kicked,
    /// Announces its departure.
    Leaving,
    /// Has left, and still answers peers that may not know about its departure yet.
    Left,
    /// All ticks of the match are final. This peer still answers other peers.
    Finished {
        /// Number of ticks of the match.
        ticks: Tick,
    },
    /// Sends nothing more.
    Closed,
}

impl Status {
    /// Whether the session has ended.
    #[must_use]
    pub const fn is_closed(self) -> bool {
        matches!(self, Status::Closed)
    }
}

/// An event of a session, returned by [`Session::next_event`](super::Session::next_event).
///
/// ```
/// use lockstep2d::session::{Event, PeerId};
/// // Computes from the events of a match for how many ticks a peer has played.
/// let peer = PeerId(5);
/// let events = [Event::Seated { peer, seat: 1, from: 60 }, Event::Unseated { peer, seat: 1, from: 660 }];
/// let (mut since, mut played) = (0, 0);
/// for event in events {
///     match event {
///         Event::Seated { from, .. } => since = from,
///         Event::Unseated { from, .. } => played += from - since,
///         _ => {}
///     }
/// }
/// assert_eq!(played, 600, "ten seconds at 60 Hz");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The status has changed.
    Status(Status),
    /// A new view is in force.
    View {
        /// Number of the view.
        number: u32,
    },
    /// A peer occupies a seat from a tick on.
    Seated {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Number of the player.
        seat: u8,
        /// First tick with the peer in the seat.
        from: Tick,
    },
    /// A peer leaves a seat from a tick on.
    Unseated {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Number of the player.
        seat: u8,
        /// First tick without the peer in the seat.
        from: Tick,
    },
    /// The match does not advance, because inputs of `peer` are missing, or because the owner of the missing inputs may
    /// not run further ahead of `peer`.
    Waiting {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Whether status records of the peer arrive, directly or through other peers. If so, the peer is connected,
        /// but its game does not advance.
        heard: bool,
    },
    /// The stall of [`Event::Waiting`] is over.
    Resumed,
    /// A peer with a vote requests a pause, or withdraws its request. Requests of spectators, and of players that wait
    /// for a seat, are not reported.
    Pause {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Whether the peer requests a pause.
        paused: bool,
    },
    /// The end of the match is decided.
    End {
        /// Number of ticks of the match.
        ticks: Tick,
    },
    /// This peer and another one have different states after the same number of final ticks.
    Desync {
        /// The other peer.
        peer: PeerId,
        /// Number of ticks after which the states differ.
        tick: Tick,
        /// Hash of this peer's state.
        ours: u128,
        /// Hash of the other peer's state.
        theirs: u128,
    },
    /// Another peer has issued two different inputs for one tick. The input that arrived first counts. This peer no
    /// longer proposes that the other peer gets a seat.
    Conflict {
        /// The peer.
        peer: PeerId,
        /// The tick.
        tick: Tick,
    },
    /// This peer is more than [`Config::log_ticks`](super::Config::log_ticks) ticks or 1024 changes of the view behind.
    /// The other peers may have dropped the inputs or changes that this peer lacks, so this peer has to join again.
    TooFarBehind,
}
