//! A damaged replay never verifies as another match: see `tests/mutated` of the engine.
#![expect(clippy::unwrap_used, reason = "the files of this repository are valid")]

#[path = "../../../tests/mutated/judge.rs"]
mod judge;
#[path = "../../../tests/mutated/memory.rs"]
mod memory;
#[path = "../../../tests/mutated/mutation.rs"]
mod mutation;

use lockstep2d_shove::Shove;

/// Number of damaged files. It is small because the matches are long.
const FILES: u64 = 300;

#[test]
fn a_mutated_replay_is_never_another_match() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/replays");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let originals: Vec<_> = paths.iter().map(|path| std::fs::read(path).unwrap()).collect();
    judge::check_replays::<Shove>(&originals, FILES);
}
