//! [`Cache`]: a folder of reports, so that a file with a cached verdict is not played again.

use std::fs::{self, File};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use blake3::Hash;
use lockstep2d::lockstep::RulesId;
use lockstep2d::replay::{FORMAT_VERSION, Limits};
use serde::{Deserialize, Serialize};

use super::report::Report;
use crate::console::json_text;

/// Version of the cache, which is part of every key. Increment it if the meaning of an entry changes, or if this
/// program gives another verdict than an earlier one for the same bytes, rules and semantics.
const VERSION: u32 = 3;

/// Maximum number of bytes that are read of an entry. An entry with the maximum number of claims (256) is smaller.
const ENTRY_BYTES_MAX: u64 = 1 << 20;

/// A folder with a file for each report. The name of each file is a hash of everything that its report depends on.
///
/// Processes may share the folder, also on several machines. An entry is renamed into place when it is complete, so no
/// process reads a part of it. If several processes write the same entry, they write the same bytes. A damaged entry
/// counts as absent.
pub(super) struct Cache {
    folder: PathBuf,
    /// Hash of the versions, the rules and the limits, which is part of every key.
    context: Hash,
}

#[derive(Serialize, Deserialize)]
struct Entry {
    report: Report,
    /// Hash of the key and the report. It detects a damaged or renamed file.
    checksum: String,
}

impl Cache {
    /// Opens the cache, and creates its folder if needed.
    pub(super) fn open(folder: &Path, rules: RulesId, limits: &Limits) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        Ok(Cache { folder: folder.to_path_buf(), context: context(rules, limits) })
    }

    pub(super) fn key(&self, bytes: &Hash) -> Hash {
        key(&self.context, bytes.as_bytes())
    }

    /// The cached report of a key. `None` if there is no entry, or if it is damaged.
    pub(super) fn get(&self, key: &Hash) -> Option<Report> {
        let (mut text, path) = (String::new(), self.path(key));
        // Only regular files are read: reading a pipe would block.
        if !fs::metadata(&path).ok()?.is_file() {
            return None;
        }
        File::open(path).ok()?.take(ENTRY_BYTES_MAX).read_to_string(&mut text).ok()?;
        let entry: Entry = serde_json::from_str(&text).ok()?;
        // The checksum covers only the decoded report. The comparison of the text also finds damage that does not
        // change the report, such as an added space.
        let is_whole = serde_json::to_string(&entry).ok()? == text;
        (is_whole && entry.checksum == checksum(key, &entry.report)).then_some(entry.report)
    }

    pub(super) fn put(&self, key: &Hash, report: Report) -> io::Result<()> {
        let entry = Entry { checksum: checksum(key, &report), report };
        let text = serde_json::to_string(&entry)?;
        let unique = RandomState::new().build_hasher().finish();
        let draft = self.folder.join(format!(".{key}.{unique:016x}.tmp"));
        let written = File::create_new(&draft)
            .and_then(|mut file| file.write_all(text.as_bytes()))
            .and_then(|()| fs::rename(&draft, self.path(key)));
        if written.is_err() {
            let _ = fs::remove_file(&draft);
        }
        written
    }

    fn path(&self, key: &Hash) -> PathBuf {
        self.folder.join(format!("{key}.json"))
    }
}

pub(super) fn key(context: &Hash, bytes: &[u8; 32]) -> Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(context.as_bytes()).update(bytes);
    hasher.finalize()
}

/// Hash of everything that a verdict depends on, except the file's bytes.
pub(super) fn context(rules: RulesId, limits: &Limits) -> Hash {
    // All fields are named, so that this code does not compile if a limit is added and not hashed.
    let Limits {
        file_bytes,
        setup_bytes,
        players,
        block_bytes,
        block_ticks,
        ticks,
        bodies,
        tick_work,
        total_work,
    } = *limits;
    let name = rules.name.as_bytes();
    let numbers = [
        VERSION.into(),
        FORMAT_VERSION.into(),
        lockstep2d::SEMANTICS.into(),
        rules.version.into(),
        file_bytes,
        setup_bytes.into(),
        players.into(),
        block_bytes.into(),
        block_ticks.into(),
        ticks,
        bodies,
        tick_work,
        total_work,
    ];
    let mut hasher = blake3::Hasher::new();
    hasher.update(b"lockstep2d verify cache");
    for number in numbers {
        hasher.update(&number.to_le_bytes());
    }
    // The name comes last, because it is the only part of variable length.
    hasher.update(name);
    hasher.finalize()
}

fn checksum(key: &Hash, report: &Report) -> String {
    let text = json_text(report);
    let mut hasher = blake3::Hasher::new();
    hasher.update(key.as_bytes()).update(text.as_bytes());
    hasher.finalize().to_string()
}
