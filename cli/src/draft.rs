//! [`Draft`]: a file that appears when all of it is written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::CommandError;
use crate::files;

/// A file that is being written, gone with the value unless it was published.
pub(crate) struct Draft {
    /// Where to write it.
    pub(crate) at: PathBuf,
    is_own: bool,
}

impl Draft {
    /// The draft of the file at `path`, in its folder.
    pub(crate) fn of(path: &Path) -> Self {
        // What is no file, such as /dev/stdout, cannot be replaced by one.
        let is_own = !fs::metadata(path).is_ok_and(|there| !there.is_file());
        let mut at = path.to_path_buf().into_os_string();
        if is_own {
            at.push(".unfinished");
        }
        Draft { at: at.into(), is_own }
    }

    /// Puts the draft in the place of the file at `path`.
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

/// Writes a file in one piece: a run that fails or is interrupted leaves the old one.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), CommandError> {
    let draft = Draft::of(path);
    files::save(&draft.at, bytes)?;
    draft.publish(path).map_err(CommandError::write(path))
}
