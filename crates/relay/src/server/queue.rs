//! [`Queue`]: frames that wait to be sent to a member.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

/// Frames that wait for a member. Their total size is limited.
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Notify,
    bytes_max: usize,
}

#[derive(Default)]
struct State {
    frames: VecDeque<Vec<u8>>,
    bytes: usize,
    /// Whether the members have changed since the last message about them.
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
        state.bytes += frame.len();
        state.frames.push_back(frame);
        while state.bytes > self.bytes_max {
            let Some(oldest) = state.frames.pop_front() else { break };
            state.bytes -= oldest.len();
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
        state.bytes -= frame.len();
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
        let queue = Queue::new(100);
        (0..50).for_each(|number| queue.push(vec![number; 10]));
        queue.room_changed();
        queue.room_changed();
        assert_eq!(queue.pop(), Some(Next::Members), "changes of the room come first, once");
        let kept: Vec<_> = std::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(kept, (40..50).map(|number| Next::Frame(vec![number; 10])).collect::<Vec<_>>());
        queue.push(vec![0; 101]);
        assert_eq!(queue.pop(), None);
        assert_eq!(queue.state().bytes, 0);
    }
}
