//! Restitution, moving surfaces, rolling resistance and hit events. Few contacts have any of them. The data of these
//! extras is therefore stored separately, and takes no cache space from other contacts.

use super::impact::Impacts;
use super::input::ContactSource;
use super::rolling::RollingRows;
use crate::math::Unit;
use crate::simd::Ints;

#[derive(Clone, Debug)]
#[repr(align(32))]
pub(in crate::solver) struct ContactExtras<const N: usize> {
    pub(super) restitution: Ints<N>,
    pub(super) restitution_threshold: Ints<N>,
    pub(super) impacts: Impacts<N>,
    /// For each point, the impulse of restitution in this sub-step.
    pub(super) bounce: [Ints<N>; 2],
    /// Sum of the surface speeds. Friction drives the tangential velocity to the negative of this sum.
    pub(super) surface_speed: Ints<N>,
    pub(super) rolls: bool,
    pub(super) rolling: RollingRows<N>,
    pub(super) hits: bool,
    /// For each point, the sum of its normal impulses in the tick.
    pub(super) hit_lambda: [Ints<N>; 2],
}

impl<const N: usize> ContactExtras<N> {
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

    /// Puts a contact into a lane. `inverse_normals` are the reciprocals of its points' denominators, with any value
    /// for a missing point.
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
