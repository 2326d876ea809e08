//! [`Meter`]: the traffic of a member.

use core::time::Duration;

/// A connection is closed at this multiple of the allowed rate.
const EXCESS: u64 = 8;

const MICROS: u64 = 1_000_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// The datagram is within the rate.
    Fine,
    /// The datagram is dropped.
    Fast,
    /// The connection is closed.
    Flood,
}

/// A token bucket, which holds at most the units of one second.
#[derive(Clone, Debug)]
struct Bucket {
    per_second: u64,
    /// Remaining units, in millionths.
    tokens: u64,
}

impl Bucket {
    fn new(per_second: u64) -> Self {
        Bucket { per_second, tokens: per_second.saturating_mul(MICROS) }
    }

    fn refill(&mut self, micros: u64) {
        let more = self.tokens.saturating_add(self.per_second.saturating_mul(micros));
        self.tokens = more.min(self.per_second.saturating_mul(MICROS));
    }

    fn take(&mut self, units: u64) -> bool {
        let rest = self.tokens.checked_sub(units.saturating_mul(MICROS));
        self.tokens = rest.unwrap_or(self.tokens);
        rest.is_some()
    }
}

#[derive(Clone, Debug)]
pub(super) struct Meter {
    /// Buckets of bytes and of datagrams. If one of them is empty, a datagram is dropped.
    allowed: [Bucket; 2],
    /// Buckets with [`EXCESS`] times the rates of `allowed`. If one of them is empty, the connection is closed.
    tolerated: [Bucket; 2],
    last: Duration,
}

impl Meter {
    pub(super) fn new(bytes_per_second: u32, datagrams_per_second: u32) -> Self {
        let rates = [bytes_per_second, datagrams_per_second].map(u64::from);
        Meter {
            allowed: rates.map(Bucket::new),
            tolerated: rates.map(|rate| Bucket::new(rate * EXCESS)),
            last: Duration::ZERO,
        }
    }

    pub(super) fn count(&mut self, now: Duration, bytes: usize) -> Pace {
        let passed = now.saturating_sub(self.last);
        self.last = self.last.max(now);
        let micros = u64::try_from(passed.as_micros()).unwrap_or(u64::MAX);
        let units = [u64::try_from(bytes).unwrap_or(u64::MAX), 1];
        for bucket in self.allowed.iter_mut().chain(&mut self.tolerated) {
            bucket.refill(micros);
        }
        let pay = |buckets: &mut [Bucket; 2]| {
            buckets.iter_mut().zip(units).fold(true, |paid, (bucket, units)| bucket.take(units) && paid)
        };
        match (pay(&mut self.tolerated), pay(&mut self.allowed)) {
            (false, _) => Pace::Flood,
            (true, false) => Pace::Fast,
            (true, true) => Pace::Fine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(interval_micros: u64, bytes: usize, count: u64) -> Vec<Pace> {
        let mut meter = Meter::new(10_000, 100);
        (0..count).map(|number| meter.count(Duration::from_micros(number * interval_micros), bytes)).collect()
    }

    #[test]
    fn a_steady_member_loses_nothing() {
        assert!(run(10_000, 100, 1000).iter().all(|pace| *pace == Pace::Fine));
    }

    #[test]
    fn above_the_rate_a_part_is_dropped() {
        // After the burst, every second datagram is lost.
        let paces = run(10_000, 200, 1000);
        let lost = paces.iter().filter(|pace| **pace == Pace::Fast).count();
        assert!((440..=460).contains(&lost), "{lost}");
        let first = paces.iter().position(|pace| *pace != Pace::Fine);
        assert_eq!(first, Some(99), "a burst of one second is allowed");
    }

    #[test]
    fn a_flood_ends_the_connection() {
        let paces = run(100, 1, 1000);
        assert_eq!(paces.iter().position(|pace| *pace == Pace::Flood), Some(869));
    }
}
