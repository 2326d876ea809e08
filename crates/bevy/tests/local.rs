//! A local game: its ticks come at its rate, its views follow the bodies, and its events are the same as without Bevy.

mod common;

use std::time::Duration;

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_lockstep2d::*;
use common::arena::{self, Arena, Setup, pad_at};
use common::{Heard, TICK, app, check_views, reference};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, verify};
use lockstep2d::world::FixedTimestep;

fn local() -> Lockstep<Arena> {
    Lockstep::local(&Setup::default()).unwrap()
}

fn tick(app: &App) -> u64 {
    app.world().resource::<Lockstep<Arena>>().tick()
}

#[test]
fn ticks_come_at_the_rate_of_the_game() {
    // 1000 frames of 7 ms are 420 ticks. The first frame has no duration.
    let mut app = app(local(), 1, Duration::from_millis(7));
    let first = tick(&app);
    (0..1001).for_each(|_| app.update());
    assert_eq!((first, tick(&app)), (0, 420));
}

#[test]
fn views_and_events_are_those_of_the_game() {
    let mut app = app(local(), 7, TICK);
    for _ in 0..1000 {
        app.update();
        check_views(&mut app);
    }
    let ticks = tick(&app);
    let (game, events) = reference(ticks, |tick| [pad_at(7, tick), pad_at(8, tick)]);
    let lockstep = app.world().resource::<Lockstep<Arena>>();
    assert_eq!(lockstep.game().state_hash(), game.state_hash());
    let heard = app.world().resource::<Heard>();
    assert_eq!(heard.confirmed, events);
    let predicted: usize = events.values().map(Vec::len).sum();
    assert!(predicted > 400, "only {predicted} events");
    assert_eq!((heard.predicted.len(), heard.retracted.len()), (predicted, 0));
}

#[test]
fn a_rollback_after_every_tick_changes_nothing() {
    let test = Lockstep::sync_test(&Setup::default(), 8).unwrap();
    let mut app = app(test, 7, TICK);
    while tick(&app) < 2000 {
        app.update();
        check_views(&mut app);
    }
    let lockstep = app.world().resource::<Lockstep<Arena>>();
    let (ticks, confirmed) = (lockstep.tick(), lockstep.confirmed());
    assert!(confirmed + 8 >= ticks && confirmed < ticks);
    let (game, events) = reference(ticks, |tick| [pad_at(7, tick), pad_at(8, tick)]);
    assert_eq!(lockstep.game().state_hash(), game.state_hash());
    let heard = app.world().resource::<Heard>();
    let all: Vec<_> =
        events.iter().flat_map(|(tick, events)| events.iter().map(|event| (*tick, *event))).collect();
    assert_eq!(heard.predicted, all, "predicted once, although every tick is played nine times");
    assert!(heard.retracted.is_empty());
    let is_final = |(tick, _): &(&u64, _)| **tick <= confirmed;
    assert!(heard.confirmed.iter().eq(events.iter().take_while(is_final)));
}

#[test]
fn a_rollback_without_a_difference_moves_no_view() {
    let mut app = app(Lockstep::sync_test(&Setup::default(), 6).unwrap(), 5, TICK);
    app.insert_resource(LockstepSettings { interpolate: false, ..LockstepSettings::default() });
    for _ in 0..300 {
        app.update();
        check_views(&mut app);
    }
}

#[test]
fn the_views_of_bodies_are_kept_through_rollbacks() {
    // Bodies that a rollback removes for a moment keep their views.
    let run = |game: Lockstep<Arena>| {
        let mut app = app(game, 3, TICK);
        app.init_resource::<Births>()
            .add_observer(|_: On<Add, BodyView>, mut births: ResMut<Births>| births.0 += 1);
        while tick(&app) < 600 {
            app.update();
        }
        app.world().resource::<Births>().0
    };
    let births = run(local());
    assert!(births > 30, "{births}");
    assert_eq!(run(Lockstep::sync_test(&Setup::default(), 12).unwrap()), births);
}

#[test]
fn an_entity_becomes_the_view_of_a_body_that_appears_later() {
    let bodies = |app: &App| -> Vec<_> {
        let lockstep = app.world().resource::<Lockstep<Arena>>();
        lockstep.world().unwrap().bodies().map(|(body, _)| body).collect()
    };
    let mut first = app(local(), 3, TICK);
    while tick(&first) < 30 {
        first.update();
    }
    let early = bodies(&first);
    while bodies(&first).iter().all(|body| early.contains(body)) {
        first.update();
    }
    let late = bodies(&first).into_iter().find(|body| !early.contains(body)).unwrap();

    let mut again = app(local(), 3, TICK);
    again.update();
    let prepared = again.world_mut().spawn(BodyView::new(late)).id();
    while tick(&again) < tick(&first) {
        again.update();
    }
    assert_eq!(again.world().resource::<BodyViews>().entity(late), Some(prepared));
    check_views(&mut again);
}

#[derive(Resource, Default)]
struct Births(u32);

#[test]
fn a_pause_stops_time_and_single_steps_pass_through_it() {
    let mut app = app(local(), 1, TICK);
    (0..10).for_each(|_| app.update());
    let before = tick(&app);
    app.world_mut().resource_mut::<Lockstep<Arena>>().pause();
    (0..10).for_each(|_| app.update());
    assert_eq!(tick(&app), before);
    app.world_mut().resource_mut::<Lockstep<Arena>>().step_once();
    (0..3).for_each(|_| app.update());
    assert_eq!(tick(&app), before + 1);
    app.world_mut().resource_mut::<Lockstep<Arena>>().resume();
    (0..10).for_each(|_| app.update());
    assert_eq!(tick(&app), before + 11);
}

#[test]
fn views_leave_with_their_game() {
    let mut app = app(local(), 1, TICK);
    (0..100).for_each(|_| app.update());
    check_views(&mut app);
    let entities = |app: &App| app.world().resource::<BodyViews>().iter().collect::<Vec<_>>();
    let old = entities(&app);
    app.insert_resource(local());
    app.update();
    check_views(&mut app);
    assert!(entities(&app).iter().all(|entity| !old.contains(entity)), "the new game has new views");
    app.world_mut().remove_resource::<Lockstep<Arena>>();
    app.update();
    assert_eq!(*app.world().resource::<LockstepStatus>(), LockstepStatus::default());
    assert_eq!(app.world_mut().query::<&BodyView>().iter(app.world()).count(), 0);
    assert_eq!(app.world().resource::<BodyViews>().iter().count(), 0);
}

#[test]
fn a_view_that_the_game_removes_is_replaced() {
    let mut app = app(local(), 1, TICK);
    (0..30).for_each(|_| app.update());
    let views: Vec<_> = app.world().resource::<BodyViews>().iter().collect();
    let [(gone, first), (bare, second), ..] = views[..] else { panic!("{views:?}") };
    app.world_mut().despawn(first);
    app.world_mut().entity_mut(second).remove::<BodyView>();
    app.update();
    check_views(&mut app);
    let views = app.world().resource::<BodyViews>();
    assert!(views.entity(gone) != Some(first) && views.entity(bare) != Some(second));
    assert!(app.world().get_entity(second).is_ok(), "it belongs to the game");
    // Makes the view of another body the view of `gone`.
    let (replaced, (_, third)) = (views.entity(gone).unwrap(), views.iter().nth(2).unwrap());
    app.world_mut().despawn(replaced);
    app.world_mut().entity_mut(third).insert(BodyView::new(gone));
    app.update();
    check_views(&mut app);
    assert_eq!(app.world().resource::<BodyViews>().entity(gone), Some(third));
    app.world_mut().entity_mut(third).insert(Disabled);
    app.update();
    assert_eq!(app.world().resource::<BodyViews>().entity(gone), Some(third), "a disabled view is kept");
}

#[test]
fn a_transform_that_the_game_replaces_is_written_again() {
    let mut app = app(local(), 1, TICK);
    (0..30).for_each(|_| app.update());
    // The body of this view is fixed, so its pose never changes.
    let (_, view) = app.world().resource::<BodyViews>().iter().next().unwrap();
    app.world_mut().entity_mut(view).insert(Transform::from_xyz(5e3, 5e3, 3.0));
    app.update();
    check_views(&mut app);
    assert_eq!(app.world().get::<Transform>(view).unwrap().translation.z, 3.0);
    let written = |app: &App| app.world().entity(view).get_change_ticks::<Transform>().unwrap().changed;
    app.update();
    let before = written(&app);
    (0..5).for_each(|_| app.update());
    assert_eq!(written(&app), before, "a view at rest is not written without a reason");
    // The scale changes while the view is disabled.
    app.world_mut().entity_mut(view).insert(Disabled);
    app.world_mut().resource_mut::<LockstepSettings>().pixels_per_metre = 7.0;
    app.update();
    app.world_mut().entity_mut(view).remove::<Disabled>();
    app.update();
    check_views(&mut app);
}

#[test]
fn an_input_given_once_counts_once() {
    for frame in [Duration::from_millis(3), Duration::from_millis(60)] {
        let mut app = app(local(), 1, frame);
        (0..40).for_each(|_| app.update());
        let bodies = |app: &App| app.world().resource::<Lockstep<Arena>>().world().unwrap().body_count();
        let mut quiet = common::app(local(), 1, frame);
        (0..40).for_each(|_| quiet.update());
        assert_eq!(bodies(&app), bodies(&quiet));
        *app.world_mut().resource_mut::<Inputs<Arena>>().once(0) = arena::SHOOT;
        *quiet.world_mut().resource_mut::<Inputs<Arena>>().once(0) = 0;
        (0..6).for_each(|_| [&mut app, &mut quiet].into_iter().for_each(App::update));
        assert_eq!(bodies(&app), bodies(&quiet) + 1, "frames of {frame:?}");
    }
}

#[test]
fn an_input_given_once_is_not_used_by_the_next_game() {
    let mut app = app(local(), 1, TICK);
    app.update();
    app.world_mut().resource_mut::<Lockstep<Arena>>().pause();
    *app.world_mut().resource_mut::<Inputs<Arena>>().once(0) = arena::SHOOT;
    app.update();
    let mut inputs = app.world_mut().resource_mut::<Inputs<Arena>>();
    assert_eq!(*inputs.once(0), arena::SHOOT, "it waits for the end of the pause");
    app.insert_resource(local());
    app.update();
    let (game, _) = reference(tick(&app), |tick| [pad_at(1, tick), pad_at(2, tick)]);
    assert_eq!(tick(&app), 1);
    let lockstep = app.world().resource::<Lockstep<Arena>>();
    assert_eq!(lockstep.game().state_hash(), game.state_hash());
}

#[test]
fn an_input_given_once_is_not_used_by_a_game_that_begins_in_the_same_frame() {
    #[derive(Resource)]
    struct Restart;
    fn shoot_and_restart(
        mut inputs: ResMut<Inputs<Arena>>,
        restart: Option<Res<Restart>>,
        mut commands: Commands,
    ) {
        if restart.is_some() {
            *inputs.once(0) = arena::SHOOT;
            commands.insert_resource(local());
            commands.remove_resource::<Restart>();
        }
    }
    let mut app = app(local(), 1, TICK);
    app.add_systems(bevy::app::RunFixedMainLoop, shoot_and_restart.in_set(LockstepSystems::Inputs));
    (0..10).for_each(|_| app.update());
    app.insert_resource(Restart);
    app.update();
    let lockstep = app.world().resource::<Lockstep<Arena>>();
    assert_eq!(lockstep.tick(), 1);
    let bodies = local().world().unwrap().body_count();
    assert_eq!(lockstep.world().unwrap().body_count(), bodies, "nobody has shot");
}

#[test]
fn views_are_drawn_between_two_ticks() {
    let mut app = app(local(), 1, TICK / 2);
    app.insert_resource(LockstepSettings { pixels_per_metre: 1.0, ..LockstepSettings::default() });
    // Positions of the player, by tick.
    let mut places = std::collections::BTreeMap::new();
    let mut moved = 0.0_f32;
    // The first frame has no duration.
    let mut clock = FixedTimestep::new(60);
    app.update();
    for _ in 0..200 {
        app.update();
        clock.advance((TICK / 2).as_nanos() as u64);
        let fraction = clock.interpolation_billionths() as f32 * 1e-9;
        let player = app.world().resource::<BodyViews>().iter().nth(4).unwrap();
        let lockstep = app.world().resource::<Lockstep<Arena>>();
        let body = lockstep.world().unwrap().body(player.0).unwrap();
        let [x, _] = lockstep2d::draw::to_f32(body.position());
        places.insert(lockstep.tick(), x);
        let Some(before) = lockstep.tick().checked_sub(1).and_then(|before| places.get(&before)) else {
            continue;
        };
        let drawn = app.world().get::<Transform>(player.1).unwrap().translation.x;
        let expected = before + (x - before) * fraction;
        assert!((drawn - expected).abs() < 1e-4, "{drawn} {expected}");
        moved = moved.max((x - before).abs());
    }
    assert!(moved > 0.01, "{moved}");
}

#[test]
fn a_local_game_is_recorded() {
    let mut app = app(local(), 5, TICK);
    (0..300).for_each(|_| app.update());
    let ticks = tick(&app);
    let game = app.world_mut().remove_resource::<Lockstep<Arena>>().unwrap();
    let file = game.finish().unwrap();
    let verdict = verify::<Arena>(&file, &Limits::default());
    assert!(verdict.is_match(), "{verdict}");
    let mut replay = common::app(Lockstep::replay(file, &Limits::default()).unwrap(), 0, TICK);
    (0..400).for_each(|_| replay.update());
    assert_eq!(tick(&replay), ticks, "it stops at its end");
    assert_eq!(replay.world().resource::<Heard>().confirmed, app.world().resource::<Heard>().confirmed);
}

#[test]
fn observers_of_a_view_hear_of_its_body() {
    #[derive(Resource, Default)]
    struct Touched(Vec<(u64, WorldEvent)>);
    let mut app = app(local(), 7, TICK);
    app.init_resource::<Touched>();
    app.update();
    let body = BodyView::clone(app.world_mut().query::<&BodyView>().iter(app.world()).nth(4).unwrap()).body();
    let view = app.world().resource::<BodyViews>().entity(body).unwrap();
    app.world_mut().entity_mut(view).observe(|on: On<BodyEvent>, mut touched: ResMut<Touched>| {
        touched.0.push((on.tick, on.event));
    });
    (0..300).for_each(|_| app.update());
    let world = app.world();
    let touched = &world.resource::<Touched>().0;
    let physics = world.resource::<Lockstep<Arena>>().world().unwrap();
    let is_own = |event: &WorldEvent| {
        let mut shapes = event.shapes().into_iter().flatten();
        shapes.any(|shape| physics.shape(shape).is_some_and(|shape| shape.body() == body))
    };
    let all = world.resource::<Heard>().confirmed.iter();
    let own: Vec<_> = all
        .flat_map(|(tick, events)| events.iter().filter(|e| is_own(e)).map(|event| (*tick, *event)))
        .collect();
    assert!(own.len() > 5, "{own:?}");
    assert_eq!(*touched, own);
}
