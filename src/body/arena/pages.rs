//! Arena pages that snapshots share. A page is copied once, and snapshots share the copy until a slot in it changes.
//! While no slot of an arena changes, snapshots share one copy of the whole arena.
//!
//! The copies leave out the fields that every step changes, such as velocities. Snapshots store them separately.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use once_cell::race::OnceBox;
use serde::Serialize;

use super::{Arena, Slot};
use crate::hash::StateHash;

/// Slots per page: few, so that a change copies little, but enough to make sharing cheap.
const PAGE_SLOTS: usize = 32;

#[derive(Debug, PartialEq)]
struct Page<T> {
    slots: Vec<Slot<T>>,
    digest: StateHash,
}

#[derive(Debug, Default, PartialEq)]
struct Vacancies {
    free: Vec<u32>,
    retired: u32,
    digest: StateHash,
}

#[derive(Debug, PartialEq)]
struct Whole<T> {
    pages: Vec<Arc<Page<T>>>,
    vacancies: Arc<Vacancies>,
    /// Digest of the vacant slots, then of each page. Stored here so that reading the digests does not visit the pages.
    digests: Vec<StateHash>,
}

/// Cached copies, not part of the state. A cell is empty if its part of the arena has changed since the last copy, or
/// has never been copied.
#[derive(Debug)]
pub(super) struct Kept<T> {
    pages: Vec<OnceBox<Arc<Page<T>>>>,
    vacancies: OnceBox<Arc<Vacancies>>,
    whole: OnceBox<Arc<Whole<T>>>,
    revision: u64,
    /// See [`Arena::returns`].
    returns: u64,
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Kept { pages: Vec::new(), vacancies: OnceBox::new(), whole: OnceBox::new(), revision: 0, returns: 0 }
    }
}

impl<T> Clone for Kept<T> {
    fn clone(&self) -> Self {
        let Kept { pages, vacancies, whole, revision, returns } = self;
        Kept {
            pages: pages.clone(),
            vacancies: vacancies.clone(),
            whole: whole.clone(),
            revision: *revision,
            returns: *returns,
        }
    }
}

impl<T> PartialEq for Kept<T> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<T> Kept<T> {
    pub(super) fn changed(&mut self, slot: u32) {
        self.revision += 1;
        self.whole = OnceBox::new();
        if let Some(page) = self.pages.get_mut(slot as usize / PAGE_SLOTS) {
            *page = OnceBox::new();
        }
    }

    /// Invalidates the copies of the list of vacant slots and of a slot's page.
    pub(super) fn came_or_went(&mut self, slot: u32, slot_count: usize) {
        self.fit(slot_count);
        self.changed(slot);
        self.vacancies = OnceBox::new();
    }

    fn fit(&mut self, slot_count: usize) {
        self.pages.resize_with(slot_count.div_ceil(PAGE_SLOTS), OnceBox::new);
    }
}

/// Arena as stored in a snapshot.
#[derive(Debug, PartialEq)]
pub(crate) struct SharedArena<T>(Arc<Whole<T>>);

impl<T> Default for SharedArena<T> {
    fn default() -> Self {
        let vacancies = Arc::default();
        SharedArena(Arc::new(Whole { pages: Vec::new(), vacancies, digests: Vec::new() }))
    }
}

impl<T> Clone for SharedArena<T> {
    fn clone(&self) -> Self {
        SharedArena(self.0.clone())
    }
}

impl<T> SharedArena<T> {
    /// Digest of the vacant slots, then of each page.
    pub(crate) fn digests(&self) -> impl Iterator<Item = StateHash> {
        self.0.digests.iter().copied()
    }

    /// Number of pages shared, by pointer, with another snapshot.
    #[cfg(test)]
    pub(crate) fn shared_with(&self, other: &Self) -> usize {
        self.0.pages.iter().zip(&other.0.pages).filter(|(a, b)| Arc::ptr_eq(a, b)).count()
    }
}

impl<T, H> Arena<T, H> {
    /// Counter that changes when a value is inserted, removed or redefined, or when a restore changes a page.
    pub(crate) fn revision(&self) -> u64 {
        self.kept.revision
    }

    /// Counter that invalidates caches of fields that every step changes, such as the impulses of joints. Edits of such
    /// fields ([`Arena::note_change`]) and [`Arena::restore`] increment it. `restore` leaves these fields to its
    /// caller.
    pub(crate) fn returns(&self) -> u64 {
        self.kept.returns
    }

    /// Increments [`Arena::returns`]. Must be called after a change, outside of a step, of a field that every step
    /// changes.
    pub(crate) fn note_change(&mut self) {
        self.kept.returns += 1;
    }

    /// Sizes the page cache after the arena has been decoded.
    pub(crate) fn keep_pages(&mut self) {
        self.kept.fit(self.slots.len());
    }

    /// Stores the arena in `shared`. Copies only the pages that have changed since they were last shared.
    pub(crate) fn share_into(&self, shared: &mut SharedArena<T>, copy: impl Fn(&T) -> T)
    where
        T: PartialEq + Serialize,
    {
        let whole = self.kept.whole.get_or_init(|| Box::new(Arc::new(self.whole(&copy))));
        debug_assert!(whole.is_copy_of(self, &copy), "a value changed without invalidating its page");
        if !Arc::ptr_eq(&shared.0, whole) {
            shared.0 = whole.clone();
        }
    }

    fn whole(&self, copy: impl Fn(&T) -> T) -> Whole<T>
    where
        T: Serialize,
    {
        let vacancies_of = || Box::new(Arc::new(Vacancies::of(&self.free, self.retired)));
        let vacancies = self.kept.vacancies.get_or_init(vacancies_of).clone();
        let pages = self.slots.chunks(PAGE_SLOTS).enumerate().map(|(index, slots)| {
            let page_of = || Box::new(Arc::new(Page::of(slots, &copy)));
            match self.kept.pages.get(index) {
                Some(kept) => kept.get_or_init(page_of).clone(),
                None => *page_of(),
            }
        });
        let pages: Vec<_> = pages.collect();
        let of_pages = pages.iter().map(|page| page.digest);
        let digests = core::iter::once(vacancies.digest).chain(of_pages).collect();
        Whole { pages, vacancies, digests }
    }

    /// Restores the arena from a snapshot, except for the fields that every step changes. Calls `changed` with every
    /// slot that the restore removes, and with every slot whose value it may change.
    pub(crate) fn restore(&mut self, shared: &SharedArena<T>, mut changed: impl FnMut(u32))
    where
        T: Clone,
    {
        self.kept.returns += 1;
        let SharedArena(whole) = shared;
        if self.kept.whole.get().is_some_and(|kept| Arc::ptr_eq(kept, whole)) {
            return;
        }
        let slot_count = whole.pages.iter().map(|page| page.slots.len()).sum();
        (slot_count..self.slots.len()).filter_map(|slot| u32::try_from(slot).ok()).for_each(&mut changed);
        let mut other = slot_count != self.slots.len();
        self.slots.truncate(slot_count);
        self.kept.fit(slot_count);
        let mut first = 0;
        for (page, kept) in whole.pages.iter().zip(&mut self.kept.pages) {
            let next = first + page.slots.len();
            let same = kept.get().is_some_and(|kept| Arc::ptr_eq(kept, page));
            if !same {
                other = true;
                let there = self.slots.len().clamp(first, next);
                self.slots[first..there].clone_from_slice(&page.slots[..there - first]);
                self.slots.extend_from_slice(&page.slots[there - first..]);
                *kept = OnceBox::with_value(Box::new(page.clone()));
                (first..next).filter_map(|slot| u32::try_from(slot).ok()).for_each(&mut changed);
            }
            first = next;
        }
        self.free.clone_from(&whole.vacancies.free);
        self.retired = whole.vacancies.retired;
        self.kept.vacancies = OnceBox::with_value(Box::new(whole.vacancies.clone()));
        self.kept.whole = OnceBox::with_value(Box::new(whole.clone()));
        self.kept.revision += u64::from(other);
    }
}

impl<T: PartialEq> Whole<T> {
    fn is_copy_of<H>(&self, arena: &Arena<T, H>, copy: impl Fn(&T) -> T) -> bool {
        let mut pages = self.pages.iter().zip(arena.slots.chunks(PAGE_SLOTS));
        self.pages.len() == arena.slots.len().div_ceil(PAGE_SLOTS)
            && pages.all(|(page, slots)| page.is_copy_of(slots, &copy))
            && *self.vacancies == Vacancies::of(&arena.free, arena.retired)
    }
}

impl<T: Serialize> Page<T> {
    fn of(slots: &[Slot<T>], copy: impl Fn(&T) -> T) -> Self {
        let slots: Vec<Slot<T>> = slots
            .iter()
            .map(|slot| Slot { generation: slot.generation, value: slot.value.as_ref().map(&copy) })
            .collect();
        let digest = StateHash::of(&slots);
        Page { slots, digest }
    }
}

impl<T: PartialEq> Page<T> {
    fn is_copy_of(&self, slots: &[Slot<T>], copy: impl Fn(&T) -> T) -> bool {
        let same = |(kept, slot): (&Slot<T>, &Slot<T>)| {
            kept.generation == slot.generation && kept.value == slot.value.as_ref().map(&copy)
        };
        self.slots.len() == slots.len() && self.slots.iter().zip(slots).all(same)
    }
}

impl Vacancies {
    fn of(free: &[u32], retired: u32) -> Self {
        Vacancies { free: free.to_vec(), retired, digest: StateHash::of(&(free, retired)) }
    }
}
