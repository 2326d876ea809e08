//! [`Silence`]: detects a dead connection, for example after the device has changed networks.
#![expect(clippy::disallowed_types, reason = "a connection is observed in real time")]

use core::time::Duration;
use std::time::Instant;

/// Time without a frame from the relay after which a ping is sent.
const PING_AFTER: Duration = Duration::from_secs(5);
/// If no frame arrives for this time after a ping, the connection counts as lost.
const LOST_AFTER: Duration = Duration::from_secs(10);

/// The times of the last frame and of the last ping on a connection.
///
/// A connection counts as lost only if a ping remains unanswered. A program that has been suspended for a long time
/// therefore sends a ping first, and keeps its connection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Silence {
    heard_at: Instant,
    pinged_at: Option<Instant>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Due {
    Nothing,
    Ping,
    Reconnect,
}

impl Silence {
    pub(crate) const fn new(now: Instant) -> Self {
        Silence { heard_at: now, pinged_at: None }
    }

    /// Must be called for each frame from the relay.
    pub(crate) const fn heard(&mut self, now: Instant) {
        *self = Silence::new(now);
    }

    /// The action that is due. Must be called only after all frames that have arrived were read.
    pub(crate) fn due(&mut self, now: Instant) -> Due {
        match self.pinged_at {
            None if now.saturating_duration_since(self.heard_at) >= PING_AFTER => {
                self.pinged_at = Some(now);
                Due::Ping
            }
            Some(at) if now.saturating_duration_since(at) >= LOST_AFTER => Due::Reconnect,
            _ => Due::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_connection_is_lost_if_a_ping_is_not_answered() {
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let mut silence = Silence::new(start);
        assert_eq!(
            [1, 4, 5, 6].map(|s| silence.due(at(s))),
            [Due::Nothing, Due::Nothing, Due::Ping, Due::Nothing]
        );
        silence.heard(at(7));
        assert_eq!(
            [11, 12, 21, 22].map(|s| silence.due(at(s))),
            [Due::Nothing, Due::Ping, Due::Nothing, Due::Reconnect]
        );
    }

    #[test]
    fn a_suspended_program_asks_before_it_connects_again() {
        let start = Instant::now();
        let mut silence = Silence::new(start);
        assert_eq!(silence.due(start + Duration::from_secs(3600)), Due::Ping);
    }
}
