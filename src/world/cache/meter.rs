//! Work units: [`WorkMeter`] counts work whose amount is known only after it is done.

use crate::collision::Contact;

/// Number of pairs per body up to which [`pair_work`] assumes that pairs fit into full SIMD batches.
const PAIRS_PER_BODY: u64 = 32;

/// Additional work units of each pair beyond [`PAIRS_PER_BODY`]. An ordinary pair costs one work unit. Measured on a
/// thousand squares in one place.
const CROWDED_WORK: u64 = 64;

/// Work units for comparing the shapes of a pair in a tick: measured on shapes of extreme sizes.
pub(crate) const NARROW_PHASE_WORK: u64 = 4;

/// Additional work units of a pair without a cached separating axis: measured on a hundred octagons in one place.
pub(crate) const NEW_PAIR_WORK: u64 = 8;

/// Number of pairs of boxes that are compared in one work unit.
const COMPARED_PER_WORK: u64 = 32;

/// Number of sleeping contacts that are visited in one work unit.
const VISITED_PER_WORK: usize = 4;

/// Counts work units against a budget. The meter is not part of the state. Work beyond the budget may be skipped, so
/// the state is then not valid: the caller that set the budget must discard a world whose meter is exhausted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WorkMeter {
    spent: u64,
    max: u64,
    /// Units of searches and visits that will not be counted.
    exempt: u64,
}

impl Default for WorkMeter {
    fn default() -> Self {
        WorkMeter { spent: 0, max: u64::MAX, exempt: 0 }
    }
}

impl WorkMeter {
    /// Sets the budget. Keeps the exempt units.
    pub(crate) fn start(&mut self, max: u64) {
        (self.spent, self.max) = (0, max);
    }

    /// Exempts units of the next searches and visits.
    pub(crate) fn exempt(&mut self, units: u64) {
        self.exempt = units;
    }

    fn spend_beyond_exempt(&mut self, units: u64) {
        let exempt = units.min(self.exempt);
        self.exempt -= exempt;
        self.spend(units - exempt);
    }

    /// Counts units. Returns false if the budget does not cover them: the caller may skip the work.
    #[inline]
    pub(crate) fn spend(&mut self, units: u64) -> bool {
        self.spent = self.spent.saturating_add(units);
        self.spent <= self.max
    }

    /// Counts a search for pairs that compares this many pairs of boxes. Returns the number of new pairs that the
    /// remaining budget covers.
    pub(crate) fn spend_search(&mut self, comparisons: u64) -> usize {
        self.spend_beyond_exempt(search_work(comparisons));
        let pairs = self.max.saturating_sub(self.spent) / (NEW_PAIR_WORK + NARROW_PHASE_WORK);
        usize::try_from(pairs).unwrap_or(usize::MAX)
    }

    /// Exhausts the budget, because the remaining budget does not cover the next work.
    pub(crate) fn exhaust(&mut self) {
        self.spent = self.spent.max(self.max.saturating_add(1));
    }

    /// Counts a visit of all sleeping contacts.
    pub(crate) fn spend_visit(&mut self, sleeping_contacts: &[Contact]) {
        self.spend_beyond_exempt(visit_work(sleeping_contacts));
    }

    pub(crate) fn is_exhausted(&self) -> bool {
        self.spent > self.max
    }

    pub(crate) fn spent(&self) -> u64 {
        self.spent
    }
}

/// Work units of a search for pairs.
pub(crate) fn search_work(comparisons: u64) -> u64 {
    comparisons / COMPARED_PER_WORK
}

/// Work units of a visit of all sleeping contacts.
pub(crate) fn visit_work(sleeping_contacts: &[Contact]) -> u64 {
    u64::try_from(sleeping_contacts.len() / VISITED_PER_WORK).unwrap_or(u64::MAX)
}

/// Work units of the pairs in one pass of the solver.
pub(crate) fn pair_work(pairs: u64, bodies: u64) -> u64 {
    // In a heap of overlapping bodies, many contacts find no free place in a SIMD batch.
    let crowded = pairs.saturating_sub(bodies.saturating_mul(PAIRS_PER_BODY));
    pairs.saturating_add(crowded.saturating_mul(CROWDED_WORK))
}
