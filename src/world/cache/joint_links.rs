//! The joints of each body, as doubly linked lists in two arrays. Adding or removing a joint takes constant time. The
//! order within a list depends on earlier edits, so [`JointLinks::of`] sorts its result.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use crate::body::{BodyId, Handle, JointId};
use crate::world::state::State;

const NONE: u32 = u32::MAX;

#[derive(Clone, Debug, Default)]
pub(crate) struct JointLinks {
    /// For each body slot, the slot of its first joint, or [`NONE`].
    first: Vec<u32>,
    /// For each joint slot, its places in the lists of its two bodies.
    links: Vec<[Link; 2]>,
}

/// The place of a joint in the list of a body.
#[derive(Clone, Copy, Debug)]
struct Link {
    body: u32,
    next: u32,
    previous: u32,
}

impl Link {
    const EMPTY: Link = Link { body: NONE, next: NONE, previous: NONE };
}

impl JointLinks {
    pub(crate) fn new(state: &State) -> Self {
        let mut links = JointLinks::default();
        for (id, joint) in state.joints.iter() {
            links.add(id, joint.def().bodies());
        }
        links
    }

    /// Adds a joint to the lists of its bodies, which must differ.
    pub(crate) fn add(&mut self, joint: JointId, (a, b): (BodyId, BodyId)) {
        let (joint, a, b) = (joint.slot(), a.slot(), b.slot());
        debug_assert_ne!(a, b, "a joint is in two lists");
        grow(&mut self.links, joint, [Link::EMPTY; 2]);
        grow(&mut self.first, a.max(b), NONE);
        for (end, body) in [a, b].into_iter().enumerate() {
            let next = core::mem::replace(&mut self.first[body as usize], joint);
            self.links[joint as usize][end] = Link { body, next, previous: NONE };
            if next != NONE {
                self.link_mut(next, body).previous = joint;
            }
        }
    }

    pub(crate) fn remove(&mut self, joint: JointId, (a, b): (BodyId, BodyId)) {
        for body in [a.slot(), b.slot()] {
            let Link { next, previous, .. } = *self.link_mut(joint.slot(), body);
            if previous == NONE {
                self.first[body as usize] = next;
            } else {
                self.link_mut(previous, body).next = next;
            }
            if next != NONE {
                self.link_mut(next, body).previous = previous;
            }
        }
    }

    /// Returns the joints of a body in slot order.
    pub(crate) fn of(&self, state: &State, body: BodyId) -> Vec<JointId> {
        let first = self.first.get(body.slot() as usize).copied().filter(|&joint| joint != NONE);
        let next = |&joint: &u32| Some(self.after(joint, body.slot())).filter(|&joint| joint != NONE);
        let mut joints: Vec<u32> = core::iter::successors(first, next).collect();
        joints.sort_unstable();
        joints.into_iter().map(|slot| state.joints.handle_at(slot)).collect()
    }

    fn after(&self, joint: u32, body: u32) -> u32 {
        let [a, b] = self.links[joint as usize];
        if a.body == body { a.next } else { b.next }
    }

    fn link_mut(&mut self, joint: u32, body: u32) -> &mut Link {
        let [a, b] = &mut self.links[joint as usize];
        if a.body == body { a } else { b }
    }
}

fn grow<T: Copy>(list: &mut Vec<T>, index: u32, empty: T) {
    list.resize(list.len().max(index as usize + 1), empty);
}
