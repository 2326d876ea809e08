//! Saving and restoring in memory, often enough for rollback.
//!
//! A snapshot has two parts. What every step changes (places, velocities, fat boxes, impulses) is packed into buffers:
//! `bodies.rs`, which the step may have done already, and `constraints.rs`. Everything else is copied in pages,
//! which snapshots share as long as nothing in them changes (`body/arena/pages.rs`). The digests of the state are taken over
//! the same bytes, so that hashing what has been saved costs no more than reading it once.

mod bodies;
mod constraints;
mod encoding;
mod packing;
mod resting;
mod restore;
#[cfg(test)]
mod tests;

use alloc::sync::Arc;
use alloc::vec::Vec;

pub(super) use bodies::PackedBodies;
pub(super) use resting::Resting;

use resting::PackedContacts;

use super::World;
use super::config::Config;
use super::digest::{Section, WorldDigest};
use super::scratch::Changes;
use super::state::{Island, Reported, State};
use crate::body::{Body, Shape, SharedArena};
use crate::hash::StateHash;
use crate::math::Rng;
use crate::solver::Joint;

/// A copy of a world's state, for [`World::restore`].
///
/// It shares what has not changed with the world and with other snapshots, and takes some 50 bytes for each body and 32
/// for each contact of its own: see [`Snapshot::rollback_bytes`]. It knows its [`Snapshot::state_hash`].
#[derive(Clone, Debug)]
pub struct Snapshot {
    rest: Rest,
    bodies: SharedArena<Body>,
    shapes: SharedArena<Shape>,
    joints: SharedArena<Joint>,
    islands: SharedArena<Island>,
    resting: Arc<PackedContacts>,
    packed: Packed,
    /// Of all this.
    digest: WorldDigest,
    /// Where to look for pairs that come or go: no part of the state, but a restored world need not look everywhere.
    changes: Changes,
}

/// What of a state is neither in an arena nor a contact.
#[derive(Clone, Debug, PartialEq)]
struct Rest {
    config: Config,
    tick: u64,
    faults: u64,
    pairs_left_out: bool,
    removed_contacts: Vec<Reported>,
    rng: Rng,
}

/// What every step changes: each kind of it as bytes, or their digest.
#[derive(Clone, Debug, Default, PartialEq)]
struct Packed<T = Vec<u8>> {
    bodies: PackedBodies<T>,
    joints: T,
    contacts: T,
    impulses: T,
}

impl PartialEq for Snapshot {
    fn eq(&self, other: &Self) -> bool {
        self.digest == other.digest
            && self.rest == other.rest
            && self.packed == other.packed
            && (&self.bodies, &self.shapes) == (&other.bodies, &other.shapes)
            && (&self.joints, &self.islands) == (&other.joints, &other.islands)
            && self.resting == other.resting
    }
}

impl Default for Snapshot {
    /// An empty world with the default settings.
    fn default() -> Self {
        World::default().save()
    }
}

impl Snapshot {
    /// [`World::state_hash`] of the world that was saved. Costs nothing: it was found when it was saved.
    #[must_use]
    pub fn state_hash(&self) -> StateHash {
        self.digest.state_hash()
    }

    /// [`World::digest`] of the world that was saved. Costs nothing.
    #[must_use]
    pub fn digest(&self) -> WorldDigest {
        self.digest
    }

    /// How many bytes of memory it takes for itself, without what it shares with the world and other snapshots.
    #[must_use]
    pub fn rollback_bytes(&self) -> usize {
        let Snapshot {
            rest,
            bodies: _,
            shapes: _,
            joints: _,
            islands: _,
            resting: _,
            packed,
            digest: _,
            changes,
        } = self;
        let Packed { bodies: PackedBodies { bodies, boxes }, joints, contacts, impulses } = packed;
        let packed: usize = [bodies, boxes, joints, contacts, impulses].into_iter().map(Vec::len).sum();
        let lists = size_of_val(&*rest.removed_contacts) + size_of_val(&*changes.shapes);
        size_of::<Self>() + packed + lists
    }

    fn empty(state: &State) -> Self {
        Snapshot {
            rest: Rest::of(state),
            bodies: SharedArena::default(),
            shapes: SharedArena::default(),
            joints: SharedArena::default(),
            islands: SharedArena::default(),
            resting: Arc::default(),
            packed: Packed::default(),
            digest: WorldDigest::NONE,
            changes: Changes::default(),
        }
    }

    /// Takes a state over, as far as it is another one than before. Its bodies may have been packed already.
    fn take(&mut self, state: &State, packed_bodies: Option<&PackedBodies>, changes: &Changes) {
        // Destructured, so that a new field does not compile until it is saved.
        let State {
            config: _,
            tick: _,
            faults: _,
            bodies,
            shapes,
            joints,
            islands,
            contacts,
            resting,
            pairs_left_out: _,
            removed_contacts: _,
            rng: _,
        } = state;
        self.rest = Rest::of(state);
        bodies.share_into(&mut self.bodies, bodies::lasting_body);
        shapes.share_into(&mut self.shapes, |shape| bodies::lasting_shape(shape, bodies));
        joints.share_into(&mut self.joints, constraints::lasting_joint);
        islands.share_into(&mut self.islands, Island::clone);
        // Each buffer is hashed as soon as it is written, while it is near.
        let Packed { bodies: moving, joints: turns, contacts: heads, impulses } = &mut self.packed;
        match packed_bodies {
            Some(packed) => moving.copy_from(packed),
            None => moving.fill(state, |_, _| {}),
        }
        debug_assert!(*moving == PackedBodies::of(state), "bodies have changed since they were packed");
        let bodies = moving.digests();
        constraints::pack_joints(joints, turns);
        let joints = StateHash::of_bytes(turns);
        constraints::pack_contacts(contacts, heads, impulses);
        let [contacts, impulses] = [StateHash::of_bytes(heads), StateHash::of_bytes(impulses)];
        self.resting = resting.share();
        changes.keep(&mut self.changes);
        self.digest = self.digest_with(&Packed { bodies, joints, contacts, impulses });
    }

    /// The digest of all of it, with those of what is packed.
    fn digest_with(&self, packed: &Packed<StateHash>) -> WorldDigest {
        let Snapshot { rest, bodies, shapes, joints, islands, resting, packed: _, digest: _, changes: _ } =
            self;
        let Rest { config, tick, faults, pairs_left_out, removed_contacts, rng } = rest;
        fn of(shared: impl Iterator<Item = StateHash>, packed: StateHash) -> StateHash {
            StateHash::of_digests(shared.chain([packed]))
        }
        let ended = StateHash::of(&(pairs_left_out, removed_contacts));
        let contacts = [ended, resting.digest, packed.contacts].into_iter();
        WorldDigest {
            sections: [
                (Section::World, StateHash::of(&(config, tick, faults))),
                (Section::Bodies, of(bodies.digests(), packed.bodies.bodies)),
                (Section::Shapes, of(shapes.digests(), packed.bodies.boxes)),
                (Section::Joints, of(joints.digests(), packed.joints)),
                (Section::Contacts, of(contacts, packed.impulses)),
                (Section::Islands, StateHash::of_digests(islands.digests())),
                (Section::Random, StateHash::of(rng)),
            ],
        }
    }
}

impl Packed {
    /// All that it is in memory.
    fn buffers(&mut self) -> [&mut Vec<u8>; 5] {
        let Packed { bodies: PackedBodies { bodies, boxes }, joints, contacts, impulses } = self;
        [bodies, boxes, joints, contacts, impulses]
    }
}

impl Rest {
    fn of(state: &State) -> Self {
        Rest {
            config: state.config,
            tick: state.tick,
            faults: state.faults,
            pairs_left_out: state.pairs_left_out,
            removed_contacts: state.removed_contacts.clone(),
            rng: state.rng.clone(),
        }
    }
}

impl World {
    /// A copy of the state. For rollback, [`World::save_into`] spares the allocations.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        let mut snapshot = Snapshot::empty(&self.state);
        self.save_into(&mut snapshot);
        snapshot.packed.buffers().into_iter().for_each(Vec::shrink_to_fit);
        snapshot
    }

    /// Replaces a snapshot, of this world or another one, by a copy of the state. Costs a few per cent of a tick: what
    /// every tick changes is copied (bodies by the step already, if the tick before was saved or hashed), everything else is
    /// shared and copied only where it has changed since it was last saved or hashed. The state hash is found on the way.
    ///
    /// ```
    /// # use lockstep2d::world::{Snapshot, World};
    /// let mut world = World::default();
    /// // The last eight ticks, each in the place of the one eight ticks before.
    /// let mut ring = vec![Snapshot::default(); 8];
    /// for tick in 0..100 {
    ///     world.save_into(&mut ring[tick % 8]);
    ///     world.step();
    /// }
    /// world.restore(&ring[92 % 8]);
    /// assert_eq!((world.tick(), world.state_hash()), (92, ring[92 % 8].state_hash()));
    /// ```
    pub fn save_into(&self, snapshot: &mut Snapshot) {
        snapshot.take(&self.state, self.state.packed_bodies(), &self.scratch.changes);
        self.state.set_digest(snapshot.digest);
    }
}
