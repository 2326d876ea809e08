//! [`Presence`]: whether something still comes from a remote.

use core::time::Duration;

use super::session::SessionEvent;

/// For how long nothing has come from a remote.
///
/// GGRS would read the clock, on which this machine may have slept or been busy while others spoke: here time counts as
/// far as somebody listened. And it marks a player whom it misses as gone in the middle of a tick, which is an assertion
/// of its own if that player has sent inputs for all ticks that were played.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Presence {
    silent: Duration,
    is_interrupted: bool,
}

impl Presence {
    /// Something has come.
    pub(super) fn hear(&mut self) {
        self.silent = Duration::ZERO;
    }

    /// Time has passed since it was last listened, of which no more than an eighth of the timeout counts. What
    /// that means for the player at `seat`; that it is lost is said until it is heard.
    pub(super) fn listen(&mut self, seat: u32, passed: Duration, timeout: Duration) -> Option<SessionEvent> {
        self.silent += passed.min(timeout / 8);
        if self.silent > timeout {
            return Some(SessionEvent::Lost(seat));
        }
        let is_interrupted = self.silent > timeout / 4;
        match (core::mem::replace(&mut self.is_interrupted, is_interrupted), is_interrupted) {
            (false, true) => Some(SessionEvent::Interrupted(seat)),
            (true, false) => Some(SessionEvent::Resumed(seat)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    const TIMEOUT: Duration = Duration::from_secs(2);

    /// What is said when it is listened at these times, in milliseconds, and something comes at those.
    fn events(polls: &[u64], messages: &[u64]) -> Vec<(u64, SessionEvent)> {
        let mut presence = Presence::default();
        let mut last = 0;
        let mut said = Vec::new();
        for &poll in polls {
            if messages.iter().any(|at| (last..poll).contains(at)) {
                presence.hear();
            }
            let event = presence.listen(3, Duration::from_millis(poll - last), TIMEOUT);
            said.extend(event.map(|event| (poll, event)));
            last = poll;
        }
        said
    }

    #[test]
    fn who_is_silent_is_interrupted_and_then_lost() {
        let polls: Vec<u64> = (1..=25).map(|n| 100 * n).collect();
        let lost = (21..=25).map(|n| (100 * n, SessionEvent::Lost(3)));
        let expected: Vec<_> = [(600, SessionEvent::Interrupted(3))].into_iter().chain(lost).collect();
        assert_eq!(events(&polls, &[]), expected);
    }

    #[test]
    fn who_is_heard_again_is_back() {
        let polls: Vec<u64> = (1..=20).map(|n| 100 * n).collect();
        let expected = [(600, SessionEvent::Interrupted(3)), (1100, SessionEvent::Resumed(3))];
        assert_eq!(events(&polls, &[1050, 1500, 1900]), expected);
    }

    #[test]
    fn a_machine_that_has_slept_misses_nobody() {
        assert_eq!(events(&[100, 60_000, 60_100, 120_000, 120_100], &[60_050, 120_050]), []);
        let rarely: Vec<u64> = (1..=9).map(|n| 10_000 * n).collect();
        let expected = [(30_000, SessionEvent::Interrupted(3)), (90_000, SessionEvent::Lost(3))];
        assert_eq!(events(&rarely, &[]), expected);
    }
}
