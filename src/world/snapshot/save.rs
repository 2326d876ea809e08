use alloc::vec::Vec;

use super::digest::WorldDigest;
use super::rollback::Snapshot;
use crate::body::BodyId;
use crate::hash::StateHash;
use crate::world::World;

impl World {
    /// Returns a copy of the state. To reuse the memory of an existing snapshot, call [`World::save_into`].
    #[must_use]
    #[doc(alias = "snapshot")]
    pub fn save(&self) -> Snapshot {
        let mut snapshot = Snapshot::empty(&self.state);
        self.save_into(&mut snapshot);
        snapshot.buffers().into_iter().for_each(Vec::shrink_to_fit);
        snapshot
    }

    /// Replaces a snapshot of this or another world by a copy of the state and its hash. Always copies the data that
    /// ticks change. Other data is copied only if it has changed since the world was last saved or hashed.
    ///
    /// ```
    /// # use lockstep2d::world::{Snapshot, World};
    /// let mut world = World::default();
    /// // A ring buffer with the states at the start of the last eight ticks.
    /// let mut ring = vec![Snapshot::default(); 8];
    /// for tick in 0..100 {
    ///     world.save_into(&mut ring[tick % 8]);
    ///     world.step();
    /// }
    /// world.restore(&ring[92 % 8]);
    /// assert_eq!((world.tick(), world.state_hash()), (92, ring[92 % 8].state_hash()));
    /// ```
    #[doc(alias = "rollback")]
    pub fn save_into(&self, snapshot: &mut Snapshot) {
        snapshot.take(&self.state, &self.scratch.pairs.changes);
        self.state.set_digest(snapshot.digest());
    }

    /// Returns the hash of the state, which is cached until the world changes. Costs about as much as [`World::save`].
    #[must_use]
    #[doc(alias = "checksum")]
    pub fn state_hash(&self) -> StateHash {
        self.digest().state_hash()
    }

    /// Returns the digest of each section of the state.
    #[must_use]
    pub fn digest(&self) -> WorldDigest {
        let Some(cached) = self.state.digest() else {
            return self.save().digest();
        };
        debug_assert_eq!(*cached, self.save().digest(), "the state has changed since its digest was cached");
        *cached
    }

    /// Returns the digest of each body, in slot order.
    pub fn body_digests(&self) -> impl Iterator<Item = (BodyId, StateHash)> {
        self.state.bodies.iter().map(|(id, body)| (id, StateHash::of(body)))
    }
}

impl Default for Snapshot {
    /// A snapshot of an empty world with the default settings.
    fn default() -> Self {
        World::default().save()
    }
}
