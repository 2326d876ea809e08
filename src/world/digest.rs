//! The state hash, and the digests it is made of: what a report of a divergence is built from.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;
use core::ops::{Deref, DerefMut};

use once_cell::race::OnceBox;

use super::World;
use super::rollback::PackedBodies;
use super::state::State;
use crate::body::BodyId;
use crate::hash::StateHash;

/// A part of the state with a digest of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// Settings, tick and fault count.
    World,
    /// Bodies and their free list.
    Bodies,
    /// Shapes, their fat boxes and their free list.
    Shapes,
    /// Joints, their impulses and their free list.
    Joints,
    /// Contacts and their impulses, also of what sleeps.
    Contacts,
    /// What sleeps, and together with what.
    Islands,
    /// Random numbers.
    Random,
}

impl fmt::Display for Section {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Section::World => "world",
            Section::Bodies => "bodies",
            Section::Shapes => "shapes",
            Section::Joints => "joints",
            Section::Contacts => "contacts",
            Section::Islands => "islands",
            Section::Random => "random",
        })
    }
}

/// The digests of a world's sections, in order. Two worlds that differ, differ in one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorldDigest {
    /// The digest of each section.
    pub sections: [(Section, StateHash); 7],
}

impl WorldDigest {
    /// Of sections that have not been looked at yet.
    pub(super) const NONE: Self = WorldDigest {
        sections: [
            (Section::World, StateHash(0)),
            (Section::Bodies, StateHash(0)),
            (Section::Shapes, StateHash(0)),
            (Section::Joints, StateHash(0)),
            (Section::Contacts, StateHash(0)),
            (Section::Islands, StateHash(0)),
            (Section::Random, StateHash(0)),
        ],
    };

    /// The hash of the whole state.
    #[must_use]
    pub fn state_hash(&self) -> StateHash {
        StateHash::of_digests(self.sections.map(|(_, digest)| digest))
    }

    /// The sections in which two worlds differ.
    #[must_use]
    pub fn differing(&self, other: &WorldDigest) -> Vec<Section> {
        let pairs = self.sections.iter().zip(&other.sections);
        pairs.filter(|(a, b)| a != b).map(|((section, _), _)| *section).collect()
    }
}

impl World {
    /// The hash of everything that influences the future. Costs about as much as [`World::save_into`], or nothing if the
    /// world has not changed since it was last hashed or saved.
    #[must_use]
    pub fn state_hash(&self) -> StateHash {
        self.digest().state_hash()
    }

    /// The digest of each section of the state.
    #[must_use]
    pub fn digest(&self) -> WorldDigest {
        let Some(known) = self.state.digest.get() else {
            return self.save().digest();
        };
        debug_assert_eq!(*known, self.save().digest(), "the state has changed unseen");
        *known
    }

    /// The digest of each body, in slot order.
    pub fn body_digests(&self) -> impl Iterator<Item = (BodyId, StateHash)> {
        self.state.bodies.iter().map(|(id, body)| (id, StateHash::of(body)))
    }
}

/// A state, and what has been found out about it until it changes: whoever may change the state, forgets it.
#[derive(Clone, Debug)]
pub(super) struct Hashed {
    state: State,
    digest: OnceBox<WorldDigest>,
    /// The bodies as snapshots have them, while `is_packed`.
    packed: PackedBodies,
    is_packed: bool,
    /// Whether a state since the last step has been saved or hashed: who does so with one tick does so with the next, and
    /// the step packs the bodies while it has them at hand.
    is_watched: bool,
}

impl Hashed {
    pub(super) fn new(state: State) -> Self {
        let (digest, packed) = (OnceBox::new(), PackedBodies::default());
        Hashed { state, digest, packed, is_packed: false, is_watched: false }
    }

    pub(super) const fn get(&self) -> &State {
        &self.state
    }

    /// Takes note of the digest of the state as it is.
    pub(super) fn set_digest(&self, digest: WorldDigest) {
        self.digest.get_or_init(|| Box::new(digest));
    }

    /// Its bodies as snapshots have them, if the last step has packed them.
    pub(super) fn packed_bodies(&self) -> Option<&PackedBodies> {
        self.is_packed.then_some(&self.packed)
    }

    /// The state, for a step, and where to pack the bodies at its end if that is worth while.
    pub(super) fn for_step(&mut self) -> (&mut State, Option<&mut PackedBodies>) {
        self.forget();
        self.is_packed = core::mem::take(&mut self.is_watched);
        (&mut self.state, self.is_packed.then_some(&mut self.packed))
    }

    fn forget(&mut self) {
        self.is_watched |= self.digest.get().is_some();
        self.is_packed = false;
        self.digest = OnceBox::new();
    }
}

impl Deref for Hashed {
    type Target = State;

    fn deref(&self) -> &State {
        &self.state
    }
}

impl DerefMut for Hashed {
    fn deref_mut(&mut self) -> &mut State {
        self.forget();
        &mut self.state
    }
}
