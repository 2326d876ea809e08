//! The replay commands, on a match with four players and claims.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Step, Verdict, VerifiedReplay, verify};
use lockstep2d_shove::Shove;

fn replay() -> String {
    format!("{}/replays/match.replay", env!("CARGO_MANIFEST_DIR"))
}

/// Runs a command that should succeed, and returns its output.
fn shove(arguments: &[&str]) -> String {
    let outcome =
        Command::new(env!("CARGO_BIN_EXE_shove")).args(arguments).output().expect("the binary should run");
    let messages = String::from_utf8_lossy(&outcome.stderr).into_owned();
    assert!(outcome.status.success(), "{arguments:?}: {messages}");
    String::from_utf8(outcome.stdout).expect("the output should be UTF-8")
}

/// A path at which there is no file.
fn path(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("shove-{}-{name}", std::process::id()));
    let _ = fs::remove_file(&path);
    path
}

fn text(path: &Path) -> &str {
    path.to_str().expect("the path should be UTF-8")
}

#[test]
fn a_match_can_be_gone_through() {
    let bytes = fs::read(replay()).expect("the committed replay should be readable");
    let mut verified =
        VerifiedReplay::<Shove>::open(&bytes, &Limits::default()).expect("the replay should be valid");
    while verified.tick() < 1990 {
        verified.step().expect("the replay should be valid");
    }
    let keyframes = path("keyframes");
    let arguments = ["seek", &replay(), "--tick", "2000", "--back", "10", "--keyframes", text(&keyframes)];
    let expected = format!("tick 1990 of 3000\nstate {}\n", verified.game().state_hash());
    for there in [2000, 200] {
        let out = shove(&arguments);
        assert!(out.contains(&expected), "{out}");
        assert!(out.contains(&format!("simulated {there} ticks, and 199 for 10 back")), "{out}");
    }
    let _ = fs::remove_file(keyframes);
    let out = shove(&["inspect", &replay(), "--tick", "1990", "--path", "rules.seats[0].score"]);
    assert_eq!(out.lines().count(), 2, "{out}");
    let out = shove(&["export", &replay(), "--json", "--from", "1989", "--to", "1990"]);
    assert_eq!(out.lines().count(), 2);
    assert!(out.contains(&format!("{{\"tick\":1990,\"hash\":\"{}\"", verified.game().state_hash())));
    assert!(shove(&["stats", &replay()]).contains("joints solved"));

    while matches!(verified.step(), Ok(Step::Ticked)) {}
    let (told, claims) = (shove(&["inspect", &replay()]), verified.game().claims());
    assert_eq!(claims.len(), 4);
    for (name, value) in claims {
        assert!(told.contains(&format!("claims \"{name}\" = {value}\n")), "{told}");
    }
}

#[test]
fn a_match_can_end_otherwise() {
    let (new, then) = (path("fork.replay"), path("pads"));
    fs::write(&then, "[1,2,3,4]\n[17,1,0,0]\n").expect("the temporary folder should be writable");
    let out =
        shove(&["fork", &replay(), "--tick", "700", "--then", text(&then), "--idle", "98", "-o", text(&new)]);
    assert!(out.contains("700 ticks of ") && out.contains(" and 100 more"), "{out}");
    let whole = fs::read(&new).expect("the fork was just written");
    let verdict = verify::<Shove>(&whole, &Limits::default());
    assert!(matches!(verdict, Verdict::Match { ticks: 800, .. }), "{verdict}");

    let (cut, trimmed) = (path("cut.replay"), path("trimmed.replay"));
    fs::write(&cut, &whole[..whole.len() * 9 / 10]).expect("the temporary folder should be writable");
    shove(&["trim", text(&cut), "-o", text(&trimmed)]);
    let verdict = verify::<Shove>(
        &fs::read(&trimmed).expect("the trimmed replay was just written"),
        &Limits::default(),
    );
    assert!(verdict.is_match() && verdict.ticks().is_multiple_of(60) && verdict.ticks() > 300, "{verdict}");
    for file in [new, then, cut, trimmed] {
        let _ = fs::remove_file(file);
    }
}
