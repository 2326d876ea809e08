//! [`Rooms`]: the members of all rooms.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::limits::Limits;
use super::queue::Queue;
use crate::frame::{Member, Members, to_text};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Full {
    Room,
    Relay,
}

/// Rooms by code. A room is removed when its last member leaves.
#[derive(Default)]
pub(super) struct Rooms(Mutex<BTreeMap<String, Room>>);

/// Members in order of arrival.
type Room = Vec<(Member, Arc<Queue>)>;

impl Rooms {
    fn rooms(&self) -> MutexGuard<'_, BTreeMap<String, Room>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a connection to a room. If the member already has a connection, the new one replaces it.
    pub(super) fn enter(
        &self,
        code: &str,
        member: Member,
        queue: &Arc<Queue>,
        limits: &Limits,
    ) -> Result<(), Full> {
        let mut rooms = self.rooms();
        if !rooms.contains_key(code) && rooms.len() >= limits.rooms {
            return Err(Full::Relay);
        }
        let room = rooms.entry(code.to_owned()).or_default();
        if let Some((_, old)) = room.iter_mut().find(|(other, _)| *other == member) {
            old.replace();
            *old = Arc::clone(queue);
        } else if room.len() >= limits.members.max(1) {
            return Err(Full::Room);
        } else {
            room.push((member, Arc::clone(queue)));
        }
        room.iter().for_each(|(_, queue)| queue.room_changed());
        Ok(())
    }

    /// Removes a connection. Has no effect if a newer connection has replaced it.
    pub(super) fn leave(&self, code: &str, queue: &Arc<Queue>) {
        let mut rooms = self.rooms();
        let Some(room) = rooms.get_mut(code) else { return };
        room.retain(|(_, other)| !Arc::ptr_eq(other, queue));
        room.iter().for_each(|(_, queue)| queue.room_changed());
        if room.is_empty() {
            rooms.remove(code);
        }
    }

    /// Passes a frame to the member `to`. Drops the frame if there is no such member.
    pub(super) fn forward(&self, code: &str, to: Member, frame: Vec<u8>) {
        let queue = {
            let rooms = self.rooms();
            let room = rooms.get(code).map_or(&[][..], Vec::as_slice);
            room.iter().find(|(member, _)| *member == to).map(|(_, queue)| Arc::clone(queue))
        };
        if let Some(queue) = queue {
            queue.push(frame);
        }
    }

    /// The members of a room, as a message to the member `you`.
    pub(super) fn members(&self, code: &str, you: Member) -> Members {
        let rooms = self.rooms();
        let room = rooms.get(code).map_or(&[][..], Vec::as_slice);
        let others = room.iter().filter(|(member, _)| *member != you).map(|(member, _)| to_text(*member));
        Members { you: to_text(you), others: others.collect() }
    }

    #[cfg(test)]
    fn len(&self) -> usize {
        self.rooms().len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn member(number: u8) -> Member {
        [number; 8]
    }

    #[test]
    fn rooms_are_bounded_and_vanish_when_they_are_empty() {
        let rooms = Rooms::default();
        let limits = Limits { rooms: 2, members: 2, ..Limits::default() };
        let queues: Vec<_> = (0..5).map(|_| Arc::new(Queue::new(100))).collect();
        assert_eq!(rooms.enter("A", member(0), &queues[0], &limits), Ok(()));
        assert_eq!(rooms.enter("A", member(1), &queues[1], &limits), Ok(()));
        assert_eq!(rooms.enter("A", member(2), &queues[2], &limits), Err(Full::Room));
        assert_eq!(rooms.enter("B", member(2), &queues[2], &limits), Ok(()));
        assert_eq!(rooms.enter("C", member(3), &queues[3], &limits), Err(Full::Relay));
        assert_eq!(rooms.members("A", member(1)).others, ["0000000000000000"]);
        rooms.leave("A", &queues[0]);
        rooms.leave("A", &queues[1]);
        assert_eq!(rooms.len(), 1);
        assert_eq!(rooms.enter("C", member(3), &queues[3], &limits), Ok(()));
    }

    #[test]
    fn a_newer_connection_of_a_member_stays_when_the_older_one_leaves() {
        let rooms = Rooms::default();
        let limits = Limits { members: 1, ..Limits::default() };
        let [old, new] = [(); 2].map(|()| Arc::new(Queue::new(100)));
        rooms.enter("A", member(0), &old, &limits).unwrap();
        rooms.enter("A", member(0), &new, &limits).unwrap();
        rooms.leave("A", &old);
        assert_eq!(rooms.len(), 1);
        rooms.leave("A", &new);
        assert_eq!(rooms.len(), 0);
    }
}
