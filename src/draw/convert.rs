use crate::math::{Fx, Vec2};

/// Converts a vector to a pair of floats for graphics libraries. At 10 km from the origin, neighbouring floats differ
/// by 1 mm: to draw a world far from the origin, subtract the camera's position first.
///
/// ```
/// use lockstep2d::{draw, fx, math::Vec2};
/// let (camera, ball) = (Vec2::new(fx!(1000000), fx!(0)), Vec2::new(fx!(1000000.25), fx!(-1.5)));
/// assert_eq!(draw::to_f32(ball - camera), [0.25, -1.5]);
/// ```
///
/// With the feature `mint`, `Vec2<Fx>` converts into `mint::Vector2<f32>` and `mint::Point2<f32>`, and through them
/// into the types of `glam`, `nalgebra`, `cgmath` and others.
#[expect(clippy::disallowed_types, reason = "graphics libraries take floats")]
#[must_use]
pub fn to_f32(v: Vec2<Fx>) -> [f32; 2] {
    [v.x.to_num(), v.y.to_num()]
}

#[cfg(feature = "mint")]
#[expect(clippy::disallowed_types, reason = "graphics libraries take floats")]
impl From<Vec2<Fx>> for mint::Vector2<f32> {
    fn from(v: Vec2<Fx>) -> Self {
        to_f32(v).into()
    }
}

#[cfg(feature = "mint")]
#[expect(clippy::disallowed_types, reason = "graphics libraries take floats")]
impl From<Vec2<Fx>> for mint::Point2<f32> {
    fn from(v: Vec2<Fx>) -> Self {
        to_f32(v).into()
    }
}
