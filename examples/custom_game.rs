//! A custom game that records itself and verifies the recording: `cargo run --example custom_game`.

mod tug;

use std::error::Error;

use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, Recording, verify};

use tug::Tug;

fn main() -> Result<(), Box<dyn Error>> {
    let mut recording = Recording::<Tug>::start(&(), CHECKPOINT_INTERVAL)?;
    for tick in 0..600 {
        let left = if tick % 120 < 60 { -2 } else { 0 };
        recording.step(&[left, 3])?;
    }
    println!("after {} ticks the ball is at {:.3} m", recording.ticks(), recording.game().position().x);
    let file = recording.finish()?;
    println!("{} bytes: {}", file.len(), verify::<Tug>(&file, &Limits::default()));
    Ok(())
}
