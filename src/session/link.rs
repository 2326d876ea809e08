/// Binary logarithm of the unit of timestamps in packets, 128 microseconds.
const UNIT_SHIFT: u32 = 7;
/// Longest round trip that is accepted, in microseconds: less than half the 8.4 s after which timestamps in packets
/// wrap.
const ROUND_TRIP_MAX: u64 = 4_000_000;
const LOSS_WINDOW: u32 = 64;

/// Measurements of the network path to a peer and back.
///
/// ```
/// use lockstep2d::session::Link;
/// /// The number of signal bars beside the name of a player.
/// fn bars(link: &Link) -> u32 {
///     let slow = link.round_trip > 150_000;
///     let lossy = link.loss_per_mille > 30;
///     3 - u32::from(slow) - u32::from(lossy)
/// }
/// assert_eq!(bars(&Link::default()), 3);
/// let mut satellite = Link::default();
/// satellite.round_trip = 600_000;
/// assert_eq!(bars(&satellite), 2);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Link {
    /// Smoothed round trip in microseconds; 0 if none was measured.
    pub round_trip: u64,
    /// Smoothed absolute difference between a measured round trip and the smoothed one, in microseconds.
    pub jitter: u64,
    /// Share of the peer's packets that did not arrive, in thousandths, updated about every 64 packets.
    pub loss_per_mille: u32,
    /// Bytes sent, without the headers of the transport.
    pub bytes_sent: u64,
    /// Bytes received.
    pub bytes_received: u64,
    /// Packets sent.
    pub packets_sent: u64,
    /// Packets received.
    pub packets_received: u64,
    pub(super) next_sequence: u16,
    /// Timestamp of the peer's newest packet, and the time of its arrival.
    last_sent: Option<(u16, u64)>,
    last_sequence: Option<u16>,
    expected: u32,
    arrived: u32,
}

pub(super) fn stamp(now: u64) -> u16 {
    let [low, high, ..] = (now >> UNIT_SHIFT).to_le_bytes();
    u16::from_le_bytes([low, high])
}

impl Link {
    /// Echo for the next packet to the peer: the timestamp of the peer's newest packet plus the time since its arrival,
    /// so that the round trip that the peer measures does not include this time.
    pub(super) fn echo(&self, now: u64) -> Option<u16> {
        let (sent, arrived) = self.last_sent?;
        let held = now.checked_sub(arrived).filter(|&held| held < ROUND_TRIP_MAX)?;
        Some(sent.wrapping_add(stamp(held)))
    }

    pub(super) fn arrived(&mut self, sequence: u16, sent: u16, echo: Option<u16>, bytes: usize, now: u64) {
        self.packets_received += 1;
        self.bytes_received += u64::try_from(bytes).unwrap_or(0);
        if let Some(echo) = echo {
            let trip = u64::from(stamp(now).wrapping_sub(echo)) << UNIT_SHIFT;
            if trip < ROUND_TRIP_MAX {
                self.measure(trip);
            }
        }
        // After an outage, the number of sent packets is unknown, as sequence numbers wrap. The measurement of the loss
        // begins again.
        let is_old = self.last_sent.is_some_and(|(_, arrived)| now >= arrived.saturating_add(ROUND_TRIP_MAX));
        if is_old {
            (self.last_sequence, self.expected, self.arrived) = (None, 0, 0);
        }
        let step = self.last_sequence.map_or(1, |last| sequence.wrapping_sub(last));
        self.arrived += 1;
        if (1..1 << 15).contains(&step) {
            self.last_sequence = Some(sequence);
            self.last_sent = Some((sent, now));
            self.expected += u32::from(step);
        }
        if self.expected >= LOSS_WINDOW {
            let lost = self.expected.saturating_sub(self.arrived);
            self.loss_per_mille = 1000 * lost / self.expected;
            (self.expected, self.arrived) = (0, 0);
        }
    }

    pub(super) fn measure(&mut self, trip: u64) {
        if self.round_trip == 0 {
            self.round_trip = trip.max(1);
            self.jitter = trip / 4;
            return;
        }
        let deviation = trip.abs_diff(self.round_trip);
        self.jitter = (7 * self.jitter + deviation) / 8;
        self.round_trip = ((7 * self.round_trip + trip) / 8).max(1);
    }

    pub(super) fn sent(&mut self, bytes: usize) {
        self.next_sequence = self.next_sequence.wrapping_add(1);
        self.packets_sent += 1;
        self.bytes_sent += u64::try_from(bytes).unwrap_or(0);
    }
}
