//! `inspect`: the description of a file, and the fields of a state.

use lockstep2d::lockstep::{Game, History};
use lockstep2d::replay::Recorder;
use lockstep2d::report::{Desync, DesyncReport};
use lockstep2d::world::World;
use lockstep2d_cli::Exit;
use serde_json::{Value, json};

use crate::counter::{Counter, inputs_at, setup};
use crate::{Folder, golden, replay, run, run_sandbox};

fn json_of(arguments: &[&str]) -> (Value, Exit) {
    let outcome = run(&[&["inspect", "--json"], arguments].concat());
    (serde_json::from_str(&outcome.out).unwrap(), outcome.exit)
}

#[test]
fn a_complete_replay_is_described() {
    let folder = Folder::new("inspect");
    let bytes = replay(35);
    let file = folder.write("a.replay", &bytes);
    let outcome = run(&["inspect", &file]);
    let mut game = Counter::new(&setup()).unwrap();
    (0..35).for_each(|tick| game.step(&inputs_at(tick)));
    let (hash, sum, length) = (game.state_hash(), game.sum, bytes.len());
    let runs = (0..35).filter(|&tick| tick % 10 == 0 || inputs_at(tick) != inputs_at(tick - 1)).count();
    let trailer = 5 + 40 + 1 + 2 + 16 + 4 + 3 + 8;
    let inputs = length - 84 - trailer;
    let expected = format!(
        "{file}: replay, complete\n\
         engine semantics {}, rules \"counter\" version 3\n\
         this program can verify it\n\
         players 2, ticks per second 60, a checkpoint every 10 ticks\n\
         35 ticks (0.58 s) in 4 blocks, {runs} runs of inputs\n\
         {length} bytes: header 84 (setup 13), inputs {inputs}, trailer {trailer}, not whole 0\n\
         states the final hash {hash}\n\
         claims \"half\" = {}\n\
         claims \"sum\" = {sum}\n\
         game {}\n\
         setup: 2 fields\n  start: 5\n  label: \"a\"\n",
        lockstep2d::SEMANTICS,
        sum / 2,
        json_of(&[&file]).0["game"].as_str().unwrap(),
    );
    assert_eq!((outcome.out, outcome.err, outcome.exit), (expected, String::new(), Exit::Success));

    let (found, _) = json_of(&[&file]);
    assert_eq!((&found["kind"], &found["end"]), (&json!("replay"), &json!("complete")));
    assert_eq!((&found["ticks"], &found["final_hash"]), (&json!(35), &json!(hash.to_string())));
    assert_eq!(found["claims"], json!({"half": sum / 2, "sum": sum}));
    assert_eq!(found["setup"][1], json!({"path": "label", "text": "\"a\"", "bits": null}));
    let few = run(&["inspect", &file, "--fields", "1"]).out;
    assert!(few.ends_with("  start: 5\n  and 1 more (--fields 2)\n"), "{few}");
}

#[test]
fn what_is_whole_of_a_replay_is_described() {
    let folder = Folder::new("inspect-part");
    let whole = replay(35);
    for length in 84..whole.len() {
        let (found, exit) = json_of(&[&folder.write("cut", &whole[..length])]);
        assert_eq!((&found["end"], exit), (&json!("cut"), Exit::Success), "{length}");
    }
    let mut last = 0;
    for at in 84..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x10;
        let (found, exit) = json_of(&[&folder.write("damaged", &damaged)]);
        let ticks = found["ticks"].as_u64().unwrap();
        assert!(ticks >= last && (ticks % 10 == 0 || ticks == 35), "{ticks}");
        // If a damaged length points beyond the end, the file looks cut.
        assert!(found["end"] == "damaged" && exit == Exit::NoMatch || found["end"] == "cut", "{found}");
        last = ticks;
    }
    assert_eq!(last, 35);
    let mut damaged = whole.clone();
    damaged[140] ^= 0x10;
    let outcome = run(&["inspect", &folder.write("damaged", &damaged)]);
    assert!(outcome.out.contains(": replay, damaged at byte "), "{}", outcome.out);
    assert!(outcome.out.contains("; the part before that is intact\n"), "{}", outcome.out);
}

#[test]
fn files_of_other_rules_and_engines_are_described() {
    let (found, exit) = json_of(&[&golden("game")]);
    assert_eq!((&found["rules"]["name"], exit), (&json!("sandbox"), Exit::Success));
    assert!(found["unverifiable"].as_str().unwrap().contains("this program has \"counter\" version 3"));
    assert_eq!((&found["setup"], &found["ticks"]), (&Value::Null, &json!(400)));

    let folder = Folder::new("inspect-other");
    let mut other = replay(35);
    other[12] = 77;
    let chain = lockstep2d::hash::StateHash::of_bytes(&other[..76]).0;
    other[76..84].copy_from_slice(&chain.to_le_bytes()[..8]);
    let file = folder.write("other", &other);
    let outcome = run(&["inspect", &file]);
    assert!(outcome.out.contains("engine semantics 77, "), "{}", outcome.out);
    assert!(outcome.out.contains("cannot verify it: made with engine semantics 77"), "{}", outcome.out);
    let outcome = run(&["inspect", &file, "--tick", "3"]);
    assert_eq!(outcome.exit, Exit::NoMatch, "the state of a tick needs a replay that can be played");

    let mut other = replay(35);
    other[8] = 9;
    let outcome = run(&["inspect", &folder.write("format", &other)]);
    assert_eq!(outcome.exit, Exit::NoMatch);
    assert!(outcome.err.contains("version 9 of the file format"), "{}", outcome.err);
}

#[test]
fn fields_of_a_state_are_listed() {
    let folder = Folder::new("inspect-state");
    let file = folder.write("a.replay", &replay(35));
    let mut game = Counter::new(&setup()).unwrap();
    (0..12).for_each(|tick| game.step(&inputs_at(tick)));
    let outcome = run(&["inspect", &file, "--tick", "12"]);
    let (hash, sum) = (game.state_hash(), game.sum);
    assert_eq!(outcome.out, format!("state after tick 12: {hash}\nsum: {sum}\ntick: 12\nmoods: 0\n"));
    let outcome = run(&["inspect", &file, "--tick", "12", "--path", "s"]);
    assert_eq!(outcome.out, format!("state after tick 12: {hash}\nsum: {sum}\n"));
    let (found, _) = json_of(&[&file, "--tick", "12"]);
    assert_eq!(found["fields"][1], json!({"path": "tick", "text": "12", "bits": "12"}));
    for (arguments, exit, message) in [
        (vec!["--tick", "36"], Exit::Trouble, "there is no tick 36"),
        (vec!["--tick", "3", "--path", "nothing"], Exit::Trouble, "there is no field whose path"),
        (
            vec!["--tick", "3", "--body", "7"],
            Exit::Trouble,
            "there is no body \"7\" in this state: a body is given by",
        ),
        (vec!["--body", "7", "--path", "sum"], Exit::Trouble, "cannot be used with"),
    ] {
        let outcome = run(&[vec!["inspect", &file], arguments].concat());
        assert_eq!((outcome.exit, outcome.out.as_str()), (exit, ""));
        assert!(outcome.err.contains(message), "{}", outcome.err);
    }
}

#[test]
fn a_body_is_found_by_its_number_or_handle() {
    let lines = |body: &str| {
        let outcome = run_sandbox(&["inspect", &golden("ragdoll"), "--tick", "50", "--body", body]);
        assert_eq!(outcome.exit, Exit::Success, "{}", outcome.err);
        outcome.out.lines().map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(lines("3"), lines("3v0"));
    let found = lines("3");
    assert!(found[1..].iter().all(|line| line.starts_with("world.bodies.body 3v0.")), "{found:?}");
    assert!(found.iter().any(|line| line.contains(".velocity.x: ") && line.contains(" (bits ")), "{found:?}");
}

#[test]
fn snapshots_and_saves_are_told_apart() {
    let folder = Folder::new("inspect-world");
    let mut world = World::default();
    world.step();
    let file = folder.write("world", &world.to_bytes());
    let outcome = run(&["inspect", &file]);
    assert!(outcome.out.starts_with(&format!("{file}: snapshot of a world, ")), "{}", outcome.out);
    assert!(outcome.out.contains(&world.state_hash().to_string()), "{}", outcome.out);
    let outcome = run(&["inspect", &file, "--path", "tick"]);
    assert_eq!(outcome.out, format!("state after tick 1: {}\ntick: 1\n", world.state_hash()));

    let replay_file = folder.write("a.replay", &replay(35));
    let save = folder.path("save");
    run(&["seek", &replay_file, "--tick", "9", "-o", &save]);
    let outcome = run(&["inspect", &save]);
    assert!(outcome.out.starts_with("state that was saved\nsum: "), "{}", outcome.out);

    let mut older = world.to_bytes();
    older[12] = 2;
    for (bytes, message) in [
        (&b"neither"[..], "neither a report nor a replay nor a snapshot"),
        (&world.to_bytes()[..40], "a damaged snapshot"),
        (&older, "a snapshot of another version: made with semantics 2"),
    ] {
        let outcome = run(&["inspect", &folder.write("bad", bytes)]);
        assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""));
        assert!(outcome.err.contains(message), "{}", outcome.err);
    }
}

#[test]
fn reports_are_described_with_their_states() {
    let folder = Folder::new("inspect-report");
    let (mut recorder, mut game) = Recorder::<Counter>::start(&setup(), 10).unwrap();
    let mut history = History::<Counter>::of_ticks(8);
    for tick in 1..=35 {
        game.step(recorder.record(&inputs_at(tick - 1)).unwrap());
        game.sum += i64::from(tick == 33);
        recorder.checkpoint(game.state_hash());
        history.push(tick, game.save(), game.state_hash());
    }
    let found = Desync { players: 2, tick: 34, known: 35, seats: vec![1], hashes: Vec::new() };
    let report = DesyncReport::new(&found, &history, recorder.so_far(game.state_hash()));
    let file = folder.write("report", &report.to_bytes());
    let outcome = run(&["inspect", &file]);
    let hash = history.get(34).unwrap().hash;
    for line in [
        format!("{file}: report of a divergence\n"),
        "players 2, seats of the writer [1]\nstates differed at tick 34\n".into(),
        format!("  seats [1]: {hash}\n"),
        "state hashes 8, ticks 28 to 35\nsaves 8, ticks 28 to 35, ".into(),
        "replay in it, cut: it has no trailer\n".into(),
    ] {
        assert!(outcome.out.contains(&line), "{line:?} in {}", outcome.out);
    }
    assert_eq!(outcome.exit, Exit::Success);
    let (document, _) = json_of(&[&file]);
    assert_eq!((&document["kind"], &document["replay"]["ticks"]), (&json!("report"), &json!(35)));

    let sum = history.get(33).unwrap().save.sum;
    let outcome = run(&["inspect", &file, "--tick", "33", "--path", "sum"]);
    assert!(
        outcome.out.ends_with(&format!("\nsum: {sum}\n")),
        "the state saved by the peer: {}",
        outcome.out
    );
    let outcome = run(&["inspect", &file, "--tick", "5", "--path", "tick"]);
    assert!(outcome.out.ends_with("\ntick: 5\n"), "the state computed from the replay: {}", outcome.out);
}
