//! Network matches, for `shove play` and the viewer.

use std::fmt;
use std::io;
use std::net::{SocketAddr, ToSocketAddrs};

use lockstep2d::peer::{
    Peer, PeerError, PeerEvent, PeerIdentity, PeerOptions, Transport, Udp, socket_address,
};
use lockstep2d::session::{Address, Event, PeerId, Status};

use crate::game::Shove;
use crate::pad::Pad;
use crate::setup::Setup;

/// Way to enter a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Participation<A> {
    /// Hosts a new match.
    Host,
    /// Joins a match as a player.
    Join {
        /// Address of any participant.
        contact: A,
    },
    /// Joins a match as a spectator.
    Watch {
        /// Address of any participant.
        contact: A,
    },
}

/// Peer of a match over UDP.
pub type UdpPeer = Peer<Shove, Udp>;

/// Reason why a match cannot be entered.
#[derive(Debug)]
pub enum OnlineError {
    /// An address is invalid or cannot be resolved.
    Address {
        /// The address as given.
        address: String,
        /// Error of the system, or `None` if the lookup had no result.
        why: Option<io::Error>,
    },
    /// The socket cannot be opened.
    Socket(io::Error),
    /// The match cannot start.
    Peer(PeerError),
}

impl fmt::Display for OnlineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OnlineError::Address { address, why: Some(why) } => write!(f, "{address}: {why}"),
            OnlineError::Address { address, why: None } => write!(f, "{address}: no such address"),
            OnlineError::Socket(why) => why.fmt(f),
            OnlineError::Peer(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for OnlineError {}

impl Participation<Address> {
    /// Enters a match.
    ///
    /// # Errors
    /// [`PeerError`] if the setup or an option is invalid.
    pub fn enter<T: Transport>(
        self,
        setup: &Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: T,
    ) -> Result<Peer<Shove, T>, PeerError> {
        match self {
            Participation::Host => Peer::host(setup, options, me, transport),
            Participation::Join { contact } => Peer::join(setup, options, me, transport, contact),
            Participation::Watch { contact } => Peer::watch(setup, options, me, transport, contact),
        }
    }
}

impl Participation<&str> {
    /// Enters a match over UDP. `bind` is the local address of the socket; `None` stands for any free port.
    ///
    /// # Errors
    /// [`OnlineError`] if an address cannot be resolved, the socket cannot be opened, or the setup or an option is
    /// invalid.
    pub fn enter_udp(
        self,
        bind: Option<&str>,
        setup: &Setup,
        options: PeerOptions,
        me: PeerIdentity,
    ) -> Result<UdpPeer, OnlineError> {
        let contact = match self {
            Participation::Host => None,
            Participation::Join { contact } | Participation::Watch { contact } => Some(resolve(contact)?),
        };
        let anywhere = if contact.is_some_and(|contact| contact.is_ipv6()) { "[::]:0" } else { "0.0.0.0:0" };
        let udp = Udp::bind(resolve(bind.unwrap_or(anywhere))?).map_err(OnlineError::Socket)?;
        let contact = contact.map_or_else(Address::nowhere, socket_address);
        let participation = match self {
            Participation::Host => Participation::Host,
            Participation::Join { .. } => Participation::Join { contact },
            Participation::Watch { .. } => Participation::Watch { contact },
        };
        participation.enter(setup, options, me, udp).map_err(OnlineError::Peer)
    }
}

fn resolve(address: &str) -> Result<SocketAddr, OnlineError> {
    let error = |why| OnlineError::Address { address: address.to_owned(), why };
    let mut found = address.to_socket_addrs().map_err(|why| error(Some(why)))?;
    found.next().ok_or_else(|| error(None))
}

/// Plays all ticks that are due. For each tick and each local seat, `pad` returns the local player's pad for the next
/// tick, given the game and the seat.
///
/// # Errors
/// [`PeerError`] if the match cannot continue.
pub fn play_due<T: Transport>(
    peer: &mut Peer<Shove, T>,
    mut pad: impl FnMut(&Shove, u8) -> Pad,
) -> Result<(), PeerError> {
    while peer.is_due() {
        let seats = peer.seats();
        let seats = seats.iter().filter_map(|&seat| u8::try_from(seat).ok());
        let pads: Vec<Pad> = seats.map(|seat| pad(peer.game(), seat)).collect();
        peer.advance(&pads)?;
    }
    Ok(())
}

/// Describes an event in one line. Seats are counted from 0.
#[must_use]
pub fn describe<T: Transport>(peer: &Peer<Shove, T>, event: &PeerEvent) -> String {
    let name = |id: PeerId| match peer.seats_of(id)[..] {
        [] => "a peer without a seat".to_owned(),
        [seat] => format!("seat {seat}"),
        ref seats => format!("seats {seats:?}"),
    };
    match *event {
        PeerEvent::Joined { tick } => format!("received the state after tick {tick}"),
        PeerEvent::Desync(found) => {
            let (ours, theirs) = (found.ours, found.theirs);
            format!("after tick {} the state is {ours} here and {theirs} at {}", found.tick, name(found.peer))
        }
        PeerEvent::Session(event) => match event {
            Event::Status(status) => describe_status(status),
            Event::View { number } => format!("change {number} of the players"),
            Event::Seated { seat, from, .. } => format!("seat {seat} plays from tick {from}"),
            Event::Unseated { seat, from, .. } => format!("seat {seat} is empty from tick {from}"),
            Event::Waiting { peer, heard: true } => {
                format!("waiting for {}, which does not advance", name(peer))
            }
            Event::Waiting { peer, heard: false } => {
                format!("waiting for {}, which is not heard", name(peer))
            }
            Event::Resumed => "play goes on".to_owned(),
            Event::Pause { peer, paused: true } => format!("{} asks for a pause", name(peer)),
            Event::Pause { peer, paused: false } => format!("{} ends its pause", name(peer)),
            Event::End { ticks } => format!("the match ends after tick {ticks}"),
            Event::Desync { tick, .. } => format!("the states differ after tick {tick}"),
            Event::Conflict { peer, tick } => format!("{} has issued two inputs for tick {tick}", name(peer)),
            Event::TooFarBehind => "too far behind: the others no longer have the inputs".to_owned(),
        },
    }
}

fn describe_status(status: Status) -> String {
    match status {
        Status::Joining => "joining: follows the match until a seat is free",
        Status::Watching => "watching",
        Status::Waiting => "waiting for more players",
        Status::Playing => "playing",
        Status::Paused => "paused: no majority of the players is heard",
        Status::Dropped => "dropped: the others went on; asking for the seat again",
        Status::Kicked => "removed by the others",
        Status::Leaving => "leaving",
        Status::Left => "has left",
        Status::Finished { .. } => "finished",
        Status::Closed => "closed",
    }
    .to_owned()
}
