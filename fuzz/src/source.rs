//! Decisions drawn from the fuzzer's bytes. When no bytes are left, most decisions are the first option, so that a
//! short input makes a short scene.

use arbitrary::Unstructured;
use lockstep2d::math::{Angle, Fx, Vec2};

/// Turns bytes into decisions.
pub struct Source<'a> {
    bytes: Unstructured<'a>,
    ordinary: bool,
}

/// Bits of [`Fx`] numbers at or near the limits of formats and parameters.
const EDGES: [i64; 24] = [
    0,
    1,
    -1,
    i64::MIN,
    i64::MAX,
    i64::MIN + 1,
    1 << 62,
    -(1 << 62),
    1_000_000_000 << 32,
    -(1_000_000_000 << 32),
    256 << 32,
    -(256 << 32),
    120 << 32,
    512 << 32,
    -(512 << 32),
    400 << 32,
    -(400 << 32),
    100_000 << 32,
    1000 << 32,
    -(1000 << 32),
    1 << 32,
    -(1 << 32),
    8_589_935,
    2_147_484,
];

impl<'a> Source<'a> {
    /// Creates a source.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Source { bytes: Unstructured::new(bytes), ordinary: false }
    }

    /// Sets whether [`Source::mostly`] avoids limits.
    pub fn set_ordinary(&mut self, ordinary: bool) {
        self.ordinary = ordinary;
    }

    /// Whether [`Source::mostly`] avoids limits.
    #[must_use]
    pub fn is_ordinary(&self) -> bool {
        self.ordinary
    }

    /// Whether no bytes are left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The remaining bytes.
    #[must_use]
    pub fn rest(self) -> &'a [u8] {
        self.bytes.take_rest()
    }

    /// Draws a byte, or 0 if no bytes are left.
    pub fn byte(&mut self) -> u8 {
        self.bytes.arbitrary().unwrap_or(0)
    }

    /// Draws a number of 64 bits, or 0 if no bytes are left.
    pub fn word(&mut self) -> u64 {
        self.bytes.arbitrary().unwrap_or(0)
    }

    /// A number below `bound`, or 0 if `bound` is 0.
    pub fn below(&mut self, bound: usize) -> usize {
        self.bytes.int_in_range(0..=bound.saturating_sub(1)).unwrap_or(0)
    }

    /// True with a probability of `1 / n`. If no bytes are left, false (for `n` of 2 or more).
    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    /// Picks one of the values, or the first if no bytes are left. There must be at least one value.
    pub fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// A number from `low` to `high`, both in thousandths.
    pub fn thousandths(&mut self, low: i64, high: i64) -> Fx {
        let value = self.bytes.int_in_range(low..=high).unwrap_or(low);
        lockstep2d::math::ratio(value, 1000)
    }

    /// A number at or near a limit, or any number.
    pub fn edge(&mut self) -> Fx {
        let bits = match self.below(3) {
            0 => self.pick(&EDGES),
            1 => self.pick(&EDGES).wrapping_add(i64::from(self.byte() as i8)),
            _ => (self.word() as i64) >> self.below(64),
        };
        Fx::from_bits(bits)
    }

    /// A number from `low` to `high`, often at or next to one of them.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        match self.below(8) {
            0 => self.bytes.int_in_range(low..=high).unwrap_or(low),
            1 => low,
            2 => high,
            3 => low.saturating_add(1).min(high),
            4 => high.saturating_sub(1).max(low),
            5 => 0.clamp(low, high),
            6 => self.edge().to_bits().clamp(low, high),
            _ => ((self.word() as i64) >> self.below(64)).clamp(low, high),
        }
    }

    /// A number from `low` to `high` thousandths. If the source is not ordinary, sometimes a number near a limit.
    pub fn mostly(&mut self, low: i64, high: i64) -> Fx {
        if !self.ordinary && self.one_in(24) { self.edge() } else { self.thousandths(low, high) }
    }

    /// A vector of two [`Source::mostly`] numbers.
    pub fn mostly_vec(&mut self, low: i64, high: i64) -> Vec2<Fx> {
        Vec2::new(self.mostly(low, high), self.mostly(low, high))
    }

    /// An angle: a multiple of a quarter turn, a multiple of 1/256 turn, or any angle.
    pub fn angle(&mut self) -> Angle {
        match self.below(3) {
            0 => Angle::from_bits((self.byte() as u32 & 3) << 30),
            1 => Angle::from_bits(u32::from(self.byte()) << 24),
            _ => Angle::from_bits(self.bytes.arbitrary().unwrap_or(0)),
        }
    }
}
