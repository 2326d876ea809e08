//! `bisect` and `trace`: files, results and exit codes.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, Sandbox, SandboxSetup, SetupError};
use lockstep2d::replay::{Limits, Recording};
use lockstep2d::world::Command;
use lockstep2d_cli::{Exit, Tool};
use lockstep2d_scenes::Scene;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{Folder, run_sandbox, run_tool_of};

fn ragdoll() -> SandboxSetup {
    Scene::find("ragdoll").unwrap().setup(0)
}

/// A replay of 50 ticks. At tick `kicked`, a command stops the rotation of a body.
fn replay(kicked: Option<u64>) -> Vec<u8> {
    let mut recording = Recording::<Sandbox>::start(&ragdoll(), 20).unwrap();
    for tick in 0..50 {
        let mut commands = Vec::new();
        if kicked == Some(tick) {
            let (body, found) =
                recording.game().world().bodies().find(|(_, body)| body.is_dynamic()).unwrap();
            let velocity = found.velocity();
            commands.push(Command::SetVelocity { body, velocity, angular_velocity: lockstep2d::fx!(0) });
        }
        recording.step(&[commands]).unwrap();
    }
    recording.finish().unwrap()
}

fn json_of(arguments: &[&str]) -> (Value, Exit) {
    let outcome = run_sandbox(&[&["bisect", "--json"], arguments].concat());
    (serde_json::from_str(&outcome.out).unwrap(), outcome.exit)
}

#[test]
fn a_replay_of_this_program_and_its_trace_keep_its_course() {
    let folder = Folder::new("bisect-equal");
    let file = folder.write("a.replay", &replay(None));
    let trace = folder.path("a.trace");
    let outcome = run_sandbox(&["trace", &file, "--to", "30", "--ticks", "10", "-o", &trace]);
    assert_eq!((outcome.exit, outcome.err.as_str()), (Exit::Success, ""));
    assert_eq!(outcome.out, format!("{trace}: ticks 20 to 30, 11 of 11 states\n"));
    for (file, last) in [(&file, 50), (&trace, 30)] {
        let (found, exit) = json_of(&[file]);
        assert_eq!(
            (exit, &found["equal"], &found["last_equal"]),
            (Exit::Success, &true.into(), &last.into())
        );
    }
    let outcome = run_sandbox(&["bisect", &file]);
    assert!(outcome.out.contains("equal up to tick 50"), "{}", outcome.out);
}

#[test]
fn two_replays_with_other_inputs_part_after_the_first_that_matters() {
    let folder = Folder::new("bisect-inputs");
    let a = folder.write("a.replay", &replay(None));
    let b = folder.write("b.replay", &replay(Some(33)));
    let (found, exit) = json_of(&[&a, &b]);
    assert_eq!(exit, Exit::NoMatch);
    assert_eq!((&found["last_equal"], &found["first_different"]), (&33.into(), &34.into()));
    assert_eq!(found["stage"], "before_step");
    assert_eq!(found["input"]["tick"], 33);
    let outcome = run_sandbox(&["bisect", &a, &b]);
    assert!(outcome.out.contains("before the step of the world"), "{}", outcome.out);
}

#[test]
fn what_is_no_evidence_is_trouble() {
    let folder = Folder::new("bisect-trouble");
    let file = folder.write("nothing", b"nothing");
    for arguments in
        [&["bisect", &file][..], &["bisect", "/no/such/file"], &["trace", "/no/such/file", "-o", "x"]]
    {
        let outcome = run_sandbox(arguments);
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""), "{arguments:?}");
        assert!(!outcome.err.is_empty());
    }
    let output = folder.path("never");
    let outcome = run_sandbox(&["trace", &file, "-o", &output]);
    assert_eq!(outcome.exit, Exit::NoMatch);
    assert!(outcome.err.contains("malformed"), "{}", outcome.err);
}

/// A game whose inputs are texts of any length. They have no effect on the state, which is the number of ticks.
#[derive(Clone, Serialize, Deserialize)]
struct Shouts(u64);

impl Game for Shouts {
    type Setup = ();
    type Input = String;
    type Save = Shouts;

    const RULES: RulesId = RulesId { name: "shouts", version: 1 };

    fn new(_: &()) -> Result<Self, SetupError> {
        Ok(Shouts(0))
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, _: &[String]) {
        self.0 += 1;
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(self)
    }

    fn save(&self) -> Shouts {
        self.clone()
    }

    fn load(&mut self, save: &Shouts) {
        *self = save.clone();
    }

    fn work(&self, _: &[String]) -> u64 {
        1
    }
}

/// A block holds at most 16 MiB, so the two inputs of 10 MB need two blocks. A command that records the replay again
/// must therefore keep its checkpoint interval, which is one tick.
#[test]
fn a_replay_with_large_inputs_is_traced_and_stressed() {
    let folder = Folder::new("trace-large");
    let mut recording = Recording::<Shouts>::start(&(), 1).unwrap();
    for letter in ["a", "b"] {
        recording.step(&[letter.repeat(10_000_000)]).unwrap();
    }
    let file = folder.write("large.replay", &recording.finish().unwrap());
    let tool = Tool::<Shouts>::new();
    let trace = folder.path("trace");
    let done = [&["verify", &file][..], &["trace", &file, "-o", &trace], &["stress-saves", "--all", &file]]
        .map(|arguments| run_tool_of(&tool, arguments));
    let exits = done.each_ref().map(|outcome| outcome.exit);
    assert_eq!(exits, [Exit::Success; 3], "{:?}", done.map(|outcome| outcome.out + &outcome.err));
}

#[test]
fn a_trace_that_is_too_long_is_wrong_usage() {
    let folder = Folder::new("trace-long");
    let bytes = replay(None);
    let file = folder.write("a.replay", &bytes);
    let limits = Limits { file_bytes: bytes.len() as u64 + 100, ..Limits::default() };
    let tool = Tool::<Sandbox>::new().with_limits(limits);
    let outcome = run_tool_of(&tool, &["trace", &file, "-o", &folder.path("trace")]);
    assert!(outcome.err.contains("trace fewer ticks"), "{}", outcome.err);
    assert_eq!(outcome.exit, Exit::Trouble);
}

#[test]
fn a_trace_beyond_the_end_is_not_written() {
    let folder = Folder::new("trace-beyond");
    let file = folder.write("a.replay", &replay(None));
    let trace = folder.path("a.trace");
    let outcome = run_sandbox(&["trace", &file, "--to", "51", "-o", &trace]);
    assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""));
    assert!(outcome.err.contains("has 50 ticks, there is no tick 51"), "{}", outcome.err);
    assert!(!std::path::Path::new(&trace).exists());
    assert_eq!(run_sandbox(&["trace", &file, "--to", "50", "-o", &trace]).exit, Exit::Success);
}
