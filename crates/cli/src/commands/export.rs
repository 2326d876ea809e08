//! `export`: plays a replay and writes its states as pictures, animations, plots or JSON.

use std::path::PathBuf;

use clap::Args;
use lockstep2d::draw::{Layers, View};
use lockstep2d::lockstep::Game;
use lockstep2d::math::Aabb;
use lockstep2d::replay::{Limits, VerifiedReplay};
use lockstep2d::report::{Evidence, EvidenceError};
use lockstep2d::world::World;

use crate::console::Console;
use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::files::is_save;
use crate::output_file::{self, Overwrite};
use crate::panics;

mod animation;
mod format;
mod json;
mod options;
mod output;
mod plot;
mod still;

use format::{Format, Formats};
use output::Output;

/// Play a replay and write its states as a picture, an animation, a plot or JSON
#[derive(Args, Debug)]
#[command(
    after_help = "The format can be omitted if the output file name ends in it. Tick t is the state after t ticks; 0 \
                        is the start. A picture shows one tick, by default the last. An animation, a plot and JSON \
                        cover the ticks --from to --to. A line of JSON has the tick, the state hash and the game's \
                        save in readable form; a fixed-point number is given as bits and as a decimal. A snapshot of a \
                        world can be written as a picture or as a line of JSON.\n\nExit code: 0 when it was written, 1 \
                        when the replay cannot be played up to the tick, 2 for wrong usage, a tick after the end, or \
                        files that cannot be read or written."
)]
pub(crate) struct Arguments {
    /// The replay, or a snapshot of a world
    pub(super) file: PathBuf,
    #[command(flatten)]
    formats: Formats,
    /// The file to write [default for JSON, SVG and plots: the standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// The tick to write [default: the last for a picture, all for JSON]
    #[arg(long, value_name = "N")]
    tick: Option<u64>,
    /// The first tick [default: the start]
    #[arg(long, value_name = "TICK", conflicts_with = "tick")]
    from: Option<u64>,
    /// The last tick [default: the end]
    #[arg(long, value_name = "TICK", conflicts_with = "tick")]
    to: Option<u64>,
    /// Number of ticks between frames or lines of JSON [default: 1 for JSON; for animations, the smallest with at most
    /// 30 frames a second]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u32).range(1..))]
    every: Option<u32>,
    /// Width in pixels
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(64..=16384))]
    width: Option<u32>,
    /// Height in pixels
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(64..=16384))]
    height: Option<u32>,
    /// Names of the layers to draw, separated by commas, or `all`, or `none`
    #[arg(long, value_name = "NAMES", value_parser = options::layers)]
    layers: Option<Layers>,
    /// The part of the world to draw, as two opposite corners in metres
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = options::window, allow_hyphen_values = true)]
    window: Option<Aabb>,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let format = arguments.formats.chosen(arguments.output.as_deref())?;
    arguments.check(format)?;
    if let Some(path) = &arguments.output {
        output_file::check(path, arguments.overwrite)?;
    }
    let (bytes, limits) = (context.load(&arguments.file)?, context.limits());
    let path = || arguments.file.clone();
    match Evidence::read(bytes.clone(), limits) {
        Ok(Evidence::World(world)) => return export_world(&world, format, arguments, &mut context.console),
        Ok(Evidence::Report(_)) => {
            return Err(CommandError::NoReplay { path: path(), kind: "a report of a divergence" });
        }
        Err(EvidenceError::Unknown) if is_save::<G>(&bytes) => {
            return Err(CommandError::NoReplay { path: path(), kind: "a save of this game" });
        }
        Ok(Evidence::Replay(_)) | Err(EvidenceError::Unknown) => {}
        Err(error) => return Err(CommandError::Evidence { path: path(), error }),
    }
    let mut replay = Replay::<G>::open(&bytes, arguments, limits)?;
    match format {
        Format::Svg | Format::Png => {
            let tick = arguments.tick.unwrap_or(replay.verified.ticks());
            replay.check(tick)?;
            replay.play_to(tick)?;
            let view = arguments.view(replay.view(context.tool.view));
            still::write(replay.world()?, &view, format, arguments, &mut context.console)
        }
        Format::Gif | Format::Apng => animation::write(&bytes, replay, format, arguments, context),
        Format::Json => {
            let (first, last) = replay.range(arguments)?;
            let every = arguments.every.unwrap_or(1);
            Output::write(arguments, &mut context.console, |output| {
                json::write(replay, (first..=last).step_by(every as usize), output)
            })
        }
        Format::Plot => plot::write(replay, arguments, &mut context.console),
    }
}

fn export_world(
    world: &World,
    format: Format,
    arguments: &Arguments,
    console: &mut Console<'_>,
) -> CommandResult {
    let mut ticks = [arguments.tick, arguments.from, arguments.to].into_iter().flatten();
    if arguments.every.is_some() || ticks.any(|tick| tick != world.tick()) {
        return Err(CommandError::NothingThere { what: "other tick in this snapshot".into() });
    }
    match format {
        Format::Svg | Format::Png => {
            still::write(world, &arguments.view(View::default()), format, arguments, console)
        }
        Format::Json => {
            let line = json::line(world.tick(), world.state_hash(), &world.save())?;
            Output::write(arguments, console, |output| output.line(&line))
        }
        Format::Gif | Format::Apng | Format::Plot => {
            Err(CommandError::OneState { path: arguments.file.clone(), format: format.option() })
        }
    }
}

impl Arguments {
    /// Refuses options that do not apply to the format.
    fn check(&self, format: Format) -> Result<(), CommandError> {
        let is_still = matches!(format, Format::Svg | Format::Png);
        let is_animation = matches!(format, Format::Gif | Format::Apng);
        let is_picture = is_still || is_animation;
        let options = [
            ("--tick", self.tick.is_some(), is_still || format == Format::Json),
            ("--from", self.from.is_some(), !is_still),
            ("--to", self.to.is_some(), !is_still),
            ("--every", self.every.is_some(), is_animation || format == Format::Json),
            ("--width", self.width.is_some(), format != Format::Json),
            ("--height", self.height.is_some(), format != Format::Json),
            ("--layers", self.layers.is_some(), is_picture),
            ("--window", self.window.is_some(), is_picture),
        ];
        match options.into_iter().find(|(_, is_given, is_useful)| *is_given && !is_useful) {
            Some((option, ..)) => Err(CommandError::Useless { option, format: format.option() }),
            None => Ok(()),
        }
    }

    /// The game's own view, overridden by the arguments.
    fn view(&self, game: View) -> View {
        let (width, height) = (self.width.unwrap_or(game.width), self.height.unwrap_or(game.height));
        let frame = self.window.map_or(game.frame, lockstep2d::draw::Frame::Window);
        View { width, height, frame, layers: self.layers.unwrap_or(game.layers), title: game.title }
    }
}

/// A replay that is being played. Each export plays it up to the tick that it needs next.
struct Replay<'a, G: Game> {
    verified: VerifiedReplay<'a, G>,
    path: &'a PathBuf,
}

impl<'a, G: Game> Replay<'a, G> {
    fn open(bytes: &'a [u8], arguments: &'a Arguments, limits: &Limits) -> Result<Self, CommandError> {
        let path = &arguments.file;
        Ok(Replay {
            verified: VerifiedReplay::open(bytes, limits).map_err(CommandError::replay(path))?,
            path,
        })
    }

    fn range(&self, arguments: &Arguments) -> Result<(u64, u64), CommandError> {
        let first = arguments.tick.or(arguments.from).unwrap_or(0);
        let last = arguments.tick.or(arguments.to).unwrap_or(self.verified.ticks());
        self.check(first)?;
        self.check(last)?;
        if first > last {
            return Err(CommandError::Reversed { from: first, to: last });
        }
        Ok((first, last))
    }

    /// Refuses a tick after the end.
    fn check(&self, tick: u64) -> Result<(), CommandError> {
        let ticks = self.verified.ticks();
        let path = || self.path.clone();
        if tick > ticks { Err(CommandError::NoSuchTick { path: path(), tick, ticks }) } else { Ok(()) }
    }

    fn play_to(&mut self, tick: u64) -> Result<(), CommandError> {
        while self.verified.tick() < tick {
            self.verified.step().map_err(CommandError::replay(self.path))?;
            panics::played(self.verified.tick());
        }
        Ok(())
    }

    fn view(&self, view: Option<fn(&G) -> View>) -> View {
        view.map_or_else(View::default, |view| view(self.verified.game()))
    }

    fn world(&mut self) -> Result<&World, CommandError> {
        self.verified.world().ok_or(CommandError::NoPictures)
    }
}
