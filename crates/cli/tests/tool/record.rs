//! `scenes` and `record`: scenes are listed, and a recorded scene verifies.

use std::fs;

use lockstep2d_cli::{Exit, Tool};

use crate::{Folder, run, run_tool};

#[test]
fn scenes_are_listed() {
    let outcome = run(&["scenes"]);
    let expected = "waves  the sum goes up and down (100 ticks)\nbad    cannot start (1 ticks)\n";
    assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Success, expected));
}

#[test]
fn a_recorded_scene_verifies() {
    let folder = Folder::new("record");
    let (whole, part, seeded) = (folder.path("whole"), folder.path("part"), folder.path("seeded"));
    let outcome = run(&["record", "waves", "-o", &whole]);
    assert!(outcome.out.starts_with(&format!("{whole}: recorded 100 ticks, final hash ")), "{}", outcome.out);
    assert_eq!(outcome.exit, Exit::Success, "{}", outcome.err);
    assert_eq!(run(&["record", "waves", "--ticks", "7", "--output", &part]).exit, Exit::Success);
    assert_eq!(run(&["record", "waves", "--seed", "1", "-o", &seeded]).exit, Exit::Success);

    let outcome = run(&["verify", &whole, &part, &seeded]);
    assert_eq!(outcome.exit, Exit::Success, "{}", outcome.out);
    for ticks in ["whole: match: 100 ticks", "part: match: 7 ticks", "seeded: match: 100 ticks"] {
        assert!(outcome.out.contains(ticks), "{ticks} in {}", outcome.out);
    }
    assert_ne!(fs::read(&whole).unwrap(), fs::read(&seeded).unwrap(), "the seed reaches the scene");
}

#[test]
fn what_cannot_be_recorded_is_trouble() {
    let folder = Folder::new("unrecordable");
    let file = folder.path("x.replay");
    let nowhere = folder.path("no/such/folder/x.replay");
    for (arguments, message) in [
        (vec!["record", "nowhere", "-o", &file], "there is no scene \"nowhere\"; there are waves, bad"),
        (vec!["record", "bad", "-o", &file], "the sum starts above 1000"),
        (vec!["record", "waves", "-o", &nowhere], "cannot write"),
        (vec!["record", "waves"], "--output <FILE>"),
        (vec!["record", "waves", "--ticks", "many", "-o", &file], "'--ticks <TICKS>'"),
    ] {
        let outcome = run(&arguments);
        assert_eq!(outcome.exit, Exit::Trouble, "{arguments:?}");
        assert!(outcome.err.contains(message), "{message:?} in {:?}", outcome.err);
        assert!(!fs::exists(&file).unwrap(), "{arguments:?} left a file behind");
    }
}

#[test]
fn a_game_without_scenes_has_no_such_commands() {
    let tool = Tool::new();
    for command in ["scenes", "record"] {
        let outcome = run_tool(&tool, &[command]);
        assert_eq!(outcome.exit, Exit::Trouble);
        assert!(outcome.err.contains("unrecognized subcommand"), "{}", outcome.err);
    }
    let help = run_tool(&tool, &["--help"]);
    assert_eq!(help.exit, Exit::Success);
    assert!(help.out.contains("verify") && !help.out.contains("record"), "{}", help.out);
}
