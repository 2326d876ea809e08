//! Live sessions driven by window events. The saved replay verifies, whatever the user does.

use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::Rng;
use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d_render::Text;
use lockstep2d_viewer::{App, Button, Event, Key, LAYER_KEYS, Request};

use super::common::{SIZE, frames, press, texts, wait_for};

const SCENES: [&str; 8] =
    ["box_stack", "pyramid", "hundred_polygons", "chain", "ragdoll", "bridge", "game", "character"];

fn live(scene: &str) -> App {
    let mut app = App::default();
    app.handle(Event::Resized(SIZE));
    assert!(app.show_scene(scene, 0));
    app.draw();
    app
}

fn saved(app: &mut App) -> Vec<u8> {
    press(app, Key::Character('s'));
    match &app.take_requests()[..] {
        [Request::Save { bytes, .. }] => bytes.clone(),
        other => panic!("{} requests", other.len()),
    }
}

/// A random position in the part of the window where most bodies are.
fn somewhere(rng: &mut Rng) -> [f32; 2] {
    let mut side = |size: f32| size * (rng.below(1000) + rng.below(1000)) as f32 / 2000.0;
    let x = side(SIZE[0]);
    [x, side(SIZE[1]) * 0.4 + SIZE[1] * 0.45]
}

fn random_event(rng: &mut Rng, app: &mut App) {
    let keys = ['b', 'x', 'e', 'g', 'x', 'e', 'f', 'r', '+', '-', 'h', 'j'];
    let travel =
        [Key::Left, Key::Right, Key::PageUp, Key::PageDown, Key::Up, Key::Down, Key::Space, Key::End];
    match rng.below(20) {
        0..=7 => app.handle(Event::Moved(somewhere(rng))),
        8 | 9 => app.handle(Event::Down(Button::Left)),
        10 => app.handle(Event::Down(Button::Right)),
        11 => app.handle(Event::Down(Button::Middle)),
        12 | 13 => app.handle(Event::Up(Button::Left)),
        14 => app.handle(Event::Up(Button::Right)),
        15 => app.handle(Event::Up(Button::Middle)),
        16 => press(app, Key::Character(keys[rng.below(12) as usize])),
        17 => press(app, travel[rng.below(8) as usize]),
        18 => press(app, Key::Character(LAYER_KEYS[rng.below(13) as usize])),
        _ => app.handle(Event::Wheel(rng.below(5) as f32 - 2.0)),
    }
}

#[test]
fn a_session_of_random_pointer_actions_verifies_whatever_they_are() {
    let mut touched = 0;
    for seed in 0..100 {
        let scene = SCENES[seed as usize % SCENES.len()];
        let (rng, mut app) = (&mut Rng::new(seed), live(scene));
        for _ in 0..400 {
            random_event(rng, &mut app);
            frames(&mut app, rng.below(3) as usize);
            if rng.chance(1, 16) {
                app.draw();
            }
        }
        for button in [Button::Left, Button::Right, Button::Middle] {
            app.handle(Event::Up(button));
        }
        // Seeking to the end executes the user's actions that are still queued.
        press(&mut app, Key::End);
        frames(&mut app, 200);
        let file = saved(&mut app);
        let verdict = verify::<Sandbox>(&file, &Limits::default());
        let Verdict::Match { ticks, hash } = verdict else { panic!("seed {seed}, {scene}: {verdict}") };
        // The replay ends in the state that is shown.
        assert_eq!((app.report().tick, app.report().hash), (ticks, Some(hash)), "seed {seed}, {scene}");
        let mut untouched = live(scene);
        wait_for(&mut untouched, ticks);
        touched += u32::from(untouched.report().hash != Some(hash));
    }
    assert!(touched > 90, "only {touched} of 100 sessions changed the scene");
}

#[test]
fn a_body_is_dragged_and_thrown() {
    let mut app = live("box_stack");
    press(&mut app, Key::Character('i'));
    let label = app.draw().texts().iter().rfind(|text| text.text.ends_with("v0")).unwrap().clone();
    let centre = [label.at[0] - 3.0, label.at[1] + 14.0];
    app.handle(Event::Moved(centre));
    app.handle(Event::Down(Button::Left));
    for i in 0..30 {
        app.handle(Event::Moved([centre[0] + 5.0 * i as f32, centre[1] - 3.0 * i as f32]));
        frames(&mut app, 1);
    }
    let place = |app: &mut App| {
        let text = app.draw().texts().iter().find(|text| text.text == label.text).unwrap().at;
        [text[0] - 3.0, text[1] + 14.0]
    };
    let dragged = place(&mut app);
    assert!(dragged[0] > centre[0] + 80.0 && dragged[1] < centre[1] - 40.0, "{centre:?} -> {dragged:?}");
    app.handle(Event::Up(Button::Left));
    frames(&mut app, 5);
    let thrown = place(&mut app);
    assert!(thrown[0] > dragged[0] + 5.0, "{dragged:?} -> {thrown:?}");
    assert!(verify::<Sandbox>(&saved(&mut app), &Limits::default()).is_match());
}

/// Moves the pointer to the last body with a label, and presses the left button there. Returns the label.
fn press_on_a_body(app: &mut App) -> Text {
    let label = app.draw().texts().iter().rfind(|text| text.text.ends_with("v0")).unwrap().clone();
    app.handle(Event::Moved([label.at[0] - 3.0, label.at[1] + 14.0]));
    app.handle(Event::Down(Button::Left));
    label
}

#[test]
fn a_click_selects_a_body_and_keeps_the_recording() {
    let mut app = live("box_stack");
    press(&mut app, Key::Character('i'));
    wait_for(&mut app, 100);
    press(&mut app, Key::PageUp);
    wait_for(&mut app, 40);
    press(&mut app, Key::Space);
    for start in [40, 100] {
        wait_for(&mut app, start);
        let label = press_on_a_body(&mut app);
        frames(&mut app, 3);
        app.handle(Event::Moved([label.at[0] - 1.0, label.at[1] + 15.0]));
        frames(&mut app, 3);
        app.handle(Event::Up(Button::Left));
        frames(&mut app, 3);
        assert!(texts(&mut app).contains(&format!("body {}", label.text)));
        let course = if start == 40 { "recorded" } else { "live" };
        assert!(app.report().status.starts_with(course), "{}", app.report());
        press(&mut app, Key::Escape);
    }
    let mut untouched = live("box_stack");
    wait_for(&mut untouched, app.report().tick);
    assert_eq!(app.report().hash, untouched.report().hash);
}

#[test]
fn a_body_that_moves_during_the_press_is_dragged() {
    let mut app = live("bouncing_ball");
    press(&mut app, Key::Character('i'));
    let label = press_on_a_body(&mut app);
    let height =
        |app: &mut App| app.draw().texts().iter().find(|text| text.text == label.text).unwrap().at[1];
    frames(&mut app, 50);
    let fallen = height(&mut app);
    assert!(fallen > label.at[1] + 60.0, "{} -> {fallen}", label.at[1]);
    app.handle(Event::Moved([label.at[0], label.at[1]]));
    frames(&mut app, 60);
    let lifted = height(&mut app);
    assert!(lifted < label.at[1] + 5.0, "{} -> {fallen} -> {lifted}", label.at[1]);
}

#[test]
fn a_second_button_does_not_disturb_a_drag() {
    let mut app = live("box_stack");
    press(&mut app, Key::Character('i'));
    let label = app.draw().texts().iter().rfind(|text| text.text.ends_with("v0")).unwrap().clone();
    let height =
        |app: &mut App| app.draw().texts().iter().find(|text| text.text == label.text).unwrap().at[1];
    let centre = [label.at[0] - 3.0, label.at[1] + 14.0];
    app.handle(Event::Moved(centre));
    app.handle(Event::Down(Button::Left));
    app.handle(Event::Down(Button::Right));
    for i in 0..40 {
        app.handle(Event::Moved([centre[0], centre[1] - 3.0 * i as f32]));
        frames(&mut app, 2);
    }
    let held = height(&mut app);
    app.handle(Event::Up(Button::Left));
    app.handle(Event::Up(Button::Right));
    frames(&mut app, 90);
    let fallen = height(&mut app);
    assert!(held < label.at[1] - 40.0 && fallen > held + 30.0, "{} {held} {fallen}", label.at[1]);
}

#[test]
fn bodies_come_and_go_and_gravity_turns() {
    let mut app = live("free_fall");
    let count = |app: &mut App| {
        let line = texts(app).into_iter().find(|line| line.contains(" bodies, ")).unwrap();
        line.split(' ').next().unwrap().parse::<usize>().unwrap()
    };
    let before = count(&mut app);
    for _ in 0..4 {
        press(&mut app, Key::Character('b'));
        app.handle(Event::Moved([700.0, 300.0]));
        app.handle(Event::Down(Button::Right));
        app.handle(Event::Moved([715.0, 310.0]));
        app.handle(Event::Up(Button::Right));
        frames(&mut app, 20);
    }
    assert_eq!(count(&mut app), before + 4);
    press(&mut app, Key::Character('g'));
    frames(&mut app, 2);
    press(&mut app, Key::Space);
    press(&mut app, Key::Character('i'));
    let label = app.draw().texts().iter().rfind(|text| text.text.ends_with("v0")).unwrap().clone();
    app.handle(Event::Moved([label.at[0] - 3.0, label.at[1] + 14.0]));
    press(&mut app, Key::Delete);
    press(&mut app, Key::Right);
    frames(&mut app, 2);
    assert_eq!(count(&mut app), before + 3);
    assert!(verify::<Sandbox>(&saved(&mut app), &Limits::default()).is_match());
}

#[test]
fn every_scene_can_be_gone_through() {
    let mut app = live("free_fall");
    let mut names = vec![app.report().name];
    for _ in 1..lockstep2d_scenes::ALL.len() {
        press(&mut app, Key::Character(']'));
        frames(&mut app, 1);
        names.push(app.report().name);
    }
    let all: Vec<&str> = lockstep2d_scenes::ALL.iter().map(|scene| scene.name).collect();
    assert_eq!(names, all);
    press(&mut app, Key::Character('['));
    assert_eq!(app.report().name, all[all.len() - 2]);
}
