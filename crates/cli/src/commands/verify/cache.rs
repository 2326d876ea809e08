//! [`Cache`]: a folder of cached reports, so that a file with a known verdict is not played again.

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

/// Version of the cache. Incremented when the meaning of an entry changes, or when the verdict for the same bytes,
/// rules and semantics changes.
const VERSION: u32 = 1;

/// Maximum number of bytes read from an entry: enough for 256 claims.
const ENTRY_BYTES_MAX: u64 = 1 << 20;

/// A folder with one file for each report, named by a hash of everything that the report depends on.
///
/// Any number of processes may share it, also on several machines: an entry appears complete or not at all, and all
/// writers of an entry write the same bytes. An entry that is damaged or cannot be read counts as absent.
pub(super) struct Cache {
    folder: PathBuf,
    /// Hash of what is the same for all files: versions, rules and limits.
    context: Hash,
}

/// The contents of an entry.
#[derive(Serialize, Deserialize)]
struct Entry {
    report: Report,
    /// Hash of the key and the report. It detects damage, and an entry that was renamed to another key.
    checksum: String,
}

impl Cache {
    /// Opens the cache and creates the folder if it does not exist.
    ///
    /// # Errors
    /// When the folder cannot be created.
    pub(super) fn open(folder: &Path, rules: RulesId, limits: &Limits) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        Ok(Cache { folder: folder.to_path_buf(), context: context(rules, limits) })
    }

    /// The key of the report on a file whose bytes have this digest.
    pub(super) fn key(&self, bytes: &Hash) -> Hash {
        key(&self.context, bytes.as_bytes())
    }

    /// The cached report of a key, if there is an undamaged entry.
    pub(super) fn get(&self, key: &Hash) -> Option<Report> {
        let (mut text, path) = (String::new(), self.path(key));
        // If the path is a pipe, reading it would block for ever.
        if !fs::metadata(&path).ok()?.is_file() {
            return None;
        }
        File::open(path).ok()?.take(ENTRY_BYTES_MAX).read_to_string(&mut text).ok()?;
        let entry: Entry = serde_json::from_str(&text).ok()?;
        // The checksum does not cover damage that decodes to the same report, such as a changed name of an optional
        // field.
        let is_whole = serde_json::to_string(&entry).ok()? == text;
        (is_whole && entry.checksum == checksum(key, &entry.report)).then_some(entry.report)
    }

    /// Writes the entry of a report.
    ///
    /// # Errors
    /// When the entry cannot be written. Verdicts do not depend on the cache.
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

/// The key of the report on a file whose bytes have this digest.
pub(super) fn key(context: &Hash, bytes: &[u8; 32]) -> Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(context.as_bytes()).update(bytes);
    hasher.finalize()
}

/// Hash of everything that a verdict depends on, except the file's bytes.
pub(super) fn context(rules: RulesId, limits: &Limits) -> Hash {
    // Exhaustive destructuring: a new limit does not compile until it is hashed here.
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
    // The name is the only part of variable length, so it comes last.
    hasher.update(name);
    hasher.finalize()
}

fn checksum(key: &Hash, report: &Report) -> String {
    let text = json_text(report);
    let mut hasher = blake3::Hasher::new();
    hasher.update(key.as_bytes()).update(text.as_bytes());
    hasher.finalize().to_string()
}
