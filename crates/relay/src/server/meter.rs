//! [`Meter`]: limits the traffic of a member.

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

/// Largest header of a frame from a client in bytes.
const FRAME_HEADER: u64 = 14;

/// A token bucket. Its capacity is the number of units allowed in one second.
#[derive(Clone, Debug)]
pub(super) struct Bucket {
    per_second: u64,
    /// Remaining units, in millionths.
    tokens: u64,
    last: Duration,
}

impl Bucket {
    fn new(per_second: u64) -> Self {
        Bucket { per_second, tokens: per_second.saturating_mul(MICROS), last: Duration::ZERO }
    }

    /// Bucket for all bytes of a connection, including headers, fragments and pings. Its rate is the number of bytes of
    /// a member that sends at [`EXCESS`] times both rates, with the largest headers. So this bucket closes a connection
    /// that [`Meter`] would leave open only if the member sends fragments of messages.
    pub(super) fn of_connection(bytes_per_second: u32, datagrams_per_second: u32) -> Self {
        let headers = u64::from(datagrams_per_second) * FRAME_HEADER;
        Bucket::new((u64::from(bytes_per_second) + headers) * EXCESS)
    }

    /// Takes `units` at the time `now`. If the bucket holds fewer, takes none and returns false.
    pub(super) fn take(&mut self, now: Duration, units: usize) -> bool {
        let micros = u64::try_from(now.saturating_sub(self.last).as_micros()).unwrap_or(u64::MAX);
        self.last = self.last.max(now);
        let more = self.tokens.saturating_add(self.per_second.saturating_mul(micros));
        self.tokens = more.min(self.per_second.saturating_mul(MICROS));
        let rest = self.tokens.checked_sub(u64::try_from(units).unwrap_or(u64::MAX).saturating_mul(MICROS));
        self.tokens = rest.unwrap_or(self.tokens);
        rest.is_some()
    }
}

#[derive(Clone, Debug)]
pub(super) struct Meter {
    /// Buckets of bytes and of datagrams. If one of them holds too few units for a datagram, the datagram is dropped.
    allowed: [Bucket; 2],
    /// Buckets with [`EXCESS`] times the rates of `allowed`. If one of them holds too few units, the connection is
    /// closed.
    tolerated: [Bucket; 2],
}

impl Meter {
    pub(super) fn new(bytes_per_second: u32, datagrams_per_second: u32) -> Self {
        let rates = [bytes_per_second, datagrams_per_second].map(u64::from);
        Meter { allowed: rates.map(Bucket::new), tolerated: rates.map(|rate| Bucket::new(rate * EXCESS)) }
    }

    pub(super) fn count(&mut self, now: Duration, bytes: usize) -> Pace {
        let pay = |[of_bytes, of_datagrams]: &mut [Bucket; 2]| {
            let paid = [of_bytes.take(now, bytes), of_datagrams.take(now, 1)];
            paid == [true; 2]
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
