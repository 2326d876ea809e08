//! Checks `lockstep2d::math` against exact fractions.

pub(crate) mod exact;

mod angles;
mod numbers;
mod planes;
mod roots;

use crate::source::Source;
use lockstep2d::math::{Fx, Vec2};

/// Tries operations until the bytes end. Returns the number of operations tried.
///
/// # Panics
/// When a result is not within the documented error, or is not saturated where it should be.
pub fn run(bytes: &[u8]) -> u64 {
    let mut source = Source::new(bytes);
    let mut tried = 0;
    while !source.is_empty() {
        match source.below(4) {
            0 => numbers::check(&mut source),
            1 => roots::check(&mut source),
            2 => angles::check(&mut source),
            _ => planes::check(&mut source),
        }
        tried += 1;
    }
    tried
}

/// A number at or near a limit, a multiple of 0.001 from -100 to 100, or random bits shifted by a random distance.
fn number(source: &mut Source<'_>) -> Fx {
    match source.below(3) {
        0 => source.edge(),
        1 => source.thousandths(-100_000, 100_000),
        _ => Fx::from_bits((source.word() as i64) >> source.below(64)),
    }
}

fn vector(source: &mut Source<'_>) -> Vec2<Fx> {
    Vec2::new(number(source), number(source))
}

/// A 32-bit number, often at a limit.
fn small(source: &mut Source<'_>) -> i32 {
    match source.below(3) {
        0 => source.pick(&[0, 1, -1, i32::MAX, i32::MIN, i32::MIN + 1, 1 << 30, -(1 << 30)]),
        1 => (source.word() as i32) >> source.below(32),
        _ => source.word() as i32,
    }
}
