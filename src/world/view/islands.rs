use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use crate::body::{BodyId, Handle};
use crate::world::World;
use crate::world::cache::UnionFind;
use crate::world::islands::{unite, unite_touching};

impl World {
    /// Returns the sets of enabled dynamic bodies that fall asleep and wake together: those connected by joints, by
    /// contacts of the last tick or by areas, and sleeping islands. Bodies are in slot order, sets in the order of
    /// their first bodies. Meant for tools, because each call computes the sets anew.
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
        // Contacts of bodies that were woken since the last tick are still in `sleeping_contacts`.
        unite_touching(state, &mut union, &state.sleeping_contacts);
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
