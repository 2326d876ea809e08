//! After seeking back, the picture is the same as before, in all layers except the broad phase.

use std::path::Path;

use lockstep2d_render::DrawList;
use lockstep2d_viewer::script::FRAME;
use lockstep2d_viewer::{App, Event, Key, LAYER_KEYS};

const TICKS: usize = 100;

/// The drawing of the world. Panels, the timeline and text of full size are left out, because they show the progress of
/// the verification.
fn world(app: &mut App) -> DrawList {
    let list = app.draw();
    let mut world = DrawList::default();
    for item in list.items() {
        let points = list.points(item).to_vec();
        // Panels and the timeline are rectangles without a border.
        if !item.stroke.is_none() || points.len() != 4 {
            world.line(points, item.stroke, item.width);
        }
    }
    for text in list.texts().iter().filter(|text| text.scale < 1.0) {
        world.text(text.at, text.scale, text.colour, text.text.clone());
    }
    world
}

fn press(app: &mut App, key: Key) {
    app.handle(Event::Pressed(key));
    // Seeking to a distant tick takes several frames.
    (0..200).for_each(|_| app.advance(FRAME));
}

/// Steps forwards, steps back, and goes forwards again from the start. Whenever a tick is shown again, its drawing must
/// be the same as before. Layers 1 and 5 are on already. Layer 3 is left out, because the tree of the broad phase
/// depends on how a tick was reached.
fn goes_back(mut app: App) {
    app.handle(Event::Resized([900.0, 700.0]));
    LAYER_KEYS
        .iter()
        .filter(|key| !['1', '3', '5'].contains(key))
        .for_each(|&key| press(&mut app, Key::Character(key)));
    press(&mut app, Key::Space);
    press(&mut app, Key::Home);
    let mut seen = vec![world(&mut app)];
    for _ in 0..TICKS {
        press(&mut app, Key::Right);
        seen.push(world(&mut app));
    }
    assert!(seen[TICKS] != seen[0], "the scene should move");
    let name = app.report().name;
    let check = |app: &mut App, tick: usize| {
        assert_eq!(app.report().tick, tick as u64, "{name}");
        assert!(world(app) == seen[tick], "{name}: tick {tick} looks different");
    };
    for tick in (TICKS / 2..TICKS).rev() {
        press(&mut app, Key::Left);
        check(&mut app, tick);
    }
    press(&mut app, Key::Right);
    check(&mut app, TICKS / 2 + 1);
    press(&mut app, Key::Home);
    press(&mut app, Key::PageDown);
    check(&mut app, 60);
    press(&mut app, Key::Left);
    check(&mut app, 59);
}

#[test]
fn in_replays() {
    for name in ["bridge.replay", "spawning.replay", "ragdoll.replay"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../replays").join(name);
        let mut app = App::default();
        app.show_file(name, std::fs::read(path).unwrap()).unwrap();
        goes_back(app);
    }
}

#[test]
fn in_live_scenes() {
    for name in ["pyramid", "ragdoll"] {
        let mut app = App::default();
        assert!(app.show_scene(name, 0));
        goes_back(app);
    }
}
