//! Gathers the inputs of a contact's rows.

#[cfg(test)]
mod tests;

use super::super::body_list::{BodyList, GROUND};
use super::super::colour::{Colouring, Node, Size};
use super::super::row::MassFractions;
use super::arms::{Arms, BodyMotion};
use super::prospect::Prospect;
use super::restitution::ELASTIC;
use super::{Features, Surface, WarmStarts};
use alloc::vec::Vec;

use crate::collision::{Contact, Manifold, Pair, PointImpulse};
use crate::math::{Fx, Length, Step, convert};
use crate::simd::{Lanes, Quad, prefetch};

#[derive(Clone, Copy, Debug)]
pub(crate) struct ActiveContact {
    /// Index in the contacts of the state.
    pub(crate) contact: u32,
    /// Index in the manifolds of the tick.
    pub(crate) manifold: u32,
    pub(crate) shapes: Pair,
    /// Slots of the bodies.
    pub(crate) bodies: (u32, u32),
    pub(crate) surface: Surface,
    /// Whether the shapes may approach each other at more than 5 m/s. The impulses of the last tick are then no useful
    /// initial guess.
    pub(crate) is_impact: bool,
    /// Whether the contact has a hit event, which reports the impulse of the tick.
    pub(crate) is_hit: bool,
    /// Whether the surface has extras or the contact has a hit event.
    pub(crate) extras: bool,
    /// Whether the rows have not changed since the last tick.
    pub(crate) keeps_rows: bool,
}

/// The contacts of a tick, from which batches are filled.
#[derive(Clone, Copy)]
pub(in crate::solver) struct ContactSource<'a> {
    pub(in crate::solver) pairs: &'a [ActiveContact],
    pub(in crate::solver) manifolds: &'a [Manifold],
    /// The contacts of the state, with the impulses of the last tick.
    pub(in crate::solver) contacts: &'a [Contact],
    pub(in crate::solver) list: &'a BodyList,
    /// Mean time of the sub-steps in seconds since the start of the tick.
    pub(in crate::solver) mean_time: Fx,
}

/// The inputs of one lane of a batch. The quads of all lanes are transposed into vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input {
    pub(super) bodies: [u32; 2],
    /// See [`ContactSource::changed`].
    pub(super) changed: [u32; 2],
    pub(super) contact: u32,
    pub(super) shapes: Pair,
    pub(super) features: [u16; 2],
    /// Whether one of the bodies is wedged: see [`Prospect::is_wedged`].
    pub(super) wedged: bool,
    /// Whether the normal and the arms are turned ([`Arms::turn`]).
    pub(super) turned: bool,
    /// Whether one of the bodies has an impact ([`ActiveContact::is_impact`]), in this contact or in another one.
    pub(super) impact: bool,
    pub(super) count: u8,
    pub(super) extras: bool,
    /// The normal, and the mass fractions of A and B.
    pub(super) shares: Quad,
    /// `1 / k` of A and B: the two mantissas, then the two shifts.
    pub(super) gyrations: Quad,
    /// Vectors from the centres of mass of A and B to the origin of the contact, its first point.
    pub(super) to_origin: Quad,
    pub(super) anchors: Quad,
    /// Impulses of the last tick, `p = L / D`: along the normal of each point, and along the tangent. The last number
    /// is the number of points.
    pub(super) carried: Quad,
    /// The separations of both points in the format of a step, the friction, and the gap between the surfaces half-way
    /// between the points. The gap is 0 for an overlap.
    pub(super) rest: Quad,
}

impl Input {
    pub(super) const NONE: Self = Input {
        bodies: [GROUND; 2],
        changed: [GROUND; 2],
        contact: 0,
        shapes: (0, 0),
        features: [0; 2],
        wedged: false,
        turned: false,
        impact: false,
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
    /// Adds a node for each touching pair, and fills `prospects` with a summary of each body's contacts. In the
    /// returned features, only `elastic`, `bounces` and `hits` are set.
    pub(super) fn add_nodes(&self, colouring: &mut Colouring, prospects: &mut Vec<Prospect>) -> Features {
        let mut features = Features::default();
        prospects.clear();
        prospects.resize(self.list.len(), Prospect::default());
        for pair in self.pairs {
            let (a, b) = pair.shapes;
            let manifold = &self.manifolds[pair.manifold as usize];
            let is_small = manifold.count() == 1;
            let bodies = self.changed(self.bodies_of(pair));
            let size = if is_small { Size::Small } else { Size::Large };
            colouring.add(Node::new(u64::from(a) << 32 | u64::from(b), bodies, size));
            let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
            let mut flags = flag(self.contacts[pair.contact as usize].count > 0, Prospect::WARM)
                | flag(pair.is_impact, Prospect::IMPACT);
            if pair.extras {
                flags |= flag(pair.surface.restitution.is_positive(), Prospect::BOUNCES);
                features.bounces |= pair.surface.restitution.is_positive();
                features.elastic |= pair.surface.restitution > ELASTIC;
                features.hits |= pair.is_hit;
            }
            bodies.into_iter().for_each(|body| prospects[body as usize].add(flags));
            match bodies {
                [GROUND, body] => prospects[body as usize].add_wall(manifold.normal),
                [body, GROUND] => prospects[body as usize].add_wall(-manifold.normal),
                _ => {}
            }
        }
        prospects[GROUND as usize] = Prospect::default();
        // If no body is cold, as in a world at rest, no contact is cold.
        if prospects.iter().any(|prospect| prospect.is_cold()) {
            colouring.set_cold(|bodies| bodies.iter().all(|&body| !prospects[body as usize].has_guess()));
        }
        features
    }

    /// Prefetches the data that [`Self::gather`] reads. In the order of colours, the accesses are random.
    #[inline(always)]
    pub(super) fn prefetch(&self, index: u32) {
        let pair = &self.pairs[index as usize];
        prefetch(&self.manifolds[pair.manifold as usize]);
        prefetch(&self.contacts[pair.contact as usize]);
    }

    #[inline(always)]
    pub(super) fn gather(
        &self,
        pair: &ActiveContact,
        prospects: &[Prospect],
        warm: &mut WarmStarts,
        input: &mut Input,
    ) {
        let manifold = &self.manifolds[pair.manifold as usize];
        let bodies = self.bodies_of(pair);
        let [a, b] = bodies.map(|index| self.list.facts(index));
        let fractions = MassFractions::of_masses(a.mass, b.mass);
        let (inverse_a, inverse_b) = (a.inverse_gyration.parts(), b.inverse_gyration.parts());
        let [first, second] = manifold.both_points();
        let memory = &self.contacts[pair.contact as usize];
        let gap = match memory.kept.separations {
            // A manifold that cannot be kept, such as one at a time of impact, counts as one without a gap.
            _ if !memory.kept.can_be_kept() => Step::ZERO,
            [first, second] if manifold.count() == 2 => (first >> 1) + (second >> 1),
            [first, _] => first,
        };
        let gap: Length = convert(gap.max(Step::ZERO));
        let [old_first, old_second] = carried_over(manifold, memory, warm);
        let tangent = old_first.tangent.saturating_add(old_second.tangent);
        let mut arms = Arms::of(manifold, &memory.kept);
        let presses = old_first.normal.is_positive() || old_second.normal.is_positive();
        let motions = || {
            bodies.map(|index| BodyMotion {
                shift: self.list.body_at(index).velocity.widen().scale(self.mean_time),
                rotation: self.list.facts(index).rotation,
            })
        };
        let turned = presses && a.rotation != 0 && b.rotation != 0 && arms.turn_with(motions());
        let Arms { normal: n, to_a, to_b, to_second } = arms;
        let changed = self.changed(bodies);
        *input = Input {
            bodies,
            changed,
            contact: pair.contact,
            shapes: pair.shapes,
            features: [first.feature.0, second.feature.0],
            turned,
            wedged: changed.iter().any(|&body| prospects[body as usize].is_wedged()),
            impact: changed.iter().any(|&body| prospects[body as usize].has_impact()),
            count: manifold.count(),
            extras: pair.extras,
            shares: Quad([n.x.to_bits(), n.y.to_bits(), fractions.a.to_bits(), fractions.b.to_bits()]),
            gyrations: Quad([inverse_a.0, inverse_b.0, inverse_a.1, inverse_b.1]),
            to_origin: Quad([to_a.x.to_bits(), to_a.y.to_bits(), to_b.x.to_bits(), to_b.y.to_bits()]),
            anchors: Quad([0, 0, to_second.x.to_bits(), to_second.y.to_bits()]),
            carried: Quad([
                old_first.normal.to_bits(),
                old_second.normal.to_bits(),
                tangent.to_bits(),
                i32::from(manifold.count()),
            ]),
            rest: Quad([
                first.separation.to_bits(),
                second.separation.to_bits(),
                pair.surface.friction.to_bits(),
                gap.to_bits(),
            ]),
        };
    }

    #[inline(always)]
    pub(super) fn bodies_of(&self, pair: &ActiveContact) -> [u32; 2] {
        [self.list.index_of(pair.bodies.0), self.list.index_of(pair.bodies.1)]
    }

    /// The bodies that impulses change, with the ground in place of a body that they do not change. A body counts as
    /// changed even if its share of an impulse rounds to 0: another contact may change the body, and must not get the
    /// same colour.
    #[inline(always)]
    pub(super) fn changed(&self, bodies: [u32; 2]) -> [u32; 2] {
        bodies.map(|index| if self.list.facts(index).mass.is_positive() { index } else { GROUND })
    }
}

/// Transposes the quads of all contacts.
#[inline(always)]
pub(super) fn columns<L: Lanes<N>, const N: usize>(
    inputs: &[Input; N],
    quad: impl Fn(&Input) -> &Quad,
) -> [L::Int; 4] {
    let mut rows = [quad(&inputs[0]); N];
    for (row, input) in rows.iter_mut().zip(inputs) {
        *row = quad(input);
    }
    L::transposed(rows)
}

/// The impulses for the warm start of the two points: 0 if the feature of a point is new. Updates the statistics
/// `warm`.
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
