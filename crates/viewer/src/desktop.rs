//! The command line.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use lockstep2d_viewer::App;
use lockstep2d_viewer::script::Script;

use crate::window::{self, Options};

#[cfg(target_os = "linux")]
mod display;
mod shove;

/// Shows replays, snapshots and live scenes of lockstep2d in a window.
#[derive(Debug, Parser)]
#[command(name = "lockstep2d-viewer", version)]
struct Args {
    /// Replay or snapshot to show. Without a file, a live sandbox is shown.
    file: Option<PathBuf>,
    /// Second replay or snapshot, compared with the first.
    #[arg(requires = "file")]
    other: Option<PathBuf>,
    /// Scene of the live sandbox; `--list` shows the names.
    #[arg(long, value_name = "NAME", conflicts_with = "file", default_value = window::FIRST_SCENE)]
    scene: String,
    /// Random seed of the scene or match [default: 0].
    #[arg(long, value_name = "NUMBER", global = true)]
    seed: Option<u64>,
    /// Lists the scenes.
    #[arg(long)]
    list: bool,
    /// File that the replay of a live scene or match is saved to: at the end, and with the key `s`.
    #[arg(short, long, value_name = "FILE", global = true)]
    output: Option<PathBuf>,
    /// Runs a script instead of taking user input: see the docs of `lockstep2d_viewer::script`.
    #[arg(long, value_name = "FILE", global = true)]
    script: Option<PathBuf>,
    /// Width and height of the window.
    #[arg(long, value_name = "WxH", default_value = "1120x720", value_parser = size, global = true)]
    size: [u16; 2],
    #[command(subcommand)]
    game: Option<Game>,
}

/// Subcommands that show neither a file nor a scene.
#[derive(Debug, Subcommand)]
enum Game {
    Shove(shove::Shove),
}

fn size(text: &str) -> Result<[u16; 2], String> {
    let sides =
        text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides| sides.iter().all(|side| (64..=8192).contains(side)))
        .ok_or_else(|| "should be a width and a height from 64 to 8192, such as 1120x720".to_owned())
}

/// Runs the program. Exit codes are those of the command `lockstep2d`: 0 for success, 2 for an error.
pub(crate) fn main() -> ExitCode {
    match run(Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(trouble) => {
            eprintln!("lockstep2d-viewer: {trouble}");
            ExitCode::from(2)
        }
    }
}

/// Error message for the user.
struct Trouble(String);

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

fn run(args: Args) -> Result<(), Trouble> {
    if args.list {
        for scene in lockstep2d::scenes::ALL {
            println!("{:18} {}", scene.name, scene.about);
        }
        return Ok(());
    }
    let script = match &args.script {
        None => None,
        Some(path) => {
            let text = std::fs::read_to_string(path).map_err(|error| trouble(path, &error))?;
            Some(Script::parse(&text).map_err(|error| trouble(path, &error))?)
        }
    };
    // clap cannot declare a conflict between a global argument and one that is not global.
    if args.seed.is_some() && args.file.is_some() {
        return Err(Trouble("--seed is for scenes and matches: a file contains its own seed".to_owned()));
    }
    let seed = args.seed.unwrap_or_default();
    let mut app = App::default();
    match (&args.game, &args.file) {
        (Some(Game::Shove(shove)), _) => app.show(shove.open(seed)?),
        (None, Some(path)) => {
            app.show_file(&name(path), read(path)?).map_err(|error| trouble(path, &error))?;
            if let Some(other) = &args.other {
                app.compare_with(&name(other), read(other)?).map_err(|error| trouble(other, &error))?;
            }
        }
        (None, None) if app.show_scene(&args.scene, seed) => {}
        (None, None) => {
            return Err(Trouble(format!("there is no scene {:?}: --list shows the names", args.scene)));
        }
    }
    #[cfg(target_os = "linux")]
    display::check().map_err(Trouble)?;
    let options = Options { size: args.size, script, output: args.output };
    window::show(app, options).map_err(|error| Trouble(error.to_string()))
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn read(path: &Path) -> Result<Vec<u8>, Trouble> {
    std::fs::read(path).map_err(|error| trouble(path, &error))
}

fn trouble(path: &Path, error: &dyn fmt::Display) -> Trouble {
    Trouble(format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    /// clap checks the arguments with debug assertions, so this tests nothing in a build without them.
    #[test]
    fn the_arguments_go_together() {
        super::Args::command().debug_assert();
    }
}
