//! Writing an animation takes no more memory however long it is. A process of its own, so that nothing else counts.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "what goes wrong in a helper fails the test")]
#![expect(clippy::disallowed_types, reason = "floats are what screens take")]

mod common;

use common::colourful;
use lockstep2d_picture::{Animation, Pace};

/// The most memory that this process has had, in KiB.
fn memory_peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn memory_does_not_grow_with_the_frames() {
    let pace = Pace { ticks: 2, tick_rate: 60 };
    let mut gif = Animation::gif(std::io::sink(), pace);
    let mut apng = Animation::apng(std::io::sink(), pace, 550);
    let mut add = |frame| {
        let image = colourful(frame, (120, 80));
        gif.add(&image).unwrap();
        apng.add(&image).unwrap();
    };
    (0..50).for_each(&mut add);
    let before = memory_peak();
    (50..550).for_each(&mut add);
    // 500 frames are 19 MB of pixels.
    let grown = memory_peak() - before;
    assert!(grown < 4000, "{grown} KiB more");
}
