//! `fork`: the new replay has the old beginning and another end, and verifies.

use std::fs;

use lockstep2d::lockstep::{Game, RulesId, Sandbox, SetupError};
use lockstep2d::replay::{Limits, Recording, Step, Verdict, VerifiedReplay, verify};
use lockstep2d_cli::{Exit, Tool};
use serde_json::{Value, json};

use crate::counter::{Counter, Input, Setup, add, inputs_at, like_its_counter, setup};
use crate::{Folder, golden, replay, run, run_sandbox, run_tool_of};

#[test]
fn a_fork_is_what_would_have_been_recorded() {
    let folder = Folder::new("fork");
    let (file, new) = (folder.write("a.replay", &replay(35)), folder.path("new.replay"));
    let then = folder.write("then", b"[{\"add\":3,\"wink\":true},{\"add\":-7,\"wink\":false}]\n\n[{\"add\":1,\"wink\":false},{\"add\":0,\"wink\":false}]\n");
    for tick in [0, 1, 10, 23, 35] {
        let mut recording = Recording::<Counter>::start(&setup(), 10).unwrap();
        (0..tick).for_each(|tick| recording.step(&inputs_at(tick)).unwrap());
        let tick = tick.to_string();
        let mut inputs = add(3, -7);
        inputs[0].wink = true;
        recording.step(&inputs).unwrap();
        recording.step(&add(1, 0)).unwrap();
        (0..4).for_each(|_| recording.step(&add(0, 0)).unwrap());
        let (ticks, hash) = (recording.ticks(), recording.game().state_hash());
        let new_inputs = ["--then", &then, "--idle", "4"];
        let outcome =
            run(&[&["fork", &file, "--tick", &tick, "-o", &new, "--force"], &new_inputs[..]].concat());
        let expected = format!("{new}: {tick} ticks of {file} and 6 more, final hash {hash}\n");
        assert_eq!((outcome.exit, outcome.out, outcome.err), (Exit::Success, expected, String::new()));
        let bytes = fs::read(&new).unwrap();
        assert_eq!(bytes, recording.finish().unwrap());
        assert_eq!(verify::<Counter>(&bytes, &Limits::default()), Verdict::Match { ticks, hash });
    }
}

#[test]
fn a_fork_at_the_end_is_the_same_file() {
    let folder = Folder::new("fork-same");
    let new = folder.path("new.replay");
    let outcome = run_sandbox(&["fork", &golden("spawning"), "--tick", "600", "-o", &new, "--json"]);
    assert_eq!(fs::read(&new).unwrap(), fs::read(golden("spawning")).unwrap());
    let found: Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!((&found["kept"], &found["added"], &found["ticks"]), (&json!(600), &json!(0), &json!(600)));
}

#[test]
fn commands_of_the_sandbox_come_from_json() {
    let folder = Folder::new("fork-sandbox");
    let new = folder.path("new.replay");
    let then = r#"[[{"SetGravity":{"gravity":{"x":{"bits":0},"y":{"bits":42949672960}}}}]]"#;
    let then = folder.write("then", then.as_bytes());
    let outcome = run_sandbox(&[
        "fork",
        &golden("free_fall"),
        "--tick",
        "60",
        "--then",
        &then,
        "--idle",
        "60",
        "-o",
        &new,
    ]);
    assert_eq!(outcome.exit, Exit::Success, "{}", outcome.err);
    let bytes = fs::read(&new).unwrap();
    let mut verified = VerifiedReplay::<Sandbox>::open(&bytes, &Limits::default()).unwrap();
    let rises = |verified: &VerifiedReplay<'_, Sandbox>| {
        let world = verified.game().world();
        world.bodies().any(|(_, body)| body.velocity().y > 0)
    };
    (0..60).for_each(|_| assert_eq!(verified.step(), Ok(Step::Ticked)));
    assert!(!rises(&verified), "it falls at first");
    (0..61).for_each(|_| assert_eq!(verified.step(), Ok(Step::Ticked)));
    assert!(rises(&verified), "it rises after gravity is reversed");
}

/// A counter that panics in any tick beyond the limits of work. `fork` must not play such a tick.
#[derive(Clone)]
struct Fragile(Counter);

impl Game for Fragile {
    type Setup = Setup;
    type Input = Input;
    type Save = Counter;

    const RULES: RulesId = Counter::RULES;

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        Counter::new(setup).map(Fragile)
    }

    fn step(&mut self, inputs: &[Input]) {
        assert!(self.0.sum < 100 && self.0.tick < 50, "beyond the limits");
        self.0.step(inputs);
    }

    like_its_counter!(0);
}

#[test]
fn no_tick_is_played_beyond_a_limit() {
    let folder = Folder::new("fork-limits");
    let (file, new) = (folder.write("a.replay", &replay(35)), folder.path("new.replay"));
    let one = "[{\"add\":1,\"wink\":false},{\"add\":0,\"wink\":false}]\n";
    let heavy = folder.write("heavy", format!("{}{one}", one.replace('1', "120")).as_bytes());
    for (limits, more, limit) in [
        (Limits { tick_work: 50, ..Limits::default() }, ["--then", &heavy], "121 work units in one tick"),
        (Limits { total_work: 90, ..Limits::default() }, ["--idle", "100"], "91 work units"),
    ] {
        let tool = Tool::<Fragile>::new().with_limits(limits);
        let outcome = run_tool_of(&tool, &[&["fork", &file, "--tick", "20", "-o", &new], &more[..]].concat());
        assert_eq!(outcome.exit, Exit::NoMatch, "{}", outcome.err);
        assert!(outcome.err.contains(&format!("limit exceeded: {limit}")), "{}", outcome.err);
        assert!(!fs::exists(&new).unwrap());
    }
}

#[test]
fn a_panic_after_the_kept_ticks_names_the_file_of_the_inputs_or_the_new_replay() {
    let folder = Folder::new("fork-panic");
    let (file, new) = (folder.write("a.replay", &replay(35)), folder.path("new.replay"));
    let heavy = "[{\"add\":120,\"wink\":false},{\"add\":0,\"wink\":false}]\n".repeat(2);
    let heavy = folder.write("heavy", heavy.as_bytes());
    let tool = Tool::<Fragile>::new();
    for (more, named) in [(["--then", &heavy], &heavy), (["--idle", "100"], &new)] {
        let outcome = run_tool_of(&tool, &[&["fork", &file, "--tick", "20", "-o", &new], &more[..]].concat());
        assert_eq!(outcome.exit, Exit::NoMatch, "{}", outcome.err);
        assert!(outcome.err.contains(&format!(" {named}: panicked: the game, at ")), "{}", outcome.err);
        assert!(!fs::exists(&new).unwrap());
    }
}

#[test]
fn what_cannot_be_forked_is_explained_and_writes_nothing() {
    let folder = Folder::new("unforkable");
    let (file, new) = (folder.write("a.replay", &replay(35)), folder.path("new.replay"));
    let bad = folder.write("bad.replay", b"no replay");
    let one = folder.write(
        "one",
        b"[{\"add\":3,\"wink\":true},{\"add\":3,\"wink\":true}]\n[{\"add\":3,\"wink\":true}]\n",
    );
    let other = folder.write("other", b"\n[{\"add\":300}]\n");
    let text = folder.write("text", b"add 3");
    let binary = folder.write("binary", b"\xff\xfe");
    for (arguments, exit, message) in [
        (vec!["--tick", "36"], Exit::Trouble, "has 35 ticks, there is no tick 36"),
        (vec!["--tick", "3", "--then", &one], Exit::Trouble, "one, line 2: 1 inputs for 2 players"),
        (vec!["--tick", "3", "--then", &other], Exit::Trouble, "other, line 2: invalid value"),
        (vec!["--tick", "3", "--then", &text], Exit::Trouble, "text, line 1: expected value"),
        (vec!["--tick", "3", "--then", &binary], Exit::Trouble, "cannot read"),
        (vec!["--tick", "3", "--then", &folder.path("missing")], Exit::Trouble, "cannot read"),
        (vec![], Exit::Trouble, "--tick <N>"),
    ] {
        let all = [vec!["fork", &file, "-o", &new], arguments.clone()].concat();
        let outcome = run(&all);
        assert_eq!((outcome.exit, outcome.out.as_str()), (exit, ""), "{arguments:?}");
        assert!(outcome.err.contains(message), "{message:?} in {:?}", outcome.err);
        assert!(!fs::exists(&new).unwrap());
    }
    let outcome = run(&["fork", &bad, "--tick", "0", "-o", &new]);
    assert_eq!(outcome.exit, Exit::NoMatch);
}
