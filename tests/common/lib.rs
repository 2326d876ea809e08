//! Helpers of the tests: committed hashes of scenes, and sweeps over many cases.

pub mod sweep;

use std::path::{Path, PathBuf};

/// Seed of the golden scenes.
pub const SEED: u64 = 1;

/// A line of a file of committed hashes: the hash of a scene after a number of ticks.
pub struct Golden {
    /// Name of the scene.
    pub scene: String,
    /// Number of ticks.
    pub ticks: u64,
    /// State hash in hexadecimal.
    pub hash: String,
}

/// The lines of `tests/goldens.txt` for the current semantics.
pub fn goldens() -> Vec<Golden> {
    goldens_of("tests/goldens.txt")
}

/// The lines of a file for the current semantics. Each line has four words: semantics, scene, ticks, hash.
pub fn goldens_of(file: &str) -> Vec<Golden> {
    let text = std::fs::read_to_string(root().join(file)).expect("a file of hashes");
    let semantics = lockstep2d::SEMANTICS.to_string();
    let lines = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    lines
        .map(|line| line.split_whitespace().collect::<Vec<_>>())
        .filter(|words| words[0] == semantics)
        .map(|words| match words[..] {
            [_, scene, ticks, hash] => Golden {
                scene: scene.to_owned(),
                ticks: ticks.parse().expect("a number of ticks"),
                hash: hash.to_owned(),
            },
            _ => panic!("expected four words, found {words:?}"),
        })
        .collect()
}

/// The root folder of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the tests are in a folder of the repository")
        .to_owned()
}
