//! Committed replays verify, end in the committed hashes, and equal what their scenes record.

use lockstep2d::lockstep::Sandbox;
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, Recording, Verdict, verify};
use lockstep2d_scenes::Scene;
use lockstep2d_tests::sweep;

fn replays() -> Vec<(String, Vec<u8>)> {
    let folder = std::fs::read_dir(lockstep2d_tests::root().join("replays")).expect("replays/");
    let mut replays: Vec<_> = folder
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "replay"))
        .map(|path| {
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            (name, std::fs::read(&path).expect("readable"))
        })
        .collect();
    replays.sort();
    replays
}

#[test]
fn every_replay_matches_and_ends_in_its_golden() {
    let goldens = lockstep2d_tests::goldens();
    let replays = replays();
    assert_eq!(replays.len(), goldens.len(), "a replay for each golden");
    sweep::for_each(replays, |(name, bytes)| {
        let golden = goldens.iter().find(|golden| golden.scene == name).expect("a golden for each replay");
        match verify::<Sandbox>(&bytes, &Limits::default()) {
            Verdict::Match { ticks, hash } => {
                assert_eq!((ticks, hash.to_string()), (golden.ticks, golden.hash.clone()), "{name}");
            }
            other => panic!("{name}: {other}"),
        }
    });
}

/// Recording a scene again gives the committed file.
#[test]
fn every_replay_is_what_its_scene_records() {
    sweep::for_each(replays(), |(name, bytes)| {
        let scene = Scene::find(&name).expect("a scene for each replay");
        let mut recording =
            Recording::<Sandbox>::start(&scene.setup(lockstep2d_tests::SEED), CHECKPOINT_INTERVAL)
                .expect("valid");
        for tick in 0..scene.golden_ticks {
            let commands = scene.commands(tick, recording.game());
            recording.step(&[commands]).expect("small inputs");
        }
        let recorded = recording.finish().expect("the end");
        assert!(recorded == bytes, "{name}: the recording differs from replays/{name}.replay");
    });
}
