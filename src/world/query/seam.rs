//! Casts along a floor of many shapes do not stop at the seams.
//!
//! A body at rest lies a little lower than the surface, so that a cast along the floor would meet the side of the next
//! tile, or the end of the next link of a chain. A hit of a cast that starts in contact is therefore confirmed by a
//! second cast, which starts where the shape just rests on the surfaces that it touches. An obstacle that the second
//! cast does not meet is a seam.
//!
//! Only contacts that the cast leaves or slides along lift the shape. A contact that it moves into stops it.

use smallvec::SmallVec;

use super::mover_planes::{MoverPlane, solve_planes};
use super::{Probe, QueryFilter};
use crate::body::ShapeId;
use crate::collision::{
    SKIN, SKIN_TOLERANCE, ShapeHit, SupportShape, cast_shape, distance, goes_against, to_grid,
};
use crate::fx;
use crate::math::{Fx, Unit, Vec2};
use crate::world::World;

/// Tolerances of the position in which a shape rests on the surfaces that it touches.
#[derive(Clone, Copy)]
pub(super) struct Rest {
    /// Distance in metres from the surfaces at which the second cast starts. Ledges of up to 5 µm, the difference to
    /// the gap of the first cast, count as seams: tiles of a ramp are flush to within a micrometre.
    gap: Fx,
    /// Largest additional distance in metres by which the cast may approach a surface that it slides along.
    grazing_max: Fx,
}

impl Rest {
    pub(super) const CAST: Rest = Rest { gap: fx!(0.000105), grazing_max: fx!(0.00005) };

    /// For casts that turn, whose gap is up to 0.15 mm.
    pub(super) const TURNING: Rest = Rest { gap: fx!(0.000155), grazing_max: fx!(0.00005) };

    /// For characters: no approach, because each move would bring them closer to the surface.
    pub(super) const CHARACTER: Rest = Rest { gap: fx!(0.000105), grazing_max: Fx::ZERO };

    /// Distance in metres by which a cast along a translation may approach a surface that it slides along: 1 µm per
    /// metre, because directions and the sides of rotated tiles are parallel to within 0.5 µm per metre.
    fn grazing(self, translation: Vec2<Fx>) -> Fx {
        (translation.length() >> 20_u32).min(self.grazing_max)
    }
}

/// Depth in metres up to which an overlap counts as a contact.
const DEPTH_MAX: Fx = fx!(0.02);

/// The second cast, from the position where the shape just rests on the surfaces that it touches.
pub(super) struct Resting {
    /// The shape, relative to the position of the probe.
    shape: SupportShape,
    /// Displacement in metres from the start of the cast to where the shape rests.
    pub(super) lift: Vec2<Fx>,
    pub(super) translation: Vec2<Fx>,
}

impl Resting {
    /// Confirms a hit on a shape; `None` if the hit is a seam. Takes the normal from the second cast, because the first
    /// one may have met a corner below the surface.
    pub(super) fn confirm(&self, other: &SupportShape, hit: ShapeHit) -> Option<ShapeHit> {
        let confirmed = cast_shape(other, &self.shape, self.translation)?;
        Some(ShapeHit { normal: confirmed.normal, point: confirmed.point, ..hit })
    }
}

impl World {
    /// The cast of a probe along a translation, from the position where it rests on the shapes that it touches. `None`
    /// if it touches nothing.
    pub(super) fn resting(
        &self,
        probe: &Probe,
        translation: Vec2<Fx>,
        filter: QueryFilter,
        rest: Rest,
        accept: impl Fn(ShapeId, Vec2<Unit>, [&SupportShape; 2]) -> bool,
    ) -> Option<Resting> {
        let posed = probe.posed();
        let origin = probe.position();
        let moving = SupportShape::of(&posed, origin);
        let middle = origin + moving.middle();
        let grazing = rest.grazing(translation);
        let mut planes: SmallVec<[MoverPlane; 8]> = SmallVec::new();
        self.each_overlapping(posed.bounds.expanded(SKIN + SKIN), filter, |shape, other| {
            if !other.is_solid_from(middle) {
                return;
            }
            let other = SupportShape::of(other, origin);
            let start = distance(&other, &moving);
            let touches = (-DEPTH_MAX..=SKIN + SKIN_TOLERANCE).contains(&start.distance);
            if touches
                && (!goes_against(start.normal, translation)
                    || start.normal.widen().dot(translation) >= -grazing)
                && accept(shape, start.normal, [&other, &moving])
            {
                let separation = start.distance - rest.gap - grazing;
                planes.push(self.mover_plane(shape, start.normal, separation, origin));
            }
        });
        // The broad phase finds the shapes in no defined order.
        planes.sort_unstable_by_key(|plane| plane.shape);
        let out = solve_planes(Vec2::ZERO, &mut planes);
        // From the resting position an obstacle may be further away, so the cast is longer by twice the displacement.
        let forwards = translation.normalized().unwrap_or(Vec2::ZERO).widen();
        let beyond = forwards.scale(out.length() * 2);
        (!planes.is_empty()).then(|| Resting {
            shape: moving.moved(to_grid(out)),
            lift: out,
            translation: translation + beyond,
        })
    }
}
