//! The arguments of `shove play`.

use std::error::Error;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use lockstep2d::peer::{PeerIdentity, PeerOptions};
use lockstep2d::session::{DELAY_MAX, GUESS_MAX, Key};
use lockstep2d_shove::Setup;
use lockstep2d_shove::online::{self, UdpPeer};

/// Plays a match over UDP, with a bot as the local player.
///
/// Ctrl-C leaves the match: the others continue at once, and the replay is completed. A second Ctrl-C exits without
/// waiting for the others.
#[derive(Debug, Args)]
#[command(after_help = "\
Exit codes:
  0  the match has ended, or was left
  1  two peers had different states
  2  the match cannot be played: wrong arguments, another match, a seat that is taken, nobody answers")]
pub(super) struct Arguments {
    #[command(flatten)]
    way: Participation,
    /// Local address of the socket [default: any free port]
    #[arg(long, value_name = "ADDRESS", conflicts_with = "host")]
    bind: Option<String>,
    /// Own seat, counted from 0 [default: any free seat]
    #[arg(long, conflicts_with = "watch")]
    seat: Option<u8>,
    /// Number that identifies the player: a new process with the same key gets the seat of the old one
    #[arg(long, value_name = "NUMBER")]
    key: Option<u64>,
    /// Number of players that the first tick waits for; used by the host only
    #[arg(long, default_value_t = 2)]
    players: u8,
    /// Number of seats of the match
    #[arg(long, default_value_t = 4)]
    seats: u8,
    /// Random seed for the placement of players and crates
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Wait for late inputs instead of guessing them: the same as --window 0
    #[arg(long, conflicts_with = "window")]
    lockstep: bool,
    /// Maximum number of ticks played with guessed inputs [default: 8]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u16).range(..=i64::from(GUESS_MAX)))]
    window: Option<u16>,
    /// Minimum number of ticks until an input takes effect [default: 1, or 0 in lockstep]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u16).range(..=i64::from(DELAY_MAX)))]
    delay_min: Option<u16>,
    /// Maximum number of ticks until an input takes effect; above --delay-min, the delay follows the latency
    #[arg(long, value_name = "TICKS", default_value_t = 20, value_parser = clap::value_parser!(u16).range(..=i64::from(DELAY_MAX)))]
    delay_max: u16,
    /// Seconds for which the match waits for a player whose packets do not arrive; the same for all peers
    #[arg(long, value_name = "SECONDS", default_value_t = 2, value_parser = clap::value_parser!(u64).range(1..))]
    patience: u64,
    /// Seconds without packets of other peers after which this peer gives up
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) give_up: u64,
    /// Number of ticks of the match [default: until all have left]
    #[arg(long)]
    pub(super) ticks: Option<u64>,
    /// File for the replay; it must not exist
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// File for a divergence report, written if states differ; it must not exist
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// Print a line of JSON for each event; the last one has the result
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Participation {
    /// Host a match at this address
    #[arg(long, value_name = "ADDRESS")]
    host: Option<String>,
    /// Join the match at this address: the address of any participant
    #[arg(long, value_name = "ADDRESS")]
    join: Option<String>,
    /// Join the match at this address as a spectator
    #[arg(long, value_name = "ADDRESS")]
    watch: Option<String>,
}

impl Arguments {
    pub(super) const fn give_up(&self) -> Duration {
        Duration::from_secs(self.give_up)
    }

    pub(super) fn enter(&self) -> Result<UdpPeer, Box<dyn Error>> {
        let setup = Setup { seats: self.seats, seed: self.seed, ..Setup::default() };
        if !(1..=self.seats).contains(&self.players) {
            return Err(format!("--players {}: the match has {} seats", self.players, self.seats).into());
        }
        let mut me = PeerIdentity::random();
        if let Some(key) = self.key {
            me = me.with_key(Key(key));
        }
        let Participation { host, join, watch } = &self.way;
        let way = match (join, watch) {
            (Some(contact), _) => online::Participation::Join { contact: contact.as_str() },
            (None, Some(contact)) => online::Participation::Watch { contact: contact.as_str() },
            (None, None) => online::Participation::Host,
        };
        let bind = host.as_ref().or(self.bind.as_ref());
        Ok(way.enter_udp(bind.map(String::as_str), &setup, self.options()?, me)?)
    }

    fn options(&self) -> Result<PeerOptions, Box<dyn Error>> {
        let lockstep = self.lockstep || self.window == Some(0);
        let options = if lockstep { PeerOptions::lockstep() } else { PeerOptions::rollback() };
        let delay_min = self.delay_min.unwrap_or(options.delay.0.min(self.delay_max));
        if delay_min > self.delay_max {
            return Err(format!("--delay-min {delay_min} is more than --delay-max {}", self.delay_max).into());
        }
        Ok(PeerOptions {
            guess: if lockstep { 0 } else { self.window.unwrap_or(options.guess) },
            delay: (delay_min, self.delay_max),
            patience: Duration::from_secs(self.patience),
            start_with: self.players,
            first_seat: self.seat,
            ..options
        })
    }
}
