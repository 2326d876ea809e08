//! Helpers that create apps, drive them and query their output.

use std::time::Duration;

use lockstep2d::draw::Layers;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::replay::Recording;
use lockstep2d::world::Command;
use lockstep2d_scenes::Scene;
use lockstep2d_viewer::{App, Button, Event, Key, LAYER_KEYS};

pub(crate) const SIZE: [f32; 2] = [1000.0, 700.0];

/// Records a replay of a scene. `more` returns additional commands for each tick.
pub(crate) fn replay(scene: &str, ticks: u64, more: impl Fn(u64, &Sandbox) -> Vec<Command>) -> Vec<u8> {
    let scene = Scene::find(scene).unwrap();
    let mut recording = Recording::<Sandbox>::start(&scene.setup(0), 60).unwrap();
    for tick in 0..ticks {
        let game = recording.game();
        let commands = [scene.commands(tick, game), more(tick, game)].concat();
        recording.step(&[commands]).unwrap();
    }
    recording.finish().unwrap()
}

pub(crate) fn app_of(file: Vec<u8>) -> App {
    let mut app = App::default();
    app.handle(Event::Resized(SIZE));
    app.show_file("test.replay", file).unwrap();
    press(&mut app, Key::Space);
    app
}

pub(crate) fn frames(app: &mut App, count: usize) {
    for _ in 0..count {
        app.advance(Duration::from_secs(1) / 60);
    }
}

pub(crate) fn press(app: &mut App, key: Key) {
    app.handle(Event::Pressed(key));
    app.handle(Event::Released(key));
}

pub(crate) fn click(app: &mut App, at: [f32; 2]) {
    app.handle(Event::Moved(at));
    app.handle(Event::Down(Button::Left));
    app.handle(Event::Up(Button::Left));
}

pub(crate) fn wait_for(app: &mut App, tick: u64) {
    for _ in 0..10_000 {
        if app.report().tick == tick {
            return;
        }
        frames(app, 1);
    }
    panic!("tick {tick} should be reached: {}", app.report());
}

pub(crate) fn wait_for_status(app: &mut App, start: &str) -> String {
    for _ in 0..10_000 {
        let status = app.report().status;
        if status.starts_with(start) {
            return status;
        }
        frames(app, 1);
    }
    panic!("the status should start with {start:?}: {}", app.report());
}

pub(crate) fn layer(name: &str) -> Key {
    let mut layers = Layers::NONE;
    let place = layers.named().iter().position(|(named, _)| *named == name).unwrap();
    Key::Character(LAYER_KEYS[place])
}

pub(crate) fn texts(app: &mut App) -> Vec<String> {
    app.draw().texts().iter().map(|text| text.text.clone()).collect()
}

/// State hash at a tick of a sandbox replay.
pub(crate) fn hash_at(file: &[u8], tick: u64) -> lockstep2d::hash::StateHash {
    let mut verified =
        lockstep2d::replay::VerifiedReplay::<Sandbox>::open(file, &Default::default()).unwrap();
    while verified.tick() < tick {
        verified.step().unwrap();
    }
    verified.game().state_hash()
}
