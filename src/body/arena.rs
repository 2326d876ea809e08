//! Generational arena: a handle never resolves to a later value in the same slot.
//!
//! The free list is part of the state, because it decides which handle the next value gets.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;
use core::fmt;
use core::marker::PhantomData;

use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::threads::split_at_ends;

mod pages;

use pages::Kept;
pub(crate) use pages::SharedArena;

/// A generational handle: a slot index, and the number of earlier values in that slot.
pub(crate) trait Handle: Copy + Eq {
    fn from_parts(index: u32, generation: u32) -> Self;
    fn slot(self) -> u32;
    fn generation(self) -> u32;
}

macro_rules! define_handle {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub struct $name {
            index: u32,
            generation: u32,
        }

        impl $name {
            /// Slot of the value. Slot numbers are small and are reused, so they can index a side table.
            #[must_use]
            pub const fn index(self) -> u32 {
                self.index
            }

            /// Number of earlier values in this slot.
            #[must_use]
            pub const fn generation(self) -> u32 {
                self.generation
            }
        }

        impl Handle for $name {
            fn from_parts(index: u32, generation: u32) -> Self {
                $name { index, generation }
            }
            fn slot(self) -> u32 {
                self.index
            }
            fn generation(self) -> u32 {
                self.generation
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                write!(f, "{}v{}", self.index, self.generation)
            }
        }
    };
}

define_handle! {
    /// Handle of a body. Valid until that body is despawned, or a state from before its spawn is restored.
    ///
    /// ```
    /// # use lockstep2d::{body::{BodyDef, BodyId}, world::World};
    /// # let mut world = World::default();
    /// let first: BodyId = world.spawn(&BodyDef::dynamic(), &[])?;
    /// // A side table of the game, indexed by slot.
    /// let mut scores = vec![0; world.body_count()];
    /// scores[first.index() as usize] += 5;
    /// world.despawn(first)?;
    /// // The slot is used again, and the old handle does not lead to the new body.
    /// let second = world.spawn(&BodyDef::dynamic(), &[])?;
    /// assert_eq!((second.index(), second.generation()), (first.index(), first.generation() + 1));
    /// assert!(world.body(first).is_none() && world.body(second).is_some());
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    BodyId
}
define_handle! {
    /// Handle of a shape. Valid until that shape is removed, its body is despawned, or a state from before its creation
    /// is restored.
    ///
    /// ```
    /// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef, ShapeId}, fx, world::World};
    /// # let mut world = World::default();
    /// let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
    /// let robot = world.spawn(&BodyDef::dynamic(), &[square])?;
    /// // An arm is attached to a robot and removed again.
    /// let arm: ShapeId = world.add_shape(robot, &square.offset((fx!(1), fx!(0))))?;
    /// assert_eq!(world.shapes_of(robot).len(), 2);
    /// world.remove_shape(arm)?;
    /// assert!(world.shape(arm).is_none() && world.body(robot).is_some());
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    ShapeId
}
define_handle! {
    /// Handle of a sleeping island. Valid until the island wakes.
    ///
    /// ```
    /// # use lockstep2d::{body::{BodyDef, IslandId, Polygon, ShapeDef}, fx, world::World};
    /// # let mut world = World::default();
    /// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
    /// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[square])?;
    /// let lower = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square])?;
    /// let upper = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(1.5))), &[square])?;
    /// (0..120).for_each(|_| world.step());
    /// // The bodies of a stack sleep as one island, and wake together.
    /// let island = |body| -> Option<IslandId> { world.body(body)?.island() };
    /// assert!(island(lower).is_some() && island(lower) == island(upper));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    IslandId
}
define_handle! {
    /// Handle of a joint. Valid until that joint is removed, one of its bodies is despawned, or a state from before its
    /// creation is restored.
    ///
    /// ```
    /// # use lockstep2d::{body::{BodyDef, JointId}, fx, solver::{JointDef, Revolute}, world::World};
    /// # let mut world = World::default();
    /// let frame = world.spawn(&BodyDef::fixed(), &[])?;
    /// let door = world.spawn(&BodyDef::dynamic(), &[])?;
    /// let hinge: JointId = world.add_joint(&JointDef::new(frame, door, Revolute::new()))?;
    /// assert_eq!(world.joints_of(door), [hinge]);
    /// // A joint is removed with either of its bodies.
    /// world.despawn(door)?;
    /// assert!(world.joint(hinge).is_none());
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    JointId
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Slot<T> {
    generation: u32,
    value: Option<T>,
}

/// Values behind generational handles, iterated in slot order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "T: Serialize", deserialize = "T: Deserialize<'de>"))]
pub(crate) struct Arena<T, H> {
    #[serde(deserialize_with = "slots_within_limit")]
    slots: Vec<Slot<T>>,
    /// Vacant slots that are not retired. The most recently freed slot is last.
    free: Vec<u32>,
    /// Vacant slots whose generation counter is exhausted.
    retired: u32,
    #[serde(skip)]
    kept: Kept<T>,
    #[serde(skip)]
    handle: PhantomData<fn() -> H>,
}

/// The values in a range of slots.
pub(crate) struct ArenaRange<'a, T> {
    first: u32,
    slots: &'a mut [Slot<T>],
}

impl<T> ArenaRange<'_, T> {
    /// Value in a slot of the range. The caller may change only the fields that [`Arena::at_mut`] allows. Panics if the
    /// slot is vacant or in another range.
    #[inline]
    pub(crate) fn at_mut(&mut self, slot: u32) -> &mut T {
        self.slots[(slot - self.first) as usize].value.as_mut().expect("an occupied slot")
    }
}

/// Largest number of slots that decoding accepts: the capacity of a world plus some retired slots. Without a limit, a
/// small file could cause a large allocation.
const DECODED_SLOTS_MAX: usize = (1 << 20) + (1 << 12);

fn slots_within_limit<'de, T, D>(deserializer: D) -> Result<Vec<Slot<T>>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    struct Slots<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for Slots<T> {
        type Value = Vec<Slot<T>>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "at most {DECODED_SLOTS_MAX} slots")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
            let mut slots = Vec::new();
            while let Some(slot) = sequence.next_element()? {
                if slots.len() == DECODED_SLOTS_MAX {
                    return Err(serde::de::Error::invalid_length(slots.len() + 1, &self));
                }
                slots.push(slot);
            }
            Ok(slots)
        }
    }
    deserializer.deserialize_seq(Slots(PhantomData))
}

impl<T, H> Default for Arena<T, H> {
    fn default() -> Self {
        Arena { slots: Vec::new(), free: Vec::new(), retired: 0, kept: Kept::default(), handle: PhantomData }
    }
}

impl<T, H: Handle> Arena<T, H> {
    pub(crate) fn slot_count(&self) -> usize {
        self.slots.len()
    }

    pub(crate) fn len(&self) -> usize {
        self.slots.len() - self.free.len() - self.retired as usize
    }

    /// Stores a value in the most recently freed slot, or in a new one.
    pub(crate) fn insert(&mut self, value: T) -> H {
        let handle = self.next_handle();
        match self.free.pop() {
            Some(index) => self.slots[index as usize].value = Some(value),
            None => self.slots.push(Slot { generation: 0, value: Some(value) }),
        }
        self.kept.came_or_went(handle.slot(), self.slots.len());
        handle
    }

    pub(crate) fn next_handle(&self) -> H {
        match self.free.last() {
            Some(&index) => H::from_parts(index, self.slots[index as usize].generation),
            None => H::from_parts(u32::try_from(self.slots.len()).expect("fewer than 2^32 slots"), 0),
        }
    }

    pub(crate) fn remove(&mut self, handle: H) -> Option<T> {
        self.get(handle)?;
        let slot = &mut self.slots[handle.slot() as usize];
        let value = slot.value.take();
        // A slot is retired if its generation is the largest `u32`. If the counter wrapped around, old handles would
        // resolve to new values.
        if slot.generation < u32::MAX {
            slot.generation += 1;
            self.free.push(handle.slot());
        } else {
            self.retired += 1;
        }
        self.kept.came_or_went(handle.slot(), self.slots.len());
        value
    }

    pub(crate) fn get(&self, handle: H) -> Option<&T> {
        let slot = self.slots.get(handle.slot() as usize)?;
        if slot.generation == handle.generation() { slot.value.as_ref() } else { None }
    }

    /// Value in an occupied slot. The caller may change any field, because the cached page copy is invalidated. Panics
    /// if the slot is vacant.
    pub(crate) fn redefine(&mut self, slot: u32) -> &mut T {
        self.kept.changed(slot);
        self.slots[slot as usize].value.as_mut().expect("an occupied slot")
    }

    /// Value of a handle, or `None` if the handle is stale. The caller may change any field, because the cached page
    /// copy is invalidated.
    pub(crate) fn get_mut(&mut self, handle: H) -> Option<&mut T> {
        self.get(handle)?;
        Some(self.redefine(handle.slot()))
    }

    /// Value in an occupied slot. Panics if the slot is vacant.
    #[inline]
    pub(crate) fn at(&self, slot: u32) -> &T {
        self.slots[slot as usize].value.as_ref().expect("an occupied slot")
    }

    /// Value in an occupied slot. The caller may change only fields that every step changes: cached page copies leave
    /// these fields out and stay valid. Panics if the slot is vacant.
    #[inline]
    pub(crate) fn at_mut(&mut self, slot: u32) -> &mut T {
        self.slots[slot as usize].value.as_mut().expect("an occupied slot")
    }

    /// Divides the slots into consecutive ranges. For each slot in the ascending list `ends`, one range ends before it.
    /// The caller may change only the fields that [`Arena::at_mut`] allows.
    pub(crate) fn split(
        &mut self,
        ends: impl Iterator<Item = u32> + Clone,
    ) -> impl Iterator<Item = ArenaRange<'_, T>> {
        let firsts = core::iter::once(0).chain(ends.clone());
        let parts = split_at_ends(&mut self.slots, ends.map(|end| end as usize));
        firsts.zip(parts).map(|(first, slots)| ArenaRange { first, slots })
    }

    pub(crate) fn get_slot(&self, slot: u32) -> Option<&T> {
        self.slots.get(slot as usize)?.value.as_ref()
    }

    /// Handle of the value in a slot or, if the slot is vacant, of the next value there.
    pub(crate) fn handle_at(&self, slot: u32) -> H {
        H::from_parts(slot, self.slots[slot as usize].generation)
    }

    /// Handles that the next values in vacant slots will get. The last one is used first.
    pub(crate) fn free_handles(&self) -> impl Iterator<Item = H> {
        self.free.iter().map(|&slot| self.handle_at(slot))
    }

    pub(crate) fn retired(&self) -> u32 {
        self.retired
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (H, &T)> {
        self.slots.iter().zip(0u32..).filter_map(|(slot, index)| {
            slot.value.as_ref().map(|value| (H::from_parts(index, slot.generation), value))
        })
    }

    /// All values with their handles. The caller may change only the fields that [`Arena::at_mut`] allows.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = (H, &mut T)> {
        self.slots.iter_mut().zip(0u32..).filter_map(|(slot, index)| {
            let generation = slot.generation;
            slot.value.as_mut().map(|value| (H::from_parts(index, generation), value))
        })
    }

    /// Whether every vacant slot is either retired or exactly once in the free list, and `retired` is the number of
    /// retired slots.
    pub(crate) fn is_consistent(&self) -> bool {
        let mut listed = alloc::vec![false; self.slots.len()];
        let all_vacant = self.free.iter().all(|&index| {
            let fresh = listed.get_mut(index as usize).is_some_and(|seen| !core::mem::replace(seen, true));
            fresh && self.slots[index as usize].value.is_none()
        });
        let mut retired = 0;
        let unlisted = self.slots.iter().zip(listed).filter(|(slot, listed)| slot.value.is_none() && !listed);
        let all_used_up = unlisted.inspect(|_| retired += 1).all(|(slot, _)| slot.generation == u32::MAX);
        all_vacant && all_used_up && retired == self.retired
    }
}
