//! [`Host`]: the web page around the viewer.
//!
//! The page reads lines from the log. The fields of a line are separated by tabs:
//!
//! ```text
//! lockstep2d.report  name  tick  last tick or nothing  hash or nothing  status
//! lockstep2d.save    name  bytes as hexadecimal digits
//! ```

use std::fmt::Write;
use std::path::PathBuf;

use crate::{App, Event, Report, Request};

use super::WindowError;

/// The page requests a scene by dropping an empty file, whose name is the scene's name with this extension.
const SCENE: &str = ".scene";

pub(super) struct Host {
    last: std::cell::RefCell<Option<Report>>,
}

impl Host {
    pub(super) fn new(_output: Option<PathBuf>) -> Self {
        Host { last: None.into() }
    }

    /// Carries out requests, and reports changes of the viewer to the page.
    pub(super) fn serve(&self, app: &mut App) -> Result<(), WindowError> {
        for Request::Save { name, bytes } in app.take_requests() {
            let digits = bytes.iter().fold(String::new(), |mut digits, byte| {
                // Writing to a string cannot fail.
                let _written = write!(digits, "{byte:02x}");
                digits
            });
            post_line(&format!("lockstep2d.save\t{}\t{digits}", field(&name)));
        }
        let report = app.report();
        if self.last.borrow().as_ref() != Some(&report) {
            let Report { name, tick, ticks, hash, status } = &report;
            let ticks = ticks.map(|ticks| ticks.to_string()).unwrap_or_default();
            let hash = hash.map(|hash| hash.to_string()).unwrap_or_default();
            let (name, status) = (field(name), field(status));
            post_line(&format!("lockstep2d.report\t{name}\t{tick}\t{ticks}\t{hash}\t{status}"));
            self.last.replace(Some(report));
        }
        Ok(())
    }

    pub(super) fn finish(&self, app: &mut App) -> Result<(), WindowError> {
        self.serve(app)
    }

    /// Opens a dropped file, or the scene that the page requests.
    pub(super) fn open(&self, app: &mut App, name: String, bytes: Vec<u8>) {
        match name.strip_suffix(SCENE) {
            Some(scene) if bytes.is_empty() && app.show_scene(scene, 0) => {}
            _ => app.handle(Event::Dropped { name, bytes }),
        }
    }

    /// Does nothing, because the browser limits the frame rate.
    pub(super) fn pace(&self, _elapsed: f64) {}
}

/// Writes a line to the log. The text is passed as an argument of `"{}"`, because `info!` does not format a sole
/// argument.
fn post_line(line: &str) {
    miniquad::info!("{}", line);
}

/// Replaces control characters, such as tabs and line ends, by spaces.
fn field(text: &str) -> String {
    text.replace(char::is_control, " ")
}
