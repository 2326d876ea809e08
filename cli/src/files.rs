//! Finding and reading replay files, without trusting their size.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::error::CommandError;

/// The extension of replay files in folders.
pub(crate) const EXTENSION: &str = "replay";

/// The files that a path stands for: itself, or the replays in the folder and all folders in it, sorted.
///
/// A file that is named is taken whatever its extension.
pub(crate) fn find(path: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    if fs::metadata(path)?.is_dir() {
        collect(path, &mut files)?;
        files.sort();
    } else {
        files.push(path.to_path_buf());
    }
    Ok(files)
}

/// Links to folders are not followed: they may lead in circles. Neither is what is no regular file read: a pipe
/// that is named like a replay would wait for ever.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_type()?.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == EXTENSION)
            && fs::metadata(&path)?.is_file()
        {
            files.push(path);
        }
    }
    Ok(())
}

/// The bytes of a file, but at most one more than `bytes_max`, which is enough to see that it is too large.
pub(crate) fn read(path: &Path, bytes_max: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(bytes_max.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The bytes of a file that a command cannot do without; see [`read`].
pub(crate) fn load(path: &Path, bytes_max: u64) -> Result<Vec<u8>, CommandError> {
    read(path, bytes_max).map_err(|error| CommandError::Read { path: path.to_path_buf(), error })
}

/// Writes a file.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> Result<(), CommandError> {
    fs::write(path, bytes).map_err(|error| CommandError::Write { path: path.to_path_buf(), error })
}

/// A path for a line of text: a name with a line break in it must not pass for a line of its own.
pub(crate) struct Shown<'a>(pub(crate) &'a Path);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.display().to_string().chars() {
            if character.is_control() {
                write!(f, "{}", character.escape_default())?;
            } else {
                write!(f, "{character}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_break_in_a_name_is_shown_escaped() {
        let name = Path::new("a\n9 of 9 files match\u{1b}[2J ü.replay");
        assert_eq!(Shown(name).to_string(), "a\\n9 of 9 files match\\u{1b}[2J ü.replay");
    }
}
