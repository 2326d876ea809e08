//! Command-line arguments of network matches.

use std::net::{SocketAddr, ToSocketAddrs};

use clap::Args;
use lockstep2d::lockstep::Game;
use lockstep2d::peer::{Peer, PeerIdentity, PeerOptions, Udp, socket_address};

use super::Trouble;
use crate::play::{Controls, Online, Player};
use crate::source::Source;
use crate::viewer::{SceneKind, Viewer};

const IDS: [&str; 6] = ["host", "join", "watch", "players", "lockstep", "rollback"];

#[derive(Debug, Args)]
pub(super) struct OnlineArgs {
    /// Host a match at this address, such as 0.0.0.0:7000, and wait for the players
    #[arg(long, value_name = "ADDRESS", group = "entry", conflicts_with = "file", help_heading = "Network")]
    host: Option<String>,
    /// Join the match at this address
    #[arg(long, value_name = "ADDRESS", group = "entry", conflicts_with = "file", help_heading = "Network")]
    join: Option<String>,
    /// Join the match at this address as a spectator
    #[arg(long, value_name = "ADDRESS", group = "entry", conflicts_with = "file", help_heading = "Network")]
    watch: Option<String>,
    /// Number of players that a match waits for before its first tick
    #[arg(long, value_name = "NUMBER", requires = "host", help_heading = "Network")]
    players: Option<u8>,
    /// Wait for late inputs instead of guessing them
    #[arg(long, requires = "entry", conflicts_with = "rollback", help_heading = "Network")]
    lockstep: bool,
    /// Guess late inputs and correct them afterwards
    #[arg(long, requires = "entry", help_heading = "Network")]
    rollback: bool,
}

/// Hides the arguments for network matches in the help of a program without network matches.
pub(super) fn without(command: clap::Command) -> clap::Command {
    IDS.iter().fold(command, |command, id| command.mut_arg(id, |argument| argument.hide(true)))
}

pub(super) enum Entry {
    Host(String),
    Join(String),
    Watch(String),
}

impl OnlineArgs {
    pub(super) fn entry(&self) -> Option<Entry> {
        let host = self.host.clone().map(Entry::Host);
        let join = self.join.clone().map(Entry::Join);
        host.or(join).or_else(|| self.watch.clone().map(Entry::Watch))
    }

    /// Enters a match of the named scene or, without a name, of the first scene with a setup.
    pub(super) fn open<G: Game + 'static>(
        &self,
        viewer: &Viewer<G>,
        entry: &Entry,
        scene: Option<&str>,
        seed: u64,
    ) -> Result<Box<dyn Source>, Trouble> {
        let Some(options) = viewer.online else {
            return Err(Trouble("this program has no network matches".to_owned()));
        };
        let setups = viewer.scenes.iter().filter_map(|scene| match &scene.kind {
            SceneKind::Setup(setup) => Some((scene.name.as_str(), setup)),
            SceneKind::Source(_) => None,
        });
        let mut setups = setups.filter(|(name, _)| scene.is_none_or(|scene| scene == *name));
        let Some((name, setup)) = setups.next() else {
            return Err(Trouble(
                "there is no such scene for a network match: --list shows the names".to_owned(),
            ));
        };
        let setup = setup(seed);
        let peer = self.peer::<G>(entry, name, &setup, options)?;
        let keys = viewer.players.iter().filter_map(|player| match player {
            Player::Keys(controls) => Some(controls),
            _ => None,
        });
        let controls = keys.fold(Controls::new(), |all, controls| all.with(controls));
        Ok(Box::new(Online::new(name, peer, controls).presented(viewer.presentation.clone())))
    }

    fn peer<G: Game>(
        &self,
        entry: &Entry,
        scene: &str,
        setup: &G::Setup,
        options: PeerOptions,
    ) -> Result<Peer<G, Udp>, Trouble> {
        let options = match (self.lockstep, self.rollback) {
            (true, _) => {
                let PeerOptions { guess, delay, .. } = PeerOptions::lockstep();
                PeerOptions { guess, delay, ..options }
            }
            (_, true) => {
                let PeerOptions { guess, delay, .. } = PeerOptions::rollback();
                PeerOptions { guess, delay, ..options }
            }
            _ => options,
        };
        let options = PeerOptions { start_with: self.players.unwrap_or(options.start_with), ..options };
        let me = PeerIdentity::random();
        let peer = match entry {
            Entry::Host(address) => Peer::host(setup, options, me, bind(address)?),
            Entry::Join(contact) => {
                let (udp, contact) = towards(contact)?;
                Peer::join(setup, options, me, udp, socket_address(contact))
            }
            Entry::Watch(contact) => {
                let (udp, contact) = towards(contact)?;
                Peer::watch(setup, options, me, udp, socket_address(contact))
            }
        };
        peer.map_err(|error| Trouble(format!("{scene}: {error}")))
    }
}

/// Binds a socket to a free port. Returns it with the resolved address of `contact`.
fn towards(contact: &str) -> Result<(Udp, SocketAddr), Trouble> {
    let contact = resolve(contact)?;
    let udp = bind(if contact.is_ipv6() { "[::]:0" } else { "0.0.0.0:0" })?;
    Ok((udp, contact))
}

fn bind(address: &str) -> Result<Udp, Trouble> {
    Udp::bind(resolve(address)?).map_err(|error| Trouble(format!("{address}: {error}")))
}

fn resolve(address: &str) -> Result<SocketAddr, Trouble> {
    let why = |why: &dyn std::fmt::Display| Trouble(format!("{address}: {why}"));
    let mut found = address.to_socket_addrs().map_err(|error| why(&error))?;
    found.next().ok_or_else(|| why(&"no such address"))
}
