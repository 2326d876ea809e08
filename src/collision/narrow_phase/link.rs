//! A chain link against a circle or a convex outline.
//!
//! If links collided like separate segments, the end of a link would push back a shape that slides along the chain, or
//! push it up: a ghost collision. Therefore the two links at a vertex decide together which contact normals are allowed
//! there (E. Catto, chain segments of Box2D 3):
//!
//! ```text
//! convex vertex    normals between the normals of the two links; each link has the half nearer to its own normal
//! flat or concave  only the two links' normals: a link pushes along its own normal
//! free end         every direction
//! ```
//!
//! A point beside a chain belongs to exactly one link. An exception is a point on the inner side of a concave vertex,
//! which belongs to both links.

use super::circle_hull::{distance_along, step_bits};
use super::hull_hull::{self, Face, TOLERANCE_WIDE};
use super::segment::clipped_to_window;
use crate::body::Sides;
use crate::collision::manifold::{Feature, Manifold, ManifoldPoint};
use crate::collision::shape::link::Link;
use crate::collision::shape::posed::Hull;
use crate::math::{Fx, Length, Step, Unit, Vec2, convert, saturate};

/// Sine of the angle (0.6 degrees) below which convex vertices count as flat.
const ANGLE_TOLERANCE: Unit = Unit::lit("0.01");

/// Sine of the largest angle between a face normal and the link's normal at which the two count as equal. With a larger
/// value, every vertex would push back the rounded boxes that slide along the chain.
const PARALLEL: Unit = Unit::lit("0.0002");

#[derive(Clone, Copy, Debug)]
enum LinkEnd {
    Free,
    Joined { direction: Vec2<Unit>, turn: Turn },
}

/// Turn of the chain at a vertex, as seen from the side of the shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    Convex,
    Flat,
    Concave,
}

/// Decision on a candidate normal: the contact normal that the shape and the link would have if the link had no
/// neighbours.
enum Verdict {
    /// The link pushes along the candidate normal.
    Own,
    /// The chain allows the candidate normal, but a neighbour pushes along it.
    Neighbour,
    /// The candidate normal does not belong to this link.
    Leave,
    /// The link pushes along its own normal instead.
    Snap,
}

/// A link relative to the centre of another shape, oriented so that the shape is on its right.
pub(crate) struct Facing {
    /// The link as an outline with two edges. Edge 0 faces the shape.
    hull: Hull,
    direction: Vec2<Unit>,
    normal: Vec2<Unit>,
    start: LinkEnd,
    end: LinkEnd,
    one_sided: bool,
}

impl Facing {
    /// Orients a link towards a point of the other shape. `centre` is the centre of the other shape relative to the
    /// centre of the link, and `place` is the point relative to `centre`. `None` if the link is far away, has no
    /// length, or is not solid on the side of the point.
    pub(crate) fn new(link: &Link, centre: Vec2<Fx>, place: Vec2<Fx>) -> Option<Self> {
        let link = match (link.has_on_right(centre + place), link.sides) {
            (true, _) => *link,
            (false, Sides::Both) => link.reversed(),
            (false, Sides::Right) => return None,
        };
        let (p, q) = clipped_to_window(link.a, link.b, centre)?;
        let direction = link.directions.own?;
        let end = |neighbour: Option<Vec2<Unit>>, turn: fn(Vec2<Unit>, Vec2<Unit>) -> Turn| match neighbour {
            // If the neighbour folds back in exactly the opposite direction, this end of the link counts as free.
            Some(other) if other != -direction => {
                LinkEnd::Joined { direction: other, turn: turn(other, direction) }
            }
            _ => LinkEnd::Free,
        };
        Some(Facing {
            hull: Hull::segment(p.narrow(), q.narrow(), direction),
            direction,
            normal: -direction.perp(),
            start: end(link.directions.before, turn),
            end: end(link.directions.after, |after, own| turn(own, after)),
            one_sided: link.sides == Sides::Right,
        })
    }

    /// Decides on the contact normal that the shape and the link would have if the link had no neighbours.
    fn judge(&self, n: Vec2<Unit>) -> Verdict {
        let own: Unit = self.normal.dot(n);
        let across: Unit = self.normal.cross(n);
        if own > 0 && across.abs() <= PARALLEL {
            return Verdict::Own;
        }
        // Normals clockwise of the link's own belong to its start, and normals counter-clockwise of it to its end.
        let (end, outwards) = if across < 0 { (self.start, 1) } else { (self.end, -1) };
        match end {
            LinkEnd::Free if self.one_sided && own < 0 => Verdict::Leave,
            LinkEnd::Free => Verdict::Own,
            LinkEnd::Joined { turn: Turn::Flat | Turn::Concave, .. } if own > 0 => Verdict::Snap,
            LinkEnd::Joined { turn: Turn::Flat | Turn::Concave, .. } => Verdict::Leave,
            LinkEnd::Joined { turn: Turn::Convex, direction } => {
                let other = -direction.perp();
                let beyond: Unit = other.cross(n);
                let nearer_to_other: Unit = other.dot(n);
                let within = beyond.to_bits() * outwards >= -ANGLE_TOLERANCE.to_bits();
                // On a tie the normal belongs to the link that starts at the vertex.
                let ours = if outwards == 1 { own >= nearer_to_other } else { own > nearer_to_other };
                match (within, ours) {
                    (true, true) => Verdict::Own,
                    (true, false) => Verdict::Neighbour,
                    (false, _) => Verdict::Leave,
                }
            }
        }
    }

    /// Largest separation of `b` from the faces of neighbours that meet this link at a convex vertex, with 52 fraction
    /// bits; `i64::MIN` without such neighbours. If it exceeds the separation from this link's face, the neighbour
    /// pushes `b` out, and this link does not.
    fn neighbour_separation(&self, b: &Hull) -> i64 {
        let [start, end] = [(self.start, 0), (self.end, 1)].map(|(end, vertex)| match end {
            LinkEnd::Joined { turn: Turn::Convex, direction } => {
                let normal = -direction.perp();
                hull_hull::plane_separation(normal, self.hull.vertices()[vertex], b, Vec2::ZERO)
            }
            _ => i64::MIN,
        });
        start.max(end)
    }

    /// Contact of a circle about the origin.
    pub(crate) fn collide_circle(&self, radius: Length, margin: Length) -> Manifold {
        let (a, b) = (self.hull.vertices()[0], self.hull.vertices()[1]);
        let past = |vertex: Vec2<Length>, direction: Vec2<Unit>| -> Length { (-vertex).dot(direction) };
        let at = |vertex: Vec2<Length>| {
            let distance = step_bits(vertex.length());
            single((-vertex).normalized().unwrap_or(self.normal), distance, radius, margin)
        };
        let beside = || single(self.normal, distance_along(self.normal, -a), radius, margin);
        // On the inner side of a concave vertex, the other link is nearer to the circle. This link has only a
        // speculative contact, for a fast circle that reaches this link within the tick.
        let ahead = |vertex: Vec2<Length>| {
            let near = step_bits(vertex.length()) - step_bits(radius) <= step_bits(margin);
            let contact = beside();
            let apart = contact.points().iter().all(|point| point.separation > 0);
            if near && apart { contact } else { Manifold::NONE }
        };
        if past(a, self.direction) < 0 {
            match self.start {
                LinkEnd::Free => at(a),
                LinkEnd::Joined { direction, .. } if past(a, direction) >= 0 => at(a),
                LinkEnd::Joined { turn: Turn::Concave, .. } => ahead(a),
                LinkEnd::Joined { .. } => Manifold::NONE,
            }
        } else if past(b, self.direction) >= 0 {
            match self.end {
                LinkEnd::Free => at(b),
                LinkEnd::Joined { turn: Turn::Concave, .. } => ahead(b),
                LinkEnd::Joined { .. } => Manifold::NONE,
            }
        } else {
            beside()
        }
    }

    pub(crate) fn collide_hull(&self, b: &Hull, margin: Length) -> Manifold {
        let a = &self.hull;
        let reach = i64::from(margin.saturating_add(b.radius).to_bits()) << 30;
        let face_a = hull_hull::best_face(a, b, Vec2::ZERO);
        let face_b = hull_hull::best_face(b, a, Vec2::ZERO);
        if face_a.separation > reach || face_b.separation > reach {
            return Manifold::NONE;
        }
        if hull_hull::are_apart(a, b, Vec2::ZERO, face_a, face_b) {
            self.collide_apart(b, (face_a, face_b), margin)
        } else {
            self.collide_overlapping(b, margin)
        }
    }

    fn face(&self, b: &Hull) -> Face {
        Face { edge: 0, separation: hull_hull::face_separation(&self.hull, 0, b, Vec2::ZERO) }
    }

    /// Contact of separate outlines: along the normal between their nearest features, along the link's own normal, or
    /// none. See [`Verdict`].
    fn collide_apart(&self, b: &Hull, (face_a, face_b): (Face, Face), margin: Length) -> Manifold {
        let a = &self.hull;
        let found = if hull_hull::is_reference_of_b(a, b, face_a, face_b, true) {
            hull_hull::clip(b, a, Vec2::ZERO, face_b, true, margin).swapped()
        } else if face_a.edge == 0 {
            hull_hull::clip(a, b, Vec2::ZERO, face_a, true, margin)
        } else {
            // The shape is behind the link and in front of a neighbour.
            return Manifold::NONE;
        };
        if found.points().is_empty() {
            return Manifold::NONE;
        }
        match self.judge(found.normal) {
            Verdict::Own => found,
            Verdict::Neighbour | Verdict::Leave => Manifold::NONE,
            Verdict::Snap => {
                let mut found = hull_hull::clip(a, b, Vec2::ZERO, self.face(b), false, margin);
                // A point beyond an end of the link is kept only if it is speculative: it then limits the approach of
                // the shape.
                found.retain(|point| point.separation > 0 || self.is_beside(point.anchor, b.radius));
                found
            }
        }
    }

    /// Whether a point is between the perpendiculars at the link's ends, with a tolerance. At a vertex that counts as
    /// flat, the perpendiculars of the two links may leave a gap, which the tolerance covers.
    fn is_beside(&self, place: Vec2<Length>, radius: Length) -> bool {
        let slack: Length = (radius / 64).saturating_add(Length::lit("0.0005"));
        let past = |vertex: Vec2<Length>| -> Length { (place - vertex).dot(self.direction) };
        past(self.hull.vertices()[0]) >= -slack && past(self.hull.vertices()[1]) <= slack
    }

    /// Contact on the face of least overlap among the faces whose normals the chain allows.
    fn collide_overlapping(&self, b: &Hull, margin: Length) -> Manifold {
        let a = &self.hull;
        let face = self.face(b);
        let judged = |edge: usize| {
            let face_b = Face { edge, separation: hull_hull::face_separation(b, edge, a, Vec2::ZERO) };
            match self.judge(-b.normals()[edge]) {
                Verdict::Own => Some((face_b, true)),
                Verdict::Neighbour => Some((face_b, false)),
                Verdict::Leave | Verdict::Snap => None,
            }
        };
        let best = (0..b.vertices().len()).filter_map(judged).max_by_key(|(face_b, _)| face_b.separation);
        match best.filter(|(face_b, _)| face_b.separation > face.separation + TOLERANCE_WIDE) {
            Some((face_b, true)) => {
                return hull_hull::clip(b, a, Vec2::ZERO, face_b, false, margin).swapped();
            }
            Some((_, false)) => return Manifold::NONE,
            None => {}
        }
        if self.neighbour_separation(b) > face.separation {
            return Manifold::NONE;
        }
        hull_hull::clip(a, b, Vec2::ZERO, face, false, margin)
    }
}

/// Turn from one direction of the chain to the next, as seen from the right of the chain.
fn turn(from: Vec2<Unit>, to: Vec2<Unit>) -> Turn {
    let sine: Unit = from.cross(to);
    let cosine: Unit = from.dot(to);
    match sine {
        _ if sine >= ANGLE_TOLERANCE || (cosine < 0 && sine > 0) => Turn::Convex,
        _ if sine < 0 => Turn::Concave,
        _ => Turn::Flat,
    }
}

/// Contact of a circle about the origin with a point or a line. `normal` points from there to the origin. `distance` is
/// in units of `Step`.
fn single(normal: Vec2<Unit>, distance: i64, radius: Length, margin: Length) -> Manifold {
    let separation = distance - step_bits(radius);
    if separation > step_bits(margin) {
        return Manifold::NONE;
    }
    let separation = Step::from_bits(saturate(separation));
    let back: Length = radius.saturating_add(convert(separation / 2));
    let anchor = -normal.scale(back);
    Manifold::single(normal, ManifoldPoint { anchor, separation, feature: Feature::SINGLE })
}

#[cfg(test)]
mod tests;
