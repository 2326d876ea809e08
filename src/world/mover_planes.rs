//! Movement against planes: what a shape that the game moves touches, seen as half-planes, and the movement that they
//! leave over.
//!
//! ```text
//! minimise |x - target|²   subject to   s_i + n_i . x >= 0
//! ```
//!
//! Planes push along their normals in turn until nothing moves any more, where each push so far may be taken back but
//! never becomes a pull (C. Hildreth, "A Quadratic Programming Procedure", 1957). This is what Box2D v3's
//! `b2SolvePlanes` does. A limit of a push makes a plane soft: something that is stepped into a little.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::World;
use super::probe::Probe;
use super::query::{Proximity, QueryFilter, proximity};
use crate::body::ShapeId;
use crate::collision::Core;
use crate::fx;
use crate::math::{Fx, Unit, Vec2};

/// Rounds of pushes.
const ITERATIONS_MAX: u32 = 32;

/// Sum of all pushes of a round in metres below which the planes are solved.
const TOLERANCE: Fx = fx!(0.000001);

/// A surface near a mover, as a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoverPlane {
    /// Whose surface.
    pub shape: ShapeId,
    /// Out of it, towards the mover.
    pub normal: Vec2<Unit>,
    /// Distance in metres of the mover from it; negative where they overlap.
    pub separation: Fx,
    /// Where on the surface, in the world, in metres.
    pub point: Vec2<Fx>,
    /// How far it pushes at most, in metres: [`Fx::MAX`] if it is rigid.
    pub push_limit: Fx,
    /// How far it has pushed, in metres: a result of [`solve_planes`].
    pub push: Fx,
}

impl World {
    /// Every shape within a distance in metres of a probe, as a plane, in slot order. Links that are solid from one
    /// side are left out on the other. Nothing is within a negative distance.
    ///
    /// ```
    /// use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
    /// use lockstep2d::world::{Probe, World, clip_velocity, solve_planes};
    /// use lockstep2d::{fx, math::Vec2};
    /// let mut world = World::default();
    /// let floor = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(1))?);
    /// world.spawn(&BodyDef::fixed().position(fx!(0), fx!(-1)), &[floor])?;
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
        let core = Core::of(&posed, origin);
        let middle = origin + core.middle();
        let mut planes: Vec<MoverPlane> = Vec::new();
        if within < Fx::ZERO {
            return planes;
        }
        self.each_overlapping(posed.bounds.expanded(within), filter, |shape, other| {
            let Proximity { distance, normal, point_a, .. } =
                proximity(&Core::of(other, origin), &core, origin);
            if distance <= within && other.is_solid_from(middle) {
                let (separation, point) = (distance, point_a);
                let (push_limit, push) = (Fx::MAX, Fx::ZERO);
                planes.push(MoverPlane { shape, normal, separation, point, push_limit, push });
            }
        });
        planes.sort_unstable_by_key(|plane| plane.shape);
        planes
    }
}

/// The translation nearest to a wanted one, in metres, that stays outside of all planes; each plane's `push` says what
/// it has done.
///
/// It comes within a micrometre for up to two planes that meet at a right angle or more openly. In a corner of the
/// angle `a` each round leaves `cos² a` of the error, and there are 32 rounds; where planes leave no room at all, it
/// ends between them. So what follows is a cast along the result, as [`World::move_character`] does.
#[must_use]
pub fn solve_planes(wanted: Vec2<Fx>, planes: &mut [MoverPlane]) -> Vec2<Fx> {
    let mut translation = wanted;
    for plane in &mut *planes {
        plane.push = Fx::ZERO;
    }
    for _ in 0..ITERATIONS_MAX {
        let mut moved = Fx::ZERO;
        for plane in &mut *planes {
            let normal = plane.normal.widen();
            let separation = plane.separation.saturating_add(normal.dot(translation));
            let wanted = plane.push.saturating_sub(separation);
            let push = wanted.min(plane.push_limit).max(Fx::ZERO);
            let change = push - plane.push;
            plane.push = push;
            translation += normal.scale(change);
            moved = moved.saturating_add(change.saturating_abs());
        }
        if moved < TOLERANCE {
            break;
        }
    }
    translation
}

/// The velocity nearest to a given one that leaves or follows every rigid plane that has pushed. Unlike Box2D's
/// `b2ClipVector` it does not depend on the order of the planes.
#[must_use]
pub fn clip_velocity(velocity: Vec2<Fx>, planes: &[MoverPlane]) -> Vec2<Fx> {
    let rigid = planes.iter().filter(|plane| plane.push > Fx::ZERO && plane.push_limit == Fx::MAX);
    clipped(velocity, rigid.map(|plane| plane.normal))
}

/// The vector nearest to `v` that is against none of the normals. They bound a cone, so it is `v` itself, its
/// projection on one of the cone's two borders, or nothing.
pub(super) fn clipped(v: Vec2<Fx>, normals: impl Iterator<Item = Vec2<Unit>> + Clone) -> Vec2<Fx> {
    // What is left of a vector along the normal it was projected across: the rounding of the normal.
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
mod tests {
    use super::*;
    use crate::body::Handle;
    use crate::math::{Angle, Rng, Rot};

    fn plane(normal: Vec2<Unit>, separation: Fx) -> MoverPlane {
        let (shape, point) = (ShapeId::from_parts(0, 0), Vec2::ZERO);
        MoverPlane { shape, normal, separation, point, push_limit: Fx::MAX, push: Fx::ZERO }
    }

    /// The nearest point outside of all planes: the target, its projection on one plane, or where two meet.
    fn nearest(target: Vec2<Fx>, planes: &[MoverPlane], slack: Fx) -> Option<Vec2<Fx>> {
        let height = |plane: &MoverPlane, x: Vec2<Fx>| plane.separation + plane.normal.widen().dot(x);
        let mut candidates = alloc::vec![target];
        for p in planes {
            candidates.push(target - p.normal.widen().scale(height(p, target)));
            for q in planes {
                let (n, m) = (p.normal.widen(), q.normal.widen());
                let meet = crate::math::Mat2::new(n.x, n.y, m.x, m.y);
                if meet.determinant().abs() > fx!(0.01) {
                    let inverse = meet.inverse().expect("not parallel");
                    candidates.push(inverse.apply(Vec2::new(-p.separation, -q.separation)));
                }
            }
        }
        let outside = |x: &Vec2<Fx>| planes.iter().all(|plane| height(plane, *x) >= -slack);
        candidates.into_iter().filter(outside).min_by_key(|x| x.distance(target))
    }

    #[test]
    fn the_solved_translation_is_the_nearest_one_outside() {
        let mut rng = Rng::new(1);
        let mut solved = 0;
        for _ in 0..5000 {
            // Normals within a half circle less 30 degrees: corners are at least that open.
            let turn = rng.angle();
            let normals: Vec<Vec2<Unit>> = (0..1 + rng.below(4))
                .map(|_| {
                    Rot::from_angle(turn + Angle::from_degrees(rng.range(fx!(0), fx!(120)))).apply(Vec2::X)
                })
                .collect();
            let mut planes: Vec<_> =
                normals.iter().map(|&n| plane(n, rng.range(fx!(-0.1), fx!(0.5)))).collect();
            let target = Vec2::new(rng.range(fx!(-1), fx!(1)), rng.range(fx!(-1), fx!(1)));
            let found = solve_planes(target, &mut planes);
            let Some(expected) = nearest(target, &planes, fx!(0.000001)) else { continue };
            solved += 1;
            assert!(found.distance(expected) < fx!(0.0001), "{found:?} {expected:?} {target:?} {planes:?}");
            let velocity = clipped(target, normals.iter().copied());
            let still: Vec<_> = normals.iter().map(|&n| plane(n, Fx::ZERO)).collect();
            let expected = nearest(target, &still, fx!(0.000001)).expect("zero is free");
            assert!(velocity.distance(expected) < fx!(0.00001), "{velocity:?} {expected:?} {planes:?}");
        }
        assert!(solved > 4900, "{solved}");
    }

    #[test]
    fn soft_planes_give_way() {
        let mut planes = [plane(Vec2::Y, Fx::ZERO)];
        planes[0].push_limit = fx!(0.25);
        assert_eq!(solve_planes(Vec2::new(fx!(1), fx!(-1)), &mut planes), Vec2::new(fx!(1), fx!(-0.75)));
        assert_eq!(planes[0].push, fx!(0.25));
        let velocity = Vec2::new(fx!(1), fx!(-1));
        assert_eq!(clip_velocity(velocity, &planes), velocity);
    }

    #[test]
    fn extreme_planes_do_not_panic() {
        let extremes = [Fx::MIN, Fx::MAX, Fx::ZERO, -Fx::DELTA];
        for a in extremes {
            for b in extremes {
                for limit in extremes {
                    let mut planes = [plane(Vec2::X, a), plane(-Vec2::X, b), plane(Vec2::Y, a)];
                    planes[1].push_limit = limit;
                    let _ = solve_planes(Vec2::new(b, a), &mut planes);
                    let _ = clip_velocity(Vec2::new(b, a), &planes);
                }
            }
        }
    }
}
