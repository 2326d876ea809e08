//! `stats`: the figures of every tick, and the largest and the mean value of each figure.

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::replay::{Limits, Recorder, Step, VerifiedReplay};
use lockstep2d_cli::{Exit, Tool};
use serde_json::Value;

use crate::counter::{Counter, inputs_at, setup};
use crate::{Folder, golden, replay, run, run_sandbox, run_tool_of};

#[test]
fn a_game_without_a_world_has_its_work() {
    let folder = Folder::new("stats");
    let file = folder.write("a.replay", &replay(35));
    let outcome = run(&["stats", &file, "--json"]);
    assert_eq!(outcome.exit, Exit::Success);
    let mut game = Counter::new(&setup()).unwrap();
    let mut expected = String::new();
    let mut works = Vec::new();
    for tick in 0..35 {
        works.push(game.work(&inputs_at(tick)));
        game.step(&inputs_at(tick));
        let (hash, work) = (game.state_hash(), works.last().unwrap());
        expected += &format!("{{\"tick\":{},\"hash\":\"{hash}\",\"work\":{work}}}\n", tick + 1);
    }
    assert_eq!(outcome.out, expected);

    let outcome = run(&["stats", &file]);
    let largest = works.iter().max().unwrap();
    let at = works.iter().position(|work| work == largest).unwrap() + 1;
    let tenths = works.iter().sum::<u64>() * 10 / 35;
    let mean = format!("{}.{}", tenths / 10, tenths % 10);
    let hash = game.state_hash();
    let expected = format!(
        "{file}: 35 ticks, state {hash}\n{:14} {:>12} {:>14} {:>9}\n{:14} {largest:>12} {mean:>14} {at:>9}\n",
        "", "largest", "mean", "at tick", "work"
    );
    assert_eq!(outcome.out, expected);
}

#[test]
fn figures_are_those_of_the_world() {
    let file = std::fs::read(golden("ragdoll")).unwrap();
    let outcome = run_sandbox(&["stats", &golden("ragdoll"), "--json"]);
    let mut verified = VerifiedReplay::<Sandbox>::open(&file, &Limits::default()).unwrap();
    let mut touching = 0;
    for line in outcome.out.lines() {
        assert_eq!(verified.step(), Ok(Step::Ticked));
        let line: Value = serde_json::from_str(line).unwrap();
        let world = verified.game().world();
        let stats = world.stats();
        assert_eq!(line["tick"], verified.tick());
        assert_eq!(line["hash"], verified.game().state_hash().to_string());
        assert_eq!(line["bodies"], world.body_count());
        assert_eq!(line["awake"], world.awake_body_count());
        assert_eq!((&line["contacts"], &line["points"]), (&stats.contacts.into(), &stats.points.into()));
        assert_eq!((&line["joints_solved"], &line["faults"]), (&stats.joints.into(), &stats.faults.into()));
        touching += stats.contacts;
    }
    assert_eq!(verified.step(), Ok(Step::Ended));
    assert!(touching > 100);
}

#[test]
fn a_replay_that_is_cut_or_wrong_has_them_as_far_as_it_goes() {
    let folder = Folder::new("stats-cut");
    let whole = replay(35);
    let cut = folder.write("cut", &whole[..whole.len() - 1]);
    let outcome = run(&["stats", &cut]);
    assert!(outcome.out.contains(": 35 ticks, "), "{}", outcome.out);
    assert_eq!(outcome.exit, Exit::Success);
    let empty = folder.write("empty", &replay(0));
    let outcome = run(&["stats", &empty]);
    assert!(outcome.out.contains(": 0 ticks, ") && outcome.exit == Exit::Success, "{}", outcome.out);
    for (file, exit, message) in [
        (golden("game"), Exit::NoMatch, "unverifiable"),
        (folder.path("missing"), Exit::Trouble, "cannot read"),
    ] {
        let outcome = run(&["stats", &file]);
        assert_eq!(outcome.exit, exit);
        assert!(outcome.err.contains(message), "{}", outcome.err);
    }
}

/// After a tick that exceeds a limit of work or differs at a checkpoint, the game no longer has the state of the last
/// valid tick. So `stats` must not print the hash of the game.
#[test]
fn a_wrong_state_has_no_hash() {
    let folder = Folder::new("stats-wrong");
    let (mut recorder, mut game) = Recorder::<Counter>::start(&setup(), 10).unwrap();
    for tick in 0..35 {
        game.step(recorder.record(&inputs_at(tick)).unwrap());
        game.sum += i64::from(tick == 24);
        recorder.checkpoint(game.state_hash());
    }
    let file = folder.write("a.replay", &recorder.finish(&game).unwrap());
    let outcome = run(&["stats", &file]);
    assert_eq!(
        (outcome.out.lines().next(), outcome.exit),
        (Some(&*format!("{file}: 29 ticks")), Exit::NoMatch)
    );

    let file = golden("game");
    let figures = run_sandbox(&["stats", &file, "--json"]).out;
    let work = |line: &str| serde_json::from_str::<Value>(line).unwrap()["work"].as_u64().unwrap();
    let works: Vec<u64> = figures.lines().map(work).collect();
    let tick_work = works.iter().max().unwrap() - 1;
    let ticks = works.iter().position(|work| *work > tick_work).unwrap();
    let tool = Tool::<Sandbox>::new().with_limits(Limits { tick_work, ..Limits::default() });
    let outcome = run_tool_of(&tool, &["stats", &file]);
    let expected = format!("{file}: {ticks} ticks");
    assert_eq!((outcome.out.lines().next(), outcome.exit), (Some(&*expected), Exit::NoMatch));
}
