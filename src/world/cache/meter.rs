//! [`WorkMeter`]: work whose amount is known only when it is done, with a bound.

/// Counts work units and ends what costs too much. It is no part of the state: a world whose meter is exhausted has a
/// wrong state, which whoever set the budget must not use.
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
    /// Starts at 0 with a budget in work units.
    pub(crate) fn start(max: u64) -> Self {
        WorkMeter { spent: 0, max }
    }

    /// Counts units. Returns whether the budget covers them; if it does not, the work need not be done.
    #[inline]
    pub(crate) fn spend(&mut self, units: u64) -> bool {
        self.spent = self.spent.saturating_add(units);
        self.spent <= self.max
    }

    /// Whether more was spent than the budget.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.spent > self.max
    }

    /// Units that were counted since the start.
    pub(crate) fn spent(&self) -> u64 {
        self.spent
    }
}
