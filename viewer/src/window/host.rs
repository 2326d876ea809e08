//! [`Host`]: files, and the time between frames, on a desktop.

use std::path::PathBuf;
use std::time::Duration;

use lockstep2d_viewer::{App, Event, Request};

use super::WindowError;

/// What is around the window.
pub(super) struct Host {
    output: Option<PathBuf>,
}

impl Host {
    pub(super) fn new(output: Option<PathBuf>) -> Self {
        Host { output }
    }

    /// Does what the viewer asks for. What cannot be written is said on the screen: nobody wants to lose what they did
    /// because a disk is full.
    pub(super) fn serve(&self, app: &mut App) -> Result<(), WindowError> {
        if let Err(error) = self.save(app) {
            app.tell(format!("not saved: {error}"));
        }
        Ok(())
    }

    /// Saves what is recorded, where that was asked for from the start.
    pub(super) fn finish(&self, app: &mut App) -> Result<(), WindowError> {
        if self.output.is_some() {
            app.save();
        }
        self.save(app)
    }

    fn save(&self, app: &mut App) -> Result<(), WindowError> {
        for Request::Save { name, bytes } in app.take_requests() {
            let path = self.output.clone().unwrap_or_else(|| free_path(&name));
            std::fs::write(&path, bytes)
                .map_err(|error| WindowError::File { path: path.display().to_string(), error })?;
            eprintln!("{} written", path.display());
        }
        Ok(())
    }

    /// A file that was dropped.
    pub(super) fn open(&self, app: &mut App, name: String, bytes: Vec<u8>) {
        app.handle(Event::Dropped { name, bytes });
    }

    /// Waits a little where the screen does not make frames wait for it, as no virtual screen does.
    pub(super) fn pace(&self, elapsed: f64) {
        /// Shorter frames than of the fastest screens.
        const HASTE: f64 = 1.0 / 250.0;
        if elapsed < HASTE {
            std::thread::sleep(Duration::from_secs_f64(1.0 / 60.0 - elapsed));
        }
    }
}

/// The path of a file in this folder that is not there yet: nobody has said that another one may be overwritten.
fn free_path(name: &str) -> PathBuf {
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, "replay"));
    let numbered = (2..).map(|number| format!("{stem}-{number}.{ending}"));
    let mut paths = std::iter::once(name.to_owned()).chain(numbered).map(PathBuf::from);
    paths.find(|path| !path.exists()).unwrap_or_else(|| name.into())
}
