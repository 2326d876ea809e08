//! The replay driver plays and seeks in both directions, and the views follow.

mod common;

use bevy::prelude::*;
use bevy_lockstep2d::*;
use common::arena::{Arena, Setup, pad_at};
use common::{Heard, TICK, app, check_views, reference};
use lockstep2d::body::BodyDef;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup, StartError};
use lockstep2d::replay::{Limits, Recording};
use lockstep2d::world::Command;

fn recorded(ticks: u64) -> Vec<u8> {
    let mut recording = Recording::<Arena>::start(&Setup::default(), 60).unwrap();
    for tick in 0..ticks {
        recording.step(&[pad_at(7, tick), pad_at(8, tick)]).unwrap();
    }
    recording.finish().unwrap()
}

#[test]
fn a_replay_seeks_and_its_views_follow() {
    let game = Lockstep::<Arena>::replay(recorded(900), &Limits::default()).unwrap();
    let mut app = app(game, 0, TICK);
    (0..100).for_each(|_| app.update());
    for tick in [700, 20, 900, 0, 333, 332, 331, 500] {
        app.world_mut().resource_mut::<Lockstep<Arena>>().seek(tick).unwrap();
        app.world_mut().resource_mut::<Lockstep<Arena>>().pause();
        app.world_mut().resource_mut::<Heard>().confirmed.clear();
        app.update();
        check_views(&mut app);
        let (expected, events) = reference(900.min(tick + 30), |tick| [pad_at(7, tick), pad_at(8, tick)]);
        assert!(app.world().resource::<Heard>().confirmed.is_empty(), "a seek has no events");
        app.world_mut().resource_mut::<Lockstep<Arena>>().resume();
        for _ in 0..30 {
            app.update();
            check_views(&mut app);
        }
        let lockstep = app.world().resource::<Lockstep<Arena>>();
        assert_eq!(lockstep.game().state_hash(), expected.state_hash(), "30 ticks after {tick}");
        let heard = &app.world().resource::<Heard>().confirmed;
        assert!(heard.iter().eq(events.range(tick + 1..)), "events after {tick}");
    }
    app.world_mut().resource_mut::<Lockstep<Arena>>().back(10_000).unwrap();
    app.update();
    assert!(app.world_mut().resource_mut::<Lockstep<Arena>>().seek(901).is_err());
}

#[test]
fn a_seek_keeps_the_views_of_unchanged_bodies() {
    let game = Lockstep::<Arena>::replay(recorded(300), &Limits::default()).unwrap();
    let mut app = app(game, 0, TICK);
    let views = |app: &App| app.world().resource::<BodyViews>().iter().collect::<Vec<_>>();
    app.update();
    let quiet = views(&app).len();
    while views(&app).len() < quiet + 3 {
        app.update();
    }
    app.update();
    let before = views(&app);
    let mut lockstep = app.world_mut().resource_mut::<Lockstep<Arena>>();
    lockstep.pause();
    let tick = lockstep.tick();
    // Between two frames, the shots disappear and return.
    lockstep.seek(0).unwrap();
    lockstep.seek(tick).unwrap();
    app.update();
    assert_eq!(views(&app), before);
}

#[test]
fn a_replay_uses_up_inputs() {
    let game = Lockstep::<Arena>::replay(recorded(30), &Limits::default()).unwrap();
    let mut app = app(game, 0, TICK);
    *app.world_mut().resource_mut::<Inputs<Arena>>().once(0) = u8::MAX;
    app.update();
    let mut inputs = app.world_mut().resource_mut::<Inputs<Arena>>();
    assert_ne!(*inputs.once(0), u8::MAX);
}

#[test]
fn other_bytes_are_refused() {
    assert!(matches!(
        Lockstep::<Arena>::replay(vec![0; 100], &Limits::default()),
        Err(LockstepError::Replay(_))
    ));
    let mut local = Lockstep::<Arena>::local(&Setup::default()).unwrap();
    assert!(matches!(local.seek(1), Err(LockstepError::Unsupported(_))));
}

#[test]
fn a_setup_may_not_cost_more_than_its_budget() {
    // `Observed` has to pass the work budget to the game.
    let setup = SandboxSetup::default();
    let (_, work) = Sandbox::new_within(&setup, u64::MAX).unwrap();
    assert_eq!(Observed::<Sandbox>::new_within(&setup, u64::MAX).map(|(_, work)| work), Ok(work));
    let spawn = Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] };
    let setup = SandboxSetup { commands: vec![spawn; 100], ..SandboxSetup::default() };
    let start = Observed::<Sandbox>::new_within(&setup, 1).map(|(_, work)| work);
    assert!(matches!(start, Err(StartError::TooMuchWork { .. })), "{start:?}");
}
