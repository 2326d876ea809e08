//! `shove`: the small game, for people.

use clap::Args;
use lockstep2d::net::Options;
use lockstep2d_shove::Setup;
use lockstep2d_shove::online::Way;
use lockstep2d_viewer::Source;
use lockstep2d_viewer::versus::{Online, Versus};

use super::Trouble;

/// Plays shove: two people at one keyboard, or each at their own over a network.
///
/// One plays with W, A, S, D, and F or Shift to dash, the other with the arrows, and Enter or Control. Who has the keyboard
/// alone may use both.
#[derive(Debug, Args)]
pub(super) struct Shove {
    /// Opens a match at this address, such as 0.0.0.0:7000, and waits for the players.
    #[arg(long, value_name = "ADDRESS", group = "way")]
    host: Option<String>,
    /// Takes part in the match at this address.
    #[arg(long, value_name = "ADDRESS", group = "way")]
    join: Option<String>,
    /// Watches the match at this address.
    #[arg(long, value_name = "ADDRESS", group = "way")]
    watch: Option<String>,
    /// Bots beside the two at one keyboard, at most 2.
    #[arg(long, default_value_t = 1, conflicts_with = "way", value_parser = clap::value_parser!(u8).range(..=2))]
    bots: u8,
    /// How many players the first tick of a match over a network waits for.
    #[arg(long, default_value_t = 2, requires = "host", value_parser = clap::value_parser!(u32).range(1..=4))]
    players: u32,
    /// Waits for late inputs instead of guessing them. All take the same.
    #[arg(long, requires = "way")]
    lockstep: bool,
}

impl Shove {
    /// The match, before its first tick.
    pub(super) fn open(&self, seed: u64) -> Result<Box<dyn Source>, Trouble> {
        let setup = Setup { seed, ..Setup::default() };
        let options = if self.lockstep { Options::lockstep() } else { Options::rollback() };
        let options = options.start_with(self.players);
        let (way, bind) = match (&self.host, &self.join, &self.watch) {
            (Some(host), _, _) => (Way::Host, Some(host.as_str())),
            (_, Some(join), _) => (Way::Join { contact: join.as_str(), seat: None }, None),
            (_, _, Some(watch)) => (Way::Watch { contact: watch.as_str() }, None),
            (None, None, None) => {
                let versus = Versus::for_two(seed, self.bots.into());
                return Ok(Box::new(versus.map_err(|error| Trouble(error.to_string()))?));
            }
        };
        let online = Online::udp(way, bind, &setup, options);
        Ok(Box::new(online.map_err(|error| Trouble(error.to_string()))?))
    }
}
