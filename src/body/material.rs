//! Surface properties.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::error::WorldError;
use crate::fx;
use crate::math::{Fx, fx_mul};

/// Rule that combines a property of two shapes. If two shapes have different rules, the rule that comes later in this
/// list applies.
///
/// ```
/// use lockstep2d::{body::{Material, Mixing}, fx};
/// // Ice is slippery, whatever slides on it.
/// let ice = Material { friction: fx!(0.02), friction_mixing: Mixing::Minimum, ..Material::default() };
/// let rubber = Material { friction: fx!(1.2), ..Material::default() };
/// assert_eq!(ice.mixed_friction(&rubber), fx!(0.02));
/// assert_eq!(rubber.mixed_friction(&ice), fx!(0.02));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Mixing {
    /// `(a + b) / 2`.
    Average,
    /// `sqrt(a b)`.
    GeometricMean,
    /// The smaller value.
    Minimum,
    /// `a b`.
    Product,
    /// The larger value.
    Maximum,
}

impl Mixing {
    fn mix(self, a: Fx, b: Fx) -> Fx {
        match self {
            Mixing::Average => Fx::from_bits((a.to_bits() >> 1) + (b.to_bits() >> 1)),
            Mixing::GeometricMean if a == b => a,
            Mixing::GeometricMean => geometric_mean(a, b),
            Mixing::Minimum => a.min(b),
            Mixing::Product => fx_mul(a, b),
            Mixing::Maximum => a.max(b),
        }
    }
}

/// `sqrt(a b)` of non-negative values, rounded down.
fn geometric_mean(a: Fx, b: Fx) -> Fx {
    let product = u128::from(a.to_bits().unsigned_abs()) * u128::from(b.to_bits().unsigned_abs());
    Fx::from_bits(i64::try_from(product.isqrt()).expect("the mean of two Fx is an Fx"))
}

/// Surface properties of a shape.
///
/// ```
/// use lockstep2d::{fx, body::Material};
/// let ice = Material { friction: fx!(0.05), ..Material::default() };
/// assert!(ice.is_valid());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Material {
    /// Coulomb friction coefficient, 0 to 16.
    pub friction: Fx,
    /// Rule that combines the friction of two shapes.
    pub friction_mixing: Mixing,
    /// Ratio of the speed after a bounce to the approach speed, 0 to 1.5. The combined value of a pair is clamped to 2.
    /// Shapes that approach more slowly than [`Material::restitution_threshold`] do not bounce.
    pub restitution: Fx,
    /// Rule that combines the restitution of two shapes.
    pub restitution_mixing: Mixing,
    /// Approach speed in m/s below which the shape does not bounce, 0 to 400. `None` means the world's
    /// [`restitution_threshold`](crate::solver::SolverSettings::restitution_threshold). A pair uses the smaller value
    /// of its two shapes. A ball with a threshold of 0 may take long to come to rest, and a pile of such balls may
    /// never come to rest.
    pub restitution_threshold: Option<Fx>,
    /// Rolling resistance of a round shape, 0 to 1: the offset of the ground reaction ahead of the axle, as a fraction
    /// of the radius. A pair uses the larger value and the larger radius. If the ground is round and has a larger
    /// radius than the wheel, multiply the value by the radius of the wheel and divide it by that of the ground. On
    /// level ground, a wheel with the radius `r` and the radius of gyration `k` decelerates by `rolling_resistance g /
    /// (1 + k^2 / r^2)`.
    pub rolling_resistance: Fx,
    /// Surface speed in m/s, clockwise around the shape, ±400: the upper side of a conveyor belt with a positive speed
    /// carries bodies to the right. A pair uses the sum of the speeds of its two shapes.
    pub surface_speed: Fx,
}

impl Default for Material {
    /// Friction 0.6 with the geometric mean, restitution 0 with the maximum, no rolling resistance or surface speed.
    fn default() -> Self {
        Material {
            friction: fx!(0.6),
            friction_mixing: Mixing::GeometricMean,
            restitution: Fx::ZERO,
            restitution_mixing: Mixing::Maximum,
            restitution_threshold: None,
            rolling_resistance: Fx::ZERO,
            surface_speed: Fx::ZERO,
        }
    }
}

impl Material {
    /// Largest friction coefficient.
    pub const FRICTION_MAX: Fx = fx!(16);

    /// Largest restitution.
    pub const RESTITUTION_MAX: Fx = fx!(1.5);

    /// Largest restitution threshold in m/s.
    pub const RESTITUTION_THRESHOLD_MAX: Fx = fx!(400);

    /// Largest surface speed in m/s, in either direction.
    pub const SURFACE_SPEED_MAX: Fx = fx!(400);

    /// Whether all properties are in range.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.validate().is_ok()
    }

    pub(crate) fn validate(&self) -> Result<(), WorldError> {
        let Material {
            friction,
            friction_mixing: _,
            restitution,
            restitution_mixing: _,
            restitution_threshold,
            rolling_resistance,
            surface_speed,
        } = *self;
        let threshold = restitution_threshold.unwrap_or_default();
        for (what, value, min, max) in [
            ("friction", friction, Fx::ZERO, Self::FRICTION_MAX),
            ("restitution", restitution, Fx::ZERO, Self::RESTITUTION_MAX),
            ("restitution threshold", threshold, Fx::ZERO, Self::RESTITUTION_THRESHOLD_MAX),
            ("rolling resistance", rolling_resistance, Fx::ZERO, Fx::ONE),
            ("surface speed", surface_speed, -Self::SURFACE_SPEED_MAX, Self::SURFACE_SPEED_MAX),
        ] {
            if !(min..=max).contains(&value) {
                return Err(WorldError::MaterialOutOfRange { what, value, min, max });
            }
        }
        Ok(())
    }

    /// Combined friction of two surfaces.
    #[must_use]
    pub fn mixed_friction(&self, other: &Material) -> Fx {
        self.friction_mixing.max(other.friction_mixing).mix(self.friction, other.friction)
    }

    /// Combined restitution of two surfaces. The solver clamps it to 2.
    #[must_use]
    pub fn mixed_restitution(&self, other: &Material) -> Fx {
        self.restitution_mixing.max(other.restitution_mixing).mix(self.restitution, other.restitution)
    }

    /// Combined restitution threshold of two surfaces: the smaller of the two, where `None` means `world`.
    #[must_use]
    pub fn mixed_restitution_threshold(&self, other: &Material, world: Fx) -> Fx {
        let [a, b] = [self, other].map(|material| material.restitution_threshold.unwrap_or(world));
        a.min(b)
    }
}
