//! `verify` with many files: jobs, shards, standard input, and the order of the lines.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};
use std::rc::Rc;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::replay::Recording;
use lockstep2d_cli::{Exit, Tool};
use serde_json::Value;

use crate::counter::{Counter, Input, Setup, add, inputs_at, setup};
use crate::{Folder, Outcome, replay, run, run_tool_of};

/// An input at which [`Bomb`] panics.
const FUSE: i8 = 13;

fn explode(now: bool) {
    assert!(!now, "in a setup");
}

/// A counter that panics when an input or the start value in the setup is [`FUSE`]. It is not `Send`, because the tools
/// must not require this of a game.
pub(crate) struct Bomb(Rc<Cell<Counter>>);

impl Bomb {
    fn counter(&self) -> Counter {
        let counter = self.0.replace(Counter { sum: 0, tick: 0, moods: 0 });
        self.0.set(counter.clone());
        counter
    }
}

impl Game for Bomb {
    type Setup = Setup;
    type Input = Input;
    type Save = Counter;

    const RULES: RulesId = Counter::RULES;

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        explode(setup.start == i32::from(FUSE));
        Ok(Bomb(Rc::new(Cell::new(Counter::new(setup)?))))
    }

    fn players(&self) -> u32 {
        self.counter().players()
    }

    fn tick_rate(&self) -> u32 {
        self.counter().tick_rate()
    }

    fn step(&mut self, inputs: &[Input]) {
        assert!(inputs[0].add != FUSE, "somebody\nadded {}", inputs[0].add);
        let mut counter = self.counter();
        counter.step(inputs);
        self.0.set(counter);
    }

    fn state_hash(&self) -> StateHash {
        self.counter().state_hash()
    }

    fn save(&self) -> Counter {
        self.counter()
    }

    fn load(&mut self, save: &Counter) {
        self.0.set(save.clone());
    }

    fn work(&self, inputs: &[Input]) -> u64 {
        self.counter().work(inputs)
    }

    fn claims(&self) -> Vec<(String, i64)> {
        self.counter().claims()
    }
}

pub(crate) fn run_bomb(arguments: &[&str]) -> Outcome {
    run_tool_of(&Tool::<Bomb>::new(), arguments)
}

/// A replay in which [`Bomb`] panics after `ticks` ticks.
pub(crate) fn fuse(ticks: u64) -> Vec<u8> {
    let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
    for tick in 0..ticks {
        recording.step(&inputs_at(tick)).unwrap();
    }
    recording.step(&add(FUSE, 0)).unwrap();
    recording.finish().unwrap()
}

/// The bytes of a file and its verdict. `number` selects the kind of the file.
fn file(number: u64) -> (Vec<u8>, &'static str) {
    let mut good = replay(number * 31 % 400);
    let length = good.len();
    match number % 7 {
        0 => (good[..length - 1].to_vec(), "incomplete"),
        1 => {
            good[50] ^= 1;
            (good, "malformed")
        }
        2 => {
            good[8] = 9;
            (good, "unverifiable")
        }
        3 => (fuse(number), "panicked"),
        _ => (good, "match"),
    }
}

/// A folder of `count` small files, and their paths and verdicts in path order.
fn folder(test: &str, count: u64) -> (Folder, Vec<(String, &'static str)>) {
    let folder = Folder::new(test);
    let (mut expected, mut folders) = (Vec::new(), ["a", "a/b", "c", "."]);
    for number in 0..count {
        let (bytes, verdict) = file(number);
        folders.rotate_left(1);
        let name = format!("{}/{:04}.replay", folders[0], number * 7 % count);
        folder.write(&name, &bytes);
        expected.push((name.replace("./", ""), verdict));
    }
    expected.sort();
    (folder, expected)
}

fn parsed(outcome: &Outcome) -> Vec<Value> {
    outcome.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn any_number_of_jobs_prints_the_same() {
    let (folder, expected) = folder("jobs", 300);
    let path = folder.path("");
    let alone = run_bomb(&["verify", "--json", "--jobs", "1", &path]);
    assert_eq!(alone.exit, Exit::NoMatch);
    let verdicts: Vec<(String, String)> = parsed(&alone)
        .iter()
        .map(|line| {
            (line["file"].as_str().unwrap().to_string(), line["verdict"].as_str().unwrap().to_string())
        })
        .collect();
    let expected: Vec<(String, String)> =
        expected.iter().map(|(name, verdict)| (folder.path(name), verdict.to_string())).collect();
    assert_eq!(verdicts, expected);

    let for_people = |outcome: &Outcome| {
        let lines = outcome.out.lines().map(String::from);
        lines.map(|line| line.split(" ticks in ").next().unwrap().to_string()).collect::<Vec<_>>()
    };
    let alone_for_people = for_people(&run_bomb(&["verify", "--jobs", "1", &path]));
    assert_eq!(alone_for_people.len(), 301);
    for jobs in ["2", "3", "16"] {
        let together = run_bomb(&["verify", "--json", "--jobs", jobs, &path]);
        assert_eq!((together.out, together.exit), (alone.out.clone(), alone.exit), "{jobs}");
        let together = run_bomb(&["verify", "--jobs", jobs, &path]);
        assert_eq!(for_people(&together), alone_for_people, "{jobs}");
    }
    assert_eq!(run_bomb(&["verify", &path]).exit, Exit::NoMatch, "the default number of jobs");
    for wrong in ["0", "-1", "many", "100000"] {
        assert_eq!(run_bomb(&["verify", "--jobs", wrong, &path]).exit, Exit::Trouble, "{wrong}");
    }
}

#[test]
fn what_goes_wrong_is_said_in_its_place() {
    let folder = Folder::new("place");
    let good = folder.write("good.replay", &replay(3));
    let arguments = ["verify", "--json", "--jobs", "2", &good, "no such file", &good];
    let outcome = run(&arguments);
    let lines: Vec<Value> = outcome.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let has_verdict = |line: &Value| line["verdict"] == "match";
    assert_eq!(lines.iter().map(has_verdict).collect::<Vec<_>>(), [true, false, true]);
    assert_eq!((&lines[1]["file"], outcome.exit), (&"no such file".into(), Exit::Trouble));
    assert!(outcome.err.starts_with("error: cannot read no such file: "), "{}", outcome.err);
    assert!(outcome.err.contains("\n2 of 2 files match; 6 ticks in "), "{}", outcome.err);
}

#[test]
fn every_file_is_in_one_part() {
    let (folder, expected) = folder("parts", 100);
    let path = folder.path("");
    let whole: BTreeSet<String> =
        run_bomb(&["verify", "--json", &path]).out.lines().map(String::from).collect();
    assert_eq!(whole.len(), expected.len());
    for count in [1, 2, 3, 7, 150] {
        let mut lines = BTreeMap::<String, u64>::new();
        for part in 1..=count {
            let outcome = run_bomb(&["verify", "--json", "--shard", &format!("{part}/{count}"), &path]);
            if outcome.out.is_empty() {
                assert_eq!(outcome.exit, Exit::Success, "an empty shard {part}/{count} is a success");
                assert!(outcome.err.starts_with("0 of 0 files match"), "{}", outcome.err);
            }
            for line in outcome.out.lines() {
                *lines.entry(line.to_string()).or_default() += 1;
            }
        }
        assert!(lines.values().all(|times| *times == 1), "{count}");
        assert_eq!(lines.into_keys().collect::<BTreeSet<_>>(), whole, "{count}");
    }
    for wrong in ["0/3", "4/3", "1", "a/b", ""] {
        assert_eq!(run_bomb(&["verify", "--shard", wrong, &path]).exit, Exit::Trouble, "{wrong}");
    }
    fs::create_dir(folder.path("empty")).unwrap();
    let nothing = run_bomb(&["verify", "--shard", "1/2", &folder.path("empty")]);
    assert_eq!(nothing.exit, Exit::Trouble, "a folder without replays is an error in every shard");
}

#[test]
fn a_part_does_not_depend_on_where_the_folder_is_or_what_else_is_there() {
    let (folder, other) = (Folder::new("part-here"), Folder::new("part-there"));
    let taken = |folder: &Folder, below: &str| {
        let outcome = run(&["verify", "--json", "--shard", "2/3", &folder.path(below)]);
        let strip = |line: &Value| line["file"].as_str().unwrap().rsplit('/').next().unwrap().to_string();
        parsed(&outcome).iter().map(strip).collect::<BTreeSet<_>>()
    };
    for number in 0..40 {
        folder.write(&format!("{number}.replay"), &replay(1));
        other.write(&format!("deeper/still/{number}.replay"), &replay(1));
    }
    let before = taken(&folder, "");
    assert!((5..25).contains(&before.len()), "{}", before.len());
    assert_eq!(taken(&other, "deeper/still"), before);
    for number in 40..80 {
        folder.write(&format!("{number}.replay"), &replay(1));
    }
    assert!(taken(&folder, "").is_superset(&before));
}

/// Runs the `lockstep2d` command with `input` as the standard input.
fn with_input(arguments: &[&str], input: &[u8]) -> (String, Option<i32>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lockstep2d"));
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    // The command may exit before it has read everything.
    let _ = child.stdin.take().unwrap().write_all(input);
    let output = child.wait_with_output().unwrap();
    (String::from_utf8(output.stdout).unwrap(), output.status.code())
}

#[test]
fn a_replay_comes_from_standard_input() {
    let (out, code) = with_input(&["verify", "--json", "-"], b"no replay");
    let line: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((line["file"].as_str(), line["verdict"].as_str()), (Some("-"), Some("malformed")));
    assert_eq!((line["bytes"].as_u64(), code), (Some(9), Some(1)));

    let replays = concat!(env!("CARGO_MANIFEST_DIR"), "/../../replays");
    let smallest = fs::read_dir(replays).unwrap().map(|entry| entry.unwrap().path());
    let smallest = smallest.filter(|path| path.extension().is_some_and(|extension| extension == "replay"));
    let smallest = smallest.min_by_key(|path| fs::metadata(path).unwrap().len()).unwrap();
    let bytes = fs::read(&smallest).unwrap();
    let (out, code) = with_input(&["verify", "-"], &bytes);
    assert!(out.starts_with("-: match: "), "{out}");
    assert_eq!(code, Some(0));

    let (out, code) = with_input(&["verify", "-", "-"], &bytes);
    assert_eq!((out.lines().count(), code), (2, Some(2)), "standard input can be read only once");
}

#[test]
fn standard_input_is_read_no_further_than_its_limit() {
    let (out, code) = with_input(&["verify", "--json", "--max-bytes", "100", "-"], &vec![7; 1 << 20]);
    let line: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((line["limit"].as_str(), line["value"].as_u64()), (Some("file_bytes"), Some(101)));
    assert_eq!((line["bytes"].as_u64(), code), (Some(101), Some(1)));
}
