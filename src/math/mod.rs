//! Fixed-point mathematics: number formats, vectors, angles, roots, planar geometry and random numbers.
//!
//! Everything here is exact integer arithmetic with documented rounding, so a game can write its own rules with
//! it and stay bit-identical on every machine.

mod aabb;
mod angle;
mod formats;
mod root;
mod rot;
mod transform;
mod trig;
mod vec2;

pub use aabb::Aabb;
pub use angle::{Angle, DEGREE, PI, TAU};
pub use formats::{
    Fx, Grip, Length, Rate, Ratio, Speed, Step, Unit, convert, div_round, fx_div, fx_mul, mul, mul_add,
    narrow, ratio, round_shift, round_shift_wide, saturate, saturate_wide, widen,
};
pub use root::{hypot, sqrt};
pub use rot::Rot;
pub use transform::Transform;
pub use vec2::Vec2;
