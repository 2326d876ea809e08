//! `export`: SVG pictures of a tick, and states as JSON.

use std::fs;

use lockstep2d::draw::{self, Frame, Layers, View};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Aabb, Vec2};
use lockstep2d::replay::{Limits, Step, VerifiedReplay};
use lockstep2d_cli::{Exit, Tool};
use serde_json::{Value, json};

use crate::counter::{Counter, inputs_at, setup};
use crate::{Folder, golden, replay, run, run_sandbox, run_tool_of};

/// The sandbox after `ticks` ticks of one of the repository's replays.
fn played(scene: &str, ticks: u64) -> Sandbox {
    let file = fs::read(golden(scene)).unwrap();
    let mut verified = VerifiedReplay::<Sandbox>::open(&file, &Limits::default()).unwrap();
    (0..ticks).for_each(|_| assert_eq!(verified.step(), Ok(Step::Ticked)));
    verified.into_game()
}

#[test]
fn a_tick_is_drawn() {
    for tick in [0u32, 30, 100] {
        let outcome = run_sandbox(&["export", &golden("ragdoll"), "--tick", &tick.to_string(), "--svg"]);
        let expected = draw::svg(played("ragdoll", tick.into()).world(), &View::default());
        assert_eq!(outcome.exit, Exit::Success, "{}", outcome.err);
        assert!(outcome.out == expected, "tick {tick}");
    }
    let file = fs::read(golden("bouncing_ball")).unwrap();
    let ticks = VerifiedReplay::<Sandbox>::open(&file, &Limits::default()).unwrap().ticks();
    let last = played("bouncing_ball", ticks);
    let outcome = run_sandbox(&["export", &golden("bouncing_ball"), "--svg"]);
    assert!(outcome.out == draw::svg(last.world(), &View::default()), "the default is the last tick");
}

#[test]
fn a_picture_is_of_what_one_asks_for() {
    let arguments = ["--tick", "90", "--width", "320", "--height", "200", "--layers", "outlines,joints"];
    let window = ["--window", "-2.5,-1,2,1.25"];
    let file = golden("ragdoll");
    let arguments: Vec<&str> =
        ["export", &file, "--svg"].into_iter().chain(arguments).chain(window).collect();
    let corners = (Vec2::new(fx!(-2.5), fx!(-1)), Vec2::new(fx!(2), fx!(1.25)));
    let expected = View {
        width: 320,
        height: 200,
        frame: Frame::Window(Aabb::new(corners.0, corners.1)),
        layers: Layers { outlines: true, joints: true, ..Layers::NONE },
        title: String::new(),
    };
    let outcome = run_sandbox(&arguments);
    assert!(outcome.out == draw::svg(played("ragdoll", 90).world(), &expected), "{}", outcome.err);

    let tool = Tool::<Sandbox>::new().with_view(|game| View {
        title: format!("at {}", game.world().tick()),
        layers: Layers::NONE,
        ..View::default()
    });
    let outcome = run_tool_of(&tool, &["export", &file, "--svg", "--tick", "7", "--layers", "ids"]);
    let layers = Layers { ids: true, ..Layers::NONE };
    let expected = View { title: "at 7".into(), layers, ..View::default() };
    assert!(outcome.out == draw::svg(played("ragdoll", 7).world(), &expected), "{}", outcome.err);
}

#[test]
fn a_picture_can_go_to_a_file_whose_name_says_the_format() {
    let folder = Folder::new("export-file");
    let expected = draw::svg(played("ragdoll", 0).world(), &View::default());
    for (name, option) in [("a.svg", None), ("a.SVG", None), ("a", Some("--svg"))] {
        let picture = folder.path(name);
        let file = golden("ragdoll");
        let arguments = ["export", &file, "--tick", "0", "-o", &picture];
        let outcome = run_sandbox(&arguments.into_iter().chain(option).collect::<Vec<_>>());
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Success, ""), "{}", outcome.err);
        assert!(fs::read_to_string(&picture).unwrap() == expected);
    }
}

#[test]
fn a_snapshot_has_a_picture_and_a_state() {
    let folder = Folder::new("export-snapshot");
    let game = played("ragdoll", 50);
    let file = folder.write("a.snapshot", &game.world().to_bytes());
    let world = lockstep2d::world::World::from_bytes(&game.world().to_bytes()).unwrap();
    let outcome = run_sandbox(&["export", &file, "--svg"]);
    assert!(outcome.out == draw::svg(&world, &View::default()), "{}", outcome.err);
    let line: Value = serde_json::from_str(&run_sandbox(&["export", &file, "--json"]).out).unwrap();
    assert_eq!((&line["tick"], &line["hash"]), (&50.into(), &world.state_hash().to_string().into()));
    let gif = folder.path("a.gif");
    for (arguments, message) in [
        (vec!["export", &file, "--plot"], "has one state, which is too few for --plot"),
        (vec!["export", &file, "-o", &gif], "has one state, which is too few for --gif"),
        (vec!["export", &file, "--svg", "--tick", "51"], "there is no other tick"),
        (vec!["export", &file, "--json", "--from", "9", "--to", "50"], "there is no other tick"),
        (vec!["export", &file, "--json", "--to", "51"], "there is no other tick"),
        (vec!["export", &file, "--json", "--every", "2"], "there is no other tick"),
    ] {
        let outcome = run_sandbox(&arguments);
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""));
        assert!(outcome.err.contains(message), "{}", outcome.err);
    }
}

#[test]
fn other_files_are_called_what_they_are() {
    let folder = Folder::new("export-others");
    let save = folder.path("a.save");
    run_sandbox(&["seek", &golden("ragdoll"), "--tick", "9", "-o", &save]);
    let trace = folder.path("a.trace");
    run_sandbox(&["trace", &golden("ragdoll"), "--to", "9", "-o", &trace]);
    let mut older = lockstep2d::world::World::default().to_bytes();
    // The semantics id follows the magic number and the format version, which are 12 bytes together.
    older[12] = 2;
    let older = folder.write("older", &older);
    for (file, why) in [
        (save, "a save of this game; a replay or a snapshot of a world can be exported"),
        (trace, "a report of a divergence; a replay"),
        (older, "a snapshot of another version: made with semantics 2"),
    ] {
        let outcome = run_sandbox(&["export", &file, "--svg"]);
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""), "{file}");
        assert!(outcome.err.contains(why), "{}", outcome.err);
    }
    // An animated PNG may have the extension of a PNG.
    let picture = folder.path("a.png");
    let outcome =
        run_sandbox(&["export", &golden("ragdoll"), "--apng", "--to", "3", "--width", "64", "-o", &picture]);
    assert_eq!(outcome.exit, Exit::Success, "{}", outcome.err);
}

#[test]
fn what_cannot_be_written_is_explained() {
    let folder = Folder::new("undrawable");
    let file = golden("free_fall");
    let counter = folder.write("a.replay", &replay(35));
    let bad = folder.write("bad.replay", b"no replay");
    let (missing, nowhere) = (folder.path("missing"), folder.path("no/folder.png"));
    let (gif, unknown) = (folder.path("a.gif"), folder.path("a.bmp"));
    for (arguments, exit, message) in [
        (vec!["export", &file, "--tick", "1000", "--svg"], Exit::Trouble, "there is no tick 1000"),
        (vec!["export", &bad, "--tick", "0", "--svg"], Exit::NoMatch, "malformed: at byte 0"),
        (vec!["export", &bad, "-o", &gif], Exit::NoMatch, "malformed: at byte 0"),
        (vec!["export", &bad, "--plot"], Exit::NoMatch, "malformed: at byte 0"),
        (vec!["export", &counter, "--svg"], Exit::NoMatch, "unverifiable"),
        (vec!["export", &missing, "--tick", "0", "--svg"], Exit::Trouble, "cannot read"),
        (vec!["export", &file, "--tick", "0"], Exit::Trouble, "no format given"),
        (vec!["export", &file, "-o", &unknown], Exit::Trouble, "no format given"),
        (vec!["export", &file, "--png"], Exit::Trouble, "--png needs a file to write"),
        (vec!["export", &file, "--png", "-o", &nowhere], Exit::Trouble, "cannot write"),
        (vec!["export", &file, "--tick", "0", "--svg", "--json"], Exit::Trouble, "cannot be used with"),
        (vec!["export", &file, "--svg", "--from", "0"], Exit::Trouble, "--from makes no sense with --svg"),
        (vec!["export", &file, "--plot", "--tick", "0"], Exit::Trouble, "--tick makes no sense with --plot"),
        (
            vec!["export", &file, "--json", "--width", "99"],
            Exit::Trouble,
            "--width makes no sense with --json",
        ),
        (
            vec!["export", &file, "-o", &gif, "--from", "9", "--to", "7"],
            Exit::Trouble,
            "--from 9 is after --to 7",
        ),
        (
            vec!["export", &file, "--plot", "--from", "9", "--to", "7"],
            Exit::Trouble,
            "--from 9 is after --to 7",
        ),
        (
            vec!["export", &file, "--json", "--from", "9", "--to", "7"],
            Exit::Trouble,
            "--from 9 is after --to 7",
        ),
        (
            vec!["export", &file, "--svg", "--layers", "shadows"],
            Exit::Trouble,
            "there is no layer \"shadows\"",
        ),
        (vec!["export", &file, "--svg", "--window", "1,2"], Exit::Trouble, "a window is four numbers"),
        (vec!["export", &file, "--svg", "--window", "1,2,1,2"], Exit::Trouble, "differ in both coordinates"),
        (vec!["export", &file, "--svg", "-o", &gif], Exit::Trouble, "--svg does not write"),
        (vec!["export", &file, "--plot", "-o", &gif], Exit::Trouble, "use --gif, or another name"),
        (vec!["export", &file, "--svg", "--width", "9"], Exit::Trouble, "64..=16384"),
        (vec!["export", &file, "--json", "--from", "1000"], Exit::Trouble, "there is no tick 1000"),
        (vec!["export", &file, "--json", "--to", "1000"], Exit::Trouble, "there is no tick 1000"),
    ] {
        let outcome = run_sandbox(&arguments);
        assert_eq!((outcome.exit, outcome.out.as_str()), (exit, ""), "{arguments:?}");
        assert!(outcome.err.contains(message), "{message:?} in {:?}", outcome.err);
    }
    for arguments in [vec!["--svg"], vec!["--plot"], vec!["-o", &gif]] {
        let all: Vec<&str> = ["export", &counter].into_iter().chain(arguments).collect();
        let outcome = run(&all);
        assert_eq!(outcome.exit, Exit::Trouble);
        assert!(outcome.err.contains("exposes no world (`Game::world`)"), "{}", outcome.err);
    }
    let left: Vec<_> =
        fs::read_dir(folder.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "only the two replays are left: {left:?}");
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
    let some = run(&["export", &file, "--json", "--from", "7", "--every", "10"]).out;
    assert_eq!(some.lines().collect::<Vec<_>>(), [lines[7], lines[17], lines[27]]);
    let to = folder.path("states");
    assert_eq!(run(&["export", &file, "--json", "-o", &to]).exit, Exit::Success);
    assert_eq!(fs::read_to_string(&to).unwrap(), outcome.out);
}

/// The JSON of a state gives each fixed-point number as its bits and as a decimal, also inside enum variants.
#[test]
fn numbers_of_a_world_have_bits_and_a_decimal() {
    let outcome = run_sandbox(&["export", &golden("ragdoll"), "--json", "--tick", "60"]);
    let line: Value = serde_json::from_str(&outcome.out).unwrap();
    let file = fs::read(golden("ragdoll")).unwrap();
    let mut verified = VerifiedReplay::<Sandbox>::open(&file, &Limits::default()).unwrap();
    (0..60).for_each(|_| assert_eq!(verified.step(), Ok(Step::Ticked)));
    assert_eq!(line["hash"], verified.game().state_hash().to_string());
    let world = &line["state"]["world"];
    assert_eq!(world["settings"]["gravity"]["y"], json!({"bits": -42949672960i64, "decimal": "-10"}));
    assert_eq!(world["settings"]["solver"]["contact"]["Soft"]["hertz"]["decimal"], "30");
    let (id, body) = verified.game().world().bodies().last().unwrap();
    let shown = &world["bodies"][format!("body {id}")]["velocity"]["x"];
    assert_eq!(shown["bits"], body.velocity().x.to_bits() >> 11, "a speed has 21 fraction bits");
    let text = outcome.out.as_str();
    assert_eq!(text.matches("\"bits\":").count(), text.matches("\"decimal\":").count());
}
