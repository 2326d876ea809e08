//! Restitution, moving surfaces, rolling resistance and hit events. Few contacts have any of these. The data for them
//! is stored separately from the batches, so that it takes no cache space from all other contacts.

use super::impact::Impacts;
use super::input::ContactSource;
use super::rolling::RollingRows;
use crate::math::Unit;
use crate::simd::Ints;

/// Additional data of a batch in which some contact has extras.
#[derive(Clone, Debug)]
#[repr(align(32))]
pub(in crate::solver) struct ContactExtras<const N: usize> {
    pub(super) restitution: Ints<N>,
    /// Approach speed below which restitution is not applied.
    pub(super) restitution_threshold: Ints<N>,
    pub(super) impacts: Impacts<N>,
    /// For each point, the impulse of restitution in this sub-step.
    pub(super) bounce: [Ints<N>; 2],
    /// Sum of the surface speeds of the two shapes. Friction drives the tangential velocity to the negative of this
    /// sum.
    pub(super) surface_speed: Ints<N>,
    /// Whether any lane has rolling resistance.
    pub(super) rolls: bool,
    pub(super) rolling: RollingRows<N>,
    /// Whether any lane has a hit event.
    pub(super) hits: bool,
    /// For each point, the sum of its normal impulses in the sub-steps of the tick.
    pub(super) hit_lambda: [Ints<N>; 2],
}

impl<const N: usize> ContactExtras<N> {
    /// A batch in which no lane has extras.
    pub(super) const NONE: Self = ContactExtras {
        restitution: Ints::ZERO,
        restitution_threshold: Ints::ZERO,
        impacts: Impacts::NONE,
        bounce: [Ints::ZERO; 2],
        surface_speed: Ints::ZERO,
        rolls: false,
        rolling: RollingRows::NONE,
        hits: false,
        hit_lambda: [Ints::ZERO; 2],
    };

    /// Puts a contact into a lane. `inverse_normals` are the reciprocals of its points' denominators. The value for a
    /// missing point does not matter, because the point has no impulse.
    pub(super) fn fill(
        &mut self,
        lane: usize,
        source: &ContactSource<'_>,
        index: usize,
        inverse_normals: [Unit; 2],
    ) {
        let pair = &source.pairs[index];
        self.restitution.0[lane] = pair.surface.restitution.to_bits();
        self.restitution_threshold.0[lane] = pair.surface.restitution_threshold.to_bits();
        self.surface_speed.0[lane] = pair.surface.surface_speed.to_bits();
        self.hits |= pair.is_hit;
        if pair.surface.rolling_resistance > 0 {
            self.rolls = true;
            let carried = source.contacts[pair.contact as usize].rolling;
            self.rolling.fill(lane, pair, carried, source.list, inverse_normals);
        }
    }
}
