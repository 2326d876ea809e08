//! `submit`: adds files to the queue.

use std::fs::File;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};

use async_nats::jetstream::object_store::ObjectStore;
use futures_util::stream::{self, BoxStream, StreamExt, TryStreamExt};
use lockstep2d::lockstep::RulesId;
use lockstep2d_cli::Walk;
use serde::Serialize;

use crate::app::SubmitArguments;
use crate::bucket::Bucket;
use crate::error::WorkerError;
use crate::files::inside;
use crate::job::{Job, Source};
use crate::queue::{Added, Queue, json, retry};

/// Number of files that are submitted at the same time. With fewer, the rate would be limited by the wait for each
/// acknowledgement.
const AT_ONCE: usize = 16;

/// Names of files, as in jobs and results.
pub(crate) type Names<'a> = BoxStream<'a, Result<String, WorkerError>>;

#[derive(Serialize)]
struct Line<'a> {
    file: &'a str,
    blake3: &'a str,
    /// Whether the job is new. Files with the same bytes are one job.
    queued: bool,
}

enum Files {
    /// The files are in the folders of the workers, at the same paths as here.
    Folder,
    /// The files are in the file system of this command. Workers read them from the object store of the queue.
    Objects(Box<ObjectStore>),
    Bucket(Bucket),
}

/// Adds the files, and prints a line for each.
pub(crate) async fn run(arguments: &SubmitArguments, rules: RulesId) -> Result<(), WorkerError> {
    let queue = Queue::open(&arguments.connection, rules).await?;
    let files = match &arguments.bucket {
        Some(url) => Files::Bucket(Bucket::open(url)?),
        None if arguments.objects => Files::Objects(Box::new(queue.files().await?)),
        None => Files::Folder,
    };
    let whole = [PathBuf::new()];
    let paths = if arguments.paths.is_empty() { &whole } else { arguments.paths.as_slice() };
    let names = stream::iter(paths).then(|path| replays(&files, path)).try_flatten();
    let lines = names.map(|name| submit(&queue, &files, name)).buffered(AT_ONCE);
    lines.try_for_each(|line| async move { print(&line) }).await
}

fn print(line: &str) -> Result<(), WorkerError> {
    std::io::stdout().write_all(format!("{line}\n").as_bytes()).map_err(WorkerError::Output)
}

/// The file at `path`. If `path` is a folder, the replays in it.
async fn replays<'a>(files: &'a Files, path: &'a Path) -> Result<Names<'a>, WorkerError> {
    if let Files::Bucket(bucket) = files {
        return bucket.replays(path.to_str().ok_or_else(|| no_name(path))?).await;
    }
    let name = |path: PathBuf| path.to_str().map(String::from).ok_or_else(|| no_name(&path));
    if !path.is_dir() {
        return Ok(stream::iter([name(path.to_path_buf())]).boxed());
    }
    let mut walk = Walk::new(path)
        .map(move |found| match found {
            Ok(path) => name(path),
            Err(error) => Err(WorkerError::Read { path: error.path, error: error.error }),
        })
        .peekable();
    if walk.peek().is_none() {
        return Err(WorkerError::NothingToSubmit { path: path.to_path_buf() });
    }
    Ok(stream::iter(walk).boxed())
}

fn no_name(path: &Path) -> WorkerError {
    WorkerError::Path { path: path.to_path_buf() }
}

async fn submit(
    queue: &Queue,
    files: &Files,
    name: Result<String, WorkerError>,
) -> Result<String, WorkerError> {
    let name = name?;
    let path = Path::new(&name);
    let (source, blake3) = match files {
        Files::Folder => {
            inside(path).ok_or_else(|| no_name(path))?;
            (Source::Folder, blake3_of(path)?)
        }
        Files::Objects(store) => {
            let blake3 = blake3_of(path)?;
            upload(store, path, &blake3).await?;
            (Source::Object, blake3)
        }
        Files::Bucket(bucket) => (Source::Bucket, bucket.blake3(&name).await?),
    };
    let job = Job { file: name, source, blake3 };
    let queued = queue.submit(&job).await? == Added::New;
    Ok(json(&Line { file: &job.file, blake3: &job.blake3, queued }))
}

/// BLAKE3 digest of a file, in 64 hexadecimal digits.
fn blake3_of(path: &Path) -> Result<String, WorkerError> {
    let failed = WorkerError::read(path);
    let mut hasher = blake3::Hasher::new();
    std::io::copy(&mut BufReader::new(File::open(path).map_err(&failed)?), &mut hasher).map_err(&failed)?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// Adds a file to the object store, unless the store already has it.
async fn upload(store: &ObjectStore, path: &Path, blake3: &str) -> Result<(), WorkerError> {
    if store.info(blake3).await.is_ok_and(|info| !info.deleted) {
        return Ok(());
    }
    let bytes = std::fs::read(path).map_err(WorkerError::read(path))?;
    // If the file has changed since its digest was computed, the store would keep wrong bytes under this digest.
    if blake3::hash(&bytes).to_hex().as_str() != blake3 {
        return Err(WorkerError::read(path)(std::io::Error::other("the file has changed in the meantime")));
    }
    let put = || async { store.put(blake3, &mut bytes.as_slice()).await };
    retry("store a file", put).await.map(|_| ())
}
