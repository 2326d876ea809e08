//! Measures the cost of rollback relative to the time of a step: of a save with its hash, and of a rollback frame,
//! which restores a save and then simulates, saves and hashes 8 ticks. `cargo run --release --example rollback_cost
//! [NUMBER OF BODIES]`.

use std::error::Error;
use std::time::Duration;

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::Fx;
use lockstep2d::world::World;

/// Number of ticks of a rollback.
const TICKS: u32 = 8;
const ROUNDS: u32 = 41;
/// Default number of bodies.
const BODIES: i32 = 1000;

/// A trough, and balls and boxes in 40 columns that fall into it.
fn pile(bodies: i32) -> Result<World, WorldError> {
    let mut world = World::default();
    for (x, y, half_x, half_y) in [(0, -1, 30, 1), (-12, 20, 1, 20), (12, 20, 1, 20)] {
        let wall = Polygon::rectangle(Fx::from_num(half_x), Fx::from_num(half_y))?;
        world.spawn(
            &BodyDef::fixed().position((Fx::from_num(x), Fx::from_num(y))),
            &[ShapeDef::new(wall).friction(fx!(0.3))],
        )?;
    }
    for at in 0..bodies {
        let (column, row) = (at % 40, at / 40);
        let x = Fx::from_num(column) * fx!(0.53) - fx!(10.4) + Fx::from_num(row % 3) * fx!(0.05);
        let y = Fx::from_num(row) * fx!(0.55) + fx!(0.4);
        let shape = match at % 2 {
            0 => ShapeDef::new(Geometry::circle(fx!(0.25))?),
            _ => ShapeDef::new(Polygon::square(fx!(0.25))?),
        };
        world.spawn(&BodyDef::dynamic().position((x, y)).never_sleeps(), &[shape.friction(fx!(0.3))])?;
    }
    Ok(world)
}

fn timed(work: impl FnOnce()) -> Duration {
    #[expect(clippy::disallowed_types, reason = "this is a stopwatch")]
    let start = std::time::Instant::now();
    work();
    start.elapsed()
}

fn median<T: Ord + Copy>(mut values: Vec<T>) -> T {
    values.sort_unstable();
    values[values.len() / 2]
}

fn hundredths(part: Duration, whole: Duration) -> u128 {
    part.as_nanos() * 100 / whole.as_nanos().max(1)
}

fn main() -> Result<(), Box<dyn Error>> {
    let bodies = std::env::args().nth(1).map_or(Ok(BODIES), |count| count.parse())?;
    let mut world = pile(bodies)?;
    for _ in 0..120 {
        world.step();
    }
    let (mut steps, mut saves, mut frames) = (Vec::new(), Vec::new(), Vec::new());
    let mut kept = vec![world.save(); 16];
    for _ in 0..ROUNDS {
        // A frame without rollback: eight ticks.
        let (mut step, mut save) = (Duration::ZERO, Duration::ZERO);
        let start = world.save();
        for slot in kept.iter_mut().take(TICKS as usize) {
            step += timed(|| world.step());
            save += timed(|| {
                *slot = world.save();
                std::hint::black_box(world.state_hash());
            });
        }
        steps.push(step / TICKS);
        saves.push(hundredths(save, step));
        // A rollback frame: goes back and simulates these ticks again.
        let frame = timed(|| {
            world.restore(&start);
            for slot in kept.iter_mut().skip(TICKS as usize) {
                world.step();
                *slot = world.save();
                std::hint::black_box(world.state_hash());
            }
        });
        frames.push(hundredths(frame, step / TICKS));
    }
    let (step, save, frame) = (median(steps), median(saves), median(frames));
    println!(
        "{} awake bodies, {} contacts, a step {step:?}",
        world.awake_body_count(),
        world.stats().contacts
    );
    println!("a save and its hash: {save} % of a step");
    println!("{TICKS} ticks again: {}.{:02} steps", frame / 100, frame % 100);
    Ok(())
}
