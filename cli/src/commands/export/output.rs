//! [`Output`]: where results go, which in a file are whole or not there.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::console::Console;
use crate::error::CommandError;
use crate::exit::Exit;

/// Where results go, and what a failure to write them is.
pub(super) struct Output<'a> {
    to: &'a mut dyn Write,
    path: Option<&'a Path>,
}

impl Output<'_> {
    /// Has something written to a file, or to the standard output. A file appears when all of it is written: whoever
    /// fails or is interrupted leaves what was there before.
    pub(super) fn write(
        path: Option<&Path>,
        console: &mut Console<'_>,
        write: impl FnOnce(&mut Output<'_>) -> Result<(), CommandError>,
    ) -> Result<Exit, CommandError> {
        let Some(path) = path else {
            write(&mut Output { to: console.out, path: None })?;
            return Ok(Exit::Success);
        };
        let draft = Draft::of(path);
        let failed = |error| CommandError::Write { path: path.to_path_buf(), error };
        let mut buffer = BufWriter::new(File::create(&draft.at).map_err(failed)?);
        write(&mut Output { to: &mut buffer, path: Some(path) })?;
        let file = buffer.into_inner().map_err(|error| failed(error.into_error()))?;
        drop(file);
        draft.publish(path).map_err(failed)?;
        Ok(Exit::Success)
    }

    pub(super) fn line(&mut self, line: &str) -> Result<(), CommandError> {
        writeln!(self.to, "{line}").map_err(|error| explain(self.path, error))
    }

    /// Where to write bytes, and what a failure to do so is.
    pub(super) fn parts(&mut self) -> (&mut dyn Write, impl Fn(io::Error) -> CommandError) {
        let path = self.path;
        (self.to, move |error| explain(path, error))
    }
}

fn explain(path: Option<&Path>, error: io::Error) -> CommandError {
    match path {
        Some(path) => CommandError::Write { path: path.to_path_buf(), error },
        None => CommandError::Output(error),
    }
}

/// A file that is being written, gone with the value unless it was published.
struct Draft {
    at: PathBuf,
    is_own: bool,
}

impl Draft {
    fn of(path: &Path) -> Self {
        // What is no file, such as /dev/stdout, cannot be replaced by one.
        let is_own = !fs::metadata(path).is_ok_and(|there| !there.is_file());
        let mut at = path.to_path_buf().into_os_string();
        if is_own {
            at.push(".unfinished");
        }
        Draft { at: at.into(), is_own }
    }

    fn publish(mut self, path: &Path) -> io::Result<()> {
        if self.is_own {
            fs::rename(&self.at, path)?;
            self.is_own = false;
        }
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if self.is_own {
            let _ = fs::remove_file(&self.at);
        }
    }
}
