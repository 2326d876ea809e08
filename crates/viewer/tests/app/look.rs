//! The screen shows layers, the fields of a selected body, the followed body and the help.

use lockstep2d::draw::Layers;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d_render::{CELL_HEIGHT, DrawList};
use lockstep2d_viewer::{App, Button, Controls, Event, Key, Viewer};

use super::common::{SIZE, app_of, click, frames, layer, press, replay, texts, wait_for};

fn app() -> App {
    let mut app = app_of(replay("ragdoll", 200, |_, _| vec![]));
    press(&mut app, Key::PageDown);
    press(&mut app, Key::PageDown);
    wait_for(&mut app, 120);
    app
}

fn size_of(list: &DrawList) -> usize {
    list.items().len() + list.texts().len()
}

#[test]
fn every_layer_adds_something_and_takes_it_away_again() {
    let mut app = app();
    // Zoom in far enough for labels to be drawn.
    app.handle(Event::Moved(SIZE.map(|side| side / 2.0)));
    app.handle(Event::Wheel(3.0));
    for (name, shown) in (Layers { outlines: true, joints: true, ..Layers::NONE }).named() {
        let before = app.draw().clone();
        press(&mut app, layer(name));
        let after = app.draw().clone();
        match shown {
            true => assert!(size_of(&after) < size_of(&before), "{name}"),
            false => assert!(size_of(&after) > size_of(&before), "{name}"),
        }
        press(&mut app, layer(name));
        assert!(*app.draw() == before, "{name}");
    }
}

#[test]
fn a_click_in_the_list_of_layers_switches_one() {
    let mut app = app();
    let line = app.draw().texts().iter().find(|text| text.text.ends_with("velocities")).unwrap().clone();
    assert!(!line.text.contains('*'));
    click(&mut app, [line.at[0] + 20.0, line.at[1] + 8.0]);
    assert!(texts(&mut app).iter().any(|text| text.contains('*') && text.ends_with("velocities")));
}

#[test]
fn a_click_on_a_body_shows_all_its_fields_as_decimals_and_bits() {
    let file = replay("box_stack", 100, |_, _| vec![]);
    let mut app = app_of(file.clone());
    // The id labels show where the bodies are.
    press(&mut app, layer("ids"));
    frames(&mut app, 1);
    let labels: Vec<_> =
        app.draw().texts().iter().filter(|text| text.text.ends_with("v0")).cloned().collect();
    assert!(labels.len() > 5, "{labels:?}");
    let label = &labels[4];
    // A label is 3 pixels to the right of the body's centre of mass, and 14 pixels above it.
    click(&mut app, [label.at[0] - 3.0, label.at[1] + 14.0]);
    let lines = texts(&mut app);
    assert!(lines.contains(&format!("body {}", label.text)), "{lines:?}");
    let verified =
        lockstep2d::replay::VerifiedReplay::<lockstep2d::lockstep::Sandbox>::open(&file, &Default::default());
    let verified = verified.unwrap();
    let mut bodies = verified.game().world().bodies();
    let (_, body) = bodies.find(|(id, _)| id.to_string() == label.text).unwrap();
    let y = body.centre_of_mass().y.to_bits();
    assert!(lines.iter().any(|line| line.ends_with(&format!("(bits {y})"))), "{y}: {lines:?}");
    press(&mut app, Key::Escape);
    assert!(!texts(&mut app).contains(&format!("body {}", label.text)));
}

#[test]
fn the_pointer_acts_on_the_world_below_the_fields_of_a_body() {
    let mut app = app();
    app.handle(Event::Resized([1000.0, 2000.0]));
    press(&mut app, layer("ids"));
    let label = app.draw().texts().iter().find(|text| text.text.ends_with("v0")).unwrap().clone();
    click(&mut app, [label.at[0] - 3.0, label.at[1] + 14.0]);
    let list = app.draw().clone();
    let heading = list.texts().iter().find(|text| text.text.starts_with("body ")).unwrap();
    let rows = list.texts().iter().filter(|text| text.at[0] == heading.at[0]);
    let bottom = rows.map(|text| text.at[1]).fold(0.0, f32::max) + CELL_HEIGHT;
    assert!(bottom < 1800.0, "the list should not fill the window: {bottom}");
    app.handle(Event::Moved([heading.at[0] + 50.0, bottom - 2.0]));
    app.handle(Event::Wheel(1.0));
    assert!(*app.draw() == list, "the wheel should scroll the fields");
    app.handle(Event::Moved([heading.at[0] + 50.0, bottom + 20.0]));
    app.handle(Event::Wheel(-1.0));
    assert!(*app.draw() != list, "the wheel should zoom");
    click(&mut app, [heading.at[0] + 50.0, 1850.0]);
    assert!(!texts(&mut app).contains(&heading.text), "the click should select nothing");
}

#[test]
fn the_camera_follows_a_body_and_lets_go() {
    let mut app = app_of(replay("free_fall", 120, |_, _| vec![]));
    press(&mut app, layer("ids"));
    press(&mut app, layer("centres_of_mass"));
    app.draw();
    let label = app.draw().texts().iter().rfind(|text| text.text.ends_with("v0")).unwrap().clone();
    click(&mut app, [label.at[0] - 3.0, label.at[1] + 14.0]);
    assert!(texts(&mut app).contains(&format!("body {}", label.text)), "{:?} {:?}", label, texts(&mut app));
    press(&mut app, Key::Character('f'));
    for _ in 0..3 {
        press(&mut app, Key::PageDown);
        frames(&mut app, 3);
        let shown = app.draw().texts().iter().find(|text| text.text == label.text).unwrap().clone();
        let [x, y] = [shown.at[0] - 3.0, shown.at[1] + 14.0];
        assert!((x - SIZE[0] / 2.0).abs() < 1.0 && (y - SIZE[1] / 2.0).abs() < 1.0, "{x} {y}");
    }
    press(&mut app, Key::Character('r'));
    app.draw();
    press(&mut app, Key::Left);
    frames(&mut app, 2);
    let shown = app.draw().texts().iter().find(|text| text.text == label.text).unwrap().clone();
    assert!(
        (shown.at[1] + 14.0 - SIZE[1] / 2.0).abs() > 1.0,
        "after a reset the camera should not follow the body"
    );
}

#[test]
fn dragging_pans_and_the_wheel_zooms_about_the_pointer() {
    let mut app = app();
    press(&mut app, layer("ids"));
    let middle = |at: [f32; 2]| (at[0] - 500.0).hypot(at[1] - 350.0);
    let labels = app.draw().texts().iter().filter(|text| text.text.ends_with("v0") && middle(text.at) > 10.0);
    let label = labels.min_by(|a, b| middle(a.at).total_cmp(&middle(b.at))).unwrap().text.clone();
    let place = |app: &mut App| {
        let at = app.draw().texts().iter().find(|text| text.text == label).unwrap().at;
        // Position of the labelled body.
        [at[0] - 3.0, at[1] + 14.0]
    };
    let far = place(&mut app);
    app.handle(Event::Moved([500.0, 350.0]));
    app.handle(Event::Wheel(1.0));
    let before = place(&mut app);
    let factor = (before[0] - 500.0) / (far[0] - 500.0);
    assert!((factor - 1.2).abs() < 0.01, "{far:?} -> {before:?}");
    app.handle(Event::Down(Button::Middle));
    app.handle(Event::Moved([530.0, 310.0]));
    app.handle(Event::Up(Button::Middle));
    let after = place(&mut app);
    assert!((after[0] - before[0] - 30.0).abs() < 0.1 && (after[1] - before[1] + 40.0).abs() < 0.1);
}

#[test]
fn help_is_there_when_asked_for() {
    let mut app = app();
    assert!(!texts(&mut app).iter().any(|line| line.contains("play, pause")));
    press(&mut app, Key::Character('h'));
    assert!(texts(&mut app).iter().any(|line| line.contains("play, pause")));
}

/// A game with these keys: the left arrow, the space bar, the keys of two layers, and two keys for the zoom.
fn played() -> App {
    let keys = [' ', '2', 'c', '+', '-'].into_iter();
    let keys =
        keys.fold(Controls::new(), |keys, key| keys.key(key, |_: &mut Vec<_>| ())).key(Key::Left, |_| ());
    let viewer = ["first", "second", "third"].into_iter().fold(Viewer::<Sandbox>::new(), |viewer, name| {
        viewer.scene(name, "an empty world", |_| SandboxSetup::default())
    });
    let mut app = viewer.keys(keys).app();
    assert!(app.show_scene("first", 0));
    app
}

#[test]
fn the_help_lists_the_keys_that_a_game_leaves_free() {
    let mut app = played();
    press(&mut app, Key::Character('h'));
    let lines = texts(&mut app);
    let has = |text: &str| lines.iter().any(|line| line == text);
    for free in ["p", ",", "right or .", "up", "=", "1 3 4 5 6 7 8 9 0 v i", "wheel"] {
        assert!(has(free), "{free:?}: {lines:?}");
    }
    for used in ["space or p", "left or ,", "-", "zoom out"] {
        assert!(!has(used), "{used:?}: {lines:?}");
    }
    assert!(!has("right drag"), "nobody can draw bodies in it: {lines:?}");
}

#[test]
fn layers_are_listed_while_a_game_is_paused() {
    let mut app = played();
    let is_listed = |app: &mut App| texts(app).iter().any(|line| line.ends_with("velocities"));
    assert!(!is_listed(&mut app));
    press(&mut app, Key::Character('p'));
    assert!(is_listed(&mut app));
}

#[test]
fn ticks_go_back_and_forth_when_the_arrows_are_those_of_the_game() {
    let mut app = played();
    frames(&mut app, 10);
    press(&mut app, Key::Character('p'));
    let tick = app.report().tick;
    for (key, back) in [(',', 1), (',', 2), ('.', 1)] {
        press(&mut app, Key::Character(key));
        wait_for(&mut app, tick - back);
    }
}

#[test]
fn brackets_switch_to_the_scenes_beside() {
    let mut app = played();
    for (key, name) in [('[', "third"), ('[', "second"), (']', "third"), (']', "first")] {
        press(&mut app, Key::Character(key));
        assert_eq!(app.report().name, name);
    }
}
