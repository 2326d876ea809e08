use alloc::boxed::Box;
use alloc::vec::Vec;
use core::fmt;
use core::ops::{Deref, DerefMut};

use once_cell::race::OnceBox;

use crate::hash::StateHash;
use crate::world::state::State;

/// A part of the state with a digest of its own.
///
/// ```
/// # use lockstep2d::{body::BodyDef, world::World};
/// use lockstep2d::world::Section;
/// # let mut world = World::default();
/// # world.spawn(&BodyDef::dynamic(), &[])?;
/// let before = world.digest();
/// world.rng().next_u32();
/// // Which part of the state has changed?
/// assert_eq!(world.digest().differing(&before), [Section::Random]);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
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
    /// Active and sleeping contacts and their impulses, touching contacts that edits have ended since the last tick,
    /// and whether [`Config::pair_limit`](crate::world::Config::pair_limit) left pairs out at the last pair update.
    Contacts,
    /// Sleeping islands.
    Islands,
    /// Random number generator.
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

/// The digests of a world's sections, in order. Sections with equal digests are equal, except for hash collisions.
///
/// ```
/// use lockstep2d::world::{World, WorldDigest};
/// let (world, other) = (World::default(), World::default());
/// let (ours, theirs): (WorldDigest, WorldDigest) = (world.digest(), other.digest());
/// assert_eq!(ours.state_hash(), world.state_hash());
/// assert!(ours.differing(&theirs).is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorldDigest {
    /// Digest of each section.
    pub sections: [(Section, StateHash); 7],
}

impl WorldDigest {
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

    /// The sections whose digests differ.
    #[must_use]
    pub fn differing(&self, other: &WorldDigest) -> Vec<Section> {
        let pairs = self.sections.iter().zip(&other.sections);
        pairs.filter(|(a, b)| a != b).map(|((section, _), _)| *section).collect()
    }
}

/// A state and its cached digest. Mutable access drops the digest.
#[derive(Clone, Debug)]
pub(crate) struct HashedState {
    state: State,
    digest: OnceBox<WorldDigest>,
}

impl HashedState {
    pub(crate) fn new(state: State) -> Self {
        HashedState { state, digest: OnceBox::new() }
    }

    /// Returns the state. Unlike `Deref`, this method can be called in `const` functions.
    pub(crate) const fn get(&self) -> &State {
        &self.state
    }

    pub(super) fn digest(&self) -> Option<&WorldDigest> {
        self.digest.get()
    }

    pub(super) fn set_digest(&self, digest: WorldDigest) {
        self.digest.get_or_init(|| Box::new(digest));
    }
}

impl Deref for HashedState {
    type Target = State;

    fn deref(&self) -> &State {
        &self.state
    }
}

impl DerefMut for HashedState {
    fn deref_mut(&mut self) -> &mut State {
        self.digest = OnceBox::new();
        &mut self.state
    }
}
