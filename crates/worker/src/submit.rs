//! `submit`: adds files to the queue.

use std::fs::File;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};

use async_nats::jetstream::object_store::ObjectStore;
use futures_util::stream::{self, StreamExt, TryStreamExt};
use lockstep2d::lockstep::RulesId;
use lockstep2d_cli::Walk;
use serde::Serialize;

use crate::app::Connection;
use crate::error::WorkerError;
use crate::files::inside;
use crate::job::{Job, Source};
use crate::queue::{Added, Queue, json, retry};

/// Files that are submitted at a time, so that the queue limits the speed.
const AT_ONCE: usize = 16;

/// The line of a file that was submitted.
#[derive(Serialize)]
struct Line<'a> {
    file: &'a str,
    blake3: &'a str,
    /// Whether it is new: files with the same bytes are one job.
    queued: bool,
}

/// Submits files, and the replays in folders. Prints a line for each.
pub(crate) async fn run(
    connection: &Connection,
    rules: RulesId,
    paths: &[PathBuf],
    source: Source,
) -> Result<(), WorkerError> {
    let queue = Queue::open(connection, rules).await?;
    let store = match source {
        Source::Object => Some(queue.files().await?),
        Source::Folder => None,
    };
    let tasks = stream::iter(paths.iter().flat_map(|path| replays(path)));
    let submit = |path: Result<PathBuf, WorkerError>| submit(&queue, store.as_ref(), path);
    let lines = tasks.map(submit).buffered(AT_ONCE);
    lines.try_for_each(|line| async move { print(&line) }).await
}

fn print(line: &str) -> Result<(), WorkerError> {
    std::io::stdout().write_all(format!("{line}\n").as_bytes()).map_err(WorkerError::Output)
}

/// The file itself, or the replays in a folder.
fn replays(path: &Path) -> Box<dyn Iterator<Item = Result<PathBuf, WorkerError>> + '_> {
    if !path.is_dir() {
        return Box::new(std::iter::once(Ok(path.to_path_buf())));
    }
    let mut walk = Walk::new(path)
        .map(|found| found.map_err(|error| WorkerError::Read { path: error.path, error: error.error }));
    match walk.next() {
        Some(first) => Box::new(std::iter::once(first).chain(walk)),
        None => Box::new(std::iter::once(Err(WorkerError::NothingToSubmit { path: path.to_path_buf() }))),
    }
}

async fn submit(
    queue: &Queue,
    store: Option<&ObjectStore>,
    path: Result<PathBuf, WorkerError>,
) -> Result<String, WorkerError> {
    let path = path?;
    let no_name = || WorkerError::Path { path: path.clone() };
    let name = path.to_str().ok_or_else(no_name)?;
    let failed = WorkerError::read(&path);
    let mut hasher = blake3::Hasher::new();
    std::io::copy(&mut BufReader::new(File::open(&path).map_err(&failed)?), &mut hasher).map_err(&failed)?;
    let blake3 = hasher.finalize().to_hex().to_string();
    let source = match store {
        Some(store) => {
            upload(store, &path, &blake3).await?;
            Source::Object
        }
        None => {
            inside(&path).ok_or_else(no_name)?;
            Source::Folder
        }
    };
    let job = Job { file: name.into(), source, blake3 };
    let queued = queue.submit(&job).await? == Added::New;
    Ok(json(&Line { file: name, blake3: &job.blake3, queued }))
}

/// Adds a file to the object store, unless it is there.
async fn upload(store: &ObjectStore, path: &Path, blake3: &str) -> Result<(), WorkerError> {
    if store.info(blake3).await.is_ok() {
        return Ok(());
    }
    let bytes = std::fs::read(path).map_err(WorkerError::read(path))?;
    let put = || async { store.put(blake3, &mut bytes.as_slice()).await };
    retry("store a file", put).await.map(|_| ())
}
