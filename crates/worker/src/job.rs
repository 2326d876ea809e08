//! [`Job`]: a file to verify, as it is encoded in the queue.

use serde::{Deserialize, Serialize};

/// A file to verify.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Job {
    /// The name in the result, and the path if the file is in a folder or bucket.
    pub(crate) file: String,
    pub(crate) source: Source,
    /// BLAKE3 of the file: 64 hexadecimal digits.
    pub(crate) blake3: String,
}

/// Location of the bytes for a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Source {
    /// The file is in the folder of the worker.
    Folder,
    /// The file is in the object store of the queue, under its BLAKE3.
    Object,
    /// The file is in the bucket of the worker.
    Bucket,
}

impl Job {
    pub(crate) fn digest(&self) -> Option<[u8; 32]> {
        blake3::Hash::from_hex(&self.blake3).ok().map(Into::into)
    }
}
