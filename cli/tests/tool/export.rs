//! `export`: the picture after a tick.

use std::fs;

use lockstep2d::lockstep::Game;
use lockstep2d_cli::Exit;

use crate::counter::{Counter, inputs_at, setup};
use crate::{Folder, replay, run};

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
    ] {
        let outcome = run(&arguments);
        assert_eq!(outcome.exit, exit, "{arguments:?}");
        assert!(outcome.err.contains(message), "{message:?} in {:?}", outcome.err);
    }
}
