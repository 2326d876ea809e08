//! Access to the committed hashes, shared by test binaries.
#![allow(dead_code, reason = "each test binary uses only some of these items")]

use std::path::PathBuf;

/// Seed of the golden scenes.
pub(crate) const SEED: u64 = 1;

/// Hash of a scene after a number of ticks, for the current semantics.
pub(crate) struct Golden {
    pub(crate) scene: String,
    pub(crate) ticks: u64,
    pub(crate) hash: String,
}

/// Returns the lines of `tests/goldens.txt` for the current semantics.
pub(crate) fn goldens() -> Vec<Golden> {
    goldens_of("tests/goldens.txt")
}

/// Returns the lines of a file of hashes for the current semantics: semantics, scene, ticks, hash.
pub(crate) fn goldens_of(file: &str) -> Vec<Golden> {
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

/// Returns the root folder of the repository.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}
