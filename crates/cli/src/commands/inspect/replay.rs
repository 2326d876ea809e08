//! The description of a replay, without playing it.

use lockstep2d::codec;
use lockstep2d::inspect::{Field, fields};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Mismatch, Part, ReadError, Reader, Trailer};
use serde_json::{Value as Json, json};

use super::state::{field_json, field_text};
use super::{Arguments, shown};
use crate::console::{BAD, Console, DOUBTFUL, GOOD};
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::Shown;
use crate::identity::{GameDigest, mismatch};

pub(super) fn print<G: Game>(
    bytes: &[u8],
    arguments: &Arguments,
    context: &mut Context<'_, G>,
) -> CommandResult {
    let read = Summary::read::<G>(bytes, context.limits());
    let summary = read.map_err(CommandError::replay(&arguments.file))?;
    if arguments.json {
        let mut document = summary.document();
        document["file"] = arguments.file.display().to_string().into();
        context.console.json(&document)?;
    } else {
        let file = format!("{}", Shown(&arguments.file));
        summary.print(&format!("{file}: replay"), arguments, &mut context.console)?;
    }
    Ok(summary.exit())
}

/// Properties of a replay that is not played.
pub(super) struct Summary {
    semantics: u32,
    rules: (String, u32),
    unverifiable: Option<Mismatch>,
    players: u32,
    tick_rate: u32,
    checkpoint_interval: u32,
    setup: Setup,
    ticks: u64,
    blocks: u64,
    runs: u64,
    bytes: Bytes,
    game: Option<String>,
    end: Ending,
}

/// Lengths of the parts of a file in bytes.
#[derive(Default)]
struct Bytes {
    header: u64,
    setup: u64,
    inputs: u64,
    trailer: u64,
    /// Number of bytes after the intact part.
    rest: u64,
}

enum Setup {
    Fields(Vec<Field>),
    /// The setup cannot be decoded, or belongs to other rules.
    Unknown,
}

enum Ending {
    Complete(Trailer),
    Cut,
    Damaged(ReadError),
}

impl Summary {
    pub(super) fn read<G: Game>(file: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut reader = Reader::open(file, limits)?;
        let mut bytes = Bytes { header: reader.offset(), ..Bytes::default() };
        let (mut blocks, mut runs) = (0, 0);
        let end = loop {
            let start = reader.offset();
            match reader.next_part() {
                Ok(Some(Part::Inputs(block))) => {
                    bytes.inputs += reader.offset() - start;
                    blocks += 1;
                    let mut list = block.runs();
                    while let Ok(Some(_)) = list.next_run() {
                        runs += 1;
                    }
                }
                Ok(Some(Part::Trailer(trailer))) => {
                    bytes.trailer = reader.offset() - start;
                    break Ending::Complete(trailer);
                }
                Ok(Some(Part::Cut) | None) => break Ending::Cut,
                Err(error) => break Ending::Damaged(error),
            }
        };
        bytes.rest = (file.len() as u64).saturating_sub(bytes.header + bytes.inputs + bytes.trailer);
        let header = reader.header();
        bytes.setup = header.setup.len() as u64;
        Ok(Summary {
            semantics: header.semantics,
            rules: (header.rules_name.into(), header.rules_version),
            unverifiable: mismatch::<G>(header.semantics, header.rules_name, header.rules_version),
            players: header.players,
            tick_rate: header.tick_rate,
            checkpoint_interval: header.checkpoint_interval,
            setup: setup::<G>((header.rules_name, header.rules_version), header.setup),
            ticks: reader.ticks(),
            blocks,
            runs,
            bytes,
            game: GameDigest::of_any(file, limits).ok().map(|game| game.to_string()),
            end,
        })
    }

    pub(super) fn exit(&self) -> Exit {
        if matches!(self.end, Ending::Damaged(_)) { Exit::NoMatch } else { Exit::Success }
    }

    pub(super) fn print(
        &self,
        title: &str,
        arguments: &Arguments,
        console: &mut Console<'_>,
    ) -> Result<(), CommandError> {
        let Summary { semantics, players, tick_rate, checkpoint_interval, ticks, blocks, runs, .. } = self;
        match &self.end {
            Ending::Complete(_) => console.line(format_args!("{title}, {GOOD}complete{GOOD:#}"))?,
            Ending::Cut => {
                console.line(format_args!("{title}, {DOUBTFUL}cut{DOUBTFUL:#}: it has no trailer"))?
            }
            Ending::Damaged(error) => {
                let error = shown(&error.to_string());
                console.line(format_args!(
                    "{title}, {BAD}damaged{BAD:#} {error}; the part before that is intact"
                ))?;
            }
        }
        let (name, version) = (shown(&format!("{:?}", self.rules.0)), self.rules.1);
        console.line(format_args!("engine semantics {semantics}, rules {name} version {version}"))?;
        match &self.unverifiable {
            None => console.line("this program can verify it")?,
            Some(why) => console.line(format_args!(
                "{DOUBTFUL}this program cannot verify it{DOUBTFUL:#}: {}",
                shown(&why.to_string())
            ))?,
        }
        console.line(format_args!(
            "players {players}, ticks per second {tick_rate}, a checkpoint every {checkpoint_interval} ticks"
        ))?;
        let seconds = self.hundredths();
        let duration = format!("{}.{:02} s", seconds / 100, seconds % 100);
        console.line(format_args!("{ticks} ticks ({duration}) in {blocks} blocks, {runs} runs of inputs"))?;
        let Bytes { header, setup, inputs, trailer, rest } = self.bytes;
        let all = header + inputs + trailer + rest;
        console.line(format_args!(
            "{all} bytes: header {header} (setup {setup}), inputs {inputs}, trailer {trailer}, not whole {rest}"
        ))?;
        if let Ending::Complete(trailer) = &self.end {
            console.line(format_args!("states the final hash {}", trailer.final_hash))?;
            for (claim, value) in &trailer.claims {
                console.line(format_args!("claims {} = {value}", shown(&format!("{claim:?}"))))?;
            }
        }
        if let Some(game) = &self.game {
            console.line(format_args!("game {game}"))?;
        }
        self.print_setup(arguments, console)
    }

    fn print_setup(&self, arguments: &Arguments, console: &mut Console<'_>) -> Result<(), CommandError> {
        let Setup::Fields(fields) = &self.setup else {
            return console.line("setup: not one that this program knows");
        };
        console.line(format_args!("setup: {} fields", fields.len()))?;
        for field in fields.iter().take(arguments.fields) {
            console.line(format_args!("  {}", field_text(field)))?;
        }
        match fields.len().saturating_sub(arguments.fields) {
            0 => Ok(()),
            more => console.line(format_args!("  and {more} more (--fields {})", fields.len())),
        }
    }

    /// The duration in hundredths of a second, rounded to nearest.
    fn hundredths(&self) -> u128 {
        let rate = u128::from(self.tick_rate.max(1));
        (u128::from(self.ticks) * 200 + rate) / (2 * rate)
    }

    pub(super) fn document(&self) -> Json {
        let Bytes { header, setup, inputs, trailer, rest } = self.bytes;
        let (end, damage, stated) = match &self.end {
            Ending::Complete(trailer) => ("complete", None, Some(trailer)),
            Ending::Cut => ("cut", None, None),
            Ending::Damaged(error) => ("damaged", Some(error.to_string()), None),
        };
        let claims = |trailer: &Trailer| {
            trailer.claims.iter().map(|(name, value)| (name.clone(), json!(value))).collect::<Json>()
        };
        let setup_fields = match &self.setup {
            Setup::Fields(fields) => Some(fields.iter().map(field_json).collect::<Vec<_>>()),
            Setup::Unknown => None,
        };
        json!({
            "kind": "replay",
            "end": end,
            "damage": damage,
            "semantics": self.semantics,
            "rules": {"name": self.rules.0, "version": self.rules.1},
            "unverifiable": self.unverifiable.as_ref().map(|why| why.to_string()),
            "players": self.players,
            "tick_rate": self.tick_rate,
            "checkpoint_interval": self.checkpoint_interval,
            "ticks": self.ticks,
            "blocks": self.blocks,
            "runs": self.runs,
            "bytes": {"header": header, "setup": setup, "inputs": inputs, "trailer": trailer, "not_whole": rest},
            "game": self.game,
            "final_hash": stated.map(|trailer| trailer.final_hash.to_string()),
            "claims": stated.map(claims),
            "setup": setup_fields,
        })
    }
}

fn setup<G: Game>(rules: (&str, u32), bytes: &[u8]) -> Setup {
    if rules != (G::RULES.name, G::RULES.version) {
        return Setup::Unknown;
    }
    // If another version of the engine has encoded the setup, the bytes may decode to a wrong setup. This is recognised
    // by encoding the setup again, which gives other bytes.
    let decoded = codec::decode::<G::Setup>(bytes).ok().filter(|setup| codec::encode(setup) == bytes);
    decoded.and_then(|setup| fields(&setup).ok()).map_or(Setup::Unknown, Setup::Fields)
}
