//! Values that follow from definitions: masses, fat boxes, limits of offsets.

use super::config::Config;
use crate::body::{
    Body, BodyKind, BodySettings, MassProperties, MassSource, REACH_MAX, ShapeDef, WORLD_EXTENT_MAX,
    WorldError,
};
use crate::collision::PosedShape;
use crate::math::{Aabb, Fx};

/// Number of low bits of an [`Fx`] that are 0 in the corners of fat boxes: their grid is 2^-22 m.
pub(crate) const FAT_GRID_SHIFT: u32 = 10;

/// Largest distance of a shape from its body's origin on each axis, in metres. On bodies that can move, these distances
/// become lever arms, which have a smaller range than positions.
pub(crate) fn offset_max(kind: BodyKind) -> Fx {
    match kind {
        BodyKind::Fixed => WORLD_EXTENT_MAX,
        BodyKind::Kinematic | BodyKind::Dynamic => REACH_MAX,
    }
}

/// Mass properties of a body with the given shapes.
///
/// # Errors
/// [`WorldError`] if the mass or the radius of gyration of a dynamic body is out of range, or if a given mass, radius
/// of gyration or centre of mass is.
pub(crate) fn mass_of<'a>(
    kind: BodyKind,
    source: MassSource,
    settings: &BodySettings,
    shapes: impl Iterator<Item = &'a ShapeDef> + Clone,
) -> Result<MassProperties, WorldError> {
    let mass = match kind {
        BodyKind::Dynamic => MassProperties::dynamic(source, shapes)?,
        BodyKind::Fixed | BodyKind::Kinematic => {
            // A given mass is only used once the body becomes dynamic, but it has to be valid from the start.
            if matches!(source, MassSource::Given { .. }) {
                MassProperties::dynamic(source, shapes)?;
            }
            MassProperties::immovable()
        }
    };
    Ok(if settings.locks.rotation { mass.without_rotation() } else { mass })
}

/// The fat box of a shape that was added or moved by an edit. Shapes of fixed bodies get no margin, because no tick
/// moves them.
pub(crate) fn fat_box(shape: &ShapeDef, body: &Body, config: &Config) -> Aabb {
    let bounds = PosedShape::new(shape, body, body.rotation()).bounds;
    match body.kind() {
        BodyKind::Fixed => fattened(bounds, Fx::ZERO),
        BodyKind::Kinematic | BodyKind::Dynamic => fattened(bounds, config.margin_of(bounds)),
    }
}

/// The fat box around `bounds` with a margin in metres. The coordinates of its corners are multiples of 2^-22 m, so
/// that a snapshot can store coordinates near the body's centre as 32-bit offsets from it.
pub(crate) fn fattened(bounds: Aabb, margin: Fx) -> Aabb {
    bounds.expanded(margin).rounded_out(FAT_GRID_SHIFT)
}
