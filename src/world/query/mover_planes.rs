//! Surfaces near a shape as half-planes, and the translation that they allow.
//!
//! ```text
//! minimise |x - target|²   subject to   s_i + n_i . x >= 0
//! ```
//!
//! Here `x` is the translation, and `s_i` and `n_i` are the separations and the normals of the planes. A plane with a
//! limited push is soft: the mover may enter it. If there are soft planes, or no point is outside of all planes, the
//! planes push along their normals in turn for at most 64 rounds (C. Hildreth, "A Quadratic Programming Procedure",
//! 1957), as in Box2D v3's `b2SolvePlanes`.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::overlap::{ClosestPoints, proximity};
use super::{Probe, QueryFilter};
use crate::body::{BodyId, Handle, ShapeId};
use crate::collision::SupportShape;
use crate::fx;
use crate::math::{Angle, Fx, Unit, Vec2, fx_div};
use crate::world::World;

const ITERATIONS_MAX: u32 = 64;

/// Total change of the pushes in a round, in metres, at which the planes count as solved.
const TOLERANCE: Fx = fx!(0.000001);

/// Planes count as parallel if the sine of the angle between them is below this value.
const PARALLEL: Fx = fx!(0.000001);

/// A surface near a mover, as a plane.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, world::World};
/// use lockstep2d::world::{MoverPlane, Probe, solve_planes};
/// use lockstep2d::{fx, math::Vec2};
/// # let mut world = World::default();
/// # let floor = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(1))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor])?;
/// // A character moved by the game's own code, 1 cm above the floor, that walks 5 cm to the right and falls by 1 m.
/// let ball = Probe::new(Geometry::circle(fx!(0.5))?, Vec2::new(fx!(0), fx!(0.51)))?;
/// let mut planes: Vec<MoverPlane> = world.collide_mover(&ball, fx!(1), Default::default());
/// let step = solve_planes(Vec2::new(fx!(0.05), fx!(-1)), &mut planes);
/// assert!(step.x == fx!(0.05) && (step.y + fx!(0.01)).abs() < fx!(0.001));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[doc(alias = "collision plane")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoverPlane {
    /// The shape that the surface belongs to.
    pub shape: ShapeId,
    /// The body of that shape.
    pub body: BodyId,
    /// Position of the body's origin at the time of the query, in the world, in metres.
    pub body_position: Vec2<Fx>,
    /// Rotation of the body at the time of the query.
    pub body_angle: Angle,
    /// Velocity of the surface at `point` in m/s, including the surface speed of its material. A body that was moved by
    /// [`World::move_to`] has no velocity after the tick.
    pub velocity: Vec2<Fx>,
    /// Outward normal, towards the mover.
    pub normal: Vec2<Unit>,
    /// Distance of the mover from the surface in metres, negative if they overlap.
    pub separation: Fx,
    /// Nearest point on the surface, in the world, in metres.
    pub point: Vec2<Fx>,
    /// Largest push in metres: [`Fx::MAX`] if the plane is rigid.
    pub push_limit: Fx,
    /// Push along the normal in metres, set by [`solve_planes`].
    pub push: Fx,
}

impl World {
    /// Returns a plane for every shape within a distance in metres of a probe, in slot order. Leaves out chain links
    /// that are solid from one side if the probe's middle is on the other side.
    ///
    /// ```
    /// use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
    /// use lockstep2d::world::{Probe, World, clip_velocity, solve_planes};
    /// use lockstep2d::{fx, math::Vec2};
    /// let mut world = World::default();
    /// let floor = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(1))?);
    /// world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor])?;
    ///
    /// let ball = Probe::new(Geometry::circle(fx!(0.5))?, Vec2::new(fx!(0), fx!(0.75)))?;
    /// let mut planes = world.collide_mover(&ball, fx!(1), Default::default());
    /// let translation = solve_planes(Vec2::new(fx!(1), fx!(-1)), &mut planes);
    /// assert_eq!(translation, Vec2::new(fx!(1), fx!(-0.25)));
    /// let velocity = clip_velocity(Vec2::new(fx!(3), fx!(-5)), &planes);
    /// assert_eq!(velocity, Vec2::new(fx!(3), fx!(0)));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    pub fn collide_mover(&self, probe: &Probe, within: Fx, filter: QueryFilter) -> Vec<MoverPlane> {
        let posed = probe.posed();
        let origin = probe.position();
        let support = SupportShape::of(&posed, origin);
        let middle = origin + support.middle();
        let mut planes: Vec<MoverPlane> = Vec::new();
        if within < Fx::ZERO {
            return planes;
        }
        self.each_overlapping(posed.bounds.expanded(within), filter, |shape, other| {
            let ClosestPoints { distance, normal, point_a, .. } =
                proximity(&SupportShape::of(other, origin), &support, origin);
            if distance <= within && other.is_solid_from(middle) {
                planes.push(self.mover_plane(shape, normal, distance, point_a));
            }
        });
        planes.sort_unstable_by_key(|plane| plane.shape);
        planes
    }

    pub(super) fn mover_plane(
        &self,
        shape: ShapeId,
        normal: Vec2<Unit>,
        separation: Fx,
        point: Vec2<Fx>,
    ) -> MoverPlane {
        let body = self.state.body_of(shape.slot());
        let belt = self.state.shapes.at(shape.slot()).material().surface_speed;
        let velocity = body.velocity_at(point) + along_surface(normal, belt);
        MoverPlane {
            shape,
            body: self.state.shapes.at(shape.slot()).body(),
            body_position: body.position(),
            body_angle: body.angle(),
            velocity,
            normal,
            separation,
            point,
            push_limit: Fx::MAX,
            push: Fx::ZERO,
        }
    }
}

/// Vector with the given length (or speed) along a surface. On ground, a positive length leads to the right.
pub(super) fn along_surface(normal: Vec2<Unit>, length: Fx) -> Vec2<Fx> {
    Vec2::new(normal.y, -normal.x).widen().scale(length)
}

/// Returns the translation in metres that is nearest to a wanted one and stays outside of all planes. Sets each plane's
/// `push`.
///
/// If all planes are rigid and some point is outside of all of them, the result is exact except for rounding. Otherwise
/// the planes push in turn. This iteration converges for two planes whose normals differ by 25 to 155 degrees. At other
/// angles, or between two walls, the result may be behind a plane: check it by a cast.
#[must_use]
pub fn solve_planes(wanted: Vec2<Fx>, planes: &mut [MoverPlane]) -> Vec2<Fx> {
    match nearest_outside(wanted, planes) {
        Some(translation) => {
            let out = translation - wanted;
            for plane in planes {
                let reached = plane.height(translation) <= TOLERANCE;
                let push = plane.normal.widen().dot(out).max(Fx::ZERO);
                plane.push = if reached { push } else { Fx::ZERO };
            }
            translation
        }
        None => pushed_in_turn(wanted, planes),
    }
}

impl MoverPlane {
    /// Distance of the mover from the surface after a translation.
    pub(super) fn height(&self, translation: Vec2<Fx>) -> Fx {
        self.separation.saturating_add(self.normal.widen().dot(translation))
    }
}

/// The nearest point outside of rigid planes. Planes are added one by one: if the point so far is behind the new plane,
/// the next point is on that plane (R. Seidel, "Small-Dimensional Linear Programming and Convex Hulls Made Easy",
/// 1991). `None` if a plane is soft, or if no point is outside of all planes.
fn nearest_outside(wanted: Vec2<Fx>, planes: &[MoverPlane]) -> Option<Vec2<Fx>> {
    if planes.iter().any(|plane| plane.push_limit != Fx::MAX) {
        return None;
    }
    let mut nearest = wanted;
    for (i, plane) in planes.iter().enumerate() {
        if plane.height(nearest) >= Fx::ZERO {
            continue;
        }
        // The points on the border of `plane` are p + t d.
        let n = plane.normal.widen();
        let (p, d) = (wanted - n.scale(plane.height(wanted)), n.perp());
        let (mut t_min, mut t_max) = (Fx::MIN, Fx::MAX);
        for other in &planes[..i] {
            let (height, slope) = (other.height(p), other.normal.widen().dot(d));
            if slope.abs() < PARALLEL {
                if height < -TOLERANCE {
                    return None;
                }
                continue;
            }
            let t = fx_div(height.saturating_neg(), slope)?;
            (t_min, t_max) = if slope > 0 { (t_min.max(t), t_max) } else { (t_min, t_max.min(t)) };
        }
        if t_min > t_max {
            return None;
        }
        nearest = p + d.scale(Fx::ZERO.clamp(t_min, t_max));
    }
    Some(nearest)
}

/// The translation after planes have pushed in turn, each within its limit.
fn pushed_in_turn(wanted: Vec2<Fx>, planes: &mut [MoverPlane]) -> Vec2<Fx> {
    let mut translation = wanted;
    for plane in &mut *planes {
        plane.push = Fx::ZERO;
    }
    for _ in 0..ITERATIONS_MAX {
        let mut moved = Fx::ZERO;
        for plane in &mut *planes {
            let wanted = plane.push.saturating_sub(plane.height(translation));
            let push = wanted.min(plane.push_limit).max(Fx::ZERO);
            let change = push - plane.push;
            plane.push = push;
            translation += plane.normal.widen().scale(change);
            moved = moved.saturating_add(change.saturating_abs());
        }
        if moved < TOLERANCE {
            break;
        }
    }
    translation
}

/// Returns the velocity that is nearest to `velocity` and does not lead into any rigid plane with a positive `push`.
/// The result does not depend on the order of the planes, unlike in Box2D's `b2ClipVector`.
#[must_use]
pub fn clip_velocity(velocity: Vec2<Fx>, planes: &[MoverPlane]) -> Vec2<Fx> {
    let rigid = planes.iter().filter(|plane| plane.push > Fx::ZERO && plane.push_limit == Fx::MAX);
    clipped(velocity, rigid.map(|plane| plane.normal))
}

/// The vector nearest to `v` with no component against the normals. All vectors without such a component form a cone:
/// the result is `v`, its projection on a border of the cone, or zero.
pub(super) fn clipped(v: Vec2<Fx>, normals: impl Iterator<Item = Vec2<Unit>> + Clone) -> Vec2<Fx> {
    // Tolerance: normals are rounded, so that a vector projected onto a plane keeps a small component along its normal.
    let size = v.x.saturating_abs().max(v.y.saturating_abs());
    let rounding = (size >> 26_u32) + Fx::DELTA * 4;
    let is_free = |w: Vec2<Fx>| normals.clone().all(|n| n.widen().dot(w) >= -rounding);
    if is_free(v) {
        return v;
    }
    let across = |n: Vec2<Unit>| v - n.widen().scale(n.widen().dot(v));
    let against = normals.clone().filter(|n| n.widen().dot(v) < -rounding);
    against.map(across).filter(|&w| is_free(w)).max_by_key(|w| w.length()).unwrap_or(Vec2::ZERO)
}

#[cfg(test)]
mod tests;
