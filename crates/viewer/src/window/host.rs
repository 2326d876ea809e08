//! [`Host`]: file access and frame pacing on a desktop.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::{App, Event, Request};

use super::WindowError;

pub(super) struct Host {
    output: Option<PathBuf>,
}

impl Host {
    pub(super) fn new(output: Option<PathBuf>) -> Self {
        Host { output }
    }

    /// Writes the files that the viewer wants to save. A failed write is shown as a message, so that a full disk does
    /// not end the session.
    pub(super) fn serve(&self, app: &mut App) -> Result<(), WindowError> {
        if let Err(error) = self.save(app) {
            app.tell(format!("not saved: {error}"));
        }
        Ok(())
    }

    /// Called when the program ends. If the command line names an output file, saves the recording there. Otherwise
    /// writes the files that the viewer still wants to save.
    pub(super) fn finish(&self, app: &mut App) -> Result<(), WindowError> {
        let Some(path) = &self.output else { return self.save(app) };
        app.save();
        let requests = app.take_requests();
        if requests.is_empty() {
            let error = io::Error::other(app.message().unwrap_or("nothing to save"));
            return Err(WindowError::File { path: path.display().to_string(), error });
        }
        self.fulfil(app, requests)
    }

    fn save(&self, app: &mut App) -> Result<(), WindowError> {
        let requests = app.take_requests();
        self.fulfil(app, requests)
    }

    fn fulfil(&self, app: &mut App, requests: Vec<Request>) -> Result<(), WindowError> {
        for Request::Save { name, bytes } in requests {
            let named = self.output.clone().unwrap_or_else(|| name.clone().into());
            let failed = |error| WindowError::File { path: named.display().to_string(), error };
            let path = match &self.output {
                Some(path) => replace(path, &bytes).map(|()| path.clone()),
                None => save_as_new(&name, &bytes),
            };
            let path = path.map_err(failed)?;
            eprintln!("{} written", path.display());
            // The viewer's message begins with the name that it requested. The message should name the file that was
            // written.
            if let Some(rest) = app.message().and_then(|message| message.strip_prefix(&name)) {
                app.tell(format!("{}{rest}", path.display()));
            }
        }
        Ok(())
    }

    pub(super) fn open(&self, app: &mut App, name: String, bytes: Vec<u8>) {
        app.handle(Event::Dropped { name, bytes });
    }

    /// Sleeps if the display does not limit the frame rate, which is the case for a virtual display. `elapsed` is the
    /// time since the last frame in seconds.
    pub(super) fn pace(&self, elapsed: f64) {
        /// If a frame takes less than this time, in seconds, the display does not limit the frame rate.
        const HASTE: f64 = 1.0 / 250.0;
        if elapsed < HASTE {
            std::thread::sleep(Duration::from_secs_f64(1.0 / 60.0 - elapsed));
        }
    }
}

/// Replaces a file atomically. A pipe or device is written directly.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.exists() && !path.is_file() {
        return fs::write(path, bytes);
    }
    let beside = write_beside(path, bytes)?;
    fs::rename(&beside, path).inspect_err(|_| remove(&beside))
}

/// Writes a new file and returns its path. If `name` exists, a number is added to the name.
fn save_as_new(name: &str, bytes: &[u8]) -> io::Result<PathBuf> {
    let beside = write_beside(Path::new(name), bytes)?;
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, "replay"));
    let numbered = (2..1000).map(|number| format!("{stem}-{number}.{ending}"));
    let mut outcome = Err(io::ErrorKind::AlreadyExists.into());
    for path in std::iter::once(name.to_owned()).chain(numbered).map(PathBuf::from) {
        outcome = link_or_write(&beside, &path, bytes).map(|()| path);
        if !outcome.as_ref().is_err_and(|error| error.kind() == io::ErrorKind::AlreadyExists) {
            break;
        }
    }
    remove(&beside);
    outcome
}

/// Creates a hard link `name` to `file`. Unlike a rename, this fails if `name` exists. If the file system has no hard
/// links, writes `bytes` to a new file instead.
fn link_or_write(file: &Path, name: &Path, bytes: &[u8]) -> io::Result<()> {
    match fs::hard_link(file, name) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
            fill(File::create_new(name)?, name, bytes)
        }
        outcome => outcome,
    }
}

/// Writes a temporary file in the folder of `path`, and returns its path.
fn write_beside(path: &Path, bytes: &[u8]) -> io::Result<PathBuf> {
    let mut beside = path.to_path_buf().into_os_string();
    beside.push(format!(".{}.unfinished", std::process::id()));
    let beside = PathBuf::from(beside);
    fill(File::create(&beside)?, &beside, bytes)?;
    Ok(beside)
}

/// Writes all bytes to `file`, a new file at `path`. After an error, the file is removed.
fn fill(mut file: File, path: &Path, bytes: &[u8]) -> io::Result<()> {
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    // Windows cannot remove an open file.
    drop(file);
    written.inspect_err(|_| remove(path))
}

/// Removes a file that is no longer needed. Errors are ignored, because a remaining file does no harm.
fn remove(path: &Path) {
    let _removed = fs::remove_file(path);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_file_is_lost() {
        let folder = std::env::temp_dir().join(format!("lockstep2d-viewer-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let first = folder.join("pile.replay");
        let name = first.to_str().unwrap();
        assert_eq!(save_as_new(name, b"one").unwrap(), first);
        assert_eq!(save_as_new(name, b"two").unwrap(), folder.join("pile-2.replay"));
        assert_eq!(fs::read(&first).unwrap(), b"one");
        replace(&first, b"three").unwrap();
        assert_eq!(fs::read(&first).unwrap(), b"three");
        assert!(save_as_new(folder.join("none/a.replay").to_str().unwrap(), b"").is_err());
        // A file that was opened for reading cannot be written, like a file on a full disk.
        fs::write(folder.join("cut.replay"), b"").unwrap();
        let full = File::open(folder.join("cut.replay")).unwrap();
        assert!(fill(full, &folder.join("cut.replay"), b"bytes").is_err());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "no unfinished file is left");
        fs::remove_dir_all(&folder).unwrap();
    }
}
