use super::config::Config;
use crate::body::{
    Body, BodyKind, BodySettings, MassProperties, MassSource, REACH_MAX, ShapeDef, WORLD_EXTENT_MAX,
    WorldError,
};
use crate::collision::PosedShape;
use crate::math::{Aabb, Fx};

/// Number of low bits of an [`Fx`] that are 0 in the corners of fat boxes: the corners are multiples of 2^-22 m.
pub(crate) const FAT_GRID_SHIFT: u32 = 10;

/// Largest distance of a shape from its body's origin on each axis, in metres. On bodies that move, this distance is a
/// lever arm, which has a smaller range than positions.
pub(crate) fn offset_max(kind: BodyKind) -> Fx {
    match kind {
        BodyKind::Fixed => WORLD_EXTENT_MAX,
        BodyKind::Kinematic | BodyKind::Dynamic => REACH_MAX,
    }
}

/// Mass properties of a body.
///
/// # Errors
/// [`WorldError`] if a mass, a radius of gyration or a centre of mass is out of range.
pub(crate) fn mass_of<'a>(
    kind: BodyKind,
    source: MassSource,
    settings: &BodySettings,
    shapes: impl Iterator<Item = &'a ShapeDef> + Clone,
) -> Result<MassProperties, WorldError> {
    let mass = match kind {
        BodyKind::Dynamic => MassProperties::dynamic(source, shapes)?,
        BodyKind::Fixed | BodyKind::Kinematic => {
            // Checks a given mass although the body is not dynamic, because the body may become dynamic later.
            if matches!(source, MassSource::Given { .. }) {
                MassProperties::dynamic(source, shapes)?;
            }
            MassProperties::immovable()
        }
    };
    Ok(if settings.locks.rotation { mass.without_rotation() } else { mass })
}

/// The fat box of a shape after an edit. On fixed bodies, which ticks do not move, the box has no margin.
pub(crate) fn fat_box(shape: &ShapeDef, body: &Body, config: &Config) -> Aabb {
    let bounds = PosedShape::new(shape, body, body.rotation()).bounds;
    match body.kind() {
        BodyKind::Fixed => fattened(bounds, Fx::ZERO),
        BodyKind::Kinematic | BodyKind::Dynamic => fattened(bounds, config.margin_of(bounds)),
    }
}

/// Bounds extended by a margin in metres. Corners are multiples of 2^-22 m, so that a snapshot can store corners near
/// the body's centre as 32-bit offsets.
pub(crate) fn fattened(bounds: Aabb, margin: Fx) -> Aabb {
    bounds.expanded(margin).rounded_out(FAT_GRID_SHIFT)
}
