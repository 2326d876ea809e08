//! [`Cache`]: a folder of reports, so that no file is played twice.

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

/// Goes up whenever an entry means something else, or a verdict is another for the same bytes, rules and semantics.
const VERSION: u32 = 1;

/// Most bytes of an entry that are read: more than 256 claims take.
const ENTRY_BYTES_MAX: u64 = 1 << 20;

/// A folder with a file for every report, named by all that the report depends on.
///
/// Any number of processes may share it, on several machines too: an entry appears whole or not at all, and whoever writes
/// it writes the same. What cannot be read, or is damaged, is as good as absent.
pub(super) struct Cache {
    folder: PathBuf,
    /// What is the same for all files: the program and the limits.
    context: Hash,
}

/// The content of an entry.
#[derive(Serialize, Deserialize)]
struct Entry {
    report: Report,
    /// Of the key and the report: damage, or an entry under another's name.
    checksum: String,
}

impl Cache {
    /// Makes the folder if there is none.
    ///
    /// # Errors
    /// When that is not possible.
    pub(super) fn open(folder: &Path, rules: RulesId, limits: &Limits) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        Ok(Cache { folder: folder.to_path_buf(), context: context(rules, limits) })
    }

    /// What identifies the report on these bytes.
    pub(super) fn key(&self, bytes: &[u8]) -> Hash {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.context.as_bytes()).update(blake3::hash(bytes).as_bytes());
        hasher.finalize()
    }

    pub(super) fn get(&self, key: &Hash) -> Option<Report> {
        let mut text = String::new();
        File::open(self.path(key)).ok()?.take(ENTRY_BYTES_MAX).read_to_string(&mut text).ok()?;
        let entry: Entry = serde_json::from_str(&text).ok()?;
        // Some damage makes no other report of it, such as to the name of a field that may be missing.
        let is_whole = serde_json::to_string(&entry).ok()? == text;
        (is_whole && entry.checksum == checksum(key, &entry.report)).then_some(entry.report)
    }

    /// Keeps a report.
    ///
    /// # Errors
    /// When it cannot be written. Nothing depends on that.
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

/// All that a verdict depends on besides the bytes.
fn context(rules: RulesId, limits: &Limits) -> Hash {
    // Taken apart in full, so that a new limit cannot be forgotten here.
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
    // The only part whose length varies, and the last.
    hasher.update(name);
    hasher.finalize()
}

fn checksum(key: &Hash, report: &Report) -> String {
    let text = json_text(report);
    let mut hasher = blake3::Hasher::new();
    hasher.update(key.as_bytes()).update(text.as_bytes());
    hasher.finalize().to_string()
}
