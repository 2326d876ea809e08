//! `shove play`: a match over UDP, in which a bot is the local player.

mod arguments;
mod log;

use std::error::Error;
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use clap::{ArgMatches, Args, Command, FromArgMatches};
use lockstep2d::peer::{PeerDesync, PeerEvent};
use lockstep2d::session::{Event, Status};
use lockstep2d_cli::Exit;
use lockstep2d_shove::Bot;
use lockstep2d_shove::online::{self, UdpPeer};

use arguments::Arguments;
use log::Log;

/// Time between two updates of the peer. A packet that arrives in between is read at the next update.
const UPDATE_INTERVAL: Duration = Duration::from_millis(1);

pub(crate) fn command() -> Command {
    Arguments::augment_args(Command::new("play"))
}

pub(crate) fn run(matches: &ArgMatches) -> Exit {
    let arguments = match Arguments::from_arg_matches(matches) {
        Ok(arguments) => arguments,
        Err(usage) => usage.exit(),
    };
    match play(&arguments) {
        Ok(None) => Exit::Success,
        Ok(Some(_)) => Exit::NoMatch,
        Err(error) => {
            log::say_error(arguments.json, &*error);
            Exit::Trouble
        }
    }
}

/// Plays a match. Returns the first desync that this peer has detected, if any.
fn play(arguments: &Arguments) -> Result<Option<PeerDesync>, Box<dyn Error>> {
    for path in arguments.output.iter().chain(&arguments.report) {
        check_absent(path)?;
    }
    let mut peer = arguments.enter()?;
    let interrupts = interrupts()?;
    let mut file = arguments.output.as_deref().map(create).transpose()?;
    let mut log = Log::new(arguments.json);
    log.say_bound(&mut peer)?;
    if let Some(ticks) = arguments.ticks {
        peer.end_at(ticks);
    }
    let played = take_part(arguments, &mut peer, &interrupts, &mut log, file.as_mut());
    // The replay and the summary are written even if `take_part` has failed.
    let summary = log.summary(&peer);
    let end = peer.finish()?;
    if let (Some(file), Some(path)) = (&mut file, &arguments.output) {
        file.write_all(&end.replay)?;
        let is_recorded = file.metadata()?.len() > 0;
        if !is_recorded {
            eprintln!("no replay: this peer was not in the match from the first tick");
        }
        // The replay may go to a pipe, which is not removed.
        if path.is_file() && (end.ticks == 0 || !is_recorded) {
            fs::remove_file(path)?;
        }
    }
    log.say_end(summary, &end);
    played
}

/// Creates the file of the replay or the report. An existing path is opened only if it is not a regular file, for
/// example a pipe. Two processes cannot create the same file. The replay is written during the match, so a killed
/// process leaves a replay without a trailer.
fn create(path: &Path) -> Result<File, Box<dyn Error>> {
    let file = match File::create_new(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            check_absent(path)?;
            File::options().write(true).open(path)
        }
        created => created,
    };
    file.map_err(|error| format!("cannot write {}: {error}", path.display()).into())
}

/// Refuses an existing regular file.
fn check_absent(path: &Path) -> Result<(), Box<dyn Error>> {
    if path.is_file() {
        return Err(format!("cannot write {}: it exists; name another file", path.display()).into());
    }
    Ok(())
}

fn take_part(
    arguments: &Arguments,
    peer: &mut UdpPeer,
    interrupts: &AtomicUsize,
    log: &mut Log,
    mut file: Option<&mut File>,
) -> Result<Option<PeerDesync>, Box<dyn Error>> {
    let clock = Clock::start();
    let mut bots: Vec<(u8, Bot)> = Vec::new();
    let mut desync = None;
    let mut heard_at = Duration::ZERO;
    while peer.status() != Some(Status::Closed) {
        let now = clock.now();
        peer.update(now)?;
        online::play_due(peer, |game, seat| pad_of_bot(&mut bots, arguments.seed, seat, game))?;
        while let Some(event) = peer.next_event() {
            log.say(peer, now, &event);
            if let PeerEvent::Session(Event::TooFarBehind) = event {
                return Err("too far behind the others: join the match again".into());
            }
            if let PeerEvent::Desync(found) = event
                && desync.is_none()
            {
                desync = Some(found);
                if let Some(path) = &arguments.report {
                    create(path)?.write_all(&peer.report(&found)?)?;
                }
            }
        }
        log.watch(peer, now);
        if let Some(file) = &mut file {
            file.write_all(&peer.take_replay())?;
        }
        match (interrupts.load(Ordering::Relaxed), peer.status()) {
            (0, Some(Status::Kicked)) => return Err("removed from the match by the others".into()),
            (0, None | Some(Status::Paused)) if now.saturating_sub(heard_at) >= arguments.give_up() => {
                return Err(format!("nobody was heard for {} s", arguments.give_up).into());
            }
            (0, None | Some(Status::Paused)) => {}
            (0, Some(_)) => heard_at = now,
            // The user has interrupted the process before it was in a match, so there is nothing to leave.
            (_, None) => break,
            (1, Some(_)) => peer.leave(),
            // The second signal: this process exits without waiting for the others.
            (_, Some(_)) => break,
        }
        thread::sleep(UPDATE_INTERVAL);
    }
    Ok(desync)
}

fn pad_of_bot(
    bots: &mut Vec<(u8, Bot)>,
    seed: u64,
    seat: u8,
    game: &lockstep2d_shove::Shove,
) -> lockstep2d_shove::Pad {
    let place = bots.iter().position(|(of, _)| *of == seat).unwrap_or_else(|| {
        bots.push((seat, Bot::new(seed, seat)));
        bots.len() - 1
    });
    bots[place].1.pad(game)
}

/// Counts Ctrl-C and termination signals.
fn interrupts() -> Result<Arc<AtomicUsize>, ctrlc::Error> {
    let count = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&count);
    ctrlc::set_handler(move || {
        counted.fetch_add(1, Ordering::Relaxed);
    })?;
    Ok(count)
}

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
