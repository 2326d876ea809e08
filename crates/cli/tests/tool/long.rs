//! `verify` with slow files: they delay no other file, are reported by name, and can be stopped without a verdict.

use std::fs;
use std::thread;
use std::time::Duration;

use lockstep2d::lockstep::{Game, RulesId};
use lockstep2d_cli::{Exit, Tool};
use serde_json::Value;

use crate::counter::{Counter, Input, Setup, add, like_its_counter, setup};
use crate::{Folder, Outcome, replay, run_tool_of};

/// The input at which a tick of [`Slow`] takes 100 ms.
const SLOW: i8 = 17;

/// A counter with slow ticks.
struct Slow(Counter);

impl Game for Slow {
    type Setup = Setup;
    type Input = Input;
    type Save = Counter;

    const RULES: RulesId = Counter::RULES;

    fn new(setup: &Setup) -> Result<Self, lockstep2d::lockstep::SetupError> {
        Counter::new(setup).map(Slow)
    }

    like_its_counter!(0);

    fn step(&mut self, inputs: &[Input]) {
        if inputs[0].add == SLOW {
            thread::sleep(Duration::from_millis(100));
        }
        self.0.step(inputs);
    }

    fn claims(&self) -> Vec<(String, i64)> {
        self.0.claims()
    }
}

fn run_slow(arguments: &[&str]) -> Outcome {
    run_tool_of(&Tool::<Slow>::new(), arguments)
}

/// A replay whose ticks take 100 ms each.
fn slow(ticks: u64) -> Vec<u8> {
    let mut recording = lockstep2d::replay::Recording::<Counter>::start(&setup(), 10).unwrap();
    for _ in 0..ticks {
        recording.step(&add(SLOW, 0)).unwrap();
    }
    recording.finish().unwrap()
}

fn lines(outcome: &Outcome) -> Vec<Value> {
    outcome.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_file_without_time_has_no_verdict_and_is_not_cached() {
    let folder = Folder::new("long-seconds");
    let (good, long) = (folder.write("a.replay", &replay(5)), folder.write("b.replay", &slow(25)));
    let cache = folder.path("cache");
    let arguments = ["verify", "--json", "--cache", &cache, "--max-seconds", "1", &good, &long];
    for known in [false, true] {
        let outcome = run_slow(&arguments);
        let lines = lines(&outcome);
        assert_eq!((lines.len(), outcome.exit), (2, Exit::Trouble), "{}", outcome.out);
        assert_eq!((&lines[0]["verdict"], &lines[0]["cached"]), (&"match".into(), &known.into()));
        assert_eq!(lines[1]["verdict"], Value::Null);
        assert_eq!(
            (lines[1]["stopped"].as_str(), lines[1]["seconds"].as_u64()),
            (Some("max_seconds"), Some(1))
        );
        let ticks = lines[1]["ticks"].as_u64().unwrap();
        assert!((1..25).contains(&ticks), "{ticks}");
        assert!(outcome.err.contains("1 of 2 files match; 1 out of time"), "{}", outcome.err);
    }
    let text = run_slow(&["verify", "--max-seconds", "1", &long]);
    assert!(text.out.contains("b.replay: out of time: no verdict after 1 s and "), "{}", text.out);
    // With enough time the file is verified, and only then cached.
    let enough = ["verify", "--json", "--cache", &cache, "--max-seconds", "600", &long];
    for known in [false, true] {
        let line = lines(&run_slow(&enough)).remove(0);
        assert_eq!((&line["verdict"], &line["cached"]), (&"match".into(), &known.into()));
    }
    for wrong in ["0", "-1", "1.5", "soon"] {
        assert_eq!(run_slow(&["verify", "--max-seconds", wrong, &good]).exit, Exit::Trouble, "{wrong}");
    }
}

#[test]
fn unordered_results_do_not_wait_for_a_long_file() {
    let folder = Folder::new("long-unordered");
    for number in 0..30 {
        folder.write(&format!("{number:02}.replay"), &replay(number));
    }
    folder.write("10.replay", &slow(10));
    let whole = folder.path("");
    let file = |line: &Value| line["file"].as_str().unwrap().to_string();
    let files = |arguments: &[&str]| lines(&run_slow(arguments)).iter().map(file).collect::<Vec<_>>();
    let in_order = files(&["verify", "--json", "--jobs", "2", &whole]);
    assert!(in_order.is_sorted() && in_order.len() == 30);
    let mut unordered = files(&["verify", "--json", "--jobs", "2", "--unordered", &whole]);
    assert!(unordered.last().unwrap().ends_with("10.replay"), "{unordered:?}");
    unordered.sort();
    assert_eq!(unordered, in_order);
}

#[test]
fn a_long_file_is_named_with_its_tick_and_rate() {
    let folder = Folder::new("long-named");
    let file = folder.write("a.replay", &slow(70));
    let outcome = run_slow(&["verify", "--json", &file]);
    let named = outcome.err.lines().next().unwrap();
    assert!(named.starts_with(&format!("{file}: at work for ")), "{}", outcome.err);
    assert!(named.contains(" of 70, ") && named.ends_with(" ticks per second"), "{named}");
    assert_eq!((outcome.out.lines().count(), outcome.exit), (1, Exit::Success));
}

/// A pipe without a writer stands for a file whose verification never ends.
#[cfg(unix)]
#[test]
fn signals_say_what_was_at_work_and_lose_no_result() {
    use std::io::{BufRead, BufReader, Read};
    use std::os::unix::process::ExitStatusExt;
    use std::process::{Command, Stdio};

    let folder = Folder::new("long-signal");
    let bytes = fs::read(crate::golden("free_fall")).unwrap();
    let before = folder.write("a.replay", &bytes);
    let endless = folder.path("b");
    assert!(Command::new("mkfifo").arg(&endless).status().unwrap().success());
    let after = folder.write("c.replay", &bytes);
    for (name, signal) in [("TERM", 15), ("INT", 2)] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_lockstep2d"))
            .args(["verify", "--jobs", "2", &before, &endless, &after])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut first = String::new();
        out.read_line(&mut first).unwrap();
        assert!(first.starts_with(&format!("{before}: match: ")), "{first}");
        // Meanwhile the third file is verified. Its result has to wait, because the second file has no result yet.
        thread::sleep(Duration::from_millis(1500));
        let kill = ["-s", name, &child.id().to_string()].map(String::from);
        assert!(Command::new("kill").args(kill).status().unwrap().success());
        let (mut rest, mut err) = (String::new(), String::new());
        out.read_to_string(&mut rest).unwrap();
        child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
        assert_eq!(child.wait().unwrap().signal(), Some(signal), "{err}");
        assert!(rest.starts_with(&format!("{after}: match: ")), "{rest}");
        assert!(err.contains(&format!("{endless}: at work for ")), "{err}");
        assert!(err.contains(&format!("stopped by SIG{name} with 1 files at work")), "{err}");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_in_the_cache_is_no_entry() {
    let folder = Folder::new("long-pipe");
    let (file, cache) = (folder.write("a.replay", &replay(3)), folder.path("cache"));
    let arguments = ["verify", "--json", "--cache", &cache, &file];
    run_slow(&arguments);
    let entry = fs::read_dir(&cache).unwrap().next().unwrap().unwrap().path();
    fs::remove_file(&entry).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&entry).status().unwrap().success());
    let line = lines(&run_slow(&arguments)).remove(0);
    assert_eq!((&line["verdict"], &line["cached"]), (&"match".into(), &false.into()));
}
