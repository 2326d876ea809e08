//! An app whose physics state the schedules of bevy_ggrs save and load. The benchmark runs these schedules itself,
//! without a session, to time each save and load.

use std::time::Duration;

use bevy::app::TaskPoolPlugin;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::time::TimePlugin;
use bevy_ggrs::{ConfirmedFrameCount, LoadWorld, RollbackFrameCount, SaveWorld, SnapshotPlugin};

use crate::engine::{DEPTH, Engine};

/// One tick of physics.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Tick;

/// An app, and a function that reads the state to compare.
pub struct GgrsApp {
    app: App,
    state: fn(&mut World) -> Vec<u64>,
}

/// An app with snapshots and without physics.
pub fn app() -> App {
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), TimePlugin, TransformPlugin, SnapshotPlugin));
    app.init_schedule(Tick);
    app
}

impl GgrsApp {
    pub fn new(mut app: App, state: fn(&mut World) -> Vec<u64>) -> Self {
        app.finish();
        app.cleanup();
        app.update();
        GgrsApp { app, state }
    }

    fn frame(&mut self) -> &mut i32 {
        &mut self.app.world_mut().resource_mut::<RollbackFrameCount>().into_inner().0
    }
}

impl Engine for GgrsApp {
    fn step(&mut self) {
        *self.frame() += 1;
        let world = self.app.world_mut();
        world.resource_mut::<Time>().advance_by(Duration::from_nanos(16_666_667));
        world.run_schedule(Tick);
    }

    fn save(&mut self) {
        let oldest = *self.frame() - (DEPTH as i32 - 1);
        let world = self.app.world_mut();
        world.resource_mut::<ConfirmedFrameCount>().0 = oldest;
        world.run_schedule(SaveWorld);
    }

    fn load(&mut self) {
        *self.frame() -= DEPTH as i32 - 1;
        self.app.world_mut().run_schedule(LoadWorld);
    }

    fn state(&mut self) -> Vec<u64> {
        (self.state)(self.app.world_mut())
    }
}

/// Bits of floats, for exact comparison.
pub fn bits<const N: usize>(values: [f32; N]) -> [u64; N] {
    values.map(|value| u64::from(value.to_bits()))
}
