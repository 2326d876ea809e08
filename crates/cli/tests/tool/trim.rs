//! `trim`: the intact part of a cut or damaged replay becomes a complete replay.

use std::fs;

use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Recorder, Recording, verify};
use lockstep2d_cli::{Exit, Tool};
use serde_json::Value;

use crate::counter::{Counter, add, inputs_at, setup};
use crate::{Folder, golden, replay, run, run_sandbox, run_tool};

/// Number of ticks of the trimmed file, and the text of the error stream. `None` if nothing could be kept.
fn trimmed(folder: &Folder, bytes: &[u8], more: &[&str]) -> Option<(u64, String)> {
    let (file, new) = (folder.write("a.replay", bytes), folder.path("new.replay"));
    let outcome = run(&[&["trim", &file, "-o", &new], more].concat());
    let written = fs::read(&new).ok();
    let _ = fs::remove_file(&new);
    if outcome.exit == Exit::NoMatch {
        assert_eq!((written, outcome.out.as_str()), (None, ""));
        return None;
    }
    let verdict = verify::<Counter>(&written.unwrap(), &Limits::default());
    assert!(verdict.is_match(), "{verdict}");
    let ticks = verdict.ticks();
    assert!(
        outcome.out.starts_with(&format!("{new}: {ticks} ticks of {file}, final hash ")),
        "{}",
        outcome.out
    );
    Some((ticks, outcome.err))
}

#[test]
fn a_replay_that_is_cut_anywhere_becomes_complete() {
    let folder = Folder::new("trim-cut");
    let whole = replay(35);
    let mut kept = Vec::new();
    for length in 0..=whole.len() {
        match trimmed(&folder, &whole[..length], &[]) {
            Some((ticks, message)) => {
                assert_eq!(message, "", "a cut file is not reported as damaged");
                kept.push(ticks);
            }
            None => assert!(kept.is_empty(), "every file with an intact header can be trimmed"),
        }
    }
    kept.dedup();
    assert_eq!(kept, [0, 10, 20, 30, 35]);
}

#[test]
fn in_front_of_damage_it_is_kept() {
    let folder = Folder::new("trim-damage");
    let whole = replay(35);
    let mut kept = Vec::new();
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 1;
        if let Some((ticks, message)) = trimmed(&folder, &damaged, &[]) {
            // If a damaged length points beyond the end, the file looks cut.
            assert!(message.is_empty() || message.contains("left out:"), "{message}");
            kept.push(ticks);
        }
    }
    assert!(kept.is_sorted());
    kept.dedup();
    assert_eq!(kept, [0, 10, 20, 30, 35]);
}

#[test]
fn a_complete_replay_stays_or_becomes_shorter() {
    let folder = Folder::new("trim-short");
    let whole = replay(35);
    for ticks in [0, 1, 10, 34, 35, 99] {
        let (kept, message) = trimmed(&folder, &whole, &["--ticks", &ticks.to_string()]).unwrap();
        assert_eq!((kept, message.as_str()), (ticks.min(35), ""));
    }
    let new = folder.path("same");
    assert_eq!(run_sandbox(&["trim", &golden("chain"), "-o", &new]).exit, Exit::Success);
    assert_eq!(fs::read(&new).unwrap(), fs::read(golden("chain")).unwrap());
}

/// The checksums of this replay are right, but from tick 25 on the recorded states are wrong.
#[test]
fn where_a_replay_leaves_the_rules_it_ends() {
    let folder = Folder::new("trim-diverged");
    let (mut recorder, mut game) = Recorder::<Counter>::start(&setup(), 10).unwrap();
    for tick in 0..35 {
        game.step(recorder.record(&inputs_at(tick)).unwrap());
        game.sum += i64::from(tick == 24);
        recorder.checkpoint(game.state_hash());
    }
    let diverged = recorder.finish(&game).unwrap();
    let (kept, message) = trimmed(&folder, &diverged, &[]).unwrap();
    assert_eq!(kept, 20);
    assert!(message.contains("diverged: equal at tick 20, different at tick 30"), "{message}");
    assert_eq!(trimmed(&folder, &diverged, &["--ticks", "15"]), Some((15, String::new())));
    let (kept, message) = trimmed(&folder, &diverged, &["--ticks", "25"]).unwrap();
    assert_eq!(kept, 20, "the checkpoint after the requested ticks does not agree");
    assert!(message.contains("diverged"), "{message}");

    let file = folder.write("a.replay", &diverged);
    let outcome = run(&["trim", &file, "-o", &folder.path("new"), "--json"]);
    let found: Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!(found["ticks"], 20);
    assert!(found["left_out"].as_str().unwrap().starts_with("diverged"), "{found}");
}

/// Tick 25 exceeds a limit, so the checkpoint of tick 30 is never compared.
#[test]
fn ticks_after_the_last_agreeing_checkpoint_are_left_out() {
    let folder = Folder::new("trim-unchecked");
    let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
    for tick in 0..35 {
        recording.step(&add(if tick == 24 { 100 } else { 1 }, 0)).unwrap();
    }
    let (file, new) = (folder.write("a.replay", &recording.finish().unwrap()), folder.path("new"));
    let tool = Tool::new().with_limits(Limits { tick_work: 50, ..Limits::default() });
    let outcome = run_tool(&tool, &["trim", &file, "-o", &new]);
    assert!(outcome.out.contains(": 20 ticks of "), "{}", outcome.out);
    assert!(outcome.err.contains("limit exceeded: 101 work units in one tick"), "{}", outcome.err);
}

#[test]
fn what_has_nothing_to_keep_is_explained() {
    let folder = Folder::new("untrimmable");
    let (bad, new) = (folder.write("bad.replay", b"no replay"), folder.path("new"));
    for (file, exit, message) in [
        (bad, Exit::NoMatch, "malformed: at byte 0"),
        (golden("game"), Exit::NoMatch, "unverifiable: made with the rules \"sandbox\""),
        (folder.path("missing"), Exit::Trouble, "cannot read"),
    ] {
        let outcome = run(&["trim", &file, "-o", &new]);
        assert_eq!(outcome.exit, exit, "{file}");
        assert!(outcome.err.contains(message), "{}", outcome.err);
    }
}
