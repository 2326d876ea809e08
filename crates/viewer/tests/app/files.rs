//! Opening files: the verdicts of replays, damaged files, snapshots.

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::replay::{Verdict, verify};
use lockstep2d::world::World;
use lockstep2d_viewer::{App, Colour, Event, Key, OpenError};

use super::common::{app_of, frames, hash_at, press, replay, texts, wait_for, wait_for_status};

#[test]
fn a_replay_is_verified_while_one_looks_at_it() {
    let file = replay("pyramid", 200, |_, _| vec![]);
    let mut app = app_of(file.clone());
    let status = wait_for_status(&mut app, "match");
    assert_eq!(status, format!("match: 200 ticks, final hash {}", hash_at(&file, 200)));
    assert!(texts(&mut app).contains(&status), "the verdict should be on the screen");
    assert_eq!(app.report().tick, 0, "verifying should not move the shown tick");
}

#[test]
fn what_is_damaged_says_what_is_wrong_as_the_verifier_does() {
    let file = replay("pyramid", 200, |_, _| vec![]);
    for place in [0, 9, 30, 100, file.len() / 2, file.len() - 3] {
        let mut bad = file.clone();
        bad[place] ^= 4;
        let verdict = verify::<Sandbox>(&bad, &Default::default());
        assert!(!verdict.is_match());
        let mut app = app_of(file.clone());
        app.handle(Event::Dropped { name: "bad.replay".into(), bytes: bad.clone() });
        frames(&mut app, 200);
        let status = app.report().status;
        match App::default().show_file("bad.replay", bad) {
            Err(OpenError::File(error)) => assert!(status.contains(&error.to_string()), "{place}: {status}"),
            Err(error @ OpenError::Replay(_)) => {
                assert_eq!(error, OpenError::Replay(verdict.clone()));
                assert!(status.contains(&verdict.to_string()), "{place}: {status}");
            }
            Err(error @ OpenError::OtherGame { .. }) => {
                assert!(matches!(verdict, Verdict::Unverifiable { .. }), "{place}: {verdict}");
                assert!(status.contains(&error.to_string()), "{place}: {status}");
            }
            Err(OpenError::EmptyReport | OpenError::NoCommonTick { .. } | OpenError::Tick(_)) => {
                panic!("{place}")
            }
            Ok(()) => assert!(status.contains(&verdict.to_string()), "{place}: {status}"),
        }
        assert!(
            texts(&mut app).iter().any(|line| status.starts_with(line.as_str())),
            "the status should be on the screen"
        );
    }
}

/// Colour of the line on the screen that starts with a text.
fn colour_of(app: &mut App, start: &str) -> Colour {
    let mut lines = app.draw().texts().iter();
    lines.find(|line| line.text.starts_with(start)).expect(start).colour
}

#[test]
fn the_name_of_a_file_does_not_change_the_colour_of_an_error() {
    let file = replay("pyramid", 60, |_, _| vec![]);
    let mut app = app_of(file.clone());
    wait_for_status(&mut app, "match");
    let good = colour_of(&mut app, "match:");
    let errors = ["match.replay", "other.replay"].map(|name| {
        app.show_file(name, b"damaged".to_vec()).unwrap_err();
        colour_of(&mut app, name)
    });
    assert!(errors[0] == errors[1] && errors[0] != good, "{good:?}, {errors:?}");
    // A comparison has no verdict, whatever its file is named.
    let comparisons = ["match.replay", "diverged.replay", "other.replay"].map(|name| {
        app.compare_with(name, file.clone()).unwrap();
        colour_of(&mut app, name)
    });
    assert!(comparisons.iter().all(|colour| *colour == comparisons[2]), "{comparisons:?}");
    assert!(comparisons[2] != good && comparisons[2] != errors[0]);
    let mut app = app_of(file[..file.len() - 40].to_vec());
    wait_for_status(&mut app, "incomplete");
    assert_eq!(colour_of(&mut app, "incomplete"), errors[0]);
}

#[test]
fn a_message_makes_way_for_the_verdict_at_the_next_key() {
    let mut app = app_of(replay("pyramid", 60, |_, _| vec![]));
    wait_for_status(&mut app, "match");
    press(&mut app, Key::Character('s'));
    assert_eq!(app.report().status, "nothing to save: this source is not recorded");
    frames(&mut app, 10);
    assert!(app.report().status.starts_with("nothing to save"), "the message should stay until the next key");
    press(&mut app, Key::Right);
    assert!(app.report().status.starts_with("match"), "{}", app.report());
}

#[test]
fn what_is_cut_off_can_be_seen_as_far_as_it_goes() {
    let file = replay("pyramid", 200, |_, _| vec![]);
    let mut app = app_of(file[..file.len() - 40].to_vec());
    let status = wait_for_status(&mut app, "incomplete");
    let Verdict::Incomplete { ticks, hash } =
        verify::<Sandbox>(&file[..file.len() - 40], &Default::default())
    else {
        panic!("{status}")
    };
    assert_eq!(app.report().ticks, Some(ticks));
    press(&mut app, Key::End);
    wait_for(&mut app, ticks);
    assert_eq!(app.report().hash, Some(hash));
}

#[test]
fn a_snapshot_goes_on_forwards_and_comes_back() {
    let mut world = World::default();
    let disc = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    world.spawn(&BodyDef::dynamic(), &[disc]).unwrap();
    (0..7).for_each(|_| world.step());
    let mut app = App::default();
    app.show_file("world.snapshot", world.to_bytes()).unwrap();
    press(&mut app, Key::Space);
    assert_eq!((app.report().tick, app.report().hash), (7, Some(world.state_hash())));
    press(&mut app, Key::PageDown);
    wait_for(&mut app, 67);
    press(&mut app, Key::Home);
    wait_for(&mut app, 7);
    assert_eq!(app.report().hash, Some(world.state_hash()));
}

#[test]
fn a_replay_of_another_game_is_refused_by_name() {
    let file = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../games/shove/replays/match.replay"));
    let mut app = App::default();
    let refused = app.show_file("match.replay", file.unwrap()).unwrap_err();
    assert_eq!(refused.to_string(), "a replay of \"shove\": this viewer shows \"sandbox\"");
}

#[test]
fn no_file_makes_it_panic() {
    let file = replay("chain", 60, |_, _| vec![]);
    for seed in 0..300usize {
        let mut bytes = file.clone();
        for i in 0..=seed % 4 {
            let place = (seed * 7919 + i * 104_729) % bytes.len();
            bytes[place] = bytes[place].wrapping_add(u8::try_from(seed % 255).unwrap() + 1);
        }
        bytes.truncate(bytes.len() - (seed * 31) % bytes.len() / 2);
        let mut app = App::default();
        app.handle(Event::Dropped { name: "noise".into(), bytes });
        press(&mut app, Key::End);
        frames(&mut app, 10);
        app.draw();
    }
}
