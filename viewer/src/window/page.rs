//! [`Host`]: the page that a browser shows the viewer on.
//!
//! The page reads lines from the log, fields separated by tabs, of which the first says what the line is:
//!
//! ```text
//! lockstep2d.report  name  tick  last tick or nothing  hash or nothing  status
//! lockstep2d.save    name  bytes as hexadecimal digits
//! ```

use std::fmt::Write;
use std::path::PathBuf;

use lockstep2d_viewer::{App, Event, Report, Request};

use super::WindowError;

/// A file of this kind is a wish of the page: to see the scene that it is named after.
const SCENE: &str = ".scene";

/// The page.
pub(super) struct Host {
    last: std::cell::RefCell<Option<Report>>,
}

impl Host {
    pub(super) fn new(_output: Option<PathBuf>) -> Self {
        Host { last: None.into() }
    }

    /// Does what the viewer asks for, and tells the page what it shows.
    pub(super) fn serve(&self, app: &mut App) -> Result<(), WindowError> {
        for Request::Save { name, bytes } in app.take_requests() {
            let digits = bytes.iter().fold(String::new(), |mut digits, byte| {
                // A string takes everything.
                let _written = write!(digits, "{byte:02x}");
                digits
            });
            say(&format!("lockstep2d.save\t{}\t{digits}", field(&name)));
        }
        let report = app.report();
        if self.last.borrow().as_ref() != Some(&report) {
            let Report { name, tick, ticks, hash, status } = &report;
            let ticks = ticks.map(|ticks| ticks.to_string()).unwrap_or_default();
            let hash = hash.map(|hash| hash.to_string()).unwrap_or_default();
            let (name, status) = (field(name), field(status));
            say(&format!("lockstep2d.report\t{name}\t{tick}\t{ticks}\t{hash}\t{status}"));
            self.last.replace(Some(report));
        }
        Ok(())
    }

    pub(super) fn finish(&self, app: &mut App) -> Result<(), WindowError> {
        self.serve(app)
    }

    /// A file that was dropped, or a wish of the page.
    pub(super) fn open(&self, app: &mut App, name: String, bytes: Vec<u8>) {
        match name.strip_suffix(SCENE) {
            Some(scene) if bytes.is_empty() && app.show_scene(scene, 0) => {}
            _ => app.handle(Event::Dropped { name, bytes }),
        }
    }

    /// Browsers ask for frames themselves.
    pub(super) fn pace(&self, _elapsed: f64) {}
}

/// The macro formats nothing where its text is the only argument.
fn say(line: &str) {
    miniquad::info!("{}", line);
}

/// Without what separates fields, and without what ends a line for the log.
fn field(text: &str) -> String {
    text.replace(char::is_control, " ")
}
