//! Network matches: entering a match, and the update loop shared by `shove play` and the viewer.

use std::fmt;
use std::io;
use std::net::{SocketAddr, ToSocketAddrs};

use lockstep2d::net::{Address, Divergence, Event, NetError, NetOptions, Peer, Transport, Udp};

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
        /// Requested seat; any free seat if `None`.
        seat: Option<u32>,
    },
    /// Joins a match as a spectator.
    Watch {
        /// Address of any participant.
        contact: A,
    },
}

/// Peer of a match over UDP.
pub type UdpPeer = Peer<Shove, SocketAddr, Udp>;

/// Reason why a match cannot be entered.
#[derive(Debug)]
pub enum OnlineError {
    /// An address is invalid or cannot be resolved.
    Address {
        /// The address as given.
        address: String,
        /// Error of the system; `None` if the lookup succeeded without a result.
        why: Option<io::Error>,
    },
    /// The socket cannot be opened.
    Socket(io::Error),
    /// The match cannot start.
    Net(NetError),
}

impl fmt::Display for OnlineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OnlineError::Address { address, why: Some(why) } => write!(f, "{address}: {why}"),
            OnlineError::Address { address, why: None } => write!(f, "{address}: no such address"),
            OnlineError::Socket(why) => why.fmt(f),
            OnlineError::Net(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for OnlineError {}

impl<A> Participation<A> {
    /// Enters a match in this way.
    ///
    /// # Errors
    /// [`NetError`] if the setup is invalid.
    pub fn enter<T: Transport<A>>(
        self,
        setup: &Setup,
        options: NetOptions,
        transport: T,
    ) -> Result<Peer<Shove, A, T>, NetError>
    where
        A: Address,
    {
        match self {
            Participation::Host => Peer::host(setup, options, transport),
            Participation::Join { contact, seat } => Peer::join(setup, options, transport, contact, seat),
            Participation::Watch { contact } => Peer::watch(setup, options, transport, contact),
        }
    }
}

impl Participation<&str> {
    /// Enters a match over UDP. The socket is bound to the address `bind`, or to any free port without it.
    ///
    /// # Errors
    /// [`OnlineError`] if an address cannot be resolved, the socket cannot be opened, or the setup is invalid.
    pub fn enter_udp(
        self,
        bind: Option<&str>,
        setup: &Setup,
        options: NetOptions,
    ) -> Result<UdpPeer, OnlineError> {
        let participation = match self {
            Participation::Host => Participation::Host,
            Participation::Join { contact, seat } => Participation::Join { contact: resolve(contact)?, seat },
            Participation::Watch { contact } => Participation::Watch { contact: resolve(contact)? },
        };
        let anywhere = match participation {
            Participation::Join { contact, .. } | Participation::Watch { contact } if contact.is_ipv6() => {
                "[::]:0"
            }
            _ => "0.0.0.0:0",
        };
        let udp = Udp::bind(resolve(bind.unwrap_or(anywhere))?).map_err(OnlineError::Socket)?;
        participation.enter(setup, options, udp).map_err(OnlineError::Net)
    }
}

fn resolve(address: &str) -> Result<SocketAddr, OnlineError> {
    let error = |why| OnlineError::Address { address: address.to_owned(), why };
    let mut found = address.to_socket_addrs().map_err(|why| error(Some(why)))?;
    found.next().ok_or_else(|| error(None))
}

/// Plays all ticks that are due. `pad` returns the local player's pad for a game state and the local seat.
///
/// # Errors
/// [`NetError`] if the match cannot continue.
pub fn play_due<A: Address, T: Transport<A>>(
    peer: &mut Peer<Shove, A, T>,
    mut pad: impl FnMut(&Shove, u8) -> Pad,
) -> Result<(), NetError> {
    while peer.is_due() {
        let seat = peer.seat().and_then(|seat| u8::try_from(seat).ok()).unwrap_or(0);
        if !peer.advance(pad(peer.game(), seat))? {
            break;
        }
    }
    Ok(())
}

/// Describes an event in a line for the user.
#[must_use]
pub fn describe(event: &Event) -> String {
    match event {
        Event::Joined { seat, tick } => format!("seat {seat} plays from tick {tick}"),
        Event::Left { seat, tick } => format!("seat {seat} is empty from tick {tick}"),
        Event::Interrupted { seat } => format!("no messages from seat {seat}"),
        Event::Resumed { seat } => format!("seat {seat} is back"),
        Event::Diverged(Divergence { tick, seat, ours, theirs }) => {
            format!("after tick {tick} the state is {ours} here and {theirs} at seat {seat}")
        }
    }
}
