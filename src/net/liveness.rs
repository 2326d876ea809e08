//! [`Liveness`]: liveness of a remote.

use core::time::Duration;

use super::session::SessionEvent;

/// Time without messages from a remote.
///
/// GGRS would measure it by the system clock, although this machine may have been asleep or busy while messages were
/// waiting. Here, time counts only while this machine reads messages. GGRS also disconnects a player in the middle of a
/// tick, which fails one of its own assertions if that player has sent inputs for all ticks played.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Liveness {
    silent: Duration,
    is_interrupted: bool,
}

impl Liveness {
    /// A message has arrived.
    pub(super) fn receive(&mut self) {
        self.silent = Duration::ZERO;
    }

    /// Adds the time since the last call, of which at most an eighth of the timeout counts. Returns the resulting event
    /// for the player at `seat`. A lost player is reported in every call until a message arrives.
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

    /// The events when `listen` is called at the times `polls` and messages arrive at the times `messages`, in
    /// milliseconds.
    fn events(polls: &[u64], messages: &[u64]) -> Vec<(u64, SessionEvent)> {
        let mut liveness = Liveness::default();
        let mut last = 0;
        let mut said = Vec::new();
        for &poll in polls {
            if messages.iter().any(|at| (last..poll).contains(at)) {
                liveness.receive();
            }
            let event = liveness.listen(3, Duration::from_millis(poll - last), TIMEOUT);
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
