//! `shove play`: a match over UDP, in which a bot controls the local player.

use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use clap::{ArgMatches, Args, Command, FromArgMatches};
use lockstep2d::hash::StateHash;
use lockstep2d::net::{Divergence, Event, NetOptions};
use lockstep2d_cli::Exit;
use lockstep2d_shove::online::{self, UdpPeer};
use lockstep2d_shove::{Bot, Setup};

/// Time for which a peer stays connected after the end of its match, so that the other peers receive everything.
const LINGER: Duration = Duration::from_secs(2);

/// Plays a match over UDP, with a bot as the local player.
///
/// Exit code: 0 after the last tick, 1 if states differ, 2 if the match cannot be played.
#[derive(Debug, Args)]
struct Arguments {
    #[command(flatten)]
    way: Participation,
    /// Local address of the socket; any free port if not given.
    #[arg(long, value_name = "ADDRESS")]
    bind: Option<String>,
    /// Requested seat; any free seat if not given.
    #[arg(long)]
    seat: Option<u32>,
    /// Number of players that the first tick waits for; used by the host only.
    #[arg(long, default_value_t = 2)]
    players: u32,
    /// Number of seats of the match.
    #[arg(long, default_value_t = 4)]
    seats: u8,
    /// Random seed for the placement of players and crates.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Waits for late inputs instead of predicting them.
    #[arg(long)]
    lockstep: bool,
    /// Ticks until an input takes effect.
    #[arg(long, value_name = "TICKS")]
    input_delay: Option<u8>,
    /// Time without messages after which a player counts as disconnected, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 2)]
    timeout: u64,
    /// Ends after this number of ticks; without it the match runs until it is stopped.
    #[arg(long)]
    ticks: Option<u64>,
    /// File for the replay.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// File for a divergence report, written if states differ.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Prints one line of JSON at the end.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Participation {
    /// Hosts a match at this address.
    #[arg(long, value_name = "ADDRESS")]
    host: Option<String>,
    /// Joins the match at this address.
    #[arg(long, value_name = "ADDRESS")]
    join: Option<String>,
    /// Joins the match at this address as a spectator.
    #[arg(long, value_name = "ADDRESS")]
    watch: Option<String>,
}

/// Returns the definition of the subcommand.
pub(crate) fn command() -> Command {
    Arguments::augment_args(Command::new("play"))
}

/// Runs the subcommand.
pub(crate) fn run(matches: &ArgMatches) -> Exit {
    let arguments = match Arguments::from_arg_matches(matches) {
        Ok(arguments) => arguments,
        Err(usage) => usage.exit(),
    };
    match play(&arguments) {
        Ok(None) => Exit::Success,
        Ok(Some(_)) => Exit::NoMatch,
        Err(error) => {
            eprintln!("error: {error}");
            Exit::Trouble
        }
    }
}

/// Plays the match and returns the first divergence.
fn play(arguments: &Arguments) -> Result<Option<Divergence>, Box<dyn Error>> {
    let mut peer = sit_down(arguments)?;
    let mut file = arguments.output.as_ref().map(File::create).transpose()?;
    let mut diverged = None;
    let mut bot = None;
    let clock = Clock::start();
    let ticks = arguments.ticks.unwrap_or(u64::MAX);
    let watches = arguments.way.watch.is_some();
    let mut written = 0;
    while peer.confirmed() < ticks {
        if let Err(error) = peer.update(clock.now()) {
            // For a spectator, the end of the connection to the players is the regular end of the match.
            if !watches || peer.tick() == 0 {
                return Err(error.into());
            }
            eprintln!("spectator: {error}");
            break;
        }
        online::play_due(&mut peer, |game, seat| {
            bot.get_or_insert_with(|| Bot::new(arguments.seed, seat)).pad(game)
        })?;
        while let Some(event) = peer.next_event() {
            if let Event::Diverged(found) = event {
                let first = *diverged.get_or_insert(found);
                // The report is written again for each peer that reports its state of that tick, with more data each
                // time.
                if let Some(path) = arguments.report.as_ref().filter(|_| found.tick == first.tick) {
                    std::fs::write(path, peer.report(&first))?;
                }
            }
            let name = peer.seat().map_or("spectator".into(), |seat| format!("seat {seat}"));
            eprintln!("{name}: {}", online::describe(&event));
        }
        if let Some(file) = &mut file {
            let bytes = peer.take_replay();
            written += bytes.len();
            file.write_all(&bytes)?;
        }
        thread::sleep(Duration::from_millis(1));
    }
    let ticks = ticks.min(peer.confirmed());
    let hash = peer.history().get(ticks).map(|moment| moment.hash);
    say_end(arguments, &peer, ticks, hash, diverged);
    let end = clock.now() + LINGER;
    // Other peers may still miss messages of this one. Their events and states do not matter any more.
    while !watches && clock.now() < end && peer.update(clock.now()).is_ok() {
        thread::sleep(Duration::from_millis(5));
    }
    let rest = peer.finish(ticks)?;
    if let Some(file) = &mut file {
        file.write_all(&rest)?;
        if written + rest.len() == 0 {
            eprintln!("no replay: this peer was not in the match from the first tick");
        }
    }
    Ok(diverged)
}

fn sit_down(arguments: &Arguments) -> Result<UdpPeer, Box<dyn Error>> {
    let setup = Setup { seats: arguments.seats, seed: arguments.seed, ..Setup::default() };
    let options = if arguments.lockstep { NetOptions::lockstep() } else { NetOptions::rollback() };
    let input_delay = arguments.input_delay.unwrap_or(options.input_delay);
    let timeout = Duration::from_secs(arguments.timeout.max(1));
    let options = NetOptions { input_delay, timeout, ..options }.start_with(arguments.players);
    let Participation { host, join, watch } = &arguments.way;
    let way = match (join, watch) {
        (Some(contact), _) => online::Participation::Join { contact: contact.as_str(), seat: arguments.seat },
        (None, Some(contact)) => online::Participation::Watch { contact: contact.as_str() },
        (None, None) => online::Participation::Host,
    };
    let bind = host.as_ref().or(arguments.bind.as_ref());
    Ok(way.enter_udp(bind.map(String::as_str), &setup, options)?)
}

fn say_end(
    arguments: &Arguments,
    peer: &UdpPeer,
    ticks: u64,
    hash: Option<StateHash>,
    diverged: Option<Divergence>,
) {
    let hash = hash.map(|hash| hash.to_string());
    if arguments.json {
        let diverged = diverged.map(|found| found.tick);
        let line =
            serde_json::json!({ "seat": peer.seat(), "ticks": ticks, "hash": hash, "diverged": diverged });
        println!("{line}");
    } else {
        println!("{ticks} ticks, state {}", hash.unwrap_or_default());
    }
}

/// Time since the match was entered.
struct Clock(#[expect(clippy::disallowed_types, reason = "the clock of this process")] std::time::Instant);

impl Clock {
    fn start() -> Self {
        #[expect(clippy::disallowed_types, reason = "the clock of this process")]
        Clock(std::time::Instant::now())
    }

    fn now(&self) -> Duration {
        self.0.elapsed()
    }
}
