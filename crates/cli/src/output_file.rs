//! [`OutputFile`]: a file that is written beside its target and renamed when it is complete.
//!
//! Invariants, for a target that is a regular file or does not exist:
//! - The target has either its old contents or all of its new contents, also after a full disk, a panic or a kill.
//! - An existing file is replaced only with `--force` or [`Overwrite::ALWAYS`]. On a file system without hard links, a
//!   file that another program creates just before [`OutputFile::publish`] can still be replaced.
//! - If the file system has locks, one process at a time writes a target. The others fail.
//! - On Unix, a private file can be read only by its owner.
//! - An input that is the temporary file of a killed process is left unchanged.
//!
//! A killed process leaves its temporary file. The next writer of the target reuses this file, unless a hard link gives
//! it a second name.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::mem;
use std::path::{Path, PathBuf};

use clap::Args;
use same_file::Handle;

use crate::console::Console;
use crate::error::CommandError;

/// Suffix of the temporary file.
const SUFFIX: &str = ".unfinished";

#[cfg(unix)]
const OWNER_ONLY: u32 = 0o600;

/// Maximum number of attempts to lock a file that other processes keep renaming or deleting.
const ATTEMPTS_MAX: u32 = 100;

/// Maximum number of symbolic links from a path to its file, as on Linux.
const LINKS_MAX: u32 = 40;

/// Whether an existing file is replaced.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Overwrite {
    /// Replace the output file if it exists; it may be the input file
    #[arg(long)]
    pub(crate) force: bool,
}

impl Overwrite {
    /// For files that only the tool writes, such as keyframes: an existing file is replaced.
    pub(crate) const ALWAYS: Overwrite = Overwrite { force: true };
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Readers {
    Default,
    Owner,
}

/// A file to write. If it is dropped before it is published, its temporary file is deleted.
pub(crate) struct OutputFile {
    /// Path given by the user, for messages.
    name: PathBuf,
    /// `name` with its symbolic links resolved.
    target: PathBuf,
    /// Path of the temporary file. `None` if the target is written directly.
    temporary: Option<PathBuf>,
    /// The open file. It is locked, unless the target is written directly or the file system has no locks.
    file: File,
    overwrite: Overwrite,
    /// If an input is the file at the usual temporary path, this input. Its lock keeps other writers from the target.
    _input: Option<File>,
}

impl OutputFile {
    /// Creates the temporary file of a target. Call it before long computations, so that errors are reported early.
    /// Fails if the target exists and `--force` is not set, or if another process writes the target.
    ///
    /// The standard output and a target that is not a regular file are written directly. `inputs` are never used as
    /// temporary files.
    pub(crate) fn create(path: &Path, overwrite: Overwrite, inputs: &[&Path]) -> Result<Self, CommandError> {
        Self::create_for(path, overwrite, inputs, Readers::Default)
    }

    /// Creates a file that only its owner can read, on Unix: see [`OutputFile::create`].
    pub(crate) fn create_private(path: &Path, overwrite: Overwrite) -> Result<Self, CommandError> {
        Self::create_for(path, overwrite, &[], Readers::Owner)
    }

    fn create_for(
        path: &Path,
        overwrite: Overwrite,
        inputs: &[&Path],
        readers: Readers,
    ) -> Result<Self, CommandError> {
        let failed = CommandError::write(path);
        let name = path.to_path_buf();
        if let Some(file) = standard_output(path) {
            let target = name.clone();
            return Ok(OutputFile { name, target, temporary: None, file, overwrite, _input: None });
        }
        check(path, overwrite)?;
        // A symbolic link is preserved. The file that it refers to is replaced.
        let target = fs::canonicalize(path).unwrap_or_else(|_| end_of_links(path));
        match fs::metadata(&target) {
            Ok(metadata) if !metadata.is_file() => {
                let file = File::options().write(true).open(&target).map_err(failed)?;
                return Ok(OutputFile { name, target, temporary: None, file, overwrite, _input: None });
            }
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(failed(error)),
        }
        let mut temporary = unfinished(&target);
        let mut file = lock(&temporary, &name, inputs, readers)?;
        let mut input = None;
        if inputs.iter().any(|input| is_at(&file, input)) {
            temporary = unfinished(&temporary);
            // The file with the usual temporary name stays locked, too, because this lock keeps other writers from the
            // target.
            input = Some(mem::replace(&mut file, lock(&temporary, &name, inputs, readers)?));
        }
        let output = OutputFile { name, target, temporary: Some(temporary), file, overwrite, _input: input };
        // Another writer may have held the lock until now, and published the target.
        check(path, overwrite)?;
        output.file.set_len(0).map_err(failed)?;
        Ok(output)
    }

    pub(crate) fn append(&mut self, bytes: &[u8]) -> Result<(), CommandError> {
        self.file.write_all(bytes).map_err(CommandError::write(&self.name))
    }

    /// Makes the file appear under its name, after its bytes have reached the disk. Without `--force`, fails if another
    /// program has created the target meanwhile. If the target is the standard output, `console` writes all later lines
    /// to the message stream.
    pub(crate) fn publish(mut self, console: &mut Console<'_>) -> Result<(), CommandError> {
        let failed = CommandError::write(&self.name);
        let Some(temporary) = &self.temporary else {
            console.is_out_taken |= is_same(&self.file, Handle::stdout());
            return self.file.flush().map_err(failed);
        };
        self.file.sync_all().map_err(&failed)?;
        if !self.overwrite.force {
            // A hard link never replaces a file, but a rename does. Dropping `self` deletes the temporary name.
            match fs::hard_link(temporary, &self.target) {
                Ok(()) => return Ok(()),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    return Err(CommandError::Exists { path: self.name.clone() });
                }
                // The file system may not support hard links.
                Err(_) => {}
            }
        }
        fs::rename(temporary, &self.target).map_err(failed)?;
        self.temporary = None;
        Ok(())
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        // The file is deleted while it is locked, so no other process can have begun to write it.
        if let Some(temporary) = &self.temporary {
            let _ = fs::remove_file(temporary);
        }
    }
}

/// The path of a file that does not exist yet, with symbolic links to it resolved.
fn end_of_links(path: &Path) -> PathBuf {
    let mut path = path.to_path_buf();
    for _ in 0..LINKS_MAX {
        let Ok(next) = fs::read_link(&path) else { break };
        path = path.parent().map_or_else(|| next.clone(), |parent| parent.join(&next));
    }
    path
}

fn unfinished(path: &Path) -> PathBuf {
    let mut path = path.as_os_str().to_os_string();
    path.push(SUFFIX);
    path.into()
}

/// Fails for an existing regular file if `--force` is not set. A path that names the standard output is allowed, even
/// if the standard output is such a file.
pub(crate) fn check(path: &Path, overwrite: Overwrite) -> Result<(), CommandError> {
    let exists = || fs::metadata(path).is_ok_and(|metadata| metadata.is_file());
    if !overwrite.force && exists() && standard_output(path).is_none() {
        return Err(CommandError::Exists { path: path.to_path_buf() });
    }
    Ok(())
}

/// A duplicate of the handle of the standard output, if `path` names the same file, as `/dev/stdout` does. If the path
/// were opened instead, a redirected output would be overwritten from its start.
#[cfg(unix)]
fn standard_output(path: &Path) -> Option<File> {
    use std::os::fd::AsFd;
    use std::os::unix::fs::MetadataExt;
    let file = File::from(io::stdout().as_fd().try_clone_to_owned().ok()?);
    // The path is not opened for the comparison, because opening a pipe could block.
    let identity = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    let is_there = identity(fs::metadata(path).ok()?) == identity(file.metadata().ok()?);
    is_there.then_some(file)
}

#[cfg(not(unix))]
fn standard_output(_: &Path) -> Option<File> {
    None
}

/// Opens and locks the temporary file. `name` is for messages.
fn lock(temporary: &Path, name: &Path, inputs: &[&Path], readers: Readers) -> Result<File, CommandError> {
    let failed = CommandError::write(name);
    for _ in 0..ATTEMPTS_MAX {
        // Fails for a link or a pipe of this name: writing to a link could change another file, and a pipe could block.
        if fs::symlink_metadata(temporary).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(failed(io::ErrorKind::AlreadyExists.into()));
        }
        let file = open(temporary, readers).map_err(&failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(CommandError::Busy { path: name.to_path_buf() }),
            // The file system has no locks. Two writers of one target are then not detected.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        // Before this process locked the file, the previous writer may have renamed or deleted it.
        if !is_at(&file, temporary) {
            continue;
        }
        // A writer that was killed while it published the file may have left the file under both names.
        let is_input = inputs.iter().any(|input| is_at(&file, input));
        if is_input || !is_published(&file, name).map_err(&failed)? {
            return Ok(file);
        }
        fs::remove_file(temporary).map_err(&failed)?;
    }
    Err(CommandError::Busy { path: name.to_path_buf() })
}

fn open(temporary: &Path, readers: Readers) -> io::Result<File> {
    let mut options = File::options();
    options.write(true).create(true).truncate(false);
    #[cfg(unix)]
    if readers == Readers::Owner {
        use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
        let file = options.mode(OWNER_ONLY).open(temporary)?;
        // A killed process may have left the file with other permissions.
        file.set_permissions(fs::Permissions::from_mode(OWNER_ONLY))?;
        return Ok(file);
    }
    options.open(temporary)
}

/// Whether a temporary file also has another name. On Unix, any name counts; elsewhere, only that of its target.
#[cfg(unix)]
fn is_published(file: &File, _: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    Ok(file.metadata()?.nlink() > 1)
}

#[cfg(not(unix))]
fn is_published(file: &File, target: &Path) -> io::Result<bool> {
    Ok(is_at(file, target))
}

/// Whether `path` names the open file.
fn is_at(file: &File, path: &Path) -> bool {
    is_same(file, Handle::from_path(path))
}

fn is_same(file: &File, other: io::Result<Handle>) -> bool {
    let file = file.try_clone().and_then(Handle::from_file);
    matches!((file, other), (Ok(file), Ok(other)) if file == other)
}

pub(crate) fn save(
    path: &Path,
    bytes: &[u8],
    overwrite: Overwrite,
    inputs: &[&Path],
    console: &mut Console<'_>,
) -> Result<(), CommandError> {
    let mut output = OutputFile::create(path, overwrite, inputs)?;
    output.append(bytes)?;
    output.publish(console)
}
