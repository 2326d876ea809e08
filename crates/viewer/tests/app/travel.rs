//! Playing, stepping back and scrubbing lead to the right ticks with the right hashes.

use lockstep2d_viewer::{Button, Event, Key};

use super::common::{SIZE, app_of, frames, hash_at, layer, press, replay, texts, wait_for};

fn file() -> Vec<u8> {
    replay("chain", 300, |_, _| vec![])
}

#[test]
fn a_replay_plays_at_its_rate_and_stops_at_its_end() {
    let mut app = app_of(file());
    press(&mut app, Key::Space);
    frames(&mut app, 30);
    let tick = app.report().tick;
    assert!((29..=30).contains(&tick), "{tick}");
    press(&mut app, Key::Up);
    frames(&mut app, 30);
    let faster = app.report().tick - tick;
    assert!((59..=61).contains(&faster), "{faster}");
    frames(&mut app, 300);
    assert_eq!(app.report().tick, 300);
    assert!(texts(&mut app).iter().any(|line| line.ends_with("paused")), "{:?}", texts(&mut app));
    press(&mut app, Key::Space);
    frames(&mut app, 3);
    assert!(app.report().tick < 10, "playing at the end should start again from the first tick");
}

#[test]
fn every_tick_has_its_hash_whichever_way_one_comes() {
    let file = file();
    let mut app = app_of(file.clone());
    press(&mut app, Key::End);
    wait_for(&mut app, 300);
    let ways = [(Key::Left, 299), (Key::PageUp, 239), (Key::Right, 240), (Key::Home, 0), (Key::PageDown, 60)];
    for (key, tick) in ways {
        press(&mut app, key);
        wait_for(&mut app, tick);
        assert_eq!(app.report().hash, Some(hash_at(&file, tick)), "tick {tick}");
        assert!(
            texts(&mut app).contains(&hash_at(&file, tick).to_string()),
            "the hash should be on the screen"
        );
    }
    app.handle(Event::Pressed(Key::Shift));
    press(&mut app, Key::Left);
    app.handle(Event::Released(Key::Shift));
    wait_for(&mut app, 50);
}

/// Also compares derived data such as contact points, which a restored save lacks.
#[test]
fn ten_ticks_back_everything_is_seen_as_it_was() {
    let mut app = app_of(file());
    let layers =
        ["islands", "fat_boxes", "contact_points", "contact_normals", "contact_forces", "velocities"];
    layers.iter().chain(&["solver_colours", "ids"]).for_each(|name| press(&mut app, layer(name)));
    let mut seen = Vec::new();
    for tick in 100..130 {
        press(&mut app, Key::Right);
        if tick == 100 {
            app.handle(Event::Pressed(Key::Shift));
            (0..10).for_each(|_| press(&mut app, Key::Right));
            app.handle(Event::Released(Key::Shift));
            frames(&mut app, 60);
            seen.clear();
        }
        frames(&mut app, 2);
        seen.push((app.report(), app.draw().clone()));
    }
    assert!(seen[29].0.tick > seen[0].0.tick + 28);
    for expected in seen.iter().rev().skip(1) {
        press(&mut app, Key::Left);
        frames(&mut app, 2);
        let now = (app.report(), app.draw().clone());
        assert_eq!(now.0.tick, expected.0.tick);
        assert_eq!(now.0.hash, expected.0.hash);
        assert!(now.1 == expected.1, "tick {}", now.0.tick);
    }
}

#[test]
fn the_timeline_leads_to_any_tick() {
    let file = file();
    let mut app = app_of(file.clone());
    let bar = SIZE[1] - 18.0;
    for (x, tick) in [(500.0, 150), (12.0, 0), (988.0, 300), (-50.0, 0), (256.0, 75)] {
        // The drag starts inside the bar, and may end outside.
        app.handle(Event::Moved([500.0, bar]));
        app.handle(Event::Down(Button::Left));
        app.handle(Event::Moved([x, bar - 200.0]));
        app.handle(Event::Up(Button::Left));
        wait_for(&mut app, tick);
        assert_eq!(app.report().hash, Some(hash_at(&file, tick)));
    }
}
