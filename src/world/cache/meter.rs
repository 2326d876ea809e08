//! Work units: [`WorkMeter`] counts work whose amount is known only when it is done, and compares it with a
//! budget.

/// Number of pairs per body up to which all pairs are assumed to be solved in full SIMD batches.
const PAIRS_PER_BODY: u64 = 32;

/// Additional cost of a pair beyond [`PAIRS_PER_BODY`], in ordinary pairs: measured on a thousand squares at the same
/// position.
const CROWDED_WORK: u64 = 64;

/// Work units of comparing the shapes of a pair in a tick, independent of the solver settings: measured on shapes of
/// extreme sizes.
pub(crate) const NARROW_PHASE_WORK: u64 = 4;

/// Additional work units of a new pair, whose separating axis is not cached yet: measured on a hundred octagons at the
/// same position.
pub(crate) const NEW_PAIR_WORK: u64 = 8;

/// Counts work units against a budget. Work beyond the budget may be skipped. The meter is not part of the state. The
/// state of a world whose meter is exhausted may be wrong, and the caller that set the budget must discard it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WorkMeter {
    spent: u64,
    max: u64,
}

impl Default for WorkMeter {
    /// A meter without a bound.
    fn default() -> Self {
        WorkMeter { spent: 0, max: u64::MAX }
    }
}

impl WorkMeter {
    /// Creates a meter that starts at 0, with a budget in work units.
    pub(crate) fn start(max: u64) -> Self {
        WorkMeter { spent: 0, max }
    }

    /// Counts units. Returns whether the budget covers them; if it does not, the caller may skip the work.
    #[inline]
    pub(crate) fn spend(&mut self, units: u64) -> bool {
        self.spent = self.spent.saturating_add(units);
        self.spent <= self.max
    }

    /// Whether more than the budget was spent.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.spent > self.max
    }

    /// Units that were counted since the start.
    pub(crate) fn spent(&self) -> u64 {
        self.spent
    }
}

/// Work units of one pass of the solver over `pairs` pairs of shapes on `bodies` bodies.
pub(crate) fn pair_work(pairs: u64, bodies: u64) -> u64 {
    // In a heap of overlapping bodies, many contacts find no free place in a SIMD batch.
    let crowded = pairs.saturating_sub(bodies.saturating_mul(PAIRS_PER_BODY));
    pairs.saturating_add(crowded.saturating_mul(CROWDED_WORK))
}
