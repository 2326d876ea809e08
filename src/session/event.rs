//! [`Event`]: what happened, for the game; [`Status`]: where a session stands.

use super::id::{PeerId, Tick};

/// Where a session stands.
///
/// ```
/// use lockstep2d::session::Status;
/// /// What the screen shows over the game.
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
    /// Follows the match without a seat, and asks for one.
    Joining,
    /// Follows the match and asks for no seat.
    Watching,
    /// Has a seat. The match has not begun, because too few seats are taken.
    Waiting,
    /// Plays.
    Playing,
    /// Cannot hear a majority, which alone can go on. A peer without a seat may ask another contact.
    Paused,
    /// The others went on without this peer, which asks for its seat again.
    Dropped,
    /// The others removed it for good.
    Kicked,
    /// Tells the others that it leaves.
    Leaving,
    /// Has left, and still answers the peers that do not know it.
    Left,
    /// All ticks of the match are final. This peer still answers those that lack some.
    Finished {
        /// Number of ticks of the match.
        ticks: Tick,
    },
    /// Nothing more is sent.
    Closed,
}

impl Status {
    /// Whether nothing is left to do.
    #[must_use]
    pub const fn is_closed(self) -> bool {
        matches!(self, Status::Closed)
    }
}

/// An event of a session, returned by [`Session::next_event`](super::Session::next_event).
///
/// ```
/// use lockstep2d::session::{Event, PeerId};
/// // For how long has a peer played? From the events of a match.
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
    /// The session stands somewhere else.
    Status(Status),
    /// The seats change: a new view is in force.
    View {
        /// Number of the view.
        number: u32,
    },
    /// A peer has a seat, from a tick on.
    Seated {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Number of the player.
        seat: u8,
        /// First tick.
        from: Tick,
    },
    /// A peer no longer has a seat, from a tick on.
    Unseated {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Number of the player.
        seat: u8,
        /// First tick without it.
        from: Tick,
    },
    /// Play stands still because inputs of a peer are missing; once for each time it does.
    Waiting {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Whether its packets arrive. If so, its game does not advance.
        heard: bool,
    },
    /// Play goes on after [`Event::Waiting`].
    Resumed,
    /// A peer asks all others to stop for now, or no longer does.
    Pause {
        /// Incarnation of the peer.
        peer: PeerId,
        /// Whether it asks.
        paused: bool,
    },
    /// The end of the match is decided.
    End {
        /// Number of ticks of the match.
        ticks: Tick,
    },
    /// Two peers have different states at a final tick.
    Desync {
        /// The other peer.
        peer: PeerId,
        /// Number of ticks played.
        tick: Tick,
        /// Hash of this peer.
        ours: u128,
        /// Hash of the other peer.
        theirs: u128,
    },
    /// A peer has issued two inputs for one tick. Its inputs are not accepted any more.
    Conflict {
        /// The peer.
        peer: PeerId,
        /// The tick.
        tick: Tick,
    },
    /// The match has gone on for longer than the others keep inputs: a state is needed.
    TooFarBehind,
}
