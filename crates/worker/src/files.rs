//! Reading the bytes of a job.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use async_nats::jetstream::object_store::ObjectStore;
use tokio::io::AsyncReadExt;

use crate::job::Job;

/// Reads at most `bytes_max + 1` bytes of a file below `folder`.
pub(crate) fn read_path(folder: &Path, file: &str, bytes_max: u64) -> io::Result<Vec<u8>> {
    let path = inside(Path::new(file)).ok_or(io::Error::other("the path leads out of the folder"))?;
    let path = folder.join(path);
    // Only regular files are opened: opening a pipe would block.
    if !path.metadata()?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(bytes_max.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads at most `bytes_max + 1` bytes of an object.
pub(crate) async fn read_object(store: &ObjectStore, name: &str, bytes_max: u64) -> io::Result<Vec<u8>> {
    let object = store.get(name).await.map_err(io::Error::other)?;
    let mut bytes = Vec::new();
    object.take(bytes_max.saturating_add(1)).read_to_end(&mut bytes).await?;
    Ok(bytes)
}

/// Returns the bytes if their digest is that of the job. If the file is larger than `bytes_max`, only its beginning was
/// read, so the digest is not compared.
pub(crate) fn check(job: &Job, bytes: Vec<u8>, bytes_max: u64) -> io::Result<Vec<u8>> {
    let is_whole = u64::try_from(bytes.len()).is_ok_and(|length| length <= bytes_max);
    if is_whole && blake3::hash(&bytes).to_hex().as_str() != job.blake3 {
        return Err(io::Error::other("the file is not the one that was submitted"));
    }
    Ok(bytes)
}

/// The path, if it is relative and does not lead out of its folder.
pub(crate) fn inside(path: &Path) -> Option<PathBuf> {
    let is_inside = |component| matches!(component, Component::Normal(_) | Component::CurDir);
    (path.components().all(is_inside) && path.file_name().is_some()).then(|| path.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_cannot_lead_out_of_the_folder() {
        for path in ["a.replay", "./a/b.replay", "a/./b"] {
            assert!(inside(Path::new(path)).is_some(), "{path}");
        }
        for path in ["", ".", "/a", "../a", "a/../../b", "a/.."] {
            assert!(inside(Path::new(path)).is_none(), "{path}");
        }
    }
}
