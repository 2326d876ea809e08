//! `diff`: the first difference, the side that diverged, and the exit code.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, History, Sandbox};
use lockstep2d::replay::Recorder;
use lockstep2d::report::{Desync, DesyncReport};
use lockstep2d_cli::Exit;
use serde_json::{Value, json};

use crate::counter::{Counter, inputs_at, setup};
use crate::{Folder, golden, replay, run, run_sandbox};

/// Report of the peer on `seat`. From tick `wrong` on, the peer's sum is off by one.
fn report(seat: u32, wrong: Option<u64>) -> DesyncReport {
    let (mut recorder, mut game) = Recorder::<Counter>::start(&setup(), 10).unwrap();
    let mut history = History::new(&game);
    history.push(0, game.save(), game.state_hash());
    for tick in 1..=35 {
        let inputs = recorder.record(&inputs_at(tick - 1)).unwrap().to_vec();
        game.step(&inputs);
        game.sum += i64::from(wrong == Some(tick));
        recorder.checkpoint(game.state_hash());
        history.push(tick, game.save(), game.state_hash());
    }
    let found = Desync { players: 2, tick: 30, known: 35, seats: vec![seat], hashes: Vec::new() };
    DesyncReport::new(&found, &history, recorder.so_far(game.state_hash()))
}

fn json_of(a: &str, b: &str) -> (Value, Exit) {
    let outcome = run(&["diff", "--json", a, b]);
    (serde_json::from_str(&outcome.out).unwrap(), outcome.exit)
}

#[test]
fn reports_name_the_tick_the_peer_and_the_field() {
    let folder = Folder::new("diff-reports");
    let a = folder.write("a", &report(0, None).to_bytes());
    let b = folder.write("b", &report(1, Some(24)).to_bytes());
    let outcome = run(&["diff", &a, &b]);
    let expected = format!(
        "A: {a} (seat 0)\n\
         B: {b} (seat 1)\n\
         different at tick 24, equal at tick 23\n\
         played again up to tick 35: B diverged (seat 1) at tick 24\n\
         states after tick 24: 1 subject differs in sum\n  sum\n    sum: 3 | 4\n"
    );
    assert_eq!((outcome.out.as_str(), outcome.exit), (expected.as_str(), Exit::NoMatch));
    assert_eq!(outcome.err, "");

    let (found, exit) = json_of(&b, &a);
    assert_eq!(exit, Exit::NoMatch);
    assert_eq!(found["blame"], "a");
    assert_eq!((&found["first_different"], &found["last_equal"]), (&json!(24), &json!(23)));
    assert_eq!(found["a"], json!({"file": b, "seats": [1], "equal_until": 23, "diverges": 24}));
    let field = json!({
        "path": "sum", "name": "sum",
        "a": {"text": "4", "bits": "4"}, "b": {"text": "3", "bits": "3"},
    });
    assert_eq!(found["subjects"], json!([{"path": "sum", "section": "sum", "fields": [field]}]));
}

#[test]
fn what_is_equal_is_success() {
    let folder = Folder::new("diff-equal");
    let a = folder.write("a", &report(0, None).to_bytes());
    let b = folder.write("b", &replay(35));
    let outcome = run(&["diff", &a, &b]);
    assert!(outcome.out.contains("\nequal up to tick 35\n"), "{}", outcome.out);
    assert_eq!(outcome.exit, Exit::Success);
    let (found, exit) = json_of(&b, &b);
    assert_eq!((&found["equal"], &found["blame"], exit), (&json!(true), &json!("nobody"), Exit::Success));
}

#[test]
fn other_inputs_are_named() {
    let folder = Folder::new("diff-inputs");
    let (mut recorder, _) = Recorder::<Counter>::start(&setup(), 60).unwrap();
    let mut game = Counter::new(&setup()).unwrap();
    for tick in 0..20 {
        let mut inputs = inputs_at(tick);
        inputs[1].wink ^= tick == 12;
        game.step(recorder.record(&inputs).unwrap());
    }
    let a = folder.write("a", &recorder.finish(&game).unwrap());
    let b = folder.write("b", &replay(20));
    let (found, exit) = json_of(&a, &b);
    assert_eq!((&found["input"]["tick"], &found["input"]["seat"]), (&json!(12), &json!(1)));
    assert_eq!(found["input"]["fields"][0]["name"], "wink");
    assert_eq!((exit, &found["first_different"]), (Exit::NoMatch, &Value::Null));
}

/// The file with 999 as the value of the last claim, and with the checksum repaired as `docs/FORMAT.md` specifies.
fn with_forged_claim(file: &[u8]) -> Vec<u8> {
    let (blocks, trailer) = file.split_at(file.len() - 79);
    let mut trailer = trailer[..71].to_vec();
    trailer[63..].copy_from_slice(&999i64.to_le_bytes());
    let chain = [&trailer[5 + 24..5 + 40], &StateHash::of_bytes(&trailer).0.to_le_bytes()].concat();
    let checksum = StateHash::of_bytes(&chain).0.to_le_bytes();
    [blocks, &trailer, &checksum[..8]].concat()
}

#[test]
fn other_claims_are_a_difference() {
    let folder = Folder::new("diff-claims");
    let honest = replay(35);
    let (a, b) = (folder.write("a", &honest), folder.write("b", &with_forged_claim(&honest)));
    let verdict = run(&["verify", "--json", &b]).out;
    assert!(verdict.contains(r#""verdict":"claim_mismatch""#), "{verdict}");
    for command in ["diff", "bisect"] {
        let outcome = run(&[command, &a, &b]);
        assert_eq!(outcome.exit, Exit::NoMatch, "{command}: {}", outcome.out);
        let lines = "different, equal states up to tick 35\n\
                     played again up to tick 35: both kept to the rules, so `verify` tells which claims are true\n\
                     other claims\n    sum: 40 | 999\n";
        assert!(outcome.out.ends_with(lines), "{command}: {}", outcome.out);
        let found: Value = serde_json::from_str(&run(&[command, "--json", &a, &b]).out).unwrap();
        assert_eq!((&found["equal"], &found["claims"][0]["b"]["text"]), (&json!(false), &json!("999")));
        let same: Value = serde_json::from_str(&run(&[command, "--json", &b, &b]).out).unwrap();
        assert_eq!((&same["equal"], &same["claims"]), (&json!(true), &json!([])), "{command}");
    }
}

#[test]
fn a_trimmed_copy_is_a_difference() {
    let folder = Folder::new("diff-lengths");
    let (whole, copy) = (folder.write("whole", &replay(35)), folder.path("copy"));
    assert_eq!(run(&["trim", &whole, "--ticks", "20", "-o", &copy]).exit, Exit::Success);
    for command in ["diff", "bisect"] {
        let outcome = run(&[command, &whole, &copy]);
        assert_eq!(outcome.exit, Exit::NoMatch, "{command}: {}", outcome.out);
        let lines = "different, equal states up to tick 20\n\
                     played again up to tick 35: both kept to the rules\n\
                     other lengths: A ends after tick 35, B after tick 20\n";
        assert!(outcome.out.ends_with(lines), "{command}: {}", outcome.out);
        let found: Value = serde_json::from_str(&run(&[command, "--json", &whole, &copy]).out).unwrap();
        assert_eq!((&found["equal"], &found["lengths"]), (&json!(false), &json!([35, 20])));
        let same: Value = serde_json::from_str(&run(&[command, "--json", &copy, &copy]).out).unwrap();
        assert_eq!((&same["equal"], &same["lengths"]), (&json!(true), &Value::Null), "{command}");
    }
    // A file without a trailer may be the beginning of the other file.
    let cut = folder.write("cut", &replay(35)[..replay(35).len() - 10]);
    assert_eq!(run(&["diff", &whole, &cut]).exit, Exit::Success);
    assert_eq!(run(&["diff", &cut, &copy]).exit, Exit::Success);
}

#[test]
fn what_cannot_be_compared_is_trouble() {
    let folder = Folder::new("diff-trouble");
    let good = folder.write("good", &replay(5));
    let bad = folder.write("bad", b"neither");
    let world = folder.write("world", &lockstep2d::world::World::default().to_bytes());
    let cut = folder.write("cut", &report(0, None).to_bytes()[..200]);
    let mut damaged = replay(35);
    damaged[140] ^= 0x10;
    let damaged = folder.write("damaged", &damaged);
    for (other, why) in [
        (bad, "neither a report nor a replay nor a snapshot"),
        (world, "a snapshot can only be compared with another snapshot"),
        (cut, "a damaged report"),
        (damaged, "the replay of B: malformed: at byte "),
        (folder.path("missing"), "cannot read"),
    ] {
        let outcome = run(&["diff", &good, &other]);
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""), "{other}");
        assert!(outcome.err.contains(why), "{}", outcome.err);
    }
}

#[test]
fn snapshots_are_compared_whatever_the_game() {
    let folder = Folder::new("diff-worlds");
    let mut world = lockstep2d::world::World::default();
    let a = folder.write("a", &world.to_bytes());
    world.step();
    let b = folder.write("b", &world.to_bytes());
    let outcome = run(&["diff", &a, &b]);
    assert!(outcome.out.ends_with("1 subject differs in tick\n  tick\n    tick: 0 | 1\n"), "{}", outcome.out);
    assert_eq!(outcome.exit, Exit::NoMatch);
    assert_eq!(run(&["diff", &a, &a]).exit, Exit::Success);
}

/// If the setup of another game were decoded, its bytes could give a meaningless setup of this game.
#[test]
fn replays_of_another_game_are_named_and_not_compared() {
    let folder = Folder::new("diff-games");
    let (counter, sandbox) = (folder.write("a", &replay(5)), golden("ragdoll"));
    let why = format!(
        "cannot compare: the replay of B: unverifiable: made with the rules \"sandbox\" version {}, this program has \
         \"counter\" version 3",
        Sandbox::RULES.version
    );
    for command in ["diff", "bisect"] {
        let outcome = run(&[command, &counter, &sandbox]);
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""), "{command}");
        assert!(outcome.err.contains(&why), "{command}: {}", outcome.err);
        let outcome = run(&[command, &sandbox, &counter]);
        assert!(outcome.err.contains("cannot compare: the replay of A: unverifiable: "), "{}", outcome.err);
    }
}

#[test]
fn the_lines_about_setups_are_limited() {
    let (a, b) = (golden("ragdoll"), golden("box_stack"));
    let lines = |more: &[&str]| run_sandbox(&[&["diff", &a, &b], more].concat()).out;
    let few = lines(&["--subjects", "3"]);
    assert_eq!(few.lines().count(), 3 + 1 + 3 + 1, "{few}");
    let last = few.lines().last().unwrap();
    assert!(last.starts_with("    and ") && last.contains(" more (--subjects "), "{last}");
    assert_eq!(lines(&[]).lines().count(), 3 + 1 + 10 + 1);
    assert!(!lines(&["--subjects", "100000"]).contains("more (--subjects"));
}
