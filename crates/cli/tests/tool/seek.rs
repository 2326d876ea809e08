//! `seek`: the state at a tick, the number of ticks simulated to reach it, and the keyframe file.

use std::fs;

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSave};
use lockstep2d::replay::{Limits, Step, VerifiedReplay};
use lockstep2d_cli::Exit;
use serde_json::{Value, json};

use crate::counter::Counter;
use crate::{Folder, golden, replay, run, run_sandbox};

fn hash_at<G: Game>(file: &[u8], tick: u64) -> StateHash {
    let mut verified = VerifiedReplay::<G>::open(file, &Limits::default()).unwrap();
    (0..tick).for_each(|_| assert_eq!(verified.step(), Ok(Step::Ticked)));
    verified.game().state_hash()
}

#[test]
fn the_state_of_a_tick_is_that_of_a_verified_replay() {
    let folder = Folder::new("seek");
    let bytes = replay(95);
    let file = folder.write("a.replay", &bytes);
    for tick in [0, 1, 50, 95] {
        let hash = hash_at::<Counter>(&bytes, tick);
        let outcome = run(&["seek", &file, "--tick", &tick.to_string()]);
        let expected = format!("{file}: tick {tick} of 95\nstate {hash}\nsimulated {tick} ticks\n");
        assert_eq!((outcome.exit, outcome.out, outcome.err), (Exit::Success, expected, String::new()));
    }
    let hash = hash_at::<Counter>(&bytes, 87);
    let outcome = run(&["seek", &file, "--tick", "90", "--back", "3", "--interval", "20"]);
    let expected = format!("{file}: tick 87 of 95\nstate {hash}\nsimulated 90 ticks, and 9 for 3 back\n");
    assert_eq!(outcome.out, expected);
    let outcome = run(&["seek", &file, "--tick", "2", "--back", "5"]);
    assert!(outcome.out.contains("tick 0 of 95"), "{}", outcome.out);
}

#[test]
fn a_save_is_written_as_it_is() {
    let folder = Folder::new("seek-save");
    let save = folder.path("save");
    let outcome = run_sandbox(&["seek", &golden("ragdoll"), "--tick", "100", "--json", "-o", &save]);
    let found: Value = serde_json::from_str(&outcome.out).unwrap();
    let mut game = Sandbox::new(&Default::default()).unwrap();
    let saved: SandboxSave = codec::decode(&fs::read(&save).unwrap()).unwrap();
    game.load(&saved);
    let hash = hash_at::<Sandbox>(&fs::read(golden("ragdoll")).unwrap(), 100);
    assert_eq!((game.state_hash(), &found["hash"]), (hash, &json!(hash.to_string())));
    assert_eq!(found["counts"]["bodies"], game.world().body_count());
    assert_eq!((&found["tick"], &found["simulated"]), (&json!(100), &json!(100)));
}

#[test]
fn keyframes_are_written_once_and_used_and_added_to() {
    let folder = Folder::new("seek-keyframes");
    let bytes = replay(950);
    let (file, keyframes) = (folder.write("a.replay", &bytes), folder.path("a.keyframes"));
    let seek = |tick: u64| {
        let tick_text = tick.to_string();
        let outcome = run(&[
            "seek",
            &file,
            "--tick",
            &tick_text,
            "--keyframes",
            &keyframes,
            "--interval",
            "100",
            "--json",
        ]);
        let found: Value = serde_json::from_str(&outcome.out).unwrap();
        assert_eq!(found["hash"], hash_at::<Counter>(&bytes, tick).to_string());
        found["simulated"].as_u64().unwrap()
    };
    assert_eq!(seek(420), 420);
    let first = fs::read(&keyframes).unwrap();
    assert_eq!(seek(419), 19);
    assert_eq!(fs::read(&keyframes).unwrap(), first, "the file is not rewritten without new keyframes");
    assert_eq!(seek(950), 550);
    assert_eq!((seek(949), seek(99), seek(100), seek(0)), (49, 99, 0, 0));
    assert!(!fs::exists(folder.path("a.keyframes.unfinished")).unwrap());
}

#[test]
fn another_interval_loses_no_keyframes_of_the_file() {
    let folder = Folder::new("seek-interval");
    let (file, keyframes) = (folder.write("a.replay", &replay(950)), folder.path("a.keyframes"));
    let seek = |tick: &str, interval: &[&str]| {
        let outcome =
            run(&[&["seek", &file, "--tick", tick, "--keyframes", &keyframes, "--json"], interval].concat());
        let found: Value = serde_json::from_str(&outcome.out).unwrap();
        found["simulated"].as_u64().unwrap()
    };
    seek("420", &["--interval", "100"]);
    // The default interval is 300 ticks.
    for interval in [&[] as &[&str], &["--interval", "50"], &["--interval", "700"]] {
        seek("950", interval);
        assert_eq!(seek("410", interval), 10, "{interval:?}");
    }
}

#[test]
fn wrong_keyframes_are_refused_and_left_alone() {
    let folder = Folder::new("seek-refused");
    let (file, other) = (folder.write("a.replay", &replay(95)), folder.write("b.replay", &replay(96)));
    let keyframes = folder.path("keyframes");
    let seek = |file: &str, keyframes: &str| {
        run(&["seek", file, "--tick", "50", "--interval", "10", "--keyframes", keyframes])
    };
    assert_eq!(seek(&other, &keyframes).exit, Exit::Success);
    let garbage = folder.write("garbage", b"a poem");
    let mut damaged = fs::read(&keyframes).unwrap();
    damaged[100] ^= 1;
    let damaged = folder.write("damaged", &damaged);
    for (path, why) in [
        (&keyframes, "the keyframes belong to another replay; delete it"),
        (&garbage, "this is not a file of keyframes"),
        (&damaged, "the hash does not match"),
        (&folder.path(""), "cannot read"),
    ] {
        let before = fs::read(path).ok();
        let outcome = seek(&file, path);
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""), "{path}");
        assert!(outcome.err.contains(why), "{}", outcome.err);
        assert_eq!(fs::read(path).ok(), before);
    }
}

#[test]
fn what_cannot_be_reached_is_explained() {
    let folder = Folder::new("unreachable");
    let file = folder.write("a.replay", &replay(35));
    let (bad, missing) = (folder.write("bad.replay", b"no replay"), folder.path("missing"));
    for (arguments, exit, message) in [
        (vec!["seek", &file, "--tick", "36"], Exit::Trouble, "has 35 ticks, there is no tick 36"),
        (vec!["seek", &bad, "--tick", "0"], Exit::NoMatch, "malformed: at byte 0"),
        (vec!["seek", &golden("game"), "--tick", "0"], Exit::NoMatch, "unverifiable"),
        (vec!["seek", &missing, "--tick", "0"], Exit::Trouble, "cannot read"),
        (vec!["seek", &file], Exit::Trouble, "--tick <N>"),
        (vec!["seek", &file, "--tick", "3", "--interval", "0"], Exit::Trouble, "--interval"),
        (vec!["seek", &file, "--tick", "3", "-o", &folder.path("no/folder")], Exit::Trouble, "cannot write"),
    ] {
        let outcome = run(&arguments);
        assert_eq!(outcome.exit, exit, "{arguments:?}");
        assert!(outcome.err.contains(message), "{message:?} in {:?}", outcome.err);
    }
}
