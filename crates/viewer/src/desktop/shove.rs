//! `shove`: command-line arguments of the shove game.

use clap::Args;
use lockstep2d::peer::PeerOptions;
use lockstep2d_shove::Setup;
use lockstep2d_shove::online::Participation;
use lockstep2d_viewer::Source;
use lockstep2d_viewer::netplay::{Netplay, Online};

use super::Trouble;

/// Plays shove: two people at one keyboard, or several over a network.
///
/// One player uses W, A, S, D, and F or Shift to dash, the other the arrows, and Enter or Control to dash. In a
/// network match both sets of keys control the local player.
#[derive(Debug, Args)]
pub(super) struct Shove {
    /// Hosts a match at this address, such as 0.0.0.0:7000, and waits for the players.
    #[arg(long, value_name = "ADDRESS", group = "way")]
    host: Option<String>,
    /// Joins the match at this address.
    #[arg(long, value_name = "ADDRESS", group = "way")]
    join: Option<String>,
    /// Joins the match at this address as a spectator.
    #[arg(long, value_name = "ADDRESS", group = "way")]
    watch: Option<String>,
    /// Number of bots in a match at one keyboard, at most 2.
    #[arg(long, default_value_t = 1, conflicts_with = "way", value_parser = clap::value_parser!(u8).range(..=2))]
    bots: u8,
    /// Number of players that a network match waits for before its first tick.
    #[arg(long, default_value_t = 2, requires = "host", value_parser = clap::value_parser!(u8).range(1..=4))]
    players: u8,
    /// Waits for late inputs instead of guessing them.
    #[arg(long, requires = "way")]
    lockstep: bool,
}

impl Shove {
    /// Opens the match, before its first tick.
    pub(super) fn open(&self, seed: u64) -> Result<Box<dyn Source>, Trouble> {
        let setup = Setup { seed, ..Setup::default() };
        let options = if self.lockstep { PeerOptions::lockstep() } else { PeerOptions::rollback() };
        let options = PeerOptions { start_with: self.players, ..options };
        let (participation, bind) = match (&self.host, &self.join, &self.watch) {
            (Some(host), _, _) => (Participation::Host, Some(host.as_str())),
            (_, Some(join), _) => (Participation::Join { contact: join.as_str() }, None),
            (_, _, Some(watch)) => (Participation::Watch { contact: watch.as_str() }, None),
            (None, None, None) => {
                let netplay = Netplay::for_two(seed, self.bots.into());
                return Ok(Box::new(netplay.map_err(|error| Trouble(error.to_string()))?));
            }
        };
        let online = Online::udp(participation, bind, &setup, options);
        Ok(Box::new(online.map_err(|error| Trouble(error.to_string()))?))
    }
}
