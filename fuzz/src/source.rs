//! Decisions drawn from the fuzzer's bytes. When the bytes end every decision is the first one, so that a short
//! input is a short scene.

use arbitrary::Unstructured;
use lockstep2d::math::{Angle, Fx, Vec2};

/// Bytes turned into decisions.
pub struct Source<'a>(Unstructured<'a>);

/// Numbers at and around which formats and limits end.
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
    /// Decisions from some bytes.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Source(Unstructured::new(bytes))
    }

    /// Whether no bytes are left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All bytes that are left.
    #[must_use]
    pub fn rest(self) -> &'a [u8] {
        self.0.take_rest()
    }

    /// A byte.
    pub fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or(0)
    }

    /// 64 bits.
    pub fn word(&mut self) -> u64 {
        self.0.arbitrary().unwrap_or(0)
    }

    /// A number below `bound`, 0 when that is 0.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0.int_in_range(0..=bound.saturating_sub(1)).unwrap_or(0)
    }

    /// True once in `n` times, and never when the bytes have ended.
    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    /// One of some values.
    pub fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// A number from `low` to `high`, both in thousandths.
    pub fn thousandths(&mut self, low: i64, high: i64) -> Fx {
        let value = self.0.int_in_range(low..=high).unwrap_or(low);
        lockstep2d::math::ratio(value, 1000)
    }

    /// A number at or near the end of some format or limit, or any at all.
    pub fn edge(&mut self) -> Fx {
        let bits = match self.below(3) {
            0 => self.pick(&EDGES),
            1 => self.pick(&EDGES).wrapping_add(i64::from(self.byte() as i8)),
            _ => (self.word() as i64) >> self.below(64),
        };
        Fx::from_bits(bits)
    }

    /// Mostly a number from `low` to `high` thousandths, sometimes an edge.
    pub fn mostly(&mut self, low: i64, high: i64) -> Fx {
        if self.one_in(24) { self.edge() } else { self.thousandths(low, high) }
    }

    /// A vector of such numbers.
    pub fn mostly_vec(&mut self, low: i64, high: i64) -> Vec2<Fx> {
        Vec2::new(self.mostly(low, high), self.mostly(low, high))
    }

    /// A rotation: a multiple of a quarter turn, or any.
    pub fn angle(&mut self) -> Angle {
        match self.below(3) {
            0 => Angle::from_bits((self.byte() as u32 & 3) << 30),
            1 => Angle::from_bits(u32::from(self.byte()) << 24),
            _ => Angle::from_bits(self.0.arbitrary().unwrap_or(0)),
        }
    }
}
