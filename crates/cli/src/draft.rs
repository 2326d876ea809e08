//! [`Draft`]: a temporary file that replaces its target when all of it is written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::CommandError;
use crate::files;

/// A file that is being written. It is deleted when the value is dropped, unless it was published.
pub(crate) struct Draft {
    /// The path to write to.
    pub(crate) at: PathBuf,
    is_own: bool,
}

impl Draft {
    /// The draft for the file at `path`, in the same folder.
    pub(crate) fn of(path: &Path) -> Self {
        // A target that is not a regular file, such as /dev/stdout, is written directly.
        let is_own = !fs::metadata(path).is_ok_and(|there| !there.is_file());
        let mut at = path.to_path_buf().into_os_string();
        if is_own {
            at.push(".unfinished");
        }
        Draft { at: at.into(), is_own }
    }

    /// Renames the draft to `path`.
    pub(crate) fn publish(mut self, path: &Path) -> io::Result<()> {
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

/// Writes a file through a draft: a run that fails or is interrupted leaves the old file.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), CommandError> {
    let draft = Draft::of(path);
    files::save(&draft.at, bytes)?;
    draft.publish(path).map_err(CommandError::write(path))
}
