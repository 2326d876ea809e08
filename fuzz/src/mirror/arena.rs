//! An arena as a snapshot stores it: slots, each with a generation and an optional value, and the list of vacant slots.

use serde::{Deserialize, Serialize};

use super::Handle;
use crate::source::Source;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Slot<T> {
    pub(super) generation: u32,
    pub(super) value: Option<T>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Arena<T> {
    pub(super) slots: Vec<Slot<T>>,
    pub(super) free: Vec<u32>,
    pub(super) retired: u32,
}

impl<T> Arena<T> {
    /// Picks the index of an occupied slot, or `None` if no slot is occupied.
    pub(super) fn pick(&self, source: &mut Source<'_>) -> Option<usize> {
        let occupied = |(index, slot): (usize, &Slot<T>)| slot.value.is_some().then_some(index);
        let occupied: Vec<usize> = self.slots.iter().enumerate().filter_map(occupied).collect();
        (!occupied.is_empty()).then(|| source.pick(&occupied))
    }

    pub(super) fn handle(&self, index: usize) -> Handle {
        (index as u32, self.slots[index].generation)
    }

    pub(super) fn get(&mut self, index: usize) -> Option<&mut T> {
        self.slots.get_mut(index)?.value.as_mut()
    }

    pub(super) fn values(&mut self) -> impl Iterator<Item = &mut T> {
        self.slots.iter_mut().filter_map(|slot| slot.value.as_mut())
    }

    pub(super) fn add(&mut self, value: T) -> Handle {
        self.slots.push(Slot { generation: 0, value: Some(value) });
        self.handle(self.slots.len() - 1)
    }

    /// Removes a value as a world does: the slot becomes vacant, or is retired if its generations are used up.
    pub(super) fn remove(&mut self, index: usize) -> Option<T> {
        let slot = self.slots.get_mut(index)?;
        let value = slot.value.take()?;
        if slot.generation == u32::MAX {
            self.retired += 1;
        } else {
            slot.generation += 1;
            self.free.push(index as u32);
        }
        Some(value)
    }

    /// Makes one of three changes: swaps two entries of the list of vacant slots, adds a vacant slot and its entry in
    /// the list, or adds a retired slot, whose generations are used up.
    pub(super) fn alter_vacancies(&mut self, source: &mut Source<'_>) {
        match source.below(4) {
            0 => {
                let (a, b) = (source.below(self.free.len()), source.below(self.free.len()));
                if !self.free.is_empty() {
                    self.free.swap(a, b);
                }
            }
            1 | 2 => {
                let generation = source.within(0, u32::MAX.into()) as u32;
                self.free.push(self.slots.len() as u32);
                self.slots.push(Slot { generation, value: None });
            }
            _ => {
                self.slots.push(Slot { generation: u32::MAX, value: None });
                self.retired += 1;
            }
        }
    }
}
