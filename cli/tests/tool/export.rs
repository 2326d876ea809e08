//! `export`: the picture after a tick, and states as JSON.

use std::fs;

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::replay::{Limits, Playback, Step};
use lockstep2d_cli::Exit;
use serde_json::{Value, json};

use crate::counter::{Counter, inputs_at, setup};
use crate::{Folder, golden, replay, run, run_sandbox};

#[test]
fn a_tick_is_drawn() {
    let folder = Folder::new("export");
    let file = folder.write("a.replay", &replay(35));
    let mut game = Counter::new(&setup()).unwrap();
    for tick in 0..=35 {
        let outcome = run(&["export", &file, "--tick", &tick.to_string(), "--svg"]);
        let expected = format!("<svg>{}</svg>\n", game.sum);
        assert_eq!((outcome.exit, outcome.out), (Exit::Success, expected), "tick {tick}");
        game.step(&inputs_at(tick));
    }
}

#[test]
fn a_picture_can_go_to_a_file() {
    let folder = Folder::new("export-file");
    let (file, picture) = (folder.write("a.replay", &replay(35)), folder.path("a.svg"));
    let outcome = run(&["export", &file, "--tick", "0", "--svg", "-o", &picture]);
    assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Success, ""));
    assert_eq!(fs::read_to_string(&picture).unwrap(), "<svg>5</svg>\n");
}

#[test]
fn what_cannot_be_drawn_is_explained() {
    let folder = Folder::new("undrawable");
    let file = folder.write("a.replay", &replay(35));
    let bad = folder.write("bad.replay", b"no replay");
    let missing = folder.path("missing");
    for (arguments, exit, message) in [
        (vec!["export", &file, "--tick", "36", "--svg"], Exit::Trouble, "has 35 ticks, there is no tick 36"),
        (vec!["export", &bad, "--tick", "0", "--svg"], Exit::NoMatch, "malformed: at byte 0"),
        (vec!["export", &missing, "--tick", "0", "--svg"], Exit::Trouble, "cannot read"),
        (vec!["export", &file, "--svg"], Exit::Trouble, "--tick <TICK>"),
        (vec!["export", &file, "--tick", "0"], Exit::Trouble, "--svg"),
        (vec!["export", &file, "--tick", "0", "--svg", "--json"], Exit::Trouble, "cannot be used with"),
        (vec!["export", &file, "--svg", "--from", "0"], Exit::Trouble, "cannot be used with"),
        (vec!["export", &file, "--json", "--from", "36"], Exit::Trouble, "there is no tick 36"),
        (vec!["export", &file, "--json", "--to", "36"], Exit::Trouble, "there is no tick 36"),
    ] {
        let outcome = run(&arguments);
        assert_eq!(outcome.exit, exit, "{arguments:?}");
        assert!(outcome.err.contains(message), "{message:?} in {:?}", outcome.err);
    }
}

#[test]
fn states_are_lines_of_json() {
    let folder = Folder::new("export-json");
    let file = folder.write("a.replay", &replay(35));
    let outcome = run(&["export", &file, "--json"]);
    assert_eq!((outcome.exit, outcome.err.as_str()), (Exit::Success, ""));
    let mut game = Counter::new(&setup()).unwrap();
    let lines: Vec<&str> = outcome.out.lines().collect();
    assert_eq!(lines.len(), 36);
    for (tick, line) in (0..).zip(&lines) {
        let (hash, state) = (game.state_hash(), serde_json::to_string(&game).unwrap());
        let expected = format!("{{\"tick\":{tick},\"hash\":\"{hash}\",\"state\":{state}}}");
        assert_eq!(
            serde_json::from_str::<Value>(line).unwrap(),
            serde_json::from_str::<Value>(&expected).unwrap()
        );
        assert!(line.starts_with(&format!("{{\"tick\":{tick},")), "{line}");
        game.step(&inputs_at(tick));
    }
    let part = run(&["export", &file, "--json", "--from", "7", "--to", "9"]).out;
    assert_eq!(part.lines().collect::<Vec<_>>(), lines[7..=9]);
    assert_eq!(run(&["export", &file, "--json", "--tick", "9"]).out.trim_end(), lines[9]);
    assert_eq!(run(&["export", &file, "--json", "--from", "9", "--to", "7"]).out, "", "no ticks");
    let to = folder.path("states");
    assert_eq!(run(&["export", &file, "--json", "-o", &to]).exit, Exit::Success);
    assert_eq!(fs::read_to_string(&to).unwrap(), outcome.out);
}

/// Every fixed-point number of a world has its bits and a decimal, also within variants.
#[test]
fn numbers_of_a_world_have_bits_and_a_decimal() {
    let outcome = run_sandbox(&["export", &golden("ragdoll"), "--json", "--tick", "60"]);
    let line: Value = serde_json::from_str(&outcome.out).unwrap();
    let file = fs::read(golden("ragdoll")).unwrap();
    let mut playback = Playback::<Sandbox>::open(&file, &Limits::default()).unwrap();
    (0..60).for_each(|_| assert_eq!(playback.step(), Ok(Step::Ticked)));
    assert_eq!(line["hash"], playback.game().state_hash().to_string());
    let world = &line["state"]["world"];
    assert_eq!(world["settings"]["gravity"]["y"], json!({"bits": -42949672960i64, "decimal": "-10"}));
    assert_eq!(world["settings"]["solver"]["contact"]["Soft"]["hertz"]["decimal"], "30");
    let (id, body) = playback.game().world().bodies().last().unwrap();
    let shown = &world["bodies"][format!("body {id}")]["velocity"]["x"];
    assert_eq!(shown["bits"], body.velocity().x.to_bits() >> 11, "a speed has 21 fraction bits");
    let text = outcome.out.as_str();
    assert_eq!(text.matches("\"bits\":").count(), text.matches("\"decimal\":").count());
}

#[test]
fn a_game_without_pictures_has_states() {
    let outcome = run_sandbox(&["export", &golden("free_fall"), "--svg", "--tick", "1"]);
    assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""));
    assert!(outcome.err.contains("draws no pictures"), "{}", outcome.err);
}
