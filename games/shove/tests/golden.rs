//! The committed matches verify and end in the committed hashes. New recordings of their bots give the same files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d_shove::Shove;

/// Each scene, and its hash after 3000 ticks with seed 1.
const GOLDENS: [(&str, &str); 3] = [
    ("duel", "3442cf73863a30c5637442c86341730a"),
    ("match", "d9ed4a9970e89d8baf1343dc37b98716"),
    ("guests", "d65a8d548531ffae334e244a93ed817a"),
];

fn replay(scene: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("replays").join(scene).with_extension("replay")
}

fn shove() -> Command {
    Command::new(env!("CARGO_BIN_EXE_shove"))
}

#[test]
fn every_replay_matches_and_ends_in_its_golden() {
    for (scene, golden) in GOLDENS {
        let bytes = fs::read(replay(scene)).expect("each golden should have a replay");
        match verify::<Shove>(&bytes, &Limits::default()) {
            Verdict::Match { ticks, hash } => {
                assert_eq!((ticks, hash.to_string().as_str()), (3000, golden), "{scene}");
            }
            other => panic!("{scene}: {other}"),
        }
    }
    let folder = replay("match").with_file_name("");
    let outcome = shove().arg("verify").arg(folder).output().expect("the binary should run");
    let text = String::from_utf8_lossy(&outcome.stdout).into_owned();
    assert!(outcome.status.success() && text.contains("3 of 3 files match"), "{text}");
}

#[test]
fn every_replay_is_what_its_bots_play() {
    for (scene, _) in GOLDENS {
        let file = std::env::temp_dir().join(format!("shove-{}-{scene}.replay", std::process::id()));
        let recorded = shove().args(["record", scene, "--seed", "1", "-o"]).arg(&file).output();
        assert!(recorded.expect("the binary should run").status.success(), "{scene}");
        let bytes = fs::read(&file).expect("the recording was just written");
        let _ = fs::remove_file(&file);
        let committed = fs::read(replay(scene)).expect("each golden should have a replay");
        assert!(bytes == committed, "{scene}: the recording differs from the committed one");
    }
}

#[test]
fn a_tick_is_drawn() {
    let picture = shove().arg("export").arg(replay("match")).args(["--tick", "100", "--svg"]).output();
    let picture = picture.expect("the binary should run");
    assert!(picture.status.success());
    let text = String::from_utf8_lossy(&picture.stdout).into_owned();
    assert!(text.starts_with("<svg ") && text.contains("round 1 · Fight"), "{text}");
}
