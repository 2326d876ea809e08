//! Writing an animation takes bounded memory. This is a binary of its own, so that no other test adds to the peak of
//! the process.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

mod common;

use common::colourful;
use lockstep2d_render::{Animation, Pace};

/// Peak memory of this process, in KiB.
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
    // The pixels of 500 frames would take 19 MB.
    let grown = memory_peak() - before;
    assert!(grown < 4000, "memory grew by {grown} KiB");
}
