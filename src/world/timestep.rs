//! Fixed time steps from real time (G. Fiedler, "Fix Your Timestep!", 2004).

#[cfg(test)]
mod tests;

/// Converts elapsed real time in nanoseconds, which the game measures, to whole ticks.
///
/// ```
/// use lockstep2d::world::FixedTimestep;
/// let mut timestep = FixedTimestep::new(60);
/// assert_eq!(timestep.advance(50_000_000), 3, "50 ms at 60 Hz");
/// assert_eq!(timestep.advance(10_000_000_000), FixedTimestep::DEFAULT_TICKS_MAX, "no spiral of death");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedTimestep {
    tick_rate: u32,
    ticks_max: u32,
    /// Time that is not yet simulated, in nanoseconds times the tick rate. In this unit a tick is always 10^9, so no
    /// division rounds the time.
    remainder: u64,
}

/// One tick in the unit of `remainder`.
const TICK: u64 = 1_000_000_000;

impl FixedTimestep {
    /// Default of [`FixedTimestep::ticks_max`].
    pub const DEFAULT_TICKS_MAX: u32 = 8;

    /// A time step for a world with `tick_rate` ticks per second. 0 counts as 1.
    #[must_use]
    pub const fn new(tick_rate: u32) -> Self {
        let tick_rate = if tick_rate == 0 { 1 } else { tick_rate };
        FixedTimestep { tick_rate, ticks_max: Self::DEFAULT_TICKS_MAX, remainder: 0 }
    }

    /// Sets the largest number of ticks that one call of [`FixedTimestep::advance`] returns. Ticks beyond this number
    /// are dropped: on a machine that is too slow, the game then runs slower instead of falling behind ever further.
    #[must_use]
    pub const fn ticks_max(mut self, ticks: u32) -> Self {
        self.ticks_max = ticks;
        self
    }

    /// Adds elapsed time in nanoseconds and returns the number of ticks to simulate now.
    pub fn advance(&mut self, elapsed_nanoseconds: u64) -> u32 {
        let total = self.remainder.saturating_add(elapsed_nanoseconds.saturating_mul(self.tick_rate.into()));
        self.remainder = total % TICK;
        let ticks = (total / TICK).min(self.ticks_max.into());
        u32::try_from(ticks).unwrap_or(self.ticks_max)
    }

    /// Returns the time since the last tick in billionths of a tick, for interpolated drawing.
    #[must_use]
    pub const fn interpolation_billionths(&self) -> u32 {
        #[expect(clippy::cast_possible_truncation, reason = "the remainder is below 10^9")]
        let billionths = self.remainder as u32;
        billionths
    }
}
