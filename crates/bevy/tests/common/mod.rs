//! Shared by the tests: apps without a window.
#![allow(dead_code, reason = "each test uses a part of it")]

pub mod arena;

use std::collections::BTreeMap;
use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_lockstep2d::{
    BodyView, BodyViews, ConfirmedEvent, Inputs, Lockstep, LockstepFailed, LockstepPlugin, LockstepSettings,
    LockstepSystems, PredictedEvent, RetractedEvent, WorldEvent,
};
use lockstep2d::lockstep::Game;
use lockstep2d::world::{SensorChange, World as Physics};

use arena::Arena;

pub const TICK: Duration = Duration::from_nanos(16_666_667);

/// Events sent by an app, by tick.
#[derive(Resource, Default, Clone, Debug, PartialEq)]
pub struct Heard {
    pub confirmed: BTreeMap<u64, Vec<WorldEvent>>,
    pub predicted: Vec<(u64, WorldEvent)>,
    pub retracted: Vec<(u64, WorldEvent)>,
}

#[derive(Resource)]
pub struct Seed(pub u64);

/// An app whose inputs depend only on the tick and a seed.
pub fn app(game: Lockstep<Arena>, seed: u64, frame: Duration) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        LockstepPlugin::<Arena>::default().settings(LockstepSettings::default().exact()),
    ));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame))
        .insert_resource(game)
        .insert_resource(Seed(seed))
        .init_resource::<Heard>()
        .add_systems(bevy::app::RunFixedMainLoop, press.in_set(LockstepSystems::Inputs))
        .add_systems(Update, listen);
    app
}

fn press(mut inputs: ResMut<Inputs<Arena>>, lockstep: Option<Res<Lockstep<Arena>>>, seed: Res<Seed>) {
    let Some(lockstep) = lockstep else { return };
    for player in 0..2 {
        *inputs.held(player) = arena::pad_at(seed.0.wrapping_add(player.into()), lockstep.tick());
    }
}

fn listen(
    mut heard: ResMut<Heard>,
    mut confirmed: MessageReader<ConfirmedEvent>,
    mut predicted: MessageReader<PredictedEvent>,
    mut retracted: MessageReader<RetractedEvent>,
    mut failed: MessageReader<LockstepFailed>,
) {
    for event in confirmed.read() {
        heard.confirmed.entry(event.tick).or_default().push(event.event);
    }
    heard.predicted.extend(predicted.read().map(|event| (event.tick, event.event)));
    heard.retracted.extend(retracted.read().map(|event| (event.tick, event.event)));
    let failure = failed.read().next().map(|LockstepFailed(error)| error.to_string());
    assert_eq!(failure, None, "the driver has stopped");
}

/// Checks that there is one view for every body, at its pose.
pub fn check_views(app: &mut App) {
    let mut query = app.world_mut().query::<(Entity, &BodyView, &Transform)>();
    let scale = app.world().resource::<LockstepSettings>().pixels_per_metre;
    let world = app.world();
    let lockstep = world.resource::<Lockstep<Arena>>();
    let physics = lockstep.world().expect("the arena has a world");
    let views = world.resource::<BodyViews>();
    let mut count = 0;
    for (entity, view, transform) in query.iter(world) {
        let body = physics.body(view.body()).expect("the view's body exists");
        assert_eq!(views.entity(view.body()), Some(entity), "one view for a body");
        let [x, y] = lockstep2d::draw::to_f32(body.position());
        assert_eq!((transform.translation.x, transform.translation.y), (x * scale, y * scale));
        let angle = body.angle().to_radians().to_num::<f32>();
        let turned = transform.rotation.angle_between(Quat::from_rotation_z(angle));
        assert!(turned < 1e-3, "{turned} at tick {}", lockstep.tick());
        count += 1;
    }
    assert_eq!(count, physics.body_count(), "a view for each body");
    assert_eq!(views.iter().count(), count);
}

/// Events of the last tick, in the order in which the plugin sends them. Read from the world without the plugin.
pub fn events_of(world: &Physics) -> Vec<WorldEvent> {
    let events = world.events();
    let mut found = Vec::new();
    found.extend(events.contact_begin.iter().copied().map(WorldEvent::ContactBegin));
    found.extend(events.contact_end.iter().copied().map(WorldEvent::ContactEnd));
    found.extend(events.hits.iter().copied().map(WorldEvent::Hit));
    found.extend(events.sensor_changes().map(|change| match change {
        SensorChange::Begin(event) => WorldEvent::SensorBegin(event),
        SensorChange::End(event) => WorldEvent::SensorEnd(event),
    }));
    found.extend(events.joints.iter().copied().map(WorldEvent::Joint));
    found.extend(events.moved.iter().filter(|m| m.fell_asleep).map(|m| WorldEvent::FellAsleep(m.body)));
    found
}

/// Events of a game without Bevy, by tick.
pub fn reference(
    ticks: u64,
    mut inputs: impl FnMut(u64) -> [u8; 2],
) -> (Arena, BTreeMap<u64, Vec<WorldEvent>>) {
    let mut game = Arena::new(&arena::Setup::default()).expect("a setup");
    let mut events = BTreeMap::new();
    for tick in 0..ticks {
        game.step(&inputs(tick));
        let found = events_of(game.world().expect("a world"));
        if !found.is_empty() {
            events.insert(tick + 1, found);
        }
    }
    (game, events)
}
