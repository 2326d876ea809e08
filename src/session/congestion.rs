//! [`Congestion`]: the rate at which a state is sent to one receiver.
//!
//! The rate changes about once per round trip, by additive increase and multiplicative decrease (Chiu and Jain 1989).
//! The rate was too high if more than an eighth of the chunks were lost, or if the round trip is more than 60 ms above
//! its minimum. Such a rise indicates a queue, which delays the inputs of the match. A loss of up to an eighth is
//! attributed to the link. After each period in which the rate limited the sending, it grows: by half until it is too
//! high for the first time, and afterwards by a constant.

#[cfg(test)]
mod tests;

/// Initial rate in bytes a second.
const RATE_START: u64 = 1_000_000;
/// Smallest rate in bytes a second.
const RATE_MIN: u64 = 128_000;
/// Largest rate in bytes a second, for one receiver and for all together.
pub(super) const RATE_MAX: u64 = 16_000_000;
/// Increase of the rate in a period, in bytes a second.
const RATE_STEP: u64 = 100_000;
/// Rise of the round trip above its minimum from which on a queue is assumed, in microseconds.
const QUEUE: u64 = 60_000;
/// Bounds of the period between two changes of the rate, in microseconds.
const PERIOD_MIN: u64 = 40_000;
const PERIOD_MAX: u64 = 500_000;
/// The largest burst has as many bytes as the current rate allows in this time, in microseconds. The time is longer
/// than a frame at 60 Hz, because games update the session once per frame.
pub(super) const BURST: u64 = 25_000;
/// Minimum number of chunks for an estimate of the loss.
const CHUNKS_MIN: u32 = 8;

#[derive(Clone, Debug)]
pub(super) struct Congestion {
    rate: u64,
    /// Set until the rate is too high for the first time.
    is_starting: bool,
    budget: u64,
    budget_at: u64,
    /// Smallest round trip so far, and below the latest one, in microseconds.
    round_trip_min: u64,
    round_trip: u64,
    since: u64,
    sent: u32,
    /// Number of chunks that were sent again in the period. Each of them counts as a loss.
    lost: u32,
    /// Whether the rate limited the sending in the period.
    is_limiting: bool,
}

impl Congestion {
    pub(super) const fn new() -> Self {
        Congestion {
            rate: RATE_START,
            is_starting: true,
            budget: 0,
            budget_at: 0,
            round_trip_min: u64::MAX,
            round_trip: 0,
            since: 0,
            sent: 0,
            lost: 0,
            is_limiting: false,
        }
    }

    pub(super) fn measure(&mut self, round_trip: u64) {
        self.round_trip = round_trip;
        self.round_trip_min = self.round_trip_min.min(round_trip);
    }

    pub(super) fn may_send(&mut self, now: u64) -> bool {
        self.judge(now);
        let passed = now.saturating_sub(self.budget_at).min(BURST);
        self.budget_at = now;
        self.budget = (self.budget + passed * self.rate / 1_000_000).min(self.rate * BURST / 1_000_000);
        self.is_limiting |= self.budget == 0;
        self.budget > 0
    }

    /// Counts a sent chunk. `again` is true if the chunk was sent before and is assumed lost.
    pub(super) fn note_sent(&mut self, bytes: u64, again: bool) {
        self.budget = self.budget.saturating_sub(bytes);
        self.sent += 1;
        self.lost += u32::from(again);
    }

    fn judge(&mut self, now: u64) {
        let period = self.round_trip.clamp(PERIOD_MIN, PERIOD_MAX);
        if now < self.since.saturating_add(period) || self.sent < CHUNKS_MIN {
            return;
        }
        let queue = self.round_trip > self.round_trip_min.saturating_add(QUEUE);
        if queue || self.lost * 8 > self.sent {
            self.rate = (self.rate / 10 * 7).max(RATE_MIN);
            self.is_starting = false;
        } else if self.is_limiting {
            let step = if self.is_starting { self.rate / 2 } else { RATE_STEP };
            self.rate = (self.rate + step).min(RATE_MAX);
        }
        (self.since, self.sent, self.lost, self.is_limiting) = (now, 0, 0, false);
    }
}
