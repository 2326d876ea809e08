//! The bodies of a tick: the active bodies, other bodies that joints need, and the ground, which represents all
//! remaining bodies.

use alloc::vec::Vec;

use super::body::SolverBody;
use super::row::RATIO_MAX;
#[cfg(test)]
use crate::body::{Arena, BodyId};
use crate::body::{Body, Pose};
use crate::math::{Angle, Fx, Ratio, Reciprocal, Vec2, round_shift, saturate};
pub(super) use crate::simd::GROUND;

/// The ground, then the active bodies, then the bodies that only joints need.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyList {
    pub(super) bodies: Vec<SolverBody>,
    /// Poses at the start of the tick.
    poses: Vec<Pose>,
    facts: Vec<BodyFacts>,
    /// For each body slot, the index of its body in `bodies`, or 0 if the body is not in this list.
    indices: Vec<u32>,
    slots: Vec<u32>,
}

/// The properties of a body that do not change within a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyFacts {
    /// Mass in kg, 0 if no impulse moves the body.
    pub(super) mass: Fx,
    pub(super) inverse_gyration: Reciprocal,
    /// Rotation in radians up to the mean time of the sub-steps, at the speed at the start of the tick.
    pub(super) rotation: Fx,
}

impl BodyFacts {
    const GROUND: Self = BodyFacts { mass: Fx::ZERO, inverse_gyration: Reciprocal::ZERO, rotation: Fx::ZERO };

    fn of(body: &Body, mean_time: Fx) -> Self {
        let mass = if body.is_dynamic() { body.mass() } else { Fx::ZERO };
        let rotation = body.rotation_in(mean_time);
        BodyFacts { mass, inverse_gyration: body.mass.inverse_gyration, rotation }
    }
}

/// Lever ratio `e = c / k` with `c = r x n`, for an arm `r`, a direction `n` and the radius of gyration `k`, clamped to
/// [`RATIO_MAX`]. The direction has the fraction bits of a lever ratio. `mantissa / 2^shift` is `1 / k`, including the
/// conversion from a length to a lever ratio.
pub(super) fn lever_ratio([x, y]: [i32; 2], [n_x, n_y]: [i32; 2], mantissa: i32, shift: i32) -> Ratio {
    let wide = |a: i32| i64::from(a);
    // The bits of `c` are below 2^31.5 and those of a mantissa are below 2^31, so their product is below 2^63.
    let c = round_shift(wide(x) * wide(n_y) - wide(y) * wide(n_x), Ratio::FRAC_NBITS);
    let e = round_shift(c * wide(mantissa), shift.unsigned_abs());
    let limit = wide(RATIO_MAX.to_bits());
    Ratio::from_bits(saturate(e.clamp(-limit, limit)))
}

impl BodyList {
    #[cfg(test)]
    pub(super) fn fill(&mut self, bodies: &Arena<Body, BodyId>, slots: &[u32]) {
        self.begin(bodies.slot_count());
        slots.iter().for_each(|&slot| self.add(slot, bodies.at(slot), Fx::ZERO));
    }

    pub(super) fn begin(&mut self, slot_count: usize) {
        for &slot in &self.slots {
            self.indices[slot as usize] = GROUND;
        }
        self.indices.resize(slot_count, GROUND);
        self.slots.clear();
        self.bodies.clear();
        self.bodies.push(SolverBody::default());
        self.poses.clear();
        self.poses.push(Pose { centre: Vec2::ZERO, angle: Angle::ZERO });
        self.facts.clear();
        self.facts.push(BodyFacts::GROUND);
    }

    /// `mean_time` is the mean time of the sub-steps in seconds since the start of the tick.
    #[inline]
    pub(super) fn add(&mut self, slot: u32, body: &Body, mean_time: Fx) {
        self.push(slot, body, SolverBody::of(body), BodyFacts::of(body, mean_time));
    }

    fn push(&mut self, slot: u32, source: &Body, body: SolverBody, facts: BodyFacts) {
        self.indices[slot as usize] = u32::try_from(self.bodies.len()).expect("fewer than 2^32 bodies");
        self.slots.push(slot);
        self.bodies.push(body);
        self.poses.push(source.pose());
        self.facts.push(facts);
    }

    pub(super) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// The index of the body in a slot, or 0 if the body is not in this list.
    pub(super) fn index_of(&self, slot: u32) -> u32 {
        self.indices[slot as usize]
    }

    /// The index of a body with a joint. Adds the body if it is not in this list, because joints need the rotation of
    /// the body.
    pub(super) fn own_index_of(&mut self, slot: u32, body: &Body) -> u32 {
        if self.index_of(slot) == GROUND {
            self.push(slot, body, SolverBody::default(), BodyFacts::GROUND);
        }
        self.index_of(slot)
    }

    /// Adds a body without mass at a far anchor ([`JointFrame::is_far`]) of the fixed body in a slot, and returns its
    /// index. [`Self::index_of`] does not return this index.
    pub(super) fn add_far_anchor(&mut self, slot: u32, pose: Pose) -> u32 {
        let index = u32::try_from(self.bodies.len()).expect("fewer than 2^32 bodies");
        self.slots.push(slot);
        self.bodies.push(SolverBody::default());
        self.poses.push(pose);
        self.facts.push(BodyFacts::GROUND);
        index
    }

    pub(super) fn slots(&self) -> &[u32] {
        &self.slots
    }

    pub(super) fn poses(&self) -> &[Pose] {
        &self.poses
    }

    pub(super) fn facts(&self, index: u32) -> &BodyFacts {
        &self.facts[index as usize]
    }

    pub(super) fn body_at(&self, index: u32) -> &SolverBody {
        &self.bodies[index as usize]
    }

    /// The body in a slot, or the ground if that body is not in this list.
    pub(super) fn body(&self, slot: u32) -> &SolverBody {
        &self.bodies[self.index_of(slot) as usize]
    }
}
