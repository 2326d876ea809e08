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
    /// A replay or a snapshot. Without one, a live sandbox is shown.
    file: Option<PathBuf>,
    /// Another one, to be compared with it.
    #[arg(requires = "file")]
    other: Option<PathBuf>,
    /// The scene of the live sandbox: `--list` says which there are.
    #[arg(long, value_name = "NAME", conflicts_with = "file", default_value = window::FIRST_SCENE)]
    scene: String,
    /// What a scene, or a match, that has something random in it is made from; 0 unless told.
    #[arg(long, value_name = "NUMBER", global = true)]
    seed: Option<u64>,
    /// Lists the scenes.
    #[arg(long)]
    list: bool,
    /// Where the replay of what is played live is saved: at the end, and when one asks for it.
    #[arg(short, long, value_name = "FILE", global = true)]
    output: Option<PathBuf>,
    /// Does what a file says instead of waiting for a person: docs of `lockstep2d_viewer::script`.
    #[arg(long, value_name = "FILE", global = true)]
    script: Option<PathBuf>,
    /// Width and height of the window.
    #[arg(long, value_name = "WxH", default_value = "1120x720", value_parser = size, global = true)]
    size: [u16; 2],
    #[command(subcommand)]
    game: Option<Game>,
}

/// What is no file and no scene.
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

/// Exit codes are those of the command `lockstep2d`: 0, or 2 for trouble.
pub(crate) fn main() -> ExitCode {
    match run(Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(trouble) => {
            eprintln!("lockstep2d-viewer: {trouble}");
            ExitCode::from(2)
        }
    }
}

/// What went wrong, for people.
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
    // Nothing that is global can be in conflict with what is not.
    if args.seed.is_some() && args.file.is_some() {
        return Err(Trouble("--seed is for scenes and matches: a file has what it was made from".to_owned()));
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
            return Err(Trouble(format!("there is no scene {:?}: --list says which there are", args.scene)));
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

    /// As far as there are debug assertions: it is they that check.
    #[test]
    fn the_arguments_go_together() {
        super::Args::command().debug_assert();
    }
}
