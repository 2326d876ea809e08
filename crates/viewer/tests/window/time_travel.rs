//! After stepping back, the pixels are the same as before.

use lockstep2d_render::{CELL_HEIGHT, CELL_WIDTH, glyph};
use lockstep2d_viewer::App;

use super::picture::{Picture, distance};
use super::run::{app, directory, golden, play};

/// Keys of all layers except the broad phase, whose tree is not part of the state.
const ALL: &str = "key 2\nkey 4\nkey 6\nkey 7\nkey 8\nkey 9\nkey 0\nkey c\nkey v\nkey i\n";

#[test]
#[ignore = "needs Xvfb: crates/viewer/test-window"]
fn ten_ticks_back_is_pixel_for_pixel_what_it_was() {
    for replay in ["bridge.replay", "ragdoll.replay", "spawning.replay"] {
        let (directory, replay) = (directory("back"), golden(replay));
        let ten = |key: &str| format!("key {key}\nframes 2\n").repeat(10);
        let (right, left) = (ten("right"), ten("left"));
        // After 400 frames, the verification is complete. Its progress would change the picture. The next 100 frames
        // play 100 ticks.
        let script = format!(
            "{ALL}key space\nkey home\nframes 400\nkey space\nframes 100\nkey space\nscreenshot played.png\nreport\n\
             {right}screenshot further.png\nreport\n{left}screenshot back.png\nreport\n\
             key home\nframes 2\npress shift\n{right}release shift\nframes 10\nscreenshot again.png\nreport\n"
        );
        let reports = play(&directory, &script, &[replay.to_str().unwrap()]);
        let [played, further, back, again] = reports.as_slice() else { panic!("{reports:?}") };
        assert!(played.contains("tick 100 of "), "{played}");
        assert!(further.contains("tick 110 of "), "{further}");
        let shot = |name: &str| Picture::read(&directory.join(name));
        assert!(shot("played.png").differing(&shot("further.png"), 24).count() > 100);
        for (name, report) in [("back.png", back), ("again.png", again)] {
            assert_eq!(report, played, "{name}");
            let other = shot("played.png").differing(&shot(name), 0).count();
            assert_eq!(other, 0, "{name}: pixels of {}", replay.display());
        }
    }
}

#[test]
#[ignore = "needs Xvfb: crates/viewer/test-window"]
fn the_hash_is_on_the_screen() {
    let (directory, replay) = (directory("hash"), golden("bridge.replay"));
    let script = "key space\nkey home\nkey pagedown\nframes 30\nscreenshot hash.png\nreport\n";
    let reports = play(&directory, script, &[replay.to_str().unwrap()]);
    let hash = reports[0].split(" · ").nth(2).unwrap();
    assert_eq!(hash, hash_at(app(&replay), 60), "the hash should equal that of a run without a window");

    // Checks the pixels of every digit.
    let mut app = app(&replay);
    app.handle(lockstep2d_viewer::Event::Resized(super::run::SIZE.map(|side| side as f32)));
    let place = app.draw().texts().iter().find(|text| text.text.len() == 32).unwrap().clone();
    let ink = place.colour.rgb;
    let shown = Picture::read(&directory.join("hash.png"));
    for (column, digit) in hash.chars().enumerate() {
        let left = place.at[0] + column as f32 * CELL_WIDTH;
        for (y, row) in glyph(digit).iter().enumerate().take(CELL_HEIGHT as usize) {
            for (x, &coverage) in row.iter().enumerate() {
                let pixel = shown.at(left as usize + x, place.at[1] as usize + y);
                let from_ink = distance(pixel, ink);
                assert!(coverage < 250 || from_ink < 16, "{digit:?} at {x}, {y}: {pixel:?}");
                assert!(coverage > 5 || from_ink > 120, "{digit:?} at {x}, {y}: {pixel:?}");
            }
        }
    }
}

fn hash_at(mut app: App, tick: u64) -> String {
    let presses = format!("key space\nkey home\n{}frames 100", "key right\n".repeat(tick as usize));
    super::run::play_without_window_in(&mut app, &presses);
    assert_eq!(app.report().tick, tick);
    app.report().hash.unwrap().to_string()
}
