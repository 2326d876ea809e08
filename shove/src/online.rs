//! Matches over a network: how one begins, and what both `shove play` and a window do in every moment of it.

use std::fmt;
use std::io;
use std::net::{SocketAddr, ToSocketAddrs};

use lockstep2d::net::{Address, Divergence, Event, NetError, Options, Peer, Transport, Udp};

use crate::game::Shove;
use crate::pad::Pad;
use crate::setup::Setup;

/// How to take part in a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way<A> {
    /// Opens one.
    Host,
    /// Asks for a seat.
    Join {
        /// Somebody who takes part.
        contact: A,
        /// The seat, if not any.
        seat: Option<u32>,
    },
    /// Looks on.
    Watch {
        /// Somebody who takes part.
        contact: A,
    },
}

/// A participant over UDP.
pub type UdpPeer = Peer<Shove, SocketAddr, Udp>;

/// Why one cannot take part in a match.
#[derive(Debug)]
pub enum OnlineError {
    /// What was given as an address is none.
    Address {
        /// What was given.
        address: String,
        /// What the system says; nothing if there simply is no such address.
        why: Option<io::Error>,
    },
    /// The system gives no socket.
    Socket(io::Error),
    /// No match starts.
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

impl<A> Way<A> {
    /// Takes part in this way.
    ///
    /// # Errors
    /// [`NetError`] when the setup starts no game.
    pub fn enter<T: Transport<A>>(
        self,
        setup: &Setup,
        options: Options,
        transport: T,
    ) -> Result<Peer<Shove, A, T>, NetError>
    where
        A: Address,
    {
        match self {
            Way::Host => Peer::host(setup, options, transport),
            Way::Join { contact, seat } => Peer::join(setup, options, transport, contact, seat),
            Way::Watch { contact } => Peer::watch(setup, options, transport, contact),
        }
    }
}

impl Way<&str> {
    /// Takes part over UDP; packets come in at the address `bind`, or else at any free port.
    ///
    /// # Errors
    /// [`OnlineError`] when there is no such address, no socket, or the setup starts no game.
    pub fn enter_udp(
        self,
        bind: Option<&str>,
        setup: &Setup,
        options: Options,
    ) -> Result<UdpPeer, OnlineError> {
        let way = match self {
            Way::Host => Way::Host,
            Way::Join { contact, seat } => Way::Join { contact: resolve(contact)?, seat },
            Way::Watch { contact } => Way::Watch { contact: resolve(contact)? },
        };
        let anywhere = match way {
            Way::Join { contact, .. } | Way::Watch { contact } if contact.is_ipv6() => "[::]:0",
            _ => "0.0.0.0:0",
        };
        let udp = Udp::bind(resolve(bind.unwrap_or(anywhere))?).map_err(OnlineError::Socket)?;
        way.enter(setup, options, udp).map_err(OnlineError::Net)
    }
}

fn resolve(address: &str) -> Result<SocketAddr, OnlineError> {
    let error = |why| OnlineError::Address { address: address.to_owned(), why };
    let mut found = address.to_socket_addrs().map_err(|why| error(Some(why)))?;
    found.next().ok_or_else(|| error(None))
}

/// Plays all ticks that are due, each with the pad that `pad` gives for the game and the own seat.
///
/// # Errors
/// [`NetError`] when the match cannot go on.
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

/// What has happened, in a line for people.
#[must_use]
pub fn describe(event: &Event) -> String {
    match event {
        Event::Joined { seat, tick } => format!("seat {seat} plays from tick {tick}"),
        Event::Left { seat, tick } => format!("seat {seat} is empty from tick {tick}"),
        Event::Interrupted { seat } => format!("nothing comes from seat {seat}"),
        Event::Resumed { seat } => format!("seat {seat} is back"),
        Event::Diverged(Divergence { tick, seat, ours, theirs }) => {
            format!("after tick {tick} the state is {ours} here and {theirs} at seat {seat}")
        }
    }
}
