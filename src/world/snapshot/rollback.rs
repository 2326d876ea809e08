use alloc::sync::Arc;
use alloc::vec::Vec;

use super::bodies::{PackedBodies, lasting_body, lasting_shape};
use super::constraints::{lasting_joint, pack_contacts, pack_joints};
use super::digest::{Section, WorldDigest};
use super::sleeping_contacts::PackedContacts;
use crate::body::{Body, Shape, SharedArena};
use crate::hash::StateHash;
use crate::math::Rng;
use crate::solver::Joint;
use crate::world::cache::Changes;
use crate::world::config::Config;
use crate::world::state::{Island, Reported, State};

/// A copy of a world's state, for [`World::restore`](crate::world::World::restore).
///
/// A snapshot shares unchanged data with the world and with other snapshots. In addition, it mainly takes 36 bytes for
/// each body, 16 for each shape of a body that is not fixed, 88 for each active pair with contact points, and 8 for
/// each other active pair: see [`Snapshot::rollback_bytes`].
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::dynamic(), &[square])?;
/// let saved = world.save();
/// world.step();
/// world.restore(&saved);
/// assert_eq!((world.tick(), world.state_hash()), (0, saved.state_hash()));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Snapshot {
    pub(super) rest: Rest,
    pub(super) bodies: SharedArena<Body>,
    pub(super) shapes: SharedArena<Shape>,
    pub(super) joints: SharedArena<Joint>,
    pub(super) islands: SharedArena<Island>,
    pub(super) sleeping_contacts: Arc<PackedContacts>,
    pub(super) packed: Packed,
    /// Digest of all fields except `changes` and this one.
    pub(super) digest: WorldDigest,
    /// Changes between the last pair update and the save. They are not part of the state. With them, the first pair
    /// update after a restore need not check every pair.
    pub(super) changes: Changes,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rest {
    pub(super) config: Config,
    pub(super) tick: u64,
    pub(super) faults: u64,
    pub(super) pairs_left_out: bool,
    pub(super) edited_contacts: Vec<Reported>,
    pub(super) rng: Rng,
}

/// Data that ticks change: packed (`T = Vec<u8>`), or the digests of the packed bytes (`T = StateHash`).
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Packed<T = Vec<u8>> {
    pub(super) bodies: PackedBodies<T>,
    pub(super) joints: T,
    pub(super) contacts: T,
    pub(super) impulses: T,
}

impl PartialEq for Snapshot {
    fn eq(&self, other: &Self) -> bool {
        self.digest == other.digest
            && self.rest == other.rest
            && self.packed == other.packed
            && (&self.bodies, &self.shapes) == (&other.bodies, &other.shapes)
            && (&self.joints, &self.islands) == (&other.joints, &other.islands)
            && self.sleeping_contacts == other.sleeping_contacts
    }
}

impl Snapshot {
    /// Returns the stored [`World::state_hash`](crate::world::World::state_hash) of the saved world.
    #[must_use]
    pub fn state_hash(&self) -> StateHash {
        self.digest.state_hash()
    }

    /// Returns the stored [`World::digest`](crate::world::World::digest) of the saved world.
    #[must_use]
    pub fn digest(&self) -> WorldDigest {
        self.digest
    }

    /// Returns the size of the snapshot in bytes, without the data that it shares with the world and other snapshots.
    #[must_use]
    pub fn rollback_bytes(&self) -> usize {
        let Snapshot {
            rest,
            bodies: _,
            shapes: _,
            joints: _,
            islands: _,
            sleeping_contacts: _,
            packed,
            digest: _,
            changes,
        } = self;
        let Packed { bodies: PackedBodies { bodies, boxes }, joints, contacts, impulses } = packed;
        let packed: usize = [bodies, boxes, joints, contacts, impulses].into_iter().map(Vec::len).sum();
        let lists = size_of_val(&*rest.edited_contacts) + changes.list_bytes();
        size_of::<Self>() + packed + lists
    }

    pub(super) fn empty(state: &State) -> Self {
        Snapshot {
            rest: Rest::of(state),
            bodies: SharedArena::default(),
            shapes: SharedArena::default(),
            joints: SharedArena::default(),
            islands: SharedArena::default(),
            sleeping_contacts: Arc::default(),
            packed: Packed::default(),
            digest: WorldDigest::NONE,
            changes: Changes::default(),
        }
    }

    pub(super) fn buffers(&mut self) -> [&mut Vec<u8>; 5] {
        let Packed { bodies: PackedBodies { bodies, boxes }, joints, contacts, impulses } = &mut self.packed;
        [bodies, boxes, joints, contacts, impulses]
    }

    /// Replaces the snapshot by a copy of a state. Reuses the memory of its buffers, and shares unchanged pages with
    /// `state`.
    pub(super) fn take(&mut self, state: &State, changes: &Changes) {
        // Destructures without `..`, so that a new field causes a compile error until it is saved.
        let State {
            config: _,
            tick: _,
            faults: _,
            bodies,
            shapes,
            joints,
            islands,
            contacts,
            sleeping_contacts,
            pairs_left_out: _,
            edited_contacts: _,
            rng: _,
        } = state;
        self.rest = Rest::of(state);
        bodies.share_into(&mut self.bodies, lasting_body);
        shapes.share_into(&mut self.shapes, |shape| lasting_shape(shape, bodies));
        joints.share_into(&mut self.joints, lasting_joint);
        islands.share_into(&mut self.islands, Island::clone);
        // Each buffer is hashed immediately after it is packed, while it is in the processor's cache.
        let Packed { bodies: packed_bodies, joints: packed_joints, contacts: heads, impulses } =
            &mut self.packed;
        packed_bodies.pack(state);
        let bodies = packed_bodies.digests();
        pack_joints(joints, packed_joints);
        let joints = StateHash::of_bytes(packed_joints);
        pack_contacts(contacts, heads, impulses);
        let [contacts, impulses] = [StateHash::of_bytes(heads), StateHash::of_bytes(impulses)];
        self.sleeping_contacts = sleeping_contacts.share();
        changes.save_into(&mut self.changes);
        self.digest = self.digest_with(&Packed { bodies, joints, contacts, impulses });
    }

    fn digest_with(&self, packed: &Packed<StateHash>) -> WorldDigest {
        let Snapshot {
            rest,
            bodies,
            shapes,
            joints,
            islands,
            sleeping_contacts,
            packed: _,
            digest: _,
            changes: _,
        } = self;
        let Rest { config, tick, faults, pairs_left_out, edited_contacts, rng } = rest;
        fn of(shared: impl Iterator<Item = StateHash>, packed: StateHash) -> StateHash {
            StateHash::of_digests(shared.chain([packed]))
        }
        let ended = StateHash::of(&(pairs_left_out, edited_contacts));
        let contacts = [ended, sleeping_contacts.digest, packed.contacts].into_iter();
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

impl Rest {
    fn of(state: &State) -> Self {
        Rest {
            config: state.config,
            tick: state.tick,
            faults: state.faults,
            pairs_left_out: state.pairs_left_out,
            edited_contacts: state.edited_contacts.clone(),
            rng: state.rng.clone(),
        }
    }
}
