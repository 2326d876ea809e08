//! The command line.

use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser};
use lockstep2d::lockstep::Game;

use crate::script::Script;
use crate::viewer::Viewer;
use crate::window::{self, Options};

#[cfg(target_os = "linux")]
mod display;
mod online;

#[derive(Debug, Parser)]
#[command(version)]
struct Args {
    /// Replay, divergence report or snapshot to show [default: a live scene]
    file: Option<PathBuf>,
    /// Second replay or snapshot, compared with the first
    #[arg(requires = "file")]
    other: Option<PathBuf>,
    /// Live scene; `--list` shows the names
    #[arg(long, value_name = "NAME", conflicts_with = "file")]
    scene: Option<String>,
    /// Random seed of the scene or match [default: 0]
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// List the scenes
    #[arg(long)]
    list: bool,
    /// File for the replay of a live scene or match, saved at the end and with the key `s`; it must not exist
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Run a script instead of taking user input: see the docs of `lockstep2d_viewer::script`
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Width and height of the window
    #[arg(long, value_name = "WxH", default_value = "1120x720", value_parser = size)]
    size: [u16; 2],
    #[command(flatten)]
    online: online::OnlineArgs,
}

fn size(text: &str) -> Result<[u16; 2], String> {
    let sides =
        text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides| sides.iter().all(|side| (64..=8192).contains(side)))
        .ok_or_else(|| "should be a width and a height from 64 to 8192, such as 1120x720".to_owned())
}

/// Runs the program of a game. Exit codes: 0 for success, 2 for an error.
pub(crate) fn run<G: Game + 'static>(viewer: Viewer<G>, arguments: Vec<OsString>) -> ExitCode {
    let matches = match command(&viewer).try_get_matches_from(arguments) {
        Ok(matches) => matches,
        Err(usage) => {
            // If this fails, an error message could not be printed, either.
            let _printed = usage.print();
            return if usage.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    let name = viewer.name.clone();
    let args = Args::from_arg_matches(&matches).map_err(|error| Trouble(error.to_string()));
    match args.and_then(|args| show(viewer, args)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(trouble) => {
            eprintln!("{name}: {trouble}");
            ExitCode::from(2)
        }
    }
}

fn command<G: Game>(viewer: &Viewer<G>) -> clap::Command {
    let (rules, engine, semantics) = (G::RULES, lockstep2d::VERSION, lockstep2d::SEMANTICS);
    let version = format!("{} version {}, engine {engine}, semantics {semantics}", rules.name, rules.version);
    let command = Args::command().name(viewer.name.clone()).about(viewer.about.clone()).version(version);
    if viewer.online.is_some() { command } else { online::without(command) }
}

struct Trouble(String);

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

fn show<G: Game + 'static>(viewer: Viewer<G>, args: Args) -> Result<(), Trouble> {
    let mut app = viewer.app();
    if args.list {
        for (name, about) in app.scenes() {
            println!("{name:18} {about}");
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
    if args.seed.is_some() && args.file.is_some() {
        return Err(Trouble("--seed is for scenes and matches: a file contains its own seed".to_owned()));
    }
    let seed = args.seed.unwrap_or_default();
    let scene = args.scene.clone().or_else(|| app.first_scene());
    match (&args.file, args.online.entry()) {
        (Some(path), _) => {
            app.show_file(&name(path), read(path)?).map_err(|error| trouble(path, &error))?;
            if let Some(other) = &args.other {
                app.compare_with(&name(other), read(other)?).map_err(|error| trouble(other, &error))?;
            }
        }
        (None, Some(entry)) => app.show(args.online.open(&viewer, &entry, args.scene.as_deref(), seed)?),
        (None, None) => match scene {
            Some(scene) if app.show_scene(&scene, seed) => {}
            Some(scene) => {
                return Err(Trouble(format!("there is no scene {scene:?}: --list shows the names")));
            }
            None => return Err(Trouble("there is no scene: name a replay to show".to_owned())),
        },
    }
    if let Some(path) = args.output.as_ref().filter(|path| path.is_file()) {
        return Err(Trouble(format!("cannot write {}: it exists; name another file", path.display())));
    }
    #[cfg(target_os = "linux")]
    display::check().map_err(Trouble)?;
    let options = Options { title: viewer.name, size: args.size, script, output: args.output };
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
    /// clap reports contradictory definitions of arguments only in builds with debug assertions, so this test checks
    /// them.
    #[test]
    fn the_arguments_go_together() {
        super::command(&crate::sandbox()).debug_assert();
    }
}
