//! `verify` with files that exceed a limit, need another program, or make the game panic.

use std::collections::BTreeMap;

use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, History, RulesId, Sandbox, SandboxSetup, SetupError};
use lockstep2d::replay::{Limits, Recording};
use lockstep2d::report::{Desync, DesyncReport};
use lockstep2d::world::Command;
use lockstep2d_cli::{Exit, Tool};
use serde_json::{Value, json};

use crate::batch::{fuse, run_bomb};
use crate::counter::{add, like_its_counter, setup};
use crate::{Counter, Folder, replay, run, run_tool, run_tool_of};

fn line(out: &str) -> Value {
    serde_json::from_str(out.lines().next().unwrap()).unwrap()
}

#[test]
fn every_limit_has_its_flag() {
    let folder = Folder::new("flags");
    // The work of a tick is 1 plus the absolute values of the two inputs, which are 1 and -1. So 20 ticks take 60
    // units.
    let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
    for _ in 0..20 {
        recording.step(&add(1, -1)).unwrap();
    }
    let bytes = recording.finish().unwrap();
    let file = folder.write("good.replay", &bytes);
    let length = bytes.len() as u64;
    for (flag, limit, value) in [
        ("--max-bytes", "file_bytes", length),
        ("--max-ticks", "ticks", 20),
        ("--max-tick-work", "tick_work", 3),
        ("--max-work", "total_work", 60),
    ] {
        let enough = run(&["verify", &file, flag, &value.to_string()]);
        assert_eq!(enough.exit, Exit::Success, "{flag}: {}", enough.out);
        let outcome = run(&["verify", "--json", &file, flag, &(value - 1).to_string()]);
        let line = line(&outcome.out);
        let is =
            (line["verdict"].as_str(), line["limit"].as_str(), line["max"].as_u64(), line["value"].as_u64());
        assert_eq!(is, (Some("limit_exceeded"), Some(limit), Some(value - 1), Some(value)), "{flag}");
        assert_eq!(outcome.exit, Exit::NoMatch);
        for wrong in ["-1", "1.5", "much", ""] {
            assert_eq!(run(&["verify", &file, flag, wrong]).exit, Exit::Trouble, "{flag} {wrong}");
        }
    }
}

/// A replay of the sandbox. It has three bodies at the start, five after four ticks, and four after five ticks.
fn crowd() -> Vec<u8> {
    let ball = || Command::Spawn {
        body: BodyDef::dynamic(),
        shapes: vec![ShapeDef::new(Polygon::square(fx!(0.5)).unwrap())],
    };
    let setup = SandboxSetup { commands: vec![ball(), ball(), ball()], ..SandboxSetup::default() };
    let mut recording = Recording::<Sandbox>::start(&setup, 3).unwrap();
    for tick in 0..10 {
        let last = recording.game().world().bodies().last().unwrap().0;
        let commands = match tick {
            3 => vec![ball(), ball()],
            4 => vec![Command::Despawn { body: last }],
            _ => Vec::new(),
        };
        recording.step(&[commands]).unwrap();
    }
    recording.finish().unwrap()
}

#[test]
fn bodies_are_counted_at_the_start_and_after_every_tick() {
    let folder = Folder::new("bodies");
    let file = folder.write("crowd.replay", &crowd());
    let tool = Tool::<Sandbox>::new();
    let limited = |bodies: &str| run_tool_of(&tool, &["verify", "--json", "--max-bodies", bodies, &file]);
    for (bodies, value) in [("5", None), ("4", Some(5)), ("3", Some(5)), ("2", Some(3)), ("0", Some(3))] {
        let line = line(&limited(bodies).out);
        let is = (line["limit"].as_str(), line["value"].as_u64());
        assert_eq!(is, (value.map(|_| "bodies"), value), "{bodies}: {line}");
    }
    let text = run_tool_of(&tool, &["verify", "--max-bodies", "4", &file]).out;
    assert!(text.contains("limit exceeded: 5 bodies, at most 4 are allowed"), "{text}");
    // A game without `Game::world` counts as a game without bodies.
    let other = folder.write("counter.replay", &replay(3));
    assert_eq!(run(&["verify", "--max-bodies", "0", &other]).exit, Exit::Success);
}

#[test]
fn a_name_cannot_reverse_the_text_of_a_terminal() {
    let folder = Folder::new("override");
    let file = folder.write("a\u{202e}yalper.replay", &replay(3));
    for arguments in [["verify", "--json"], ["inspect", "--json"], ["verify", "--jobs=1"]] {
        let outcome = run(&[arguments[0], arguments[1], &file]);
        let texts = outcome.out + &outcome.err;
        assert!(texts.contains("u202e") || texts.contains("u{202e}"), "{arguments:?}: {texts}");
        assert!(!texts.contains('\u{202e}'), "{arguments:?}: {texts}");
    }
    assert_eq!(line(&run(&["verify", "--json", &file]).out)["file"], file);
}

#[test]
fn a_panic_is_said_and_hides_no_other() {
    let folder = Folder::new("panic");
    folder.write("a.replay", &replay(3));
    let file = folder.write("b.replay", &fuse(12));
    folder.write("c.replay", &replay(3));
    let outcome = run_bomb(&["verify", "--json", "--jobs", "2", &folder.path("")]);
    assert_eq!((outcome.out.lines().count(), outcome.exit), (3, Exit::NoMatch));
    assert!(outcome.err.starts_with("2 of 3 files match (1 panicked); "), "{}", outcome.err);
    let mut line: Value = serde_json::from_str(outcome.out.lines().nth(1).unwrap()).unwrap();
    assert!(line.as_object_mut().unwrap().remove("game").is_some());
    let place = line["location"].take();
    assert!(place.as_str().unwrap().contains("batch.rs:"), "{place}");
    let expected = json!({
        "file": file, "verdict": "panicked", "ticks": 12, "hash": null, "cached": false,
        "blake3": blake3::hash(&fuse(12)).to_string(), "bytes": fuse(12).len(), "why": "somebody\nadded 13", "location": null,
    });
    assert_eq!(line, expected);

    let outcome = run_bomb(&["verify", &file]);
    assert_eq!(outcome.out.lines().count(), 2, "the message is escaped to stay on one line: {}", outcome.out);
    assert!(outcome.out.contains("panicked: the game, after 12 ticks, at "), "{}", outcome.out);
    assert!(outcome.out.contains("somebody\\nadded 13"), "{}", outcome.out);
}

#[test]
fn a_panic_is_the_error_of_other_commands_too() {
    let folder = Folder::new("panic-others");
    let file = folder.write("a.replay", &fuse(12));
    let picture = folder.path("a.jsonl");
    for arguments in [
        vec!["stats", &file],
        vec!["inspect", &file, "--tick", "13"],
        vec!["export", &file, "--json"],
        vec!["export", &file, "-o", &picture],
    ] {
        let outcome = run_bomb(&arguments);
        assert_eq!(outcome.exit, Exit::NoMatch, "{arguments:?}");
        for part in ["a.replay: panicked: the game, after 12 ticks, at ", "batch.rs:", "somebody\\nadded 13"]
        {
            assert!(outcome.err.contains(part), "{arguments:?}: {}", outcome.err);
        }
    }
    // The errors of these commands do not state the number of played ticks.
    for arguments in [
        vec!["seek", &file, "--tick", "13"],
        vec!["fork", &file, "--tick", "13", "-o", &picture],
        vec!["trim", &file, "-o", &picture],
        vec!["trace", &file, "-o", &picture],
        vec!["stress-saves", &file],
        vec!["bisect", &file],
    ] {
        let outcome = run_bomb(&arguments);
        assert_eq!(outcome.exit, Exit::NoMatch, "{arguments:?}");
        for part in ["a.replay: panicked: the game, at ", "batch.rs:", "somebody\\nadded 13"] {
            assert!(outcome.err.contains(part), "{arguments:?}: {}", outcome.err);
        }
    }
    assert!(!std::path::Path::new(&picture).exists());
}

#[test]
fn a_panic_in_a_comparison_names_both_files() {
    let folder = Folder::new("panic-both");
    let bad = folder.write("bad.replay", &fuse(12));
    // `diff` plays the longer replay.
    for (command, ticks) in [("bisect", 20), ("diff", 12)] {
        let good = folder.write("good.replay", &replay(ticks));
        for [a, b] in [[&good, &bad], [&bad, &good]] {
            let outcome = run_bomb(&[command, a, b]);
            let expected = format!(" {a} or {b}: panicked: the game, at ");
            assert!(outcome.err.contains(&expected), "{command}: {}", outcome.err);
            assert_eq!(outcome.exit, Exit::NoMatch);
        }
    }
}

#[test]
fn a_setup_may_panic_as_well() {
    let folder = Folder::new("panic-setup");
    let start = crate::counter::Setup { start: 13, ..setup() };
    let bytes = Recording::<Counter>::start(&start, 10).unwrap().finish().unwrap();
    let outcome = run_bomb(&["verify", "--json", &folder.write("a.replay", &bytes)]);
    let line = line(&outcome.out);
    assert_eq!((line["verdict"].as_str(), line["ticks"].as_u64()), (Some("panicked"), Some(0)));
}

/// A game whose state has the text of its setup as a key. With `REFUSES`, it refuses the setup, with the text as the
/// reason.
struct Echo<const REFUSES: bool>(BTreeMap<String, u64>);

impl<const REFUSES: bool> Game for Echo<REFUSES> {
    type Setup = String;
    type Input = ();
    type Save = BTreeMap<String, u64>;
    const RULES: RulesId = RulesId { name: "echo", version: 1 };

    fn new(text: &String) -> Result<Self, SetupError> {
        if REFUSES {
            return Err(SetupError { why: text.clone() });
        }
        Ok(Echo(BTreeMap::from([(text.clone(), 0)])))
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, _: &[()]) {
        self.0.values_mut().for_each(|number| *number += 1);
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.0)
    }

    fn save(&self) -> Self::Save {
        self.0.clone()
    }

    fn load(&mut self, save: &Self::Save) {
        self.0.clone_from(save);
    }

    fn work(&self, _: &[()]) -> u64 {
        1
    }
}

/// Text that would clear the screen of a terminal and show a false result line.
const FORGERY: &str = "\u{1b}[2J\rA.replay: match\n";

fn assert_escaped(texts: &str, arguments: &[&str]) {
    assert!(texts.contains("\\u{1b}[2J\\rA.replay: match\\n"), "{arguments:?}: {texts:?}");
    assert!(!texts.contains(['\u{1b}', '\r']), "{arguments:?}: {texts:?}");
}

#[test]
fn an_error_cannot_write_to_the_terminal() {
    let folder = Folder::new("echo-errors");
    let bytes = Recording::<Echo<false>>::start(&FORGERY.into(), 10).unwrap().finish().unwrap();
    let (file, output) = (folder.write("a", &bytes), folder.path("output"));
    let tool = Tool::<Echo<true>>::new();
    for arguments in [
        &["verify", &file][..],
        &["stats", &file],
        &["bisect", &file],
        &["diff", &file, &file],
        &["stress-saves", &file],
        &["inspect", &file, "--tick", "0"],
        &["seek", &file, "--tick", "0"],
        &["export", &file, "--json"],
        &["fork", &file, "--tick", "0", "-o", &output],
        &["trim", &file, "-o", &output],
        &["trace", &file, "-o", &output],
    ] {
        let outcome = run_tool_of(&tool, arguments);
        assert_escaped(&(outcome.out + &outcome.err), arguments);
    }
}

#[test]
fn a_comparison_cannot_write_to_the_terminal() {
    let folder = Folder::new("echo-diff");
    let report = |ticks: usize| {
        let mut game = Echo::<false>::new(&FORGERY.into()).unwrap();
        (0..ticks).for_each(|_| game.step(&[()]));
        let mut history = History::<Echo<false>>::of_ticks(1);
        history.push(1, game.save(), game.state_hash());
        let found = Desync { players: 1, tick: 1, known: 1, seats: Vec::new(), hashes: Vec::new() };
        DesyncReport::new(&found, &history, Vec::new()).to_bytes()
    };
    let (a, b) = (folder.write("a", &report(1)), folder.write("b", &report(2)));
    let outcome = run_tool_of(&Tool::<Echo<false>>::new(), &["diff", &a, &b]);
    assert_escaped(&outcome.out, &["diff"]);
    assert!(outcome.out.contains("\n    value: 1 | 2\n"), "{}", outcome.out);
}

/// Defines a game that is the counter under another rules identifier.
macro_rules! other_rules {
    ($name:ident, $rules:expr) => {
        struct $name(Counter);

        impl Game for $name {
            type Setup = crate::counter::Setup;
            type Input = crate::counter::Input;
            type Save = Counter;
            const RULES: RulesId = $rules;

            fn new(setup: &Self::Setup) -> Result<Self, lockstep2d::lockstep::SetupError> {
                Counter::new(setup).map($name)
            }

            like_its_counter!(0);

            fn step(&mut self, inputs: &[Self::Input]) {
                self.0.step(inputs);
            }
        }
    };
}

other_rules!(Later, RulesId { name: "counter", version: 4 });
other_rules!(Renamed, RulesId { name: "adder", version: 3 });

#[test]
fn what_cannot_be_verified_says_what_it_needs() {
    let folder = Folder::new("needs");
    let later = Recording::<Later>::start(&setup(), 10).unwrap().finish().unwrap();
    let renamed = Recording::<Renamed>::start(&setup(), 10).unwrap().finish().unwrap();
    // A header with semantics 2. The checksum at its end is computed again.
    let mut older = Recording::<Counter>::start(&setup(), 10).unwrap().take_bytes();
    let end = older.len() - 8;
    older[12] = 2;
    let checksum = lockstep2d::hash::StateHash::of_bytes(&older[..end]).0.to_le_bytes();
    older[end..].copy_from_slice(&checksum[..8]);
    for (bytes, semantics, name, version, why) in [
        (
            later,
            lockstep2d::SEMANTICS,
            "counter",
            4,
            "made with the rules \"counter\" version 4, this program has \"counter\" version 3",
        ),
        (
            renamed,
            lockstep2d::SEMANTICS,
            "adder",
            3,
            "made with the rules \"adder\" version 3, this program has \"counter\" version 3",
        ),
        (older, 2, "counter", 3, "made with engine semantics 2, this program has 25"),
    ] {
        let file = folder.write("a.replay", &bytes);
        let outcome = run(&["verify", "--json", &file]);
        let line = line(&outcome.out);
        let needs = json!({"format": 1, "semantics": semantics, "rules": name, "rules_version": version});
        assert_eq!((&line["needs"], line["why"].as_str()), (&needs, Some(why)));
        assert_eq!(outcome.exit, Exit::NoMatch);
        assert!(run(&["verify", &file]).out.contains(why));
    }
}

#[test]
fn declared_results_are_shown() {
    let folder = Folder::new("declared");
    let file = folder.write("good.replay", &replay(0));
    let outcome = run(&["verify", &file]);
    let line = outcome.out.lines().next().unwrap();
    assert!(line.ends_with("; half 2, sum 5"), "{line}");
}

#[test]
fn the_help_of_verify_states_the_limits_of_the_tool() {
    let limits = Limits { ticks: 12_345, ..Limits::default() };
    let help = run_tool(&Tool::new().with_limits(limits), &["verify", "--help"]).out;
    for text in ["number of ticks [default: 12345]", "size of the file in bytes [default: 67108864]"] {
        assert!(help.contains(text), "{help}");
    }
}
