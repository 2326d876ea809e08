//! The surface of a contact: the combined materials of two shapes.

use crate::body::Material;
use crate::math::{FrictionRatio, Fx, Speed, Unit, fx_mul, narrow};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) friction: FrictionRatio,
    pub(crate) restitution: Unit,
    /// Approach speed in m/s below which the shapes do not bounce.
    pub(crate) restitution_threshold: Speed,
    /// Sum of the surface speeds of the two shapes, in m/s.
    pub(crate) surface_speed: Speed,
    /// Largest torque per unit of normal force, in metres.
    pub(crate) rolling_resistance: Fx,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceSide<'a> {
    pub(crate) material: &'a Material,
    /// The radius by which the shape is rounded, in metres.
    pub(crate) radius: Fx,
}

impl Surface {
    /// Mixes the materials of two shapes. `threshold` is the restitution threshold of the world.
    pub(crate) fn between(a: SurfaceSide<'_>, b: SurfaceSide<'_>, threshold: Fx) -> Self {
        let resistance = a.material.rolling_resistance.max(b.material.rolling_resistance);
        Surface {
            friction: narrow(a.material.mixed_friction(b.material)),
            restitution: narrow(a.material.mixed_restitution(b.material)),
            restitution_threshold: narrow(a.material.mixed_restitution_threshold(b.material, threshold)),
            surface_speed: narrow(a.material.surface_speed.saturating_add(b.material.surface_speed)),
            rolling_resistance: fx_mul(resistance, a.radius.max(b.radius)),
        }
    }

    /// Whether the surface bounces, moves or resists rolling.
    pub(crate) fn has_extras(&self) -> bool {
        self.restitution.is_positive()
            || self.surface_speed != Speed::ZERO
            || self.rolling_resistance.is_positive()
    }
}
