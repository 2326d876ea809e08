//! [`Output`]: the destination of an export. A file appears only when all of it is written.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::Arguments;
use crate::console::Console;
use crate::context::CommandResult;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::output_file::OutputFile;

pub(super) struct Output<'a> {
    to: &'a mut dyn Write,
    path: Option<&'a Path>,
}

impl Output<'_> {
    /// Calls `write` with the output file or, if there is none, with the standard output. A regular file appears only
    /// when all of it is written, so a failed run leaves the old file unchanged.
    pub(super) fn write(
        arguments: &Arguments,
        console: &mut Console<'_>,
        write: impl FnOnce(&mut Output<'_>) -> Result<(), CommandError>,
    ) -> CommandResult {
        let Some(path) = arguments.output.as_deref() else {
            write(&mut Output { to: console.out, path: None })?;
            return Ok(Exit::Success);
        };
        let mut buffer = BufWriter::new(OutputFile::create(path, arguments.overwrite, &[&arguments.file])?);
        write(&mut Output { to: &mut buffer, path: Some(path) })?;
        let file = buffer.into_inner().map_err(|error| CommandError::write(path)(error.into_error()))?;
        file.publish(console)?;
        Ok(Exit::Success)
    }

    pub(super) fn line(&mut self, line: &str) -> Result<(), CommandError> {
        writeln!(self.to, "{line}").map_err(|error| explain(self.path, error))
    }

    /// The stream, and a function that wraps its errors.
    pub(super) fn parts(&mut self) -> (&mut dyn Write, impl Fn(io::Error) -> CommandError) {
        let path = self.path;
        (self.to, move |error| explain(path, error))
    }
}

fn explain(path: Option<&Path>, error: io::Error) -> CommandError {
    match path {
        Some(path) => CommandError::write(path)(error),
        None => CommandError::Output(error),
    }
}
