//! [`WorkerError`]: the errors that stop a command.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use url::Url;

#[derive(Debug)]
pub(crate) enum WorkerError {
    Start {
        what: &'static str,
        error: io::Error,
    },
    Nats {
        what: &'static str,
        why: String,
    },
    Bucket {
        url: Box<str>,
        error: Box<object_store::Error>,
    },
    Read {
        path: PathBuf,
        error: io::Error,
    },
    /// The path is not relative, leads out of its folder, or is not UTF-8.
    Path {
        path: PathBuf,
    },
    NothingToSubmit {
        path: PathBuf,
    },
    Output(io::Error),
}

impl WorkerError {
    pub(crate) fn nats<E: Error>(what: &'static str) -> impl Fn(E) -> Self {
        move |error| WorkerError::Nats { what, why: error.to_string() }
    }

    pub(crate) fn bucket(url: &Url) -> impl Fn(object_store::Error) -> Self {
        move |error| WorkerError::Bucket { url: url.as_str().into(), error: error.into() }
    }

    pub(crate) fn read(path: &Path) -> impl Fn(io::Error) -> Self {
        move |error| WorkerError::Read { path: path.to_path_buf(), error }
    }
}

impl fmt::Display for WorkerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WorkerError::Start { what, error } => write!(f, "cannot start {what}: {error}"),
            WorkerError::Nats { what, why } => write!(f, "cannot {what}: {why}"),
            WorkerError::Bucket { url, error } => write!(f, "cannot read the bucket {url}: {error}"),
            WorkerError::Read { path, error } => write!(f, "cannot read {path:?}: {error}"),
            WorkerError::Path { path } => {
                write!(f, "{path:?} is not a relative path inside the folder of the workers")
            }
            WorkerError::NothingToSubmit { path } => {
                write!(f, "{path:?}: nothing to submit, no *.replay here")
            }
            WorkerError::Output(error) => write!(f, "cannot write the output: {error}"),
        }
    }
}

impl Error for WorkerError {}
