//! Vectors as floats, for programs that draw. Nothing in the simulation uses them.

use crate::math::{Fx, Vec2};

/// Converts a vector to a pair of floats, as graphics libraries take them. The distance of two neighbouring floats is 1
/// mm at 10 km from the origin: to draw a world that is far from it, subtract the camera's position first.
///
/// ```
/// use lockstep2d::{draw, fx, math::Vec2};
/// let (camera, ball) = (Vec2::new(fx!(1000000), fx!(0)), Vec2::new(fx!(1000000.25), fx!(-1.5)));
/// assert_eq!(draw::to_f32(ball - camera), [0.25, -1.5]);
/// ```
#[expect(clippy::disallowed_types, reason = "graphics libraries take floats")]
#[must_use]
pub fn to_f32(v: Vec2<Fx>) -> [f32; 2] {
    [v.x.to_num(), v.y.to_num()]
}
