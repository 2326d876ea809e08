//! [`Host`]: file access and frame pacing on a desktop.

use std::path::PathBuf;
use std::time::Duration;

use crate::{App, Event, Request};

use super::WindowError;

/// Desktop environment of the window.
pub(super) struct Host {
    output: Option<PathBuf>,
}

impl Host {
    pub(super) fn new(output: Option<PathBuf>) -> Self {
        Host { output }
    }

    /// Carries out the viewer's requests. A failed write is shown as a message and does not end the program, so that
    /// a full disk does not cost the user the session.
    pub(super) fn serve(&self, app: &mut App) -> Result<(), WindowError> {
        if let Err(error) = self.save(app) {
            app.tell(format!("not saved: {error}"));
        }
        Ok(())
    }

    /// Saves the recording at the end, if an output file was named on the command line.
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

    /// Opens a dropped file.
    pub(super) fn open(&self, app: &mut App, name: String, bytes: Vec<u8>) {
        app.handle(Event::Dropped { name, bytes });
    }

    /// Sleeps if the display does not pace the frames, as with a virtual display. Times are in seconds.
    pub(super) fn pace(&self, elapsed: f64) {
        /// Frames shorter than this are faster than any display.
        const HASTE: f64 = 1.0 / 250.0;
        if elapsed < HASTE {
            std::thread::sleep(Duration::from_secs_f64(1.0 / 60.0 - elapsed));
        }
    }
}

/// Returns a path in the current directory at which no file exists, so that no file is overwritten.
fn free_path(name: &str) -> PathBuf {
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, "replay"));
    let numbered = (2..).map(|number| format!("{stem}-{number}.{ending}"));
    let mut paths = std::iter::once(name.to_owned()).chain(numbered).map(PathBuf::from);
    paths.find(|path| !path.exists()).unwrap_or_else(|| name.into())
}
