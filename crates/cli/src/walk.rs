//! [`Walk`]: iterates over the replays in a folder tree, with bounded memory.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::files::EXTENSION;

/// Maximum number of names of a folder that are kept in memory. A larger folder is listed again for each batch of
/// names.
const NAMES_MAX: usize = 4096;

/// Iterator over the replays (`*.replay`) in a folder and its subfolders. They are sorted by path, component by
/// component.
///
/// Links to folders are not followed, because they may form cycles. Only regular files and links to regular files are
/// returned, because reading a pipe would block. A file that is created during the walk is returned once or not at all.
///
/// ```
/// use lockstep2d_cli::{Walk, WalkError};
/// # let folder = std::env::temp_dir().join(format!("walk-{}", std::process::id()));
/// # std::fs::create_dir_all(folder.join("old"))?;
/// # ["b.replay", "old/a.replay", "notes.txt"].iter().try_for_each(|name| std::fs::write(folder.join(name), b""))?;
/// // All replays of a folder. A folder that cannot be listed is skipped with a message.
/// let mut found = vec![];
/// for entry in Walk::new(&folder) {
///     match entry {
///         Ok(path) => found.push(path),
///         Err(WalkError { path, error }) => eprintln!("{}: {error}", path.display()),
///     }
/// }
/// assert_eq!(found, [folder.join("b.replay"), folder.join("old/a.replay")]);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Walk {
    /// The open folders, from the outermost to the current one.
    folders: Vec<Folder>,
    names_max: usize,
}

struct Folder {
    path: PathBuf,
    /// The next names in order. The value tells whether the name belongs to a folder.
    names: BTreeMap<OsString, bool>,
    /// The last name that was returned.
    last: Option<OsString>,
    /// Whether `names` has all remaining replays and subfolders of the folder.
    is_listed: bool,
}

/// A folder that cannot be listed, or an entry whose metadata cannot be read.
#[derive(Debug)]
pub struct WalkError {
    /// Path of the folder or entry.
    pub path: PathBuf,
    /// The error of the system.
    pub error: io::Error,
}

impl Walk {
    /// Begins a walk through a folder.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self::with_names_max(folder, NAMES_MAX)
    }

    fn with_names_max(folder: &Path, names_max: usize) -> Self {
        Walk { folders: vec![Folder::new(folder.to_path_buf())], names_max }
    }
}

impl Iterator for Walk {
    type Item = Result<PathBuf, WalkError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let folder = self.folders.last_mut()?;
            match folder.next(self.names_max) {
                Ok(None) => {
                    self.folders.pop();
                }
                Ok(Some((path, true))) => self.folders.push(Folder::new(path)),
                Ok(Some((path, false))) => match fs::metadata(&path) {
                    Ok(metadata) if metadata.is_file() => return Some(Ok(path)),
                    Ok(_) => {}
                    Err(error) => return Some(Err(WalkError { path, error })),
                },
                Err(error) => {
                    let path = folder.path.clone();
                    self.folders.pop();
                    return Some(Err(WalkError { path, error }));
                }
            }
        }
    }
}

impl Folder {
    fn new(path: PathBuf) -> Self {
        Folder { path, names: BTreeMap::new(), last: None, is_listed: false }
    }

    fn next(&mut self, names_max: usize) -> io::Result<Option<(PathBuf, bool)>> {
        if self.names.is_empty() && !self.is_listed {
            self.list(names_max)?;
        }
        let Some((name, is_folder)) = self.names.pop_first() else {
            return Ok(None);
        };
        let path = self.path.join(&name);
        self.last = Some(name);
        Ok(Some((path, is_folder)))
    }

    /// Lists the folder, and keeps the first `names_max` names after the last returned name.
    fn list(&mut self, names_max: usize) -> io::Result<()> {
        self.is_listed = true;
        for entry in fs::read_dir(&self.path)? {
            let entry = entry?;
            let name = entry.file_name();
            let is_full = self.names.len() >= names_max;
            let is_beyond = is_full && self.names.last_key_value().is_some_and(|(last, _)| name > *last);
            if self.last.as_ref().is_some_and(|last| name <= *last) {
                continue;
            }
            let is_folder = entry.file_type()?.is_dir();
            if !is_folder && Path::new(&name).extension().is_none_or(|extension| extension != EXTENSION) {
                continue;
            }
            self.is_listed &= !is_full;
            if !is_beyond {
                self.names.insert(name, is_folder);
                if is_full {
                    self.names.pop_last();
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(folder: &Path, names_max: usize) -> Vec<PathBuf> {
        let paths = Walk::with_names_max(folder, names_max);
        let paths = paths.map(|path| path.unwrap_or_else(|error| panic!("{}", error.error)));
        paths.map(|path| path.strip_prefix(folder).unwrap().to_path_buf()).collect()
    }

    #[test]
    fn the_order_does_not_depend_on_how_many_names_are_held() {
        let folder = std::env::temp_dir().join(format!("lockstep2d-{}-walk", std::process::id()));
        let mut expected = Vec::new();
        for number in 0..40 {
            let name = match number % 4 {
                0 => format!("{}.replay", number * 7 % 40),
                1 => format!("f{}/{number}.replay", number % 3),
                2 => format!("f{}.replay/x.replay", number * 7 % 40),
                _ => format!("f{}/g/{}", number % 3, number),
            };
            let path = folder.join(&name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, b"").unwrap();
            if name.ends_with(".replay") {
                expected.push(PathBuf::from(name));
            }
        }
        expected.sort();
        for names_max in [1, 2, 3, 7, 1000] {
            assert_eq!(walk(&folder, names_max), expected, "{names_max} at a time");
        }
        fs::remove_dir_all(&folder).unwrap();
        let mut gone = Walk::new(&folder);
        assert!(gone.next().is_some_and(|path| path.is_err_and(|error| error.path == folder)));
        assert!(gone.next().is_none());
    }
}
