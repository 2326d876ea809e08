//! [`Tasks`]: the files to verify, listed on demand.

use std::fs;
use std::path::{Path, PathBuf};

use super::shard::Shard;
use crate::error::CommandError;
use crate::walk::Walk;

/// The argument that stands for the standard input.
pub(super) const INPUT: &str = "-";

/// Iterator over the files that the arguments name, and over the errors in finding them, in the order of the arguments.
pub(super) struct Tasks<'a> {
    arguments: std::slice::Iter<'a, PathBuf>,
    shard: Shard,
    folder: Option<FolderTasks<'a>>,
    is_input_taken: bool,
}

struct FolderTasks<'a> {
    path: &'a Path,
    walk: Walk,
    /// Whether a file or an error was found, in this shard or another one.
    is_any: bool,
}

impl<'a> Tasks<'a> {
    pub(super) fn new(arguments: &'a [PathBuf], shard: Shard) -> Self {
        Tasks { arguments: arguments.iter(), shard, folder: None, is_input_taken: false }
    }

    /// Returns the task of an argument that is a file, with any extension, if the file is in the shard. If the argument
    /// is a folder, sets `self.folder` and returns `None`.
    fn open(&mut self, path: &'a Path) -> Option<Result<PathBuf, CommandError>> {
        if path.as_os_str() == INPUT {
            let again = std::mem::replace(&mut self.is_input_taken, true);
            if again {
                return Some(Err(CommandError::InputTwice));
            }
            return self.shard.takes(path).then(|| Ok(path.to_path_buf()));
        }
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => {
                self.folder = Some(FolderTasks { path, walk: Walk::new(path), is_any: false });
                None
            }
            Ok(_) => {
                let name = path.file_name().map_or(path, Path::new);
                self.shard.takes(name).then(|| Ok(path.to_path_buf()))
            }
            Err(error) => Some(Err(CommandError::read(path)(error))),
        }
    }
}

impl FolderTasks<'_> {
    fn next(&mut self, shard: Shard) -> Option<Result<PathBuf, CommandError>> {
        for found in self.walk.by_ref() {
            self.is_any = true;
            match found {
                Ok(path) if !shard.takes(path.strip_prefix(self.path).unwrap_or(&path)) => {}
                Ok(path) => return Some(Ok(path)),
                Err(error) => return Some(Err(CommandError::read(&error.path)(error.error))),
            }
        }
        let is_empty = !std::mem::replace(&mut self.is_any, true);
        is_empty.then(|| Err(CommandError::NothingToVerify { path: self.path.to_path_buf() }))
    }
}

impl Iterator for Tasks<'_> {
    type Item = Result<PathBuf, CommandError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(folder) = &mut self.folder {
                if let Some(task) = folder.next(self.shard) {
                    return Some(task);
                }
                self.folder = None;
            }
            let argument = self.arguments.next()?;
            if let Some(task) = self.open(argument) {
                return Some(task);
            }
        }
    }
}
