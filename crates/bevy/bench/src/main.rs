//! Measures saves and rollbacks of walls of boxes, and prints a table. Compares this plugin with bevy_rapier2d and
//! Avian, which use the snapshots of bevy_ggrs.

mod avian;
mod engine;
mod ggrs;
mod lockstep;
mod rapier;
mod scene;

use std::alloc::System;
use std::time::{Duration, Instant};

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

use crate::engine::{DEPTH, Engine};

/// Counts allocated bytes, in a few nanoseconds per allocation.
#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Number of ticks in which the wall comes to rest.
const SETTLING: usize = 300;
/// Number of rollbacks that are measured.
const ROLLBACKS: usize = 100;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| | bodies | bytes of a save | save us | load us | 8 ticks again us | same result |");
    println!("|---|---|---|---|---|---|---|");
    for bodies in [150, 800] {
        let mut engines: [Measured; 3] = [
            Measured::new("bevy_lockstep2d", Box::new(lockstep::Lockstep::new(bodies)?)),
            Measured::new("bevy_rapier2d, bevy_ggrs", Box::new(rapier::app(bodies))),
            Measured::new("avian2d, bevy_ggrs", Box::new(avian::app(bodies))),
        ];
        for engine in &mut engines {
            engine.settle();
        }
        // The engines take turns, so that other load on the machine affects all of them alike.
        for _ in 0..ROLLBACKS {
            engines.iter_mut().for_each(Measured::roll_back);
        }
        engines.iter().for_each(|engine| engine.print(bodies));
    }
    Ok(())
}

struct Measured {
    name: &'static str,
    engine: Box<dyn Engine>,
    bytes: usize,
    saves: Vec<Duration>,
    loads: Vec<Duration>,
    rollbacks: Vec<Duration>,
    /// Number of rollbacks after which the state was the same as before.
    equal: usize,
}

impl Measured {
    fn new(name: &'static str, engine: Box<dyn Engine>) -> Self {
        let (saves, loads, rollbacks) = (Vec::new(), Vec::new(), Vec::new());
        Measured { name, engine, bytes: 0, saves, loads, rollbacks, equal: 0 }
    }

    /// Plays until the wall rests, then counts the bytes of a save. The bytes include data that a tick has to copy
    /// because a save shares it.
    fn settle(&mut self) {
        (0..SETTLING).for_each(|_| self.engine.step());
        let region = Region::new(ALLOCATOR);
        for _ in 0..DEPTH {
            self.engine.step();
            self.engine.save();
        }
        let change = region.change();
        self.bytes = change.bytes_allocated.saturating_sub(change.bytes_deallocated) / DEPTH;
    }

    /// Plays a tick, loads the oldest save, and plays the last `DEPTH - 1` ticks again.
    fn roll_back(&mut self) {
        self.tick();
        let before = self.engine.state();
        let start = Instant::now();
        self.engine.load();
        self.loads.push(start.elapsed());
        (0..DEPTH - 1).for_each(|_| self.tick());
        self.rollbacks.push(start.elapsed());
        self.equal += usize::from(self.engine.state() == before);
    }

    fn tick(&mut self) {
        self.engine.step();
        let start = Instant::now();
        self.engine.save();
        self.saves.push(start.elapsed());
    }

    fn print(&self, bodies: usize) {
        let [save, load, rollback] =
            [&self.saves, &self.loads, &self.rollbacks].map(|times| lowest_tenth(times));
        println!(
            "| {} | {bodies} | {} | {save:.0} | {load:.0} | {rollback:.0} | {} of {ROLLBACKS} |",
            self.name, self.bytes, self.equal
        );
    }
}

/// The 10th percentile in microseconds. A mean would depend on other programs, which lengthen some calls.
fn lowest_tenth(times: &[Duration]) -> f64 {
    let mut times = times.to_vec();
    times.sort();
    times.get(times.len() / 10).map_or(0.0, |time| time.as_secs_f64() * 1e6)
}
