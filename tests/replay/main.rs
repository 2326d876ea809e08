//! Replay files, through the public API and `docs/FORMAT.md` only.

#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]

mod counter;
mod forge;
mod format;
mod hostile;
mod keyframes;
mod limits;
mod reader;
mod recorder;
mod sandbox;
mod setups;
mod timeline;

use lockstep2d::replay::{Limits, Recording, Verdict, verify};

use counter::{Counter, Input};

fn record(ticks: u64, interval: u32, inputs_at: impl Fn(u64) -> [Input; 2]) -> Vec<u8> {
    let mut recording = Recording::<Counter>::start(&counter::setup(), interval).unwrap();
    for tick in 0..ticks {
        recording.step(&inputs_at(tick)).unwrap();
    }
    recording.finish().unwrap()
}

fn verdict(file: &[u8]) -> Verdict {
    verify::<Counter>(file, &Limits::default())
}
