//! Links of chains.

use crate::body::Sides;
use crate::math::{Fx, Orientation, Unit, Vec2, orientation};

/// A link in world axes, relative to the centre of its own shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) a: Vec2<Fx>,
    pub(crate) b: Vec2<Fx>,
    pub(crate) before: Option<Vec2<Fx>>,
    pub(crate) after: Option<Vec2<Fx>>,
    pub(crate) sides: Sides,
    pub(crate) directions: Directions,
}

/// Directions of a link and its neighbours. A direction is `None` if the link or neighbour does not exist or has no
/// length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Directions {
    pub(crate) before: Option<Vec2<Unit>>,
    pub(crate) own: Option<Vec2<Unit>>,
    pub(crate) after: Option<Vec2<Unit>>,
}

impl Link {
    /// `before` is the far end of the neighbour at `a`, and `after` the far end of the neighbour at `b`.
    pub(crate) fn new([a, b]: [Vec2<Fx>; 2], [before, after]: [Option<Vec2<Fx>>; 2], sides: Sides) -> Self {
        let directions = Directions {
            before: before.and_then(|before| before.towards(a).normalized()),
            own: a.towards(b).normalized(),
            after: after.and_then(|after| b.towards(after).normalized()),
        };
        Link { a, b, before, after, sides, directions }
    }

    pub(crate) fn reversed(self) -> Self {
        let Link { a, b, before, after, sides, directions } = self;
        let back = |direction: Option<Vec2<Unit>>| direction.map(|direction| -direction);
        let directions = Directions {
            before: back(directions.after),
            own: back(directions.own),
            after: back(directions.before),
        };
        Link { a: b, b: a, before: after, after: before, sides, directions }
    }

    /// Whether a place is on the solid side of the line through the link. This decides for rays: a ray that meets the
    /// link comes from the side of the line on which it starts.
    pub(crate) fn is_facing(&self, place: Vec2<Fx>) -> bool {
        self.sides == Sides::Both || right_of(self.a, self.b, place)
    }

    /// Whether the link is solid for a shape whose centre is at `place`. A place on the right of a neighbour but on the
    /// left of this link counts only up to the neighbour's far end. Beyond that end, the place may be on the left of
    /// the chain.
    pub(crate) fn is_solid_from(&self, place: Vec2<Fx>) -> bool {
        let Link { a, b, before, after, sides, .. } = *self;
        let is_before = (place - a).dot(a.towards(b)) < 0;
        let (far_end, near_end) = if is_before { (before, a) } else { (after, b) };
        let is_short_of = |far_end: Vec2<Fx>| (place - far_end).dot(far_end.towards(near_end)) >= 0;
        sides == Sides::Both
            || self.has_on_right(place) && (right_of(a, b, place) || far_end.is_some_and(is_short_of))
    }

    /// Whether a point is on the right of the chain, judged by this link and its neighbours.
    pub(crate) fn has_on_right(&self, place: Vec2<Fx>) -> bool {
        let Link { a, b, before, after, .. } = *self;
        let own = right_of(a, b, place);
        let direction = a.towards(b);
        // Only the signs matter, and a saturated product keeps its sign.
        let (corner, neighbour) = if (place - a).dot(direction) < 0 {
            (before.map(|before| [before, a, b]), before.map(|before| (before, a)))
        } else if (place - b).dot(direction) > 0 {
            (after.map(|after| [a, b, after]), after.map(|after| (b, after)))
        } else {
            (None, None)
        };
        let (Some([p, q, r]), Some((from, to))) = (corner, neighbour) else { return own };
        let other = right_of(from, to, place);
        if orientation(p, q, r) == Orientation::CounterClockwise {
            return own || other;
        }
        // The line of the neighbour counts only between the perpendiculars at the neighbour's ends.
        let stretch = from.towards(to);
        let beside = (place - from).dot(stretch) >= 0 && (place - to).dot(stretch) <= 0;
        own && (other || !beside)
    }
}

/// Whether a point is on the right of the line from `a` to `b`, or on it. Exact.
fn right_of(a: Vec2<Fx>, b: Vec2<Fx>, place: Vec2<Fx>) -> bool {
    orientation(a, b, place) != Orientation::CounterClockwise
}
