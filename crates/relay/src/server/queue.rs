//! [`Queue`]: frames that wait to be sent to a member.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

/// Memory of a frame besides its contents, in bytes: its entry in a deque that may be half empty, and the overhead of
/// its allocation. If this memory were not counted, a flood of empty datagrams would take many times the limit.
const FRAME_OVERHEAD: usize = 80;

/// Frames that wait for a member. Their total memory is limited.
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Notify,
    bytes_max: usize,
}

#[derive(Default)]
struct State {
    frames: VecDeque<Vec<u8>>,
    bytes: usize,
    /// Whether the members of the room have changed since the last text frame with the members was taken from the
    /// queue.
    room_changed: bool,
    /// Whether a newer connection of this member replaces this one.
    replaced: bool,
}

#[derive(Debug, PartialEq, Eq)]
pub(super) enum Next {
    Frame(Vec<u8>),
    Members,
    Replaced,
}

fn memory(frame: &[u8]) -> usize {
    frame.len().saturating_add(FRAME_OVERHEAD)
}

impl Queue {
    pub(super) fn new(bytes_max: usize) -> Self {
        Queue { state: Mutex::default(), changed: Notify::new(), bytes_max }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Appends a frame. Drops the oldest frames while the limit is exceeded.
    pub(super) fn push(&self, frame: Vec<u8>) {
        let mut state = self.state();
        state.bytes += memory(&frame);
        state.frames.push_back(frame);
        while state.bytes > self.bytes_max {
            let Some(oldest) = state.frames.pop_front() else { break };
            state.bytes -= memory(&oldest);
        }
        drop(state);
        self.changed.notify_one();
    }

    pub(super) fn room_changed(&self) {
        self.state().room_changed = true;
        self.changed.notify_one();
    }

    pub(super) fn replace(&self) {
        self.state().replaced = true;
        self.changed.notify_one();
    }

    fn pop(&self) -> Option<Next> {
        let mut state = self.state();
        if state.replaced {
            return Some(Next::Replaced);
        }
        if core::mem::take(&mut state.room_changed) {
            return Some(Next::Members);
        }
        let frame = state.frames.pop_front()?;
        state.bytes -= memory(&frame);
        Some(Next::Frame(frame))
    }

    /// Waits for the next message. No message is lost if the future is dropped.
    pub(super) async fn next(&self) -> Next {
        loop {
            if let Some(next) = self.pop() {
                return next;
            }
            self.changed.notified().await;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_frames_are_dropped() {
        let queue = Queue::new(10 * (10 + FRAME_OVERHEAD));
        (0..50).for_each(|number| queue.push(vec![number; 10]));
        queue.room_changed();
        queue.room_changed();
        assert_eq!(queue.pop(), Some(Next::Members), "changes of the room come first, once");
        let kept: Vec<_> = std::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(kept, (40..50).map(|number| Next::Frame(vec![number; 10])).collect::<Vec<_>>());
        queue.push(vec![0; 11 + 9 * 10 + 10 * FRAME_OVERHEAD]);
        assert_eq!(queue.pop(), None);
        assert_eq!(queue.state().bytes, 0);
    }

    #[test]
    fn empty_frames_are_limited() {
        let queue = Queue::new(1000);
        (0..50).for_each(|_| queue.push(Vec::new()));
        assert_eq!(queue.state().frames.len(), 1000 / FRAME_OVERHEAD);
    }
}
