use alloc::vec::Vec;

use crate::collision::{BoxPairs, CachedAxis, Contact, KeptManifold, Manifold, SatCounters};
use crate::math::{Fx, Step, Unit, Vec2};
use crate::solver::ActiveContact;
use crate::threads::Threads;
use crate::world::events::HitEvent;

/// Cache of the narrow phase. Manifolds and axes refer to contacts by index, and become invalid when contacts are
/// reordered.
#[derive(Clone, Debug)]
pub(crate) struct ContactCache {
    output: NarrowPhaseOutput,
    parts: Vec<NarrowPhaseOutput>,
    /// For each contact, the cached separating axis. The list may be too short or too long: methods resize it before
    /// they use it.
    axes: Vec<CachedAxis>,
    /// During the narrow phase, the touching pairs of the last tick, sorted by pair. Otherwise outdated.
    touched: Vec<ActiveContact>,
    /// Buffer of the narrow phase.
    passing: Vec<Passing>,
    impact_order: ImpactOrder,
    surfaces_changed: bool,
}

/// A shape that passes through a one-way shape of another body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Passing {
    /// Slot of the body with the one-way shape.
    pub(crate) platform: u32,
    pub(crate) shape: u32,
}

pub(crate) struct NarrowPhaseBuffers<'a> {
    pub(crate) axes: &'a mut [CachedAxis],
    pub(crate) parts: &'a mut [NarrowPhaseOutput],
    /// The touching pairs of the last tick whose surfaces are still valid, sorted by pair.
    pub(crate) touched: &'a [ActiveContact],
    /// Buffer with any contents.
    pub(crate) passing: &'a mut Vec<Passing>,
}

/// Output of a whole narrow phase or of one thread, in the order of contacts. Aligned, so that no two threads write the
/// same cache line.
#[derive(Clone, Debug, Default)]
#[repr(align(128))]
pub(crate) struct NarrowPhaseOutput {
    pub(crate) manifolds: Vec<Manifold>,
    /// For each manifold, the index of its contact.
    pub(crate) contacts: Vec<u32>,
    /// Contacts that the solver has to solve.
    pub(crate) touching: Vec<ActiveContact>,
    /// Possible hit events. A hit event is reported only if the shapes also push each other in this tick.
    pub(crate) approaches: Vec<PendingHit>,
    /// The contacts whose manifolds are those at the time of an impact, and those whose shapes miss each other.
    pub(crate) impacts: Vec<PendingImpact>,
    pub(crate) sat: SatCounters,
    /// Buffer: box pairs of the current block.
    pub(crate) boxes: BoxPairs,
    /// Buffer: contacts of the current block that keep their manifold.
    pub(crate) recycled: Vec<Recycled>,
}

/// A manifold that a contact keeps from an earlier tick, moved to the current poses of the bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recycled {
    /// Position of the first point in the world, in metres.
    pub(crate) origin: Vec2<Fx>,
    pub(crate) separations: [Step; 2],
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PendingHit {
    /// Index of the contact in the state.
    pub(crate) contact: u32,
    pub(crate) event: HitEvent,
}

/// A contact with the manifold at the time of its impact, or whose shapes miss each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PendingImpact {
    /// Index of the manifold.
    pub(crate) manifold: u32,
    /// Index of the contact in the state.
    pub(crate) contact: u32,
    /// Slots of the bodies.
    pub(crate) bodies: [u32; 2],
    /// Fraction of the tick.
    pub(crate) fraction: Unit,
    /// Whether the shapes miss each other on their straight paths.
    pub(crate) misses: bool,
    /// The manifold at the start of the tick, and the manifold that the contact then keeps.
    pub(crate) start: (Manifold, KeptManifold),
}

/// Buffers for the order of impacts. Their contents do not matter.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImpactOrder {
    /// Body slot, fraction of the tick and index of each impact.
    pub(crate) by_body: Vec<(u32, Unit, u32)>,
    /// Indices of the impacts that get the manifold at the start of the tick.
    pub(crate) later: Vec<u32>,
    /// Manifolds of the impacts that get none.
    pub(crate) removed: Vec<u32>,
}

impl ContactCache {
    pub(crate) fn new() -> Self {
        ContactCache {
            output: NarrowPhaseOutput::default(),
            parts: Vec::new(),
            axes: Vec::new(),
            touched: Vec::new(),
            passing: Vec::new(),
            impact_order: ImpactOrder::default(),
            surfaces_changed: true,
        }
    }

    /// Output of the last narrow phase, and a buffer.
    pub(crate) fn output_mut(&mut self) -> (&mut NarrowPhaseOutput, &mut ImpactOrder) {
        (&mut self.output, &mut self.impact_order)
    }

    /// Output of the last narrow phase. Empty after contacts were invalidated.
    pub(crate) fn output(&self) -> &NarrowPhaseOutput {
        &self.output
    }

    /// Drops data indexed by contact, because contacts have been reordered.
    pub(crate) fn invalidate(&mut self) {
        self.output.clear();
        self.axes.clear();
    }

    /// Called when materials or shapes may have changed. The next narrow phase then drops all cached surfaces.
    pub(crate) fn invalidate_surfaces(&mut self) {
        self.surfaces_changed = true;
    }

    /// Drops the surfaces of removed shapes, whose slots may be reused before the next tick.
    pub(crate) fn remove_surfaces(&mut self, is_removed: impl Fn(&ActiveContact) -> bool) {
        self.output.touching.retain(|pair| !is_removed(pair));
    }

    /// The cached separating axes of `count` contacts, for an operation that reorders the contacts.
    pub(crate) fn axes(&mut self, count: usize) -> &mut Vec<CachedAxis> {
        self.axes.resize(count, CachedAxis::default());
        &mut self.axes
    }

    pub(crate) fn begin(&mut self, contact_count: usize, part_count: usize) -> NarrowPhaseBuffers<'_> {
        let ContactCache { output, parts, axes, touched, passing, impact_order: _, surfaces_changed } = self;
        axes.resize(contact_count, CachedAxis::default());
        core::mem::swap(&mut output.touching, touched);
        if core::mem::take(surfaces_changed) {
            touched.clear();
        }
        parts.resize_with(part_count, NarrowPhaseOutput::default);
        if let [only] = &mut **parts {
            core::mem::swap(only, output);
        }
        parts.iter_mut().for_each(NarrowPhaseOutput::clear);
        NarrowPhaseBuffers { axes, parts, touched, passing }
    }

    pub(crate) fn finish(&mut self, threads: &Threads) {
        let ContactCache { output, parts, .. } = self;
        match &mut **parts {
            [only] => core::mem::swap(only, output),
            parts => output.join(parts, threads),
        }
    }

    /// Adjusts the indices after a contact without a manifold was inserted at `index`.
    pub(crate) fn insert(&mut self, index: usize) {
        let NarrowPhaseOutput { contacts, touching, .. } = &mut self.output;
        let later = contacts.partition_point(|&contact| (contact as usize) < index);
        contacts[later..].iter_mut().for_each(|contact| *contact += 1);
        let later = touching.partition_point(|pair| (pair.contact as usize) < index);
        touching[later..].iter_mut().for_each(|pair| pair.contact += 1);
        if index < self.axes.len() {
            self.axes.insert(index, CachedAxis::default());
        }
    }

    /// Moves the contacts for which `stays` returns false from `contacts` to `removed`, and keeps their order.
    pub(crate) fn split_off(
        &mut self,
        contacts: &mut Vec<Contact>,
        removed: &mut Vec<Contact>,
        stays: impl Fn(&Contact) -> bool,
    ) {
        self.axes.resize(contacts.len(), CachedAxis::default());
        let NarrowPhaseOutput { manifolds, contacts: indices, .. } = &mut self.output;
        let (mut kept, mut next, mut kept_manifolds) = (0, 0, 0);
        for index in 0..contacts.len() {
            let stays = stays(&contacts[index]);
            if indices.get(next).is_some_and(|&contact| contact as usize == index) {
                if stays {
                    manifolds.swap(kept_manifolds, next);
                    indices[kept_manifolds] =
                        indices[next] - u32::try_from(index - kept).expect("fewer than 2^32 contacts");
                    kept_manifolds += 1;
                }
                next += 1;
            }
            if stays {
                contacts.swap(kept, index);
                self.axes.swap(kept, index);
                kept += 1;
            } else {
                removed.push(contacts[index]);
            }
        }
        contacts.truncate(kept);
        self.axes.truncate(kept);
        manifolds.truncate(kept_manifolds);
        indices.truncate(kept_manifolds);
    }
}

impl NarrowPhaseOutput {
    fn clear(&mut self) {
        self.manifolds.clear();
        self.contacts.clear();
        self.touching.clear();
        self.approaches.clear();
        self.impacts.clear();
        self.boxes.clear();
        self.recycled.clear();
        self.sat = SatCounters::default();
    }

    /// Removes the manifolds with the given indices, which are sorted.
    pub(crate) fn remove(&mut self, removed: &[u32]) {
        let is_removed = |index: u32| removed.binary_search(&index).is_ok();
        let (mut manifold, mut contact) = (0u32.., 0u32..);
        self.manifolds.retain(|_| manifold.next().is_none_or(|index| !is_removed(index)));
        self.contacts.retain(|_| contact.next().is_none_or(|index| !is_removed(index)));
        self.touching.retain(|pair| !is_removed(pair.manifold));
        for pair in &mut self.touching {
            pair.manifold -= count(&removed[..removed.partition_point(|&index| index < pair.manifold)]);
        }
    }

    /// Joins the outputs of the threads. Each thread copies the output that it has written.
    fn join(&mut self, parts: &[Self], threads: &Threads) {
        let NarrowPhaseOutput {
            manifolds,
            contacts,
            touching,
            approaches,
            impacts,
            sat,
            boxes: _,
            recycled: _,
        } = self;
        approaches.clear();
        impacts.clear();
        *sat = SatCounters::default();
        make_room(manifolds, parts.iter().map(|part| &*part.manifolds));
        make_room(contacts, parts.iter().map(|part| &*part.contacts));
        make_room(touching, parts.iter().map(|part| &*part.touching));
        let (mut manifolds, mut contacts, mut touching) =
            (&mut manifolds[..], &mut contacts[..], &mut touching[..]);
        let mut first_manifold = 0;
        let copies = parts.iter().map(|part| {
            let copy = Copy {
                part,
                first_manifold,
                manifolds: split_off(&mut manifolds, part.manifolds.len()),
                contacts: split_off(&mut contacts, part.contacts.len()),
                touching: split_off(&mut touching, part.touching.len()),
            };
            let moved = |impact: &PendingImpact| PendingImpact {
                manifold: first_manifold + impact.manifold,
                ..*impact
            };
            impacts.extend(part.impacts.iter().map(moved));
            first_manifold += count(&part.manifolds);
            approaches.extend_from_slice(&part.approaches);
            sat.cached_axis_hits += part.sat.cached_axis_hits;
            sat.searches += part.sat.searches;
            copy
        });
        threads.run_team(copies, |copy, _| {
            copy.run();
            0
        });
    }
}

struct Copy<'a> {
    part: &'a NarrowPhaseOutput,
    first_manifold: u32,
    manifolds: &'a mut [Manifold],
    contacts: &'a mut [u32],
    touching: &'a mut [ActiveContact],
}

impl Copy<'_> {
    fn run(self) {
        self.contacts.copy_from_slice(&self.part.contacts);
        self.manifolds.copy_from_slice(&self.part.manifolds);
        for (to, from) in self.touching.iter_mut().zip(&self.part.touching) {
            *to = ActiveContact { manifold: self.first_manifold + from.manifold, ..*from };
        }
    }
}

fn make_room<'a, T: Clone + 'a>(list: &mut Vec<T>, parts: impl Iterator<Item = &'a [T]> + Clone) {
    match parts.clone().find_map(<[T]>::first) {
        None => list.clear(),
        Some(filler) => list.resize(parts.map(<[T]>::len).sum(), filler.clone()),
    }
}

fn split_off<'a, T>(rest: &mut &'a mut [T], len: usize) -> &'a mut [T] {
    let (first, others) = core::mem::take(rest).split_at_mut(len);
    *rest = others;
    first
}

fn count<T>(list: &[T]) -> u32 {
    u32::try_from(list.len()).expect("fewer than 2^32 contacts")
}
