//! Where a command writes: results to one stream, messages to the other.

use std::fmt;
use std::io::Write;

use anstyle::{AnsiColor, Style};
use serde::Serialize;

use crate::error::CommandError;

pub(crate) const GOOD: Style = AnsiColor::Green.on_default().bold();
pub(crate) const DOUBTFUL: Style = AnsiColor::Yellow.on_default().bold();
pub(crate) const BAD: Style = AnsiColor::Red.on_default().bold();

/// The two streams of a command. Both get colours; what is no terminal strips them.
pub(crate) struct Console<'a> {
    pub(crate) out: &'a mut dyn Write,
    pub(crate) err: &'a mut dyn Write,
    /// Whether somebody watches the messages on a terminal as they come.
    pub(crate) is_terminal: bool,
}

impl Console<'_> {
    /// Writes a line of results, in one go, so that nothing that a game prints gets into it.
    pub(crate) fn line(&mut self, line: impl fmt::Display) -> Result<(), CommandError> {
        self.out.write_all(format!("{line}\n").as_bytes()).map_err(CommandError::Output)
    }

    /// Writes a result as one JSON document.
    pub(crate) fn json(&mut self, document: &impl Serialize) -> Result<(), CommandError> {
        self.line(json_text(document))
    }

    /// Writes a line that is no result, such as a summary beside machine-readable output.
    pub(crate) fn note(&mut self, note: impl fmt::Display) {
        // When not even messages can be written, there is nowhere left to say so.
        let _ = writeln!(self.err, "{note}");
    }

    /// Writes a message on something that went wrong and changes no result.
    pub(crate) fn warning(&mut self, warning: impl fmt::Display) {
        self.note(format_args!("{DOUBTFUL}warning:{DOUBTFUL:#} {warning}"));
    }

    /// Writes a message on something that went wrong.
    pub(crate) fn error(&mut self, error: impl fmt::Display) {
        self.note(format_args!("{BAD}error:{BAD:#} {error}"));
    }
}

/// A value of strings and numbers as JSON.
pub(crate) fn json_text(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("strings and numbers have a JSON form")
}
