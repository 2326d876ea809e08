//! Islands, to look at: while bodies are awake the state has none, since nothing depends on them.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::World;
use super::islands::{UnionFind, unite, unite_touching};
use crate::body::{BodyId, Handle};

impl World {
    /// The sets of dynamic bodies that can only fall asleep together: what contacts and joints of the last tick connect,
    /// and what sleeps together. Each is in the order of slots, and so are they by their first body.
    ///
    /// They are found anew every time, in about the time of a tick's share for falling asleep: for tools.
    #[must_use]
    pub fn islands(&self) -> Vec<Vec<BodyId>> {
        let state = &self.state;
        let members = state.bodies.iter().filter(|(_, body)| body.is_dynamic() && body.is_enabled());
        let slots: Vec<u32> = members.map(|(id, _)| id.slot()).collect();
        let mut union = UnionFind::default();
        union.reset(&slots, state.bodies.slot_count());
        for (_, joint) in state.joints.iter().filter(|(_, joint)| joint.is_solved()) {
            let (a, b) = joint.def().bodies();
            unite(state, &mut union, a.slot(), b.slot());
        }
        unite_touching(state, &mut union, &state.contacts);
        for (_, island) in state.islands.iter() {
            island.bodies.windows(2).for_each(|pair| union.unite(pair[0], pair[1]));
        }
        let mut islands = BTreeMap::<u32, Vec<BodyId>>::new();
        for slot in slots {
            islands.entry(union.root(slot)).or_default().push(state.bodies.handle_at(slot));
        }
        islands.into_values().collect()
    }
}
