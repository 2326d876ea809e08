//! Each layer changes the same pixels in the window as in a software rendering of the draw list.

use std::collections::BTreeSet;

use lockstep2d_viewer::LAYER_KEYS;

use super::picture::Picture;
use super::run::{app, directory, golden, play, play_without_window};

/// Replay in which every layer shows something after [`SECONDS`] seconds.
const SCENE: &str = "bridge.replay";
const SECONDS: usize = 2;

/// Takes a screenshot without layers. Then, for each layer, takes one with this layer alone, and one after it is turned
/// off again.
fn script() -> String {
    let forward = "key pagedown\n".repeat(SECONDS);
    let mut script =
        format!("key space\nkey home\n{forward}frames 40\nkey 1\nkey 5\nscreenshot none.png\nreport\n");
    for key in LAYER_KEYS {
        script += &format!("key {key}\nscreenshot {key}.png\nkey {key}\nscreenshot {key}-off.png\n");
    }
    script
}

#[test]
#[ignore = "needs Xvfb: crates/viewer/test-window"]
fn each_overlay_is_what_the_draw_list_says() {
    let (directory, replay) = (directory("overlays"), golden(SCENE));
    play(&directory, &script(), &[replay.to_str().unwrap()]);
    let shot = |name: &str| Picture::read(&directory.join(format!("{name}.png")));
    let mut expected = play_without_window(app(&replay), &script()).into_iter();

    let (none, drawn_none) = (shot("none"), expected.next().unwrap());
    assert_alike("none", &none, &drawn_none, SHAPES);
    for key in LAYER_KEYS {
        let (on, off) = (shot(&key.to_string()), shot(&format!("{key}-off")));
        let (drawn, _) = (expected.next().unwrap(), expected.next().unwrap());
        assert_eq!(off, none, "layer {key} should leave nothing behind when it is turned off");
        let share = if ['6', 'i'].contains(&key) { LABELS } else { SHAPES };
        assert_alike(&format!("layer {key}"), &on, &drawn, share);

        // Leaves out the layer list, where a star marks each layer that is on.
        let in_world = |place: &[usize; 2]| place[0] > 180 || place[1] > 320;
        let changed = |a: &Picture, b: &Picture, step| -> BTreeSet<_> {
            a.differing(b, step).filter(in_world).collect()
        };
        let (seen, meant) = (changed(&on, &none, 24), changed(&drawn, &drawn_none, 24));
        // A pixel that changes by more than 24 in one rasteriser may change less in the other, so in the other a change
        // by more than 4 is enough.
        let (all_seen, all_meant) = (changed(&on, &none, 4), changed(&drawn, &drawn_none, 4));
        println!("layer {key}: {} pixels change, {} in the draw list", seen.len(), meant.len());
        assert!(seen.len() > 30, "layer {key}: only {} pixels change", seen.len());
        for (here, there, what) in
            [(&seen, &all_meant, "shown, not drawn"), (&meant, &all_seen, "drawn, not shown")]
        {
            let stray = here.iter().filter(|place| !is_near(there, **place)).count();
            assert!(stray * 50 <= here.len(), "layer {key}: {stray} of {} pixels {what}", here.len());
        }
    }
}

fn is_near(places: &BTreeSet<[usize; 2]>, [x, y]: [usize; 2]) -> bool {
    (y.saturating_sub(1)..=y + 1).any(|y| (x.saturating_sub(1)..=x + 1).any(|x| places.contains(&[x, y])))
}

/// At most one pixel in this many may differ by more than 64 of 255 in a channel. Where lines cross, the rasterisers
/// differ.
const SHAPES: usize = 1000;
/// Like [`SHAPES`], for layers with small text: only one of the two rasterisers aligns text to pixels.
const LABELS: usize = 200;

/// Asserts that the pictures of two rasterisers agree, apart from the antialiasing of edges.
fn assert_alike(what: &str, shown: &Picture, drawn: &Picture, share: usize) {
    let far = shown.differing(drawn, 64).count();
    let near = shown.differing(drawn, 12).count();
    println!("{what}: {far} pixels differ by more than 64, {near} by more than 12 of {}", shown.pixels.len());
    assert!(far * share <= shown.pixels.len(), "{what}: {far} pixels differ by more than 64");
    assert!(near * 50 <= shown.pixels.len(), "{what}: {near} pixels differ by more than 12");
}
