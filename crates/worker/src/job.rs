//! [`Job`]: a file to verify, as encoded in the queue.

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Job {
    /// Name of the file in the result, and its path in a folder or bucket.
    pub(crate) file: String,
    pub(crate) source: Source,
    /// BLAKE3 digest of the file, in 64 hexadecimal digits.
    pub(crate) blake3: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Source {
    /// The file is in the folder of the worker.
    Folder,
    /// The file is in the object store of the queue. Its BLAKE3 digest is the name of the object.
    Object,
    /// The file is in the bucket of the worker.
    Bucket,
}

impl Job {
    pub(crate) fn digest(&self) -> Option<[u8; 32]> {
        blake3::Hash::from_hex(&self.blake3).ok().map(Into::into)
    }
}
