//! Finding and reading replay files, without trusting their size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

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
