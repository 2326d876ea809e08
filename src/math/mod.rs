//! Fixed-point mathematics: number formats, vectors, angles, roots, planar geometry and random numbers.
//!
//! All computations use integers with documented rounding, so that deterministic game rules can use them too.

mod aabb;
mod angle;
mod formats;
mod geometry;
mod mat2;
mod reciprocal;
mod rng;
mod root;
mod rot;
mod transform;
mod trig;
mod vec2;
mod wide;

pub use aabb::Aabb;
pub use angle::{Angle, DEGREE, PI, TAU};
pub use formats::{
    FrictionRatio, Fx, Length, Rate, Ratio, Shift, Speed, Step, Unit, convert, div_round, fx_div, fx_mul,
    mul, mul_add, narrow, ratio, round_shift, round_shift_wide, saturate, saturate_wide, widen,
};
pub use geometry::{
    Orientation, closest_point_on_segment, orientation, point_in_polygon, segment_intersection,
};
pub use mat2::Mat2;
pub use reciprocal::Reciprocal;
pub use rng::Rng;
pub use root::{hypot, sqrt};
pub use rot::Rot;
pub use transform::Transform;
pub use vec2::Vec2;
