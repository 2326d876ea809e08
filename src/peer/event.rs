use alloc::vec::Vec;

use crate::hash::StateHash;
use crate::session::{Event, PeerId};

/// An event of a match.
///
/// ```
/// use lockstep2d::peer::PeerEvent;
/// use lockstep2d::session::{Event, PeerId};
/// /// A line on the screen.
/// fn line(event: &PeerEvent) -> Option<String> {
///     match event {
///         PeerEvent::Session(Event::Seated { seat, .. }) => Some(format!("player {} joins", seat + 1)),
///         PeerEvent::Session(Event::Waiting { heard: false, .. }) => Some("waiting ...".into()),
///         PeerEvent::Desync(desync) => Some(format!("another game than theirs since tick {}", desync.tick)),
///         _ => None,
///     }
/// }
/// let seated = PeerEvent::Session(Event::Seated { peer: PeerId(5), seat: 1, from: 0 });
/// assert_eq!(line(&seated).as_deref(), Some("player 2 joins"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeerEvent {
    /// An event of the session.
    Session(Event),
    /// The initial state has arrived, and the game continues from it.
    Joined {
        /// Number of ticks before this state.
        tick: u64,
    },
    /// Another peer has a different state. Write [`Peer::report`](super::Peer::report) to a file.
    Desync(PeerDesync),
}

/// This peer and another one had different states after the same number of final ticks.
///
/// ```
/// # use lockstep2d::lockstep::Game;
/// use lockstep2d::peer::{Peer, PeerDesync, PeerError, PeerEvent, Transport};
/// /// The reports to write to disk, each with the name of its file.
/// fn reports<G: Game, T: Transport>(peer: &mut Peer<G, T>) -> Result<Vec<(String, Vec<u8>)>, PeerError> {
///     let mut files = vec![];
///     while let Some(event) = peer.next_event() {
///         if let PeerEvent::Desync(desync @ PeerDesync { tick, .. }) = event {
///             files.push((format!("desync-{tick}.report"), peer.report(&desync)?));
///         }
///     }
///     Ok(files)
/// }
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// # use lockstep2d::peer::{LinkConditions, Network, PeerIdentity, PeerOptions};
/// # let options = PeerOptions { input_bytes: Some(64), start_with: 1, ..PeerOptions::lockstep() };
/// # let (me, port) = (PeerIdentity::new([1, 2, 3, 4]), Network::new(LinkConditions::default(), 1).port(0));
/// # let mut alone = Peer::<Sandbox, _>::host(&SandboxSetup::default(), options, me, port)?;
/// assert_eq!(reports(&mut alone)?, [], "nobody else is there");
/// # Ok::<(), PeerError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeerDesync {
    /// The other peer.
    pub peer: PeerId,
    /// Number of ticks after which the states differ.
    pub tick: u64,
    /// Hash of this peer's state.
    pub ours: StateHash,
    /// Hash of the other peer's state.
    pub theirs: StateHash,
}

/// The result of a peer that has finished.
///
/// ```
/// # use core::time::Duration;
/// # use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// use lockstep2d::peer::{LinkConditions, Network, Peer, PeerEnd, PeerIdentity, PeerOptions};
/// use lockstep2d::{replay::{Limits, verify}, session::Status};
/// # let options = PeerOptions { input_bytes: Some(64), start_with: 1, ..PeerOptions::lockstep() };
/// # let (me, port) = (PeerIdentity::new([1, 2, 3, 4]), Network::new(LinkConditions::default(), 1).port(0));
/// let mut peer = Peer::<Sandbox, _>::host(&SandboxSetup::default(), options, me, port)?;
/// peer.end_at(200);
/// let mut now = Duration::ZERO;
/// while peer.status() != Some(Status::Closed) {
///     now += Duration::from_millis(5);
///     peer.update(now)?;
///     while peer.is_due() {
///         peer.advance(&[vec![]])?;
///     }
/// }
/// let mut file = peer.take_replay();
/// let PeerEnd { ticks, game, replay } = peer.finish()?;
/// file.extend(replay);
/// assert_eq!((ticks, game.world().tick()), (200, 200));
/// assert!(verify::<Sandbox>(&file, &Limits::default()).is_match());
/// # Ok::<(), lockstep2d::peer::PeerError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PeerEnd<G> {
    /// Number of final ticks.
    pub ticks: u64,
    /// The game after the last final tick.
    pub game: G,
    /// Bytes that [`Peer::take_replay`](super::Peer::take_replay) has not returned yet. Empty for a peer that joined
    /// after the first tick.
    pub replay: Vec<u8>,
}
