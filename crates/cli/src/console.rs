//! [`Console`]: the output of a command. Results go to the stream `out`, messages to the stream `err`.

use std::fmt;
use std::io::Write;

use anstyle::{AnsiColor, Style};
use serde::Serialize;

use crate::error::CommandError;
use crate::files::{OneLine, is_misleading};

pub(crate) const GOOD: Style = AnsiColor::Green.on_default().bold();
pub(crate) const DOUBTFUL: Style = AnsiColor::Yellow.on_default().bold();
pub(crate) const BAD: Style = AnsiColor::Red.on_default().bold();

/// The streams of a command. Both are written with ANSI colours, which [`Tool::run`](crate::Tool::run) strips where
/// they are not supported.
pub(crate) struct Console<'a> {
    pub(crate) out: &'a mut dyn Write,
    pub(crate) err: &'a mut dyn Write,
    /// Whether a command has written its output file to the standard output. The command then writes its lines to the
    /// message stream.
    pub(crate) is_out_taken: bool,
    /// Whether messages go to a terminal.
    pub(crate) is_terminal: bool,
    /// Whether the process runs only this command. The command then handles the signals of the process.
    pub(crate) owns_process: bool,
}

impl Console<'_> {
    /// Writes a line with one write call, so that output of the game cannot split it.
    pub(crate) fn line(&mut self, line: impl fmt::Display) -> Result<(), CommandError> {
        let stream = if self.is_out_taken { &mut *self.err } else { &mut *self.out };
        stream.write_all(format!("{line}\n").as_bytes()).map_err(CommandError::Output)
    }

    pub(crate) fn json(&mut self, document: &impl Serialize) -> Result<(), CommandError> {
        self.line(json_text(document))
    }

    /// Writes a line to the message stream.
    pub(crate) fn note(&mut self, note: impl fmt::Display) {
        // A failure of the message stream cannot be reported anywhere.
        let _ = writeln!(self.err, "{note}");
    }

    /// Warns of a problem that does not change any result.
    pub(crate) fn warning(&mut self, warning: impl fmt::Display) {
        self.note(format_args!("{DOUBTFUL}warning:{DOUBTFUL:#} {warning}"));
    }

    /// Writes an error on one line. It is escaped, because it may contain text of an untrusted file.
    pub(crate) fn error(&mut self, error: &CommandError) {
        self.note(format_args!("{BAD}error:{BAD:#} {}", OneLine(&error.to_string())));
    }
}

/// JSON on one line, with [misleading](is_misleading) characters escaped.
pub(crate) fn json_text(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value).expect("strings and numbers have a JSON form");
    // Such characters occur only in the strings of the JSON text, where escapes are allowed.
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if is_misleading(character) {
            let mut units = [0; 2];
            escaped.extend(character.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")));
        } else {
            escaped.push(character);
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_that_misleads_a_terminal_is_escaped_in_json() {
        let name = "a\u{202e}b\u{7f}\u{9b}2J\u{e0041}\u{1b}\n ü";
        let json = json_text(&[name]);
        assert_eq!(json, r#"["a\u202eb\u007f\u009b2J\udb40\udc41\u001b\n ü"]"#);
        assert_eq!(serde_json::from_str::<[String; 1]>(&json).unwrap(), [name]);
    }
}
