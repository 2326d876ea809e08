//! End-to-end tests of the tools: each test passes arguments, and checks the files, output and exit codes.
#![expect(clippy::unwrap_used, reason = "a failure in a helper fails the test")]

#[path = "../../../../tests/replay/counter.rs"]
mod counter;

mod batch;
mod binary;
mod bisect;
mod cache;
mod diff;
mod docs;
mod export;
mod export_files;
mod export_plot;
mod fork;
mod hostile;
mod inspect;
mod long;
#[cfg(target_os = "linux")]
mod memory;
mod only_world;
mod outputs;
mod record;
mod seek;
mod sign;
mod small_outputs;
mod stats;
mod stress_saves;
mod trim;
mod verify;
#[cfg(unix)]
mod verify_any;

use std::fs;
use std::path::{Path, PathBuf};

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::replay::Recording;
use lockstep2d_cli::{Catalogue, Exit, Scene, SceneInfo, Tool};
use lockstep2d_tests::sweep;

use counter::{Counter, Setup, inputs_at, setup};

struct Outcome {
    exit: Exit,
    out: String,
    err: String,
}

/// Runs the tools of the counter, without a terminal.
fn run(arguments: &[&str]) -> Outcome {
    run_tool(&Tool::new().with_scenes(Scenes), arguments)
}

fn run_sandbox(arguments: &[&str]) -> Outcome {
    run_tool_of(&Tool::<Sandbox>::new(), arguments)
}

fn run_tool(tool: &Tool<Counter>, arguments: &[&str]) -> Outcome {
    run_tool_of(tool, arguments)
}

fn run_tool_of<G: Game>(tool: &Tool<G>, arguments: &[&str]) -> Outcome {
    let (mut out, mut err) = (anstream::StripStream::new(Vec::new()), anstream::StripStream::new(Vec::new()));
    let arguments = ["counter"].into_iter().chain(arguments.iter().copied());
    let exit = tool.run_with(arguments, &mut out, &mut err);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Outcome { exit, out: text(out.into_inner()), err: text(err.into_inner()) }
}

struct Scenes;

impl Catalogue<Counter> for Scenes {
    fn scenes(&self) -> Vec<SceneInfo> {
        vec![
            SceneInfo { name: "waves", about: "the sum goes up and down", ticks: 100 },
            SceneInfo { name: "bad", about: "cannot start", ticks: 1 },
        ]
    }

    fn open(&self, name: &str, seed: u64) -> Option<Scene<Counter>> {
        let label = seed.to_string();
        let setup = match name {
            "waves" => Setup { label, ..setup() },
            "bad" => Setup { start: 2000, label },
            _ => return None,
        };
        Some(Scene { setup, ticks: 100, script: Box::new(|tick, _| inputs_at(tick).to_vec()) })
    }
}

/// A complete replay of the counter, with a checkpoint every 10 ticks.
fn replay(ticks: u64) -> Vec<u8> {
    let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
    for tick in 0..ticks {
        recording.step(&inputs_at(tick)).unwrap();
    }
    recording.finish().unwrap()
}

/// Path of the replay of a scene in the folder `replays` of this repository.
fn golden(scene: &str) -> String {
    format!("{}/../../replays/{scene}.replay", env!("CARGO_MANIFEST_DIR"))
}

/// A folder that is deleted on drop.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("lockstep2d-{}-{test}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_string()
    }

    /// Writes a file, and creates its parent folders. Returns the path of the file.
    fn write(&self, name: &str, bytes: &[u8]) -> String {
        let path = self.path(name);
        fs::create_dir_all(Path::new(&path).parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
