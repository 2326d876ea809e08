//! What tests share: the committed constants.
#![allow(dead_code, reason = "each test binary uses a part")]

use std::path::PathBuf;

/// The seed of the golden scenes.
pub(crate) const SEED: u64 = 1;

/// The hash of a scene after some ticks, for the present semantics.
pub(crate) struct Golden {
    pub(crate) scene: String,
    pub(crate) ticks: u64,
    pub(crate) hash: String,
}

/// The lines of `tests/goldens.txt` that belong to the present semantics.
pub(crate) fn goldens() -> Vec<Golden> {
    goldens_of("tests/goldens.txt")
}

/// The lines of a file of hashes that belong to the present semantics: semantics, scene, ticks, hash.
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
            _ => panic!("four words, not {words:?}"),
        })
        .collect()
}

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}
