//! Contacts at the time of impact: the manifold of shapes that first touch later in the tick.
//!
//! A manifold at the start of the tick describes shapes that are still apart. The normal between two balls that do not
//! meet head-on rotates until they touch, and the ends of a rotating rod move along arcs. If an impact were solved with
//! the normal and the lever arms at the start of the tick, it would not preserve angular momentum and energy. The
//! shapes are therefore advanced, at their initial velocities, to the time at which they touch, and the manifold is
//! computed there. The solver needs separations at the start of the tick. If the shapes touch at the fraction `f` of
//! the tick, and a point with the normal and lever arms of the new manifold approaches by `d` in a whole tick, its
//! separation `s` at the start is
//!
//! ```text
//! s(0) = s(f) + f d
//! ```
//!
//! The time is found by conservative advancement (B. Mirtich, 1996): the separation along a fixed axis is a lower bound
//! of the distance, so the shapes cannot touch before it is 0.

use super::speculative::{Side, SpeculativePair, approach};
use crate::collision::{CachedAxis, KeptManifold, Manifold, PosedShape, SatCounters, arm_of, collide_near};
use crate::math::{
    Angle, Length, Rot, Step, Unit, Vec2, mul, round_shift_wide, saturate, saturate_wide, widen,
};
use crate::world::cache::{MotionCache, PendingImpact, PredictedMotion, Travel};

const ROUNDS_MAX: u32 = 4;

/// Distance in metres up to which shapes count as touching, so that the search for the time of impact ends.
const TOLERANCE: Step = Step::lit("0.001");

/// The impact of two shapes on their paths within a tick.
#[derive(Debug)]
pub(super) enum Impact {
    /// The shapes pass by each other. They are closest to each other at about this fraction of the tick.
    Miss { fraction: Unit },
    At {
        /// Fraction of the tick.
        fraction: Unit,
        manifold: Manifold,
        /// Displacements of both bodies from the start of the tick to the impact.
        moved: [Vec2<Length>; 2],
    },
}

impl Impact {
    /// `start` has the manifold at the start of the tick, and the manifold that the contact then keeps.
    pub(super) fn pending(
        &self,
        manifold: u32,
        contact: u32,
        bodies: [u32; 2],
        start: (Manifold, KeptManifold),
    ) -> PendingImpact {
        let (Impact::Miss { fraction } | Impact::At { fraction, .. }) = *self;
        let misses = matches!(self, Impact::Miss { .. });
        PendingImpact { manifold, contact, bodies, fraction, misses, start }
    }
}

struct MovingShape<'a> {
    side: Side<'a>,
    motion: &'a PredictedMotion,
    disc: bool,
}

impl MovingShape<'_> {
    fn at(&self, fraction: Unit) -> PosedShape {
        let MovingShape { side: Side { shape, body, posed }, motion, disc } = *self;
        let moved = motion.shift_until(fraction);
        if motion.turn == 0 || disc {
            let mut posed = posed.clone();
            posed.shift(moved);
            return posed;
        }
        let turned: Travel = mul(motion.turn, fraction);
        let rotation = Rot::from_angle(body.angle() + Angle::from_radians(widen(turned)));
        let centre = motion.centre + moved + rotation.apply_wide(arm_of(&shape.def, body));
        PosedShape::of_geometry(shape.geometry(), centre, rotation)
    }
}

impl SpeculativePair<'_> {
    /// Whether the shapes are apart, but may approach so fast that their manifold at the time of impact differs from
    /// `manifold`, which is that at the start of the tick.
    #[inline]
    pub(super) fn may_impact(&self, manifold: &Manifold) -> bool {
        self.closing.is_longer_than(self.margins.touching)
            && manifold.points().iter().all(|point| point.separation > self.margins.touching)
    }

    /// The impact of the shapes on their unobstructed paths within the tick. `None` if `manifold`, that at the start of
    /// the tick, has no point that gets to the other shape.
    #[cold]
    pub(super) fn impact(
        &self,
        sides: [Side<'_>; 2],
        motion: &MotionCache,
        manifold: &Manifold,
        counters: &mut SatCounters,
    ) -> Option<Impact> {
        let motions = [motion.motion(self.a), motion.motion(self.b)];
        let shapes = [(self.a, 0), (self.b, 1)].map(|(shape, side)| MovingShape {
            side: sides[side],
            motion: motions[side],
            disc: shape.disc,
        });
        let mut time = time_of_touch(&soonest(motions, manifold)?, 0)?;
        let mut found = None;
        for _ in 0..ROUNDS_MAX {
            let fraction = Unit::from_bits(saturate(time));
            let [a, b] = shapes.each_ref().map(|shape| shape.at(fraction));
            let at_impact = collide_near(&a, &b, self.closing.margin, &mut CachedAxis::default(), counters);
            if at_impact.points().is_empty() {
                return Some(Impact::Miss { fraction });
            }
            let there = motions.map(|motion| motion.advanced(fraction));
            let next = soonest(there.each_ref(), &at_impact);
            let is_apart = at_impact.points().iter().all(|point| point.separation > TOLERANCE);
            found = Some((at_impact, fraction, there));
            let later = next.filter(|next| next.separation.saturating_abs() > TOLERANCE);
            match later.and_then(|later| time_of_touch(&later, time)) {
                Some(later) => time = later,
                None if is_apart => return Some(Impact::Miss { fraction }),
                None => break,
            }
        }
        let (mut at_impact, fraction, there) = found?;
        let closing_at = approach(&there[0], &there[1], &at_impact);
        at_impact.separate(|point| {
            let closing = i128::from(closing_at(point)) * i128::from(fraction.to_bits());
            let closed = saturate_wide(round_shift_wide(closing, Unit::FRAC_NBITS));
            Step::from_bits(saturate(closed.saturating_add(point.separation.to_bits().into())))
        });
        let moved = motions.map(|motion| motion.shift_until(fraction).narrow());
        Some(Impact::At { fraction, manifold: at_impact, moved })
    }
}

/// The separation of a contact point, and the distance by which it approaches in a whole tick, in units of [`Step`].
struct ClosingPoint {
    separation: Step,
    distance: i64,
}

fn soonest([a, b]: [&PredictedMotion; 2], manifold: &Manifold) -> Option<ClosingPoint> {
    let closing_at = approach(a, b, manifold);
    let points = manifold
        .points()
        .iter()
        .map(|point| ClosingPoint { separation: point.separation, distance: closing_at(point) });
    // Compares the times s1 / d1 and s2 / d2 by cross-multiplication, which needs positive distances d.
    points.filter(|point| point.distance > 0).reduce(|first, point| {
        let time = |point: &ClosingPoint, other: &ClosingPoint| {
            i128::from(point.separation.to_bits()) * i128::from(other.distance)
        };
        if time(&point, &first) < time(&first, &point) { point } else { first }
    })
}

/// The fraction of the tick at which the separation of a point becomes 0, as the bits of a [`Unit`]. `from` is the
/// fraction at which the point has `point.separation`. `None` if the result is not within the tick.
fn time_of_touch(point: &ClosingPoint, from: i64) -> Option<i64> {
    let rest = (i64::from(point.separation.to_bits()) << Unit::FRAC_NBITS) / point.distance;
    let time = from.saturating_add(rest);
    (0..=Unit::ONE.to_bits().into()).contains(&time).then_some(time)
}
