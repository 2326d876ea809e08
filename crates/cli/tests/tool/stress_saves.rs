//! `stress-saves`: a correct game passes, and the first difference of an incomplete save is reported.

use std::collections::BTreeMap;
use std::fs;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, Sandbox, SetupError};
use lockstep2d::replay::Recording;
use lockstep2d_cli::{Exit, Tool};
use serde_json::Value as Json;

use super::{Folder, Outcome, run, run_tool_of};

/// A game whose save lacks the field `bonus`.
struct Forgetful {
    tick: u64,
    bonus: u64,
    points: u64,
}

impl Game for Forgetful {
    type Setup = ();
    type Input = u8;
    type Save = (u64, u64);

    const RULES: RulesId = RulesId { name: "forgetful", version: 1 };

    fn new(_: &()) -> Result<Self, SetupError> {
        Ok(Forgetful { tick: 0, bonus: 0, points: 0 })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u8]) {
        self.tick += 1;
        if inputs == [1] {
            self.bonus += 1;
        }
        if inputs == [2] {
            self.points += self.bonus;
        }
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.save())
    }

    fn save(&self) -> (u64, u64) {
        (self.tick, self.points)
    }

    fn load(&mut self, save: &(u64, u64)) {
        (self.tick, self.points) = *save;
    }

    fn work(&self, _: &[u8]) -> u64 {
        1
    }
}

/// A replay in which the player gets a bonus in tick 20 and scores with it in tick 71.
fn forgetful() -> Vec<u8> {
    let mut recording = Recording::<Forgetful>::start(&(), 10).unwrap();
    for tick in 1..=90 {
        let input = match tick {
            20 => 1,
            71 => 2,
            _ => 0,
        };
        recording.step(&[input]).unwrap();
    }
    recording.finish().unwrap()
}

fn stress_saves(folder: &Folder, file: &[u8], more: &[&str]) -> Outcome {
    let path = folder.write("a.replay", file);
    run_tool_of(&Tool::<Forgetful>::new(), &[&["stress-saves", &path], more].concat())
}

#[test]
fn a_good_game_holds() {
    let folder = Folder::new("stress-good");
    let path = folder.write("a.replay", &super::replay(100));
    for more in [&[][..], &["--rollback"], &["--all"], &["--from", "40"], &["--to", "60"]] {
        let done = run(&[&["stress-saves", &path], more].concat());
        assert_eq!((done.exit, done.err.as_str()), (Exit::Success, ""), "{more:?}: {}", done.out);
        assert!(done.out.contains("holds"), "{}", done.out);
    }
    let done = run(&["stress-saves", &path, "--json", "--from", "30", "--to", "80"]);
    let document: Json = serde_json::from_str(&done.out).unwrap();
    assert_eq!(
        (&document["holds"], &document["from"], &document["ticks"]),
        (&true.into(), &30.into(), &80.into())
    );
}

#[test]
fn the_tick_of_a_fault_is_said() {
    let folder = Folder::new("stress-bad");
    let done = stress_saves(&folder, &forgetful(), &[]);
    assert_eq!(done.exit, Exit::NoMatch, "{}", done.err);
    assert!(done.out.contains("after tick 71") && done.out.contains("[1]: 1 | 0"), "{}", done.out);

    let done = stress_saves(&folder, &forgetful(), &["--json"]);
    let document: Json = serde_json::from_str(&done.out).unwrap();
    let failure = &document["failure"];
    assert_eq!((&document["holds"], &failure["tick"]), (&false.into(), &71.into()));
    assert_eq!(
        (&failure["fields"][0]["path"], &failure["fields"][0]["b"]["text"]),
        (&"[1]".into(), &"0".into())
    );
    assert_eq!(document["minimised"], Json::Null);

    // No difference is found if the play ends before the bonus counts, or if the comparison begins after it has
    // counted.
    for more in [["--to", "70"], ["--from", "71"]] {
        assert_eq!(stress_saves(&folder, &forgetful(), &more).exit, Exit::Success, "{more:?}");
    }
    let done = stress_saves(&folder, &forgetful(), &["--from", "21", "--rollback"]);
    assert!(done.out.contains("after tick 71"), "{}", done.out);
}

#[test]
fn a_short_replay_that_fails_is_written() {
    let folder = Folder::new("stress-short");
    let short = folder.0.join("short.replay");
    let done = stress_saves(&folder, &forgetful(), &["-o", short.to_str().unwrap()]);
    assert!(done.out.contains("2 ticks that fail 4 times out of 4"), "{}", done.out);
    let done = stress_saves(&folder, &fs::read(&short).unwrap(), &[]);
    assert_eq!(done.exit, Exit::NoMatch);
    assert!(done.out.contains("after tick 2"), "{}", done.out);
}

/// A game whose score depends on the number of wrongly predicted inputs.
struct Corrected {
    tick: u64,
    points: u64,
    seen: BTreeMap<u64, u8>,
    corrections: u64,
}

impl Game for Corrected {
    type Setup = ();
    type Input = u8;
    type Save = (u64, u64);

    const RULES: RulesId = RulesId { name: "corrected", version: 1 };

    fn new(_: &()) -> Result<Self, SetupError> {
        Ok(Corrected { tick: 0, points: 0, seen: BTreeMap::new(), corrections: 0 })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u8]) {
        self.tick += 1;
        let before = self.seen.insert(self.tick, inputs[0]);
        self.corrections += u64::from(before.is_some_and(|before| before != inputs[0]));
        self.points += self.corrections;
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.save())
    }

    fn save(&self) -> (u64, u64) {
        (self.tick, self.points)
    }

    fn load(&mut self, save: &(u64, u64)) {
        (self.tick, self.points) = *save;
    }

    fn work(&self, _: &[u8]) -> u64 {
        1
    }
}

#[test]
fn a_short_replay_fails_with_the_same_command() {
    let folder = Folder::new("stress-again");
    let mut recording = Recording::<Corrected>::start(&(), 10).unwrap();
    (0..60).for_each(|tick| recording.step(&[u8::from(tick % 3 == 0)]).unwrap());
    let (path, short) = (folder.write("a.replay", &recording.finish().unwrap()), folder.path("short.replay"));
    let tool = Tool::<Corrected>::new();
    let done = run_tool_of(&tool, &["stress-saves", &path, "--rollback", "-o", &short]);
    assert!(done.out.contains(": 1 ticks that fail 4 times out of 4: rolled back by 1 tick"), "{}", done.out);
    let again = run_tool_of(&tool, &["stress-saves", &short, "--rollback"]);
    assert_eq!(again.exit, Exit::NoMatch, "{}", again.out);
    assert!(again.out.contains("fails: rolled back by 1 tick after guessing"), "{}", again.out);
}

#[test]
fn what_cannot_be_played_is_refused() {
    let folder = Folder::new("stress-none");
    let path = folder.write("a.replay", &super::replay(20));
    let done = run(&["stress-saves", &path, "--from", "21"]);
    assert_eq!(done.exit, Exit::Trouble);
    assert!(done.err.contains("has 20 ticks, there is no tick 21"), "{}", done.err);
    assert_eq!(run(&["stress-saves", &path, "--to", "21"]).exit, Exit::Trouble);
    let done = run(&["stress-saves", &path, "--from", "20", "--to", "10"]);
    assert!(done.err.contains("--from 20 is after --to 10"), "{}", done.err);
    assert_eq!((done.exit, run(&["stress-saves", "nowhere.replay"]).exit), (Exit::Trouble, Exit::Trouble));
    // A replay of another game, and a file that is no replay.
    assert_eq!(stress_saves(&folder, &super::replay(20), &[]).exit, Exit::NoMatch);
    assert_eq!(stress_saves(&folder, b"no replay", &[]).exit, Exit::NoMatch);
}

#[test]
fn goldens_of_the_sandbox_hold() {
    let tool = Tool::<Sandbox>::new();
    for name in ["box_stack", "spawning", "ragdoll", "chain"] {
        let path = format!("{}/../../replays/{name}.replay", env!("CARGO_MANIFEST_DIR"));
        for range in [&["--to", "20"][..], &["--from", "30", "--to", "45", "--rollback"]] {
            let done = run_tool_of(&tool, &[&["stress-saves", &path], range].concat());
            assert_eq!(done.exit, Exit::Success, "{name}: {}{}", done.out, done.err);
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_failing_replay_that_cannot_be_written_is_an_error() {
    let folder = Folder::new("stress-full");
    let outcome = stress_saves(&folder, &forgetful(), &["-o", "/dev/full"]);
    assert_eq!(outcome.exit, Exit::Trouble, "{}", outcome.out);
    assert!(outcome.err.contains("cannot write /dev/full"), "{}", outcome.err);
}
