//! Gathers the inputs of a contact's rows from the narrow phase, the state and the body list.

use super::super::body_list::{BodyList, GROUND};
use super::super::colour::{Colouring, Node, Size};
use super::super::row::MassFractions;
use super::{Surface, WarmStarts};
use alloc::vec::Vec;

use crate::collision::{Contact, Impact, KeptArms, Manifold, Pair, PointImpulse};
use crate::math::{Length, Step, convert};
use crate::simd::{Quad, prefetch};

/// A touching pair that the solver solves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActiveContact {
    /// Index of the contact in the state.
    pub(crate) contact: u32,
    /// Index of its manifold among the manifolds of the tick.
    pub(crate) manifold: u32,
    /// Slots of the shapes and of their bodies.
    pub(crate) shapes: Pair,
    pub(crate) bodies: (u32, u32),
    pub(crate) surface: Surface,
    /// Whether the shapes may approach each other so fast that the impulses of the last tick are no guess for those of
    /// this tick.
    pub(crate) is_impact: bool,
}

/// Properties of a body that follow from all of its contacts: warm start, impacts, restitution.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Prospect {
    /// Whether a contact had points in the last tick.
    warm: bool,
    /// Whether a contact is an impact.
    impact: bool,
    /// Number of contacts with bodies that impulses do not move.
    walls: u32,
    /// Whether a contact has restitution.
    pub(super) bounces: bool,
}

impl Prospect {
    /// Whether the impulses of the last tick are a guess for those of this tick.
    fn has_guess(self) -> bool {
        self.warm && !self.is_wedged()
    }

    /// Whether an impact may drive the body between two walls. Neither of them gives way.
    fn is_wedged(self) -> bool {
        self.impact && self.walls > 1
    }
}

/// The contacts of a tick, from which batches are filled.
#[derive(Clone, Copy)]
pub(in crate::solver) struct ContactSource<'a> {
    pub(in crate::solver) pairs: &'a [ActiveContact],
    pub(in crate::solver) manifolds: &'a [Manifold],
    pub(in crate::solver) impacts: &'a [Impact],
    /// The contacts of the state, with the impulses of the last tick.
    pub(in crate::solver) contacts: &'a [Contact],
    pub(in crate::solver) list: &'a BodyList,
}

/// A lane of a batch that is being filled. The numbers are stored in quads, because those of eight lanes are read as
/// vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input {
    pub(super) bodies: [u32; 2],
    /// The bodies that impulses change. The ground replaces a body that no impulse moves.
    pub(super) changed: [u32; 2],
    pub(super) contact: u32,
    pub(super) features: [u16; 2],
    pub(super) arms: KeptArms,
    /// Whether one of the bodies is wedged.
    pub(super) wedged: bool,
    pub(super) count: u8,
    /// Whether the contact needs more than rows along the normal and the tangent.
    pub(super) extras: bool,
    /// The normal, and the mass fractions of A and B.
    pub(super) shares: Quad,
    /// `1 / k` of A and B: their mantissas, and their exponents.
    pub(super) gyrations: Quad,
    /// Vectors from the centres of mass of A and B to the manifold's origin.
    pub(super) to_origin: Quad,
    /// Vectors from the manifold's origin to the two points.
    pub(super) anchors: Quad,
    /// Impulses of the last tick, `p = L / D`: along the normal of each point, and along the tangent.
    pub(super) carried: Quad,
    /// The separations of the points, in the format of a step, the friction, and the distance of the surfaces half-way
    /// between the points.
    pub(super) rest: Quad,
}

impl Input {
    /// A lane without a contact.
    pub(super) const NONE: Self = Input {
        bodies: [GROUND; 2],
        changed: [GROUND; 2],
        contact: 0,
        features: [0; 2],
        arms: KeptArms([0; 6]),
        wedged: false,
        count: 0,
        extras: false,
        shares: Quad([0; 4]),
        gyrations: Quad([0; 4]),
        to_origin: Quad([0; 4]),
        anchors: Quad([0; 4]),
        carried: Quad([0; 4]),
        rest: Quad([0; 4]),
    };
}

impl ContactSource<'_> {
    /// Adds a node for each touching pair to the graph that is coloured, and collects the properties of each body that
    /// follow from its contacts.
    pub(super) fn add_nodes(&self, colouring: &mut Colouring, prospects: &mut Vec<Prospect>) {
        prospects.clear();
        prospects.resize(self.list.len(), Prospect::default());
        for pair in self.pairs {
            let (a, b) = pair.shapes;
            let is_small = self.manifolds[pair.manifold as usize].count() == 1;
            let bodies = self.changed(self.bodies_of(pair));
            let size = if is_small { Size::Small } else { Size::Large };
            colouring.add(Node::new(u64::from(a) << 32 | u64::from(b), bodies, size));
            let warm = self.contacts[pair.contact as usize].count > 0;
            let walls = u32::from(bodies.contains(&GROUND));
            for body in bodies {
                let prospect = &mut prospects[body as usize];
                prospect.walls += walls;
                prospect.warm |= warm;
                prospect.impact |= pair.is_impact;
                prospect.bounces |= pair.surface.restitution.is_positive();
            }
        }
        prospects[GROUND as usize] = Prospect::default();
        colouring.set_cold(|bodies| bodies.iter().all(|&body| !prospects[body as usize].has_guess()));
    }

    /// Prefetches the data that [`Self::gather`] reads of a pair. Contacts in the order of colours are random accesses.
    #[inline(always)]
    pub(super) fn prefetch(&self, index: u32) {
        let pair = &self.pairs[index as usize];
        prefetch(&self.manifolds[pair.manifold as usize]);
        prefetch(&self.contacts[pair.contact as usize]);
    }

    /// Gathers the data from which the rows of a touching pair are computed.
    #[inline(always)]
    pub(super) fn gather(
        &self,
        pair: &ActiveContact,
        prospects: &[Prospect],
        warm: &mut WarmStarts,
    ) -> Input {
        let manifold = &self.manifolds[pair.manifold as usize];
        let bodies = self.bodies_of(pair);
        let [a, b] = bodies.map(|index| self.list.facts(index));
        let fractions = MassFractions::of_masses(a.mass, b.mass);
        let n = manifold.normal;
        let (inverse_a, inverse_b) = (a.inverse_gyration.parts(), b.inverse_gyration.parts());
        let [first, second] = manifold.both_points();
        let (mut to_a, mut to_b) = (a.arm_to(manifold.origin), b.arm_to(manifold.origin));
        let gap = match manifold.count() {
            2 => (first.separation >> 1) + (second.separation >> 1),
            _ => first.separation,
        };
        let mut gap: Length = convert(gap.max(Step::ZERO));
        if let Some(&Impact { moved }) = manifold.impact().and_then(|index| self.impacts.get(index)) {
            (to_a, to_b) = (to_a - moved[0], to_b - moved[1]);
            gap = Length::ZERO;
        }
        let memory = &self.contacts[pair.contact as usize];
        let mut anchors =
            [first.anchor.x, first.anchor.y, second.anchor.x, second.anchor.y].map(Length::to_bits);
        let mut to_origin = [to_a.x, to_a.y, to_b.x, to_b.y].map(Length::to_bits);
        let tolerance = a.arm_tolerance().min(b.arm_tolerance());
        let arms = keep_arms(manifold, memory, tolerance, &mut anchors, &mut to_origin);
        let [old_first, old_second] = carried_over(manifold, memory, warm);
        let tangent = old_first.tangent.saturating_add(old_second.tangent);
        let changed = self.changed(bodies);
        Input {
            bodies,
            changed,
            contact: pair.contact,
            features: [first.feature.0, second.feature.0],
            arms,
            wedged: prospects[changed[0] as usize].is_wedged() || prospects[changed[1] as usize].is_wedged(),
            count: manifold.count(),
            extras: pair.surface.has_extras(),
            shares: Quad([n.x.to_bits(), n.y.to_bits(), fractions.a.to_bits(), fractions.b.to_bits()]),
            gyrations: Quad([inverse_a.0, inverse_b.0, inverse_a.1, inverse_b.1]),
            to_origin: Quad(to_origin),
            anchors: Quad(anchors),
            carried: Quad([old_first.normal.to_bits(), old_second.normal.to_bits(), tangent.to_bits(), 0]),
            rest: Quad([
                first.separation.to_bits(),
                second.separation.to_bits(),
                pair.surface.friction.to_bits(),
                gap.to_bits(),
            ]),
        }
    }

    #[inline(always)]
    fn bodies_of(&self, pair: &ActiveContact) -> [u32; 2] {
        [self.list.index_of(pair.bodies.0), self.list.index_of(pair.bodies.1)]
    }

    /// The bodies that impulses change. A body counts as changed even if it is so heavy that its share of an impulse
    /// rounds to 0: other contacts of the body may change it, and must not get the same colour.
    #[inline(always)]
    fn changed(&self, bodies: [u32; 2]) -> [u32; 2] {
        bodies.map(|index| if self.list.facts(index).mass.is_positive() { index } else { GROUND })
    }
}

/// Replaces the anchors, and the vector from B's centre to them, by those with which the arms are as in the last tick,
/// if the contact has the same points and has hardly moved. Returns the arms to be kept.
#[inline(always)]
fn keep_arms(
    manifold: &Manifold,
    memory: &Contact,
    tolerance: u16,
    [x_1, y_1, x_2, y_2]: &mut [i32; 4],
    [a_x, a_y, b_x, b_y]: &mut [i32; 4],
) -> KeptArms {
    let count = manifold.count();
    let second = if count > 1 { [a_x.wrapping_add(*x_2), a_y.wrapping_add(*y_2)] } else { [0; 2] };
    let [first_x, first_y] = [a_x.wrapping_add(*x_1), a_y.wrapping_add(*y_1)];
    let between = [b_x.wrapping_sub(*a_x), b_y.wrapping_sub(*a_y)];
    let current = KeptArms::of([first_x, first_y, second[0], second[1], between[0], between[1]]);
    let [a, b] = manifold.both_points();
    let [old_a, old_b] = &memory.points;
    let is_same =
        count == memory.count && a.feature.0 == old_a.feature && (count < 2 || b.feature.0 == old_b.feature);
    if !is_same {
        return current;
    }
    let mut arms = memory.arms;
    let differences = arms.renew(current, tolerance);
    *x_1 = x_1.saturating_add(differences[0]);
    *y_1 = y_1.saturating_add(differences[1]);
    *x_2 = x_2.saturating_add(differences[2]);
    *y_2 = y_2.saturating_add(differences[3]);
    *b_x = b_x.saturating_add(differences[4]);
    *b_y = b_y.saturating_add(differences[5]);
    arms
}

/// The impulses with which the two points are warm-started: 0 if the feature of a point is new in this tick.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Arena, Body, BodyDef, BodyId, MassProperties, MassSource};
    use crate::fx;
    use crate::math::{Fx, Speed, Unit, Vec2};

    /// The share of a very heavy body in an impulse rounds to 0, but two contacts of the body must still have different
    /// colours.
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
            friction: crate::math::FrictionRatio::ZERO,
            restitution: Unit::ZERO,
            restitution_threshold: Speed::ZERO,
            surface_speed: Speed::ZERO,
            rolling_resistance: Fx::ZERO,
        };
        let pair = ActiveContact {
            contact: 0,
            manifold: 0,
            shapes: (0, 1),
            bodies: (0, 1),
            surface,
            is_impact: false,
        };
        let source = ContactSource {
            pairs: &[pair],
            manifolds: &[Manifold::new(Vec2::Y)],
            impacts: &[],
            contacts: &[Contact::new((0, 1))],
            list: &list,
        };
        let input = source.gather(&pair, &[Prospect::default(); 3], &mut WarmStarts::default());
        assert_eq!(input.shares.0[2], 0);
        let changed: Vec<_> = input.changed.into_iter().filter(|&index| index != GROUND).collect();
        assert_eq!(changed, input.bodies);
    }
}
