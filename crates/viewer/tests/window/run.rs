//! Runs a script in the program, and the same script without a window.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use lockstep2d_render::{Colour, raster};
use lockstep2d_viewer::script::{FRAME, Script, Step};
use lockstep2d_viewer::{App, Event};

use super::picture::Picture;

pub(crate) const SIZE: [usize; 2] = [960, 640];

pub(crate) fn directory(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&path).unwrap();
    path
}

pub(crate) fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../replays").join(name)
}

pub(crate) fn command(directory: &Path, script: &str, args: &[&str]) -> Command {
    let path = directory.join("script.txt");
    std::fs::write(&path, script).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lockstep2d-viewer"));
    command.current_dir(directory).arg("--script").arg(path);
    command.arg("--size").arg(format!("{}x{}", SIZE[0], SIZE[1])).args(args);
    command
}

/// Runs a script in the window, and returns the lines that its `report` instructions print.
pub(crate) fn play(directory: &Path, script: &str, args: &[&str]) -> Vec<String> {
    let Output { status, stdout, stderr } = command(directory, script, args).output().unwrap();
    assert!(status.success(), "{status}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap().lines().map(str::to_owned).collect()
}

/// Runs a script without a window. Returns its screenshots, made by the software rasteriser.
pub(crate) fn play_without_window(mut app: App, script: &str) -> Vec<Picture> {
    play_without_window_in(&mut app, script)
}

pub(crate) fn play_without_window_in(app: &mut App, script: &str) -> Vec<Picture> {
    app.handle(Event::Resized(SIZE.map(|side| side as f32)));
    let mut pictures = Vec::new();
    for step in Script::parse(script).unwrap().steps() {
        match step {
            Step::Event(event) => app.handle(event.clone()),
            Step::Frames(count) => (0..*count).for_each(|_| app.advance(FRAME)),
            Step::Screenshot(_) => {
                let image = raster(app.draw(), (SIZE[0] as u32, SIZE[1] as u32), Colour::hex(0));
                pictures.push(Picture::from_rgba(SIZE[0], image.rgba()));
            }
            Step::Drop(_) | Step::Report | Step::Quit => {}
        }
    }
    pictures
}

pub(crate) fn app(replay: &Path) -> App {
    let mut app = App::default();
    let name = replay.file_name().unwrap().to_str().unwrap();
    app.show_file(name, std::fs::read(replay).unwrap()).unwrap();
    app
}
