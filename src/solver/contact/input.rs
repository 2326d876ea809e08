//! What is known of a contact before its rows are made: taken from the state in the order in which it lies there, so
//! that only this compact copy is read in the order of colours.

use super::super::TouchingPair;
use super::super::body_list::{BodyFacts, BodyList, GROUND};
use super::super::colour::{Node, Size};
use super::super::row::MassFractions;
use super::{Surface, WarmStarts};
use crate::collision::{Contact, Manifold, ManifoldPoint, PointImpulse};
use crate::math::{Fx, Length, Ratio, Shift, Speed, Unit, Vec2, convert};

/// A contact with its lever ratios: two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Input {
    pub(super) bodies: [u32; 2],
    /// Where impulses change them: the ground for one that nothing moves. One that is only too heavy for its partner to
    /// move it is changed by others, so that colours have to know of it.
    pub(super) changed: [u32; 2],
    pub(super) contact: u32,
    pub(super) count: u8,
    pub(super) immovable: bool,
    pub(super) features: [u16; 2],
    pub(super) n: Vec2<Ratio>,
    pub(super) fractions: MassFractions,
    pub(super) friction: i32,
    pub(super) points: [InputPoint; 2],
    pub(super) restitution: Unit,
    pub(super) surface_speed: Speed,
    pub(super) rolling_resistance: Fx,
    pub(super) rolling: Speed,
}

const _: () = assert!(size_of::<Input>() == 128, "two cache lines");

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct InputPoint {
    /// Of A and B, along the normal and along the tangent.
    pub(super) normal: [Ratio; 2],
    pub(super) tangent: [Ratio; 2],
    pub(super) separation: Shift,
    /// What the last tick has left: `p = L / D`.
    pub(super) carried: [Speed; 2],
}

impl Input {
    pub(super) fn new(
        pair: &TouchingPair,
        manifold: &Manifold,
        memory: &Contact,
        list: &BodyList,
        warm: &mut WarmStarts,
    ) -> Self {
        let bodies = [list.index_of(pair.bodies.0), list.index_of(pair.bodies.1)];
        let ends = bodies.map(|index| list.facts(index));
        let fractions = MassFractions::of_masses(ends[0].mass, ends[1].mass);
        let Surface { friction, restitution, rolling_resistance, surface_speed } = pair.surface;
        let n: Vec2<Ratio> = manifold.normal.convert();
        let points = manifold.points();
        let changed = [0, 1].map(|side: usize| if ends[side].mass > 0 { bodies[side] } else { GROUND });
        let mut input = Input {
            bodies,
            changed,
            contact: pair.contact,
            count: 0,
            immovable: fractions.a == 0 || fractions.b == 0,
            features: [0; 2],
            n,
            fractions,
            friction: friction.to_bits(),
            points: [InputPoint::default(); 2],
            restitution,
            surface_speed,
            rolling_resistance,
            rolling: memory.rolling,
        };
        let to_ends = ends.map(|end| end.arm_to(manifold.origin));
        for (i, point) in points.iter().enumerate() {
            let carried = memory.impulse_of(point.feature);
            warm.points += 1;
            warm.kept += u32::from(carried.is_some());
            input.count += 1;
            input.features[i] = point.feature.0;
            input.points[i] = InputPoint::new(point, n, ends, to_ends, carried.unwrap_or_default());
        }
        for old in memory.points().iter().filter(|old| old.normal > 0) {
            let is_there = points.iter().any(|point| point.feature.0 == old.feature);
            warm.lost += u32::from(!is_there);
        }
        input
    }

    /// Whether it needs more than rows along the normal and the tangent.
    pub(super) fn is_special(&self) -> bool {
        self.restitution > 0 || self.surface_speed != 0 || self.rolling_resistance > 0
    }

    /// The contact, to be coloured.
    pub(super) fn node(&self, shapes: (u32, u32)) -> Node {
        let key = u64::from(shapes.0) << 32 | u64::from(shapes.1);
        let size = if self.count == 1 { Size::Small } else { Size::Large };
        Node::new(key, self.changed, size)
    }
}

impl InputPoint {
    fn new(
        point: &ManifoldPoint,
        n: Vec2<Ratio>,
        ends: [&BodyFacts; 2],
        to_ends: [Vec2<Length>; 2],
        carried: PointImpulse,
    ) -> Self {
        let arms = to_ends.map(|to_end| point.anchor + to_end);
        let ratios = |n: Vec2<Ratio>| [ends[0].lever_ratio(arms[0], n), ends[1].lever_ratio(arms[1], n)];
        InputPoint {
            normal: ratios(n),
            tangent: ratios(n.perp()),
            separation: convert(point.separation),
            carried: [carried.normal, carried.tangent],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Arena, Body, BodyDef, BodyId, MassProperties, MassSource};
    use crate::fx;
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
        assert_eq!(input.fractions.a, Unit::ZERO);
        let changed: Vec<_> = input.changed.into_iter().filter(|&index| index != GROUND).collect();
        assert_eq!(changed, input.bodies);
    }
}
