//! `inspect`: describes a file without playing it, or lists the fields of one of its states.

use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::codec;
use lockstep2d::inspect::fields;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::VerifiedReplay;
use lockstep2d::report::{DesyncReport, Evidence, EvidenceError};

use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::files;
use crate::panics;

mod replay;
mod report;
mod state;
mod world;

use state::State;

/// Describe a replay, a snapshot of a world or a report of a divergence
#[derive(Args, Debug)]
#[command(
    after_help = "Without --tick nothing is played, so files of other games and other versions of the engine can be \
                        described, too. For a damaged replay, the intact part is described. Tick t is the state after \
                        t ticks; 0 is the start. A snapshot, or a save written by `seek`, has one state, which any of \
                        --tick, --body and --path selects.\n\nExit code: 0 when the file is intact, even if it is an \
                        incomplete replay, 1 when a replay is damaged or cannot be played up to the tick, 2 for wrong \
                        usage, a tick after the end, or a file of another kind or that cannot be read."
)]
pub(crate) struct Arguments {
    /// The file
    pub(super) file: PathBuf,
    /// List all fields of the state after N ticks
    #[arg(long, value_name = "N")]
    tick: Option<u64>,
    /// List only the fields of this body, given by its handle, number or name, such as 12v1, 12 or ball
    #[arg(long, value_name = "ID")]
    body: Option<String>,
    /// List only fields whose path starts with this, such as world.bodies
    #[arg(long, value_name = "PREFIX", conflicts_with = "body")]
    path: Option<String>,
    /// Maximum number of fields of a setup to show
    #[arg(long, value_name = "N", default_value_t = 20)]
    fields: usize,
    /// Print everything as one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let bytes = context.load(&arguments.file)?;
    let path = || arguments.file.clone();
    match Evidence::read(bytes.clone(), context.limits()) {
        Ok(Evidence::Replay(bytes)) if arguments.wants_state() => {
            state_of_replay(&bytes, arguments, context)?.print(arguments, &mut context.console)
        }
        Ok(Evidence::Report(report)) if arguments.wants_state() => {
            state_of_report(&report, arguments, context)?.print(arguments, &mut context.console)
        }
        Ok(Evidence::World(world)) if arguments.wants_state() => {
            let fields = fields(&world.save())?;
            State { tick: Some(world.tick()), hash: Some(world.state_hash()), fields }
                .print(arguments, &mut context.console)
        }
        Ok(Evidence::Replay(bytes)) => replay::print(&bytes, arguments, context),
        Ok(Evidence::Report(report)) => report::print(&report, arguments, context),
        Ok(Evidence::World(world)) => world::print(&world, bytes.len(), arguments, &mut context.console),
        Err(error @ EvidenceError::Unknown) => match codec::decode::<G::Save>(&bytes) {
            Ok(save) if codec::encode(&save) == bytes => {
                State { tick: None, hash: None, fields: fields(&save)? }
                    .print(arguments, &mut context.console)
            }
            _ => Err(CommandError::Evidence { path: path(), error }),
        },
        Err(error) => Err(CommandError::Evidence { path: path(), error }),
    }
}

impl Arguments {
    fn wants_state(&self) -> bool {
        self.tick.is_some() || self.body.is_some() || self.path.is_some()
    }
}

/// The state after the requested tick. Without a requested tick, the state at the start.
fn state_of_replay<G: Game>(
    bytes: &[u8],
    arguments: &Arguments,
    context: &Context<'_, G>,
) -> Result<State, CommandError> {
    let refused = CommandError::replay(&arguments.file);
    let mut replay = VerifiedReplay::<G>::open(bytes, context.limits()).map_err(&refused)?;
    let (tick, ticks) = (arguments.tick.unwrap_or(0), replay.ticks());
    if tick > ticks {
        return Err(CommandError::NoSuchTick { path: arguments.file.clone(), tick, ticks });
    }
    while replay.tick() < tick {
        replay.step().map_err(&refused)?;
        panics::played(replay.tick());
    }
    let fields = fields(&replay.game().save())?;
    Ok(State { tick: Some(tick), hash: Some(replay.game().state_hash()), fields })
}

/// The state after the requested tick, as the writer of the report had it: the save in the report, which may differ
/// from the state that results from the inputs. If the report has no save of the tick, the inputs of the report's
/// replay are played.
fn state_of_report<G: Game>(
    report: &DesyncReport,
    arguments: &Arguments,
    context: &Context<'_, G>,
) -> Result<State, CommandError> {
    let tick = arguments.tick.unwrap_or(report.tick());
    let saved = report.saves().iter().find(|(saved, _)| *saved == tick);
    let Some((_, save)) = saved else {
        if report.replay().is_empty() {
            return Err(CommandError::NothingThere { what: format!("state of tick {tick} in this report") });
        }
        return state_of_replay(report.replay(), arguments, context);
    };
    let save: G::Save =
        codec::decode(save).map_err(|error| CommandError::State { why: error.to_string() })?;
    let known = report.history().iter().find(|(known, _)| *known == tick);
    Ok(State { tick: Some(tick), hash: known.map(|(_, hash)| *hash), fields: fields(&save)? })
}

/// Text from an untrusted file, escaped for a terminal.
fn shown(text: &str) -> String {
    files::Shown(Path::new(text)).to_string()
}
