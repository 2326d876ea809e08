//! Narrow phase: a manifold for every contact whose shapes may meet within the tick.

use core::ops::Range;

use super::first_impacts;
use super::impact::Impact;
use super::passing;
use super::recycle::Recycling;
use super::speculative::{Side, SpeculativePair, approach};
use crate::body::Handle;
use crate::collision::{CachedAxis, Contact, Manifold, Pair, SatCounters, collide_near};
use crate::math::{Fx, Length, Step, Vec2};
use crate::simd::Machine;
use crate::solver::{ActiveContact, Surface, SurfaceSide};
use crate::world::cache::{
    AwakeSet, ClosingBound, Margins, MotionCache, NarrowPhaseBuffers, NarrowPhaseOutput, Passing, PendingHit,
    Poses, PredictedMotion, Scratch,
};
use crate::world::events::{ContactEvent, HitEvent};
use crate::world::state::State;

/// Smallest number of contacts that a thread gets, except for the last thread.
const CONTACTS_MIN: usize = 512;

/// Number of contacts in a block: large enough that few SIMD lanes stay empty, small enough for the cache.
const BLOCK: usize = 64;

/// Number of contacts by which prefetching is ahead. Only the data of shape B is prefetched: contacts are sorted by
/// shape A, so the data of shape A is read in order, but that of shape B is not.
const CONTACTS_AHEAD: usize = 8;

/// Finds the manifolds of all contacts. The result does not depend on the number of threads.
pub(super) fn find_manifolds(state: &mut State, scratch: &mut Scratch) {
    let Scratch { shapes, contacts: cache, awake, solver, .. } = scratch;
    let mut contacts = core::mem::take(&mut state.contacts);
    let share = contacts.len().div_ceil(solver.parts).max(CONTACTS_MIN);
    let part_count = contacts.len().div_ceil(share).max(1);
    let NarrowPhaseBuffers { axes, parts, touched, passing } = cache.begin(contacts.len(), part_count);
    passing::find(&contacts, shapes.poses().motion(), passing);
    let (margins, machine) = (Margins::of(&state.config), solver.machine);
    let narrow_phase =
        NarrowPhase { state, poses: shapes.poses(), awake, touched, passing, margins, machine };
    let chunks = contacts.chunks_mut(share).zip(axes.chunks_mut(share));
    let jobs = (0u32..).step_by(share).zip(chunks).zip(parts.iter_mut());
    solver.threads.run_team(jobs, |((first, (contacts, axes)), output), _| {
        narrow_phase.run(Job { contacts, axes, first }, output);
        0
    });
    cache.finish(&solver.threads);
    first_impacts::withdraw_later_ones(&mut contacts, state, shapes.poses(), margins.touching, cache);
    state.contacts = contacts;
}

struct NarrowPhase<'a> {
    state: &'a State,
    poses: &'a Poses,
    awake: &'a AwakeSet,
    touched: &'a [ActiveContact],
    passing: &'a [Passing],
    margins: Margins,
    machine: Machine,
}

struct Job<'a> {
    contacts: &'a mut [Contact],
    axes: &'a mut [CachedAxis],
    /// Index of the first contact in [`State::contacts`].
    first: u32,
}

/// The near contacts of a block, which are those whose shapes may meet within the tick. In each bit mask, bit `i`
/// stands for the contact at index `start + i` of the job.
#[derive(Clone, Copy)]
struct NearContacts {
    /// Index of the block's first contact in the job.
    start: usize,
    near: u64,
    box_pairs: u64,
    kept: u64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum ManifoldSource {
    Kept,
    /// The box kernel has collided the pair, in one batch with the other box pairs of the block.
    BoxPair,
    Shapes,
}

const _: () = assert!(BLOCK <= u64::BITS as usize);

impl NearContacts {
    #[inline]
    fn add(&mut self, index: usize, source: ManifoldSource) {
        let bit = index - self.start;
        self.near |= 1 << bit;
        self.box_pairs |= u64::from(source == ManifoldSource::BoxPair) << bit;
        self.kept |= u64::from(source == ManifoldSource::Kept) << bit;
    }

    #[inline]
    fn iter(self) -> impl Iterator<Item = (usize, ManifoldSource)> {
        let (mut near, NearContacts { start, box_pairs, kept, .. }) = (self.near, self);
        core::iter::from_fn(move || {
            let bit = near.trailing_zeros();
            near &= near.checked_sub(1)?;
            let source = match (kept >> bit & 1, box_pairs >> bit & 1) {
                (1, _) => ManifoldSource::Kept,
                (_, 1) => ManifoldSource::BoxPair,
                _ => ManifoldSource::Shapes,
            };
            Some((start + bit as usize, source))
        })
    }
}

impl NarrowPhase<'_> {
    /// Whether joints may change the motion of a body in the tick, so that the pose at its impact cannot be predicted.
    fn is_held(&self, side: &Side<'_>) -> bool {
        side.body.is_dynamic() && self.awake.is_held(side.shape.body().slot())
    }

    fn run(&self, mut job: Job<'_>, output: &mut NarrowPhaseOutput) {
        let Some(pair) = job.contacts.first().map(|contact| contact.shapes) else { return };
        let mut touched = &self.touched[self.touched.partition_point(|touched| touched.shapes < pair)..];
        for start in (0..job.contacts.len()).step_by(BLOCK) {
            let block = start..job.contacts.len().min(start + BLOCK);
            let near = self.find_near(&mut job, block, output);
            touched = self.find_touching(&mut job, near, touched, output);
        }
    }

    /// Finds the near contacts of a block, and collides the pairs of small boxes among them.
    fn find_near(
        &self,
        job: &mut Job<'_>,
        block: Range<usize>,
        output: &mut NarrowPhaseOutput,
    ) -> NearContacts {
        let NarrowPhase { state, poses, margins, machine, .. } = self;
        let NarrowPhaseOutput { boxes, recycled, .. } = output;
        let motion = poses.motion();
        boxes.clear();
        recycled.clear();
        let mut near = NearContacts { start: block.start, near: 0, box_pairs: 0, kept: 0 };
        for index in block {
            if let Some(ahead) = job.contacts.get(index + CONTACTS_AHEAD) {
                motion.prefetch(ahead.shapes.1);
                poses.boxes().prefetch(ahead.shapes.1);
            }
            let contact = &mut job.contacts[index];
            let (shape_a, shape_b) = (motion.shape(contact.shapes.0), motion.shape(contact.shapes.1));
            let closing = ClosingBound::of(margins, shape_a, shape_b);
            if contact.count > 0 && contact.kept.can_be_kept() {
                let recycling = Recycling::new(state, margins, closing, [shape_a, shape_b], contact.count);
                if let Some(found) = recycling.recycle(contact) {
                    recycled.push(found);
                    near.add(index, ManifoldSource::Kept);
                    continue;
                }
            }
            if !closing.may_meet(shape_a, shape_b) {
                contact.passing = false;
                continue;
            }
            let is_box_pair = machine.vectors().is_some() && shape_a.small_box && shape_b.small_box && {
                let radii = [shape_a.radius, shape_b.radius];
                boxes.push(contact.shapes, shape_a.offset_to(shape_b), radii, closing.margin)
            };
            if !is_box_pair {
                poses.prefetch(contact.shapes.1);
            }
            if closing.is_fast() {
                motion.prefetch_motions(shape_a, shape_b);
            }
            near.add(index, if is_box_pair { ManifoldSource::BoxPair } else { ManifoldSource::Shapes });
        }
        boxes.collide(*machine, poses.boxes());
        near
    }

    /// Finds the manifolds of the near contacts of a block. Adds those with points, and their contacts, to `output`.
    /// `touched` lists the active contacts of the last tick from this block on, sorted by pair. Returns the part of
    /// `touched` for the next block.
    fn find_touching<'t>(
        &self,
        job: &mut Job<'_>,
        near: NearContacts,
        mut touched: &'t [ActiveContact],
        output: &mut NarrowPhaseOutput,
    ) -> &'t [ActiveContact] {
        let NarrowPhase { state, poses, margins, .. } = self;
        let NarrowPhaseOutput { boxes, recycled, contacts, manifolds, touching, approaches, impacts, sat } =
            output;
        let motion = poses.motion();
        let (mut box_pairs, mut recycled) = (0.., recycled.iter().peekable());
        for (index, source) in near.iter() {
            let (contact, axis) = (&mut job.contacts[index], &mut job.axes[index]);
            let index = job.first + u32::try_from(index).expect("fewer than 2^32 contacts");
            let (shape_a, shape_b) = (motion.shape(contact.shapes.0), motion.shape(contact.shapes.1));
            if shape_a.sensor || shape_b.sensor {
                // Sensors have no manifolds: see `sensor_events.rs`.
                continue;
            }
            let closing = ClosingBound::of(margins, shape_a, shape_b);
            let pair = SpeculativePair { margins, a: shape_a, b: shape_b, closing };
            let is_kept = source == ManifoldSource::Kept;
            let box_pair = if source == ManifoldSource::BoxPair { box_pairs.next() } else { None };
            match recycled.next_if(|_| is_kept) {
                Some(found) => manifolds.push(contact.kept_manifold(found.origin, found.separations)),
                None if box_pair.is_some_and(|at| boxes.append_to(manifolds, at, shape_a.centre())) => {
                    sat.searches += 1;
                }
                None => manifolds.push(manifold_of(poses, &pair, contact.shapes, axis, sat)),
            }
            let place = u32::try_from(manifolds.len()).expect("fewer than 2^32 contacts") - 1;
            let Some(manifold) = manifolds.last_mut() else { continue };
            // Displacements of the bodies from the start of the tick to the time of the manifold. They are 0 unless
            // this is the time of impact.
            let mut moved_by = [Vec2::ZERO; 2];
            if !is_kept {
                keep_reachable(state, poses, &pair, contact, self.passing, manifold, sat);
                if manifold.points().is_empty() {
                    manifolds.pop();
                    continue;
                }
                let impact = self.impact(&pair, contact.shapes, manifold, sat);
                let recycling = Recycling::new(state, margins, closing, [shape_a, shape_b], manifold.count());
                recycling.keep(contact, manifold);
                if let Some(impact) = impact {
                    let bodies = [shape_a.body, shape_b.body];
                    impacts.push(impact.pending(place, index, bodies, (*manifold, contact.kept)));
                    if let Impact::At { manifold: at_impact, moved, .. } = impact {
                        *manifold = at_impact;
                        recycling.keep_impact(contact, manifold, moved);
                        moved_by = moved;
                    }
                }
            }
            contacts.push(index);
            let mut is_hit = false;
            if (shape_a.hit_events || shape_b.hit_events)
                && let Some(approach) = fast_approach(state, motion, index, contact, manifold, moved_by)
            {
                approaches.push(approach);
                is_hit = true;
            }
            while touched.first().is_some_and(|touched| touched.shapes < contact.shapes) {
                touched = &touched[1..];
            }
            let last = touched.first().filter(|touched| touched.shapes == contact.shapes);
            let surface = last.map_or_else(|| surface_of(state, poses, contact.shapes), |last| last.surface);
            let extras = surface.has_extras() || is_hit;
            touching.push(ActiveContact {
                contact: index,
                manifold: place,
                shapes: contact.shapes,
                bodies: (shape_a.body, shape_b.body),
                surface,
                is_impact: closing.is_longer_than(margins.impact),
                is_hit,
                extras,
                keeps_rows: is_kept && last.is_some() && !extras,
            });
        }
        touched
    }

    /// The impact of the shapes of a pair, if its manifold at the start of the tick does not suffice.
    #[inline(always)]
    fn impact(
        &self,
        pair: &SpeculativePair,
        (a, b): Pair,
        manifold: &Manifold,
        counters: &mut SatCounters,
    ) -> Option<Impact> {
        if !pair.may_impact(manifold) {
            return None;
        }
        let sides = [a, b].map(|slot| Side::of(self.state, self.poses, slot));
        if sides.iter().any(|side| self.is_held(side)) {
            return None;
        }
        pair.impact(sides, self.poses.motion(), manifold, counters)
    }
}

/// Whether two shapes would have contact points that the solver has to solve. Changes no state.
pub(super) fn will_touch(state: &State, poses: &Poses, shapes: Pair) -> bool {
    // The contacts of bodies that were woken in this tick are still in the list of sleeping contacts.
    let in_list = |contacts: &[Contact]| {
        contacts.binary_search_by_key(&shapes, |contact| contact.shapes).ok().map(|index| contacts[index])
    };
    let found = in_list(&state.contacts).or_else(|| in_list(&state.sleeping_contacts));
    let mut contact = found.unwrap_or(Contact::new(shapes));
    let margins = Margins::of(&state.config);
    let (a, b) = (poses.motion().shape(shapes.0), poses.motion().shape(shapes.1));
    let closing = ClosingBound::of(&margins, a, b);
    let pair = SpeculativePair { margins: &margins, a, b, closing };
    closing.may_meet(a, b) && {
        let (mut axis, mut counters) = (CachedAxis::default(), SatCounters::default());
        let mut manifold = manifold_of(poses, &pair, shapes, &mut axis, &mut counters);
        keep_reachable(state, poses, &pair, &mut contact, &[], &mut manifold, &mut counters);
        !manifold.points().is_empty()
    }
}

#[inline(always)]
fn manifold_of(
    poses: &Poses,
    pair: &SpeculativePair,
    (a, b): Pair,
    axis: &mut CachedAxis,
    counters: &mut SatCounters,
) -> Manifold {
    let (posed_a, posed_b) = (poses.at(a), poses.at(b));
    collide_near(posed_a, posed_b, pair.closing.margin, axis, counters)
}

/// Removes the points that the shapes do not reach within the tick. Removes all points if the shapes pass by each
/// other, or if one of them passes through the other, which is a one-way shape.
#[inline(always)]
fn keep_reachable(
    state: &State,
    poses: &Poses,
    pair: &SpeculativePair,
    contact: &mut Contact,
    passing: &[Passing],
    manifold: &mut Manifold,
    counters: &mut SatCounters,
) {
    let was_passing = core::mem::take(&mut contact.passing);
    if manifold.points().is_empty() {
        return;
    }
    let (a, b) = contact.shapes;
    if pair.a.one_way || pair.b.one_way {
        let sides = [a, b].map(|slot| Side::of(state, poses, slot));
        // Shapes that first touch later in the tick may then touch with other faces than those of `manifold`, which
        // were the nearest ones at the start.
        let mut at_touch = *manifold;
        if pair.may_impact(manifold)
            && let Some(Impact::At { manifold, .. }) = pair.impact(sides, poses.motion(), manifold, counters)
        {
            at_touch = manifold;
        }
        let goes_on =
            was_passing || contact.count == 0 && passing::is_beside(passing, contact.shapes, poses.motion());
        contact.passing = pair.lets_pass(sides, &at_touch, goes_on);
        if contact.passing {
            *manifold = Manifold::NONE;
            return;
        }
    }
    // Passes a closure, because posed shapes are large and only a few contacts need them.
    pair.keep_reachable(manifold, poses.motion(), || [poses.at(a), poses.at(b)]);
}

fn surface_of(state: &State, poses: &Poses, (a, b): Pair) -> Surface {
    let side = |slot: u32| SurfaceSide {
        material: state.shapes.at(slot).material(),
        radius: poses.at(slot).outline.radius(),
    };
    Surface::between(side(a), side(b), state.config.solver.restitution_threshold)
}

/// The hit event of a contact that approaches at `hit_speed` or more; `None` for a slower contact. The event is
/// reported only if the solver then finds a contact impulse. `moved_by` has the displacements of the bodies from the
/// start of the tick until the time of the manifold.
fn fast_approach(
    state: &State,
    motion: &MotionCache,
    index: u32,
    contact: &Contact,
    manifold: &Manifold,
    moved_by: [Vec2<Length>; 2],
) -> Option<PendingHit> {
    let body_motion = |shape: u32, by: Vec2<Length>| {
        let start = motion.motion(motion.shape(shape));
        PredictedMotion { centre: start.centre + by.widen(), ..*start }
    };
    let (a, b) = contact.shapes;
    let closing_at = approach(&body_motion(a, moved_by[0]), &body_motion(b, moved_by[1]), manifold);
    let closings = manifold.points().iter().map(|point| (point, closing_at(point)));
    let (point, closing) = closings.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let metres = Fx::from_bits(closing.saturating_mul(1 << (Fx::FRAC_NBITS - Step::FRAC_NBITS)));
    let approach_speed = metres.saturating_mul_int(state.config.tick_rate.into());
    if approach_speed < state.config.hit_speed {
        return None;
    }
    let point = manifold.origin + point.anchor.widen();
    let ContactEvent { shape_a, shape_b } = state.contact_event(contact);
    let normal = manifold.normal;
    let event = HitEvent { shape_a, shape_b, point, normal, approach_speed, impulse: Fx::ZERO };
    Some(PendingHit { contact: index, event })
}
