//! Fixed-point mathematics: number formats, vectors, angles, roots, planar geometry and random numbers.
//!
//! Everything here is exact integer arithmetic with documented rounding, so a game can write its own rules with
//! it and stay bit-identical on every machine.

mod formats;
mod vec2;

pub use formats::{
    Fx, Grip, Length, Rate, Ratio, Speed, Step, Unit, convert, div_round, fx_div, fx_mul, mul, mul_add,
    narrow, ratio, round_shift, round_shift_wide, saturate, saturate_wide, widen,
};
pub use vec2::Vec2;
