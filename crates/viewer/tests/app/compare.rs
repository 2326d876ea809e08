//! Comparing two replays finds and shows their first difference.

use std::cell::Cell;

use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, Sandbox, SetupError};
use lockstep2d::math::Vec2;
use lockstep2d::replay::{Limits, Recording, VerifiedReplay};
use lockstep2d::world::Command;
use lockstep2d_viewer::{Event, Key, Viewer};
use serde::{Deserialize, Serialize};

use super::common::{app_of, frames, press, replay, texts, wait_for};

/// Replay in which the fifth dynamic body gets an impulse after tick 90.
fn pushed() -> Vec<u8> {
    replay("box_stack", 200, |tick, game| {
        let fifth = game.world().bodies().filter(|(_, body)| body.is_dynamic()).nth(4).unwrap();
        let (body, impulse, point) = (fifth.0, Vec2::new(fx!(0.001), fx!(0)), fifth.1.centre_of_mass());
        if tick == 90 { vec![Command::ApplyImpulse { body, impulse, point }] } else { vec![] }
    })
}

#[test]
fn the_first_tick_body_and_field_that_differ_are_found_and_shown() {
    let mut app = app_of(replay("box_stack", 200, |_, _| vec![]));
    app.compare_with("pushed.replay", pushed()).unwrap();
    let found = (0..1000).find_map(|_| {
        frames(&mut app, 1);
        Some(app.report().status).filter(|status| status.contains("first difference at tick"))
    });
    let found = found.unwrap();
    assert!(found.contains("first difference at tick 91: body "), "{found}");
    assert!(found.contains("(bits "), "the status should show both values: {found}");
    press(&mut app, Key::Character('j'));
    wait_for(&mut app, 91);
    let rings = |app: &mut lockstep2d_viewer::App| {
        let list = app.draw();
        list.items()
            .iter()
            .filter(|item| item.closed && item.fill.is_none() && item.points.count == 24)
            .count()
    };
    assert!(rings(&mut app) >= 1);
    press(&mut app, Key::Left);
    wait_for(&mut app, 90);
    assert_eq!(rings(&mut app), 0, "no body should be circled before the first difference");
}

#[test]
fn the_same_replay_twice_has_no_difference() {
    let file = replay("box_stack", 200, |_, _| vec![]);
    let mut app = app_of(file.clone());
    app.handle(Event::Pressed(Key::Shift));
    app.handle(Event::Dropped { name: "again.replay".into(), bytes: file });
    app.handle(Event::Released(Key::Shift));
    frames(&mut app, 500);
    assert!(app.report().status.contains("identical up to tick 200"), "{}", app.report());
    assert!(texts(&mut app).iter().any(|line| line.contains("identical up to tick 200")));
}

/// Snapshot of a replay's world at a tick.
fn snapshot(file: &[u8], tick: u64) -> Vec<u8> {
    let mut replay = VerifiedReplay::<Sandbox>::open(file, &Limits::default()).unwrap();
    while replay.tick() < tick {
        replay.step().unwrap();
    }
    replay.game().world().to_bytes()
}

#[test]
fn a_snapshot_and_a_replay_are_compared_by_their_worlds() {
    let file = replay("box_stack", 200, |_, _| vec![]);
    let later = snapshot(&file, 60);
    for [first, second] in [[&file, &later], [&later, &file]] {
        let mut app = app_of(first.clone());
        app.compare_with("second", second.clone()).unwrap();
        frames(&mut app, 500);
        assert!(app.report().status.contains("identical up to tick 200"), "{}", app.report());
    }
    let mut app = app_of(pushed());
    app.compare_with("world.snapshot", later).unwrap();
    frames(&mut app, 500);
    assert!(app.report().status.contains("first difference at tick 91: body "), "{}", app.report());
}

thread_local! {
    /// Whether [`Fickle`] refuses the setup 1 on this thread.
    static REFUSES: Cell<bool> = const { Cell::new(false) };
}

/// A game that does not always accept its setup.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Fickle(u64);

impl Game for Fickle {
    type Setup = u64;
    type Input = ();
    type Save = Fickle;
    const RULES: RulesId = RulesId { name: "fickle", version: 1 };

    fn new(setup: &u64) -> Result<Self, SetupError> {
        match REFUSES.get() && *setup == 1 {
            true => Err(SetupError { why: "not again".into() }),
            false => Ok(Fickle(*setup)),
        }
    }
    fn players(&self) -> u32 {
        1
    }
    fn tick_rate(&self) -> u32 {
        60
    }
    fn step(&mut self, _: &[()]) {}
    fn state_hash(&self) -> StateHash {
        StateHash::of(self)
    }
    fn save(&self) -> Fickle {
        self.clone()
    }
    fn load(&mut self, save: &Fickle) {
        self.clone_from(save);
    }
    fn work(&self, _: &[()]) -> u64 {
        1
    }
}

#[test]
fn a_file_that_cannot_be_opened_again_is_named() {
    let [first, second] =
        [1, 2].map(|setup| Recording::<Fickle>::start(&setup, 60).unwrap().finish().unwrap());
    let mut app = Viewer::<Fickle>::new().app();
    app.show_file("first.replay", first).unwrap();
    REFUSES.set(true);
    let refused = app.compare_with("second.replay", second).unwrap_err();
    assert_eq!(app.message(), Some(format!("first.replay: {refused}").as_str()));
}

#[test]
fn files_without_a_common_tick_are_not_compared() {
    let file = replay("box_stack", 200, |_, _| vec![]);
    let later = snapshot(&file, 60);
    let mut app = app_of(replay("box_stack", 30, |_, _| vec![]));
    let refused = app.compare_with("world.snapshot", later).unwrap_err();
    assert_eq!(refused.to_string(), "no tick is both in this file and in test.replay");
    assert_eq!(app.report().status, format!("world.snapshot: {refused}"));
    frames(&mut app, 10);
    press(&mut app, Key::Right);
    assert!(!app.report().status.contains("difference"), "{}", app.report());
}
