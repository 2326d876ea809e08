//! What is known of a contact before its rows are made: taken from the state in the order in which it lies there, so
//! that only this compact copy is read in the order of colours.

use super::super::TouchingPair;
use super::super::body_list::{BodyList, GROUND};
use super::super::colour::{Node, Size};
use super::super::row::MassFractions;
use super::{Surface, WarmStarts};
use crate::collision::{Contact, Manifold, PointImpulse};
use crate::lanes::Quad;
use crate::math::{Length, Speed};

/// Where to look up what only special contacts have.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) pairs: &'a [TouchingPair],
    pub(super) contacts: &'a [Contact],
    pub(super) list: &'a BodyList,
}

/// A contact in two cache lines. What eight of them are computed from is in quads, which are read in lanes.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct Input {
    pub(super) bodies: [u32; 2],
    /// Where impulses change them: the ground for one that nothing moves. One that is only too heavy for its partner to
    /// move it is changed by others, so that colours have to know of it.
    pub(super) changed: [u32; 2],
    pub(super) contact: u32,
    pub(super) features: [u16; 2],
    pub(super) count: u8,
    /// Whether it needs more than rows along the normal and the tangent.
    pub(super) special: bool,
    /// The normal, and the mass fractions of A and B.
    pub(super) shares: Quad,
    /// `1 / k` of A and B: their mantissas, and their exponents.
    pub(super) gyrations: Quad,
    /// From the centres of mass of A and B to the manifold's origin.
    pub(super) to_origin: Quad,
    /// From there to the two points.
    pub(super) anchors: Quad,
    /// What the last tick has left: `p = L / D` along the normal of each point, and along the tangent.
    pub(super) carried: Quad,
    /// The separations of the points, in the format of a step, and the friction.
    pub(super) rest: Quad,
}

const _: () = assert!(size_of::<Input>() == 128, "two cache lines");

impl Input {
    #[inline]
    pub(super) fn new(
        pair: &TouchingPair,
        manifold: &Manifold,
        memory: &Contact,
        list: &BodyList,
        warm: &mut WarmStarts,
    ) -> Self {
        let bodies = [list.index_of(pair.bodies.0), list.index_of(pair.bodies.1)];
        let [a, b] = bodies.map(|index| list.facts(index));
        let fractions = MassFractions::of_masses(a.mass, b.mass);
        let n = manifold.normal;
        let (inverse_a, inverse_b) = (a.inverse_gyration.parts(), b.inverse_gyration.parts());
        let (to_a, to_b) = (a.arm_to(manifold.origin), b.arm_to(manifold.origin));
        let [first, second] = manifold.both_points();
        let [old_first, old_second] = carried_over(manifold, memory, warm);
        let tangent = old_first.tangent.saturating_add(old_second.tangent);
        Input {
            bodies,
            changed: [
                if a.mass.is_positive() { bodies[0] } else { GROUND },
                if b.mass.is_positive() { bodies[1] } else { GROUND },
            ],
            contact: pair.contact,
            features: [first.feature.0, second.feature.0],
            count: manifold.count(),
            special: pair.surface.is_special(),
            shares: Quad([n.x.to_bits(), n.y.to_bits(), fractions.a.to_bits(), fractions.b.to_bits()]),
            gyrations: Quad([inverse_a.0, inverse_b.0, inverse_a.1, inverse_b.1]),
            to_origin: Quad([to_a.x, to_a.y, to_b.x, to_b.y].map(Length::to_bits)),
            anchors: Quad(
                [first.anchor.x, first.anchor.y, second.anchor.x, second.anchor.y].map(Length::to_bits),
            ),
            carried: Quad([old_first.normal.to_bits(), old_second.normal.to_bits(), tangent.to_bits(), 0]),
            rest: Quad([
                first.separation.to_bits(),
                second.separation.to_bits(),
                pair.surface.friction.to_bits(),
                0,
            ]),
        }
    }

    /// The contact, to be coloured.
    #[inline]
    pub(super) fn node(&self, shapes: (u32, u32)) -> Node {
        let key = u64::from(shapes.0) << 32 | u64::from(shapes.1);
        let size = if self.count == 1 { Size::Small } else { Size::Large };
        Node::new(key, self.changed, size)
    }
}

/// The impulse that each of the two points starts from: none if its feature was not there.
#[inline]
fn carried_over(manifold: &Manifold, memory: &Contact, warm: &mut WarmStarts) -> [PointImpulse; 2] {
    let points = manifold.points();
    let old = |i: usize| points.get(i).and_then(|point| memory.impulse_of(point.feature));
    let (first, second) = (old(0), old(1));
    let kept = u8::from(first.is_some()) + u8::from(second.is_some());
    warm.points += u32::from(manifold.count());
    warm.kept += u32::from(kept);
    if kept < memory.count {
        let old = memory.points().iter().filter(|old| old.normal.is_positive());
        let is_there = |old: &&PointImpulse| points.iter().any(|point| point.feature.0 == old.feature);
        warm.lost += old.map(|old| u32::from(!is_there(&old))).sum::<u32>();
    }
    [first.unwrap_or_default(), second.unwrap_or_default()]
}

impl Surface {
    /// Whether it asks for more than rows along the normal and the tangent.
    fn is_special(&self) -> bool {
        self.restitution.is_positive()
            || self.surface_speed != Speed::ZERO
            || self.rolling_resistance.is_positive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Arena, Body, BodyDef, BodyId, MassProperties, MassSource};
    use crate::fx;
    use crate::math::{Fx, Unit, Vec2};
    use alloc::vec::Vec;

    /// Its share of a push is rounded to nothing, but other contacts of the same colour must not change it meanwhile.
    #[test]
    fn a_body_that_is_too_heavy_to_be_moved_is_still_one_that_changes() {
        let mut bodies: Arena<Body, BodyId> = Arena::default();
        for mass in [fx!(1073741824), fx!(0.00001)] {
            let source = MassSource::Given { mass, centre: Vec2::ZERO, gyration: fx!(1) };
            let mass = MassProperties::dynamic(source, core::iter::empty()).expect("valid");
            bodies.insert(Body::new(&BodyDef::dynamic(), mass));
        }
        let mut list = BodyList::default();
        list.fill(&bodies, &[0, 1]);
        let surface = Surface {
            friction: crate::math::Grip::ZERO,
            restitution: Unit::ZERO,
            surface_speed: Speed::ZERO,
            rolling_resistance: Fx::ZERO,
        };
        let pair = TouchingPair { contact: 0, manifold: 0, shapes: (0, 1), bodies: (0, 1), surface };
        let manifold = Manifold::new(Vec2::Y);
        let input = Input::new(&pair, &manifold, &Contact::new((0, 1)), &list, &mut WarmStarts::default());
        assert_eq!(input.shares.0[2], 0);
        let changed: Vec<_> = input.changed.into_iter().filter(|&index| index != GROUND).collect();
        assert_eq!(changed, input.bodies);
    }
}
