//! Sensor events: shapes that overlap a sensor at the end of the tick, or that crossed it during the tick.
//!
//! The search follows every pair with a sensor from the poses at the start of the tick to the poses at its end. These
//! are the pairs whose fat boxes overlap, because fat boxes cover the predicted motion. In addition, each shape that
//! has left its fat box is compared with all shapes along its path.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::motion::{at_start, made_motion};
use crate::body::{BodyKind, ShapeId};
use crate::collision::{Contact, Pair, SupportShape, Sweep, first_overlap, overlap};
use crate::math::{Aabb, Fx};
use crate::world::cache::Scratch;
use crate::world::events::{Events, SensorEvent};
use crate::world::islands::contact_ended;
use crate::world::state::{Side, State};

/// Work units of [`Visit::of`] for a pair without a contact.
const UNFORESEEN_WORK: u64 = 16;

/// Shapes that have left their fat boxes are compared with each other. This number of comparisons costs one work unit.
const COMPARED_PER_WORK: u64 = 16;

/// Reports overlaps with sensors, once all bodies have been moved.
pub(super) fn report_sensors(state: &mut State, scratch: &mut Scratch) {
    if !scratch.shapes.motion().may_have_sensors() {
        return;
    }
    let mut contacts = core::mem::take(&mut state.contacts);
    for contact in &mut contacts {
        if is_with_sensor(scratch, contact.shapes) {
            let visit = Visit::of(state, scratch, contact.shapes, contact.touching);
            visit.report(state, contact.shapes, &mut scratch.results.events);
            if contact.touching && !visit.is_inside && state.has_area(contact.shapes) {
                contact_ended(state, contact.shapes);
            }
            contact.touching = visit.is_inside;
        }
    }
    state.contacts = contacts;
    report_unforeseen(state, scratch);
    let events = &mut scratch.results.events;
    events.sensor_begin.sort_unstable();
    events.sensor_end.sort_unstable();
}

/// Adds an event for each sensor of the pair that detects the other shape.
pub(super) fn push_sensor_events(
    list: &mut Vec<SensorEvent>,
    (a, b): (ShapeId, ShapeId),
    side: Side,
    fraction: Fx,
) {
    if matches!(side, Side::A | Side::Both) {
        list.push(SensorEvent { fraction, sensor: a, visitor: b });
    }
    if matches!(side, Side::B | Side::Both) {
        list.push(SensorEvent { fraction, sensor: b, visitor: a });
    }
}

fn is_with_sensor(scratch: &Scratch, (a, b): Pair) -> bool {
    let motion = scratch.shapes.motion();
    motion.shape(a).sensor || motion.shape(b).sensor
}

struct Visit {
    /// Fraction of the tick at which the overlap began.
    begin: Option<Fx>,
    /// Fraction of the tick at which the overlap ended.
    end: Option<Fx>,
    is_inside: bool,
}

impl Visit {
    /// Follows a pair through the tick. `was_inside` is whether its shapes overlapped at the end of the last tick.
    fn of(state: &State, scratch: &Scratch, pair: Pair, was_inside: bool) -> Self {
        // `first_overlap` clips long segments, but only as its first shape. Only fixed bodies have segments so long that
        // they need clipping, so a shape of a fixed body is put first.
        let (a, b) = match state.body_of(pair.1).kind() {
            BodyKind::Fixed => (pair.1, pair.0),
            BodyKind::Kinematic | BodyKind::Dynamic => pair,
        };
        let [moved_a, moved_b] = [a, b].map(|shape| MovedShape::of(state, scratch, shape));
        if !moved_a.area(scratch).overlaps(moved_b.area(scratch)) {
            return Visit { begin: None, end: was_inside.then_some(Fx::ZERO), is_inside: false };
        }
        let (posed_a, posed_b) = (scratch.shapes.poses().at(a), scratch.shapes.poses().at(b));
        let origin = posed_b.centre;
        let is_inside = overlap(&SupportShape::of(posed_a, origin), &SupportShape::of(posed_b, origin));
        let first = || moved_a.first_overlap(&moved_b, scratch, Direction::Forwards);
        let last = || moved_a.first_overlap(&moved_b, scratch, Direction::Backwards).map(|f| Fx::ONE - f);
        let (begin, end) = match (was_inside, is_inside) {
            (true, true) => (None, None),
            (false, true) => (Some(first().unwrap_or(Fx::ONE)), None),
            // If the shapes do not overlap during the tick, an edit before the tick has parted them.
            (true, false) => (None, Some(last().unwrap_or(Fx::ZERO))),
            (false, false) => {
                let begin = first();
                // A fraction of 0 marks a change between ticks, which is sorted before the beginnings of the tick.
                (begin, begin.map(|begin| last().unwrap_or(begin).max(begin).max(Fx::DELTA)))
            }
        };
        Visit { begin, end, is_inside }
    }

    fn report(&self, state: &State, (a, b): Pair, events: &mut Events) {
        let Some(side) = state.sensor_of((a, b)) else { return };
        let ids = (state.shapes.handle_at(a), state.shapes.handle_at(b));
        if let Some(fraction) = self.begin {
            push_sensor_events(&mut events.sensor_begin, ids, side, fraction);
        }
        if let Some(fraction) = self.end {
            push_sensor_events(&mut events.sensor_end, ids, side, fraction);
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    Forwards,
    Backwards,
}

/// A shape, and the motion of its body in the tick.
struct MovedShape {
    shape: u32,
    body: u32,
    sweep: Sweep,
}

impl MovedShape {
    fn of(state: &State, scratch: &Scratch, shape: u32) -> Self {
        let slot = scratch.shapes.motion().shape(shape).body;
        let sweep = made_motion(state, scratch, slot);
        MovedShape { shape, body: slot, sweep }
    }

    /// Box around the shape at all times of the tick.
    fn area(&self, scratch: &Scratch) -> Aabb {
        let Sweep { start, end, turn } = self.sweep;
        let at_end = if turn == 0 {
            scratch.shapes.poses().at(self.shape).bounds
        } else {
            Aabb::new(end, end).expanded(scratch.shapes.poses().extents(self.body).radius)
        };
        at_end.swept(start - end)
    }

    /// Fraction of the tick until the first overlap, from its start or backwards from its end.
    fn first_overlap(&self, other: &MovedShape, scratch: &Scratch, direction: Direction) -> Option<Fx> {
        let (a, sweep_a) = self.sweep_in(scratch, direction);
        let (b, sweep_b) = other.sweep_in(scratch, direction);
        first_overlap(&a, &sweep_a, &b, &sweep_b)
    }

    /// The motion in a direction of time: the shape at the first pose, relative to its body's centre, and the sweep.
    fn sweep_in(&self, scratch: &Scratch, direction: Direction) -> (SupportShape, Sweep) {
        let Sweep { start, end, turn } = self.sweep;
        let at_end = SupportShape::of(scratch.shapes.poses().at(self.shape), end);
        match direction {
            Direction::Backwards => (at_end, Sweep { start: end, end: start, turn: turn.wrapping_neg() }),
            Direction::Forwards => (at_start(at_end, &self.sweep), self.sweep),
        }
    }
}

/// Reports sensor pairs that have no contact but overlapped in the tick, because a shape has left its fat box. A pair
/// that overlaps at the end of the tick becomes a contact, or is left out at the pair limit.
fn report_unforeseen(state: &mut State, scratch: &mut Scratch) {
    if scratch.sweeps.left_boxes.is_empty() {
        return;
    }
    let left = u64::try_from(scratch.sweeps.left_boxes.len()).unwrap_or(u64::MAX);
    // In the worst case each shape is compared with every other.
    if !scratch.meter.spend(left.saturating_mul(1 + left / COMPARED_PER_WORK)) {
        return;
    }
    let mut pairs = core::mem::take(&mut scratch.pairs.buffers.pairs);
    list_unforeseen(state, scratch, &mut pairs);
    for &pair in &pairs {
        if !scratch.meter.spend(UNFORESEEN_WORK) {
            break;
        }
        let visit = Visit::of(state, scratch, pair, false);
        let is_full = state.contacts.len() >= state.config.pair_limit as usize;
        if visit.is_inside && is_full {
            continue;
        }
        visit.report(state, pair, &mut scratch.results.events);
        if !visit.is_inside {
            continue;
        }
        if let Err(at) = state.contacts.binary_search_by_key(&pair, |contact| contact.shapes) {
            state.contacts.insert(at, Contact { touching: true, ..Contact::new(pair) });
            scratch.contacts.insert(at);
        }
    }
    scratch.pairs.buffers.pairs = pairs;
}

/// Lists, in order, the sensor pairs without a contact that have a shape outside of its fat box.
fn list_unforeseen(state: &State, scratch: &Scratch, pairs: &mut Vec<Pair>) {
    pairs.clear();
    let left = &scratch.sweeps.left_boxes;
    let mut consider = |a: u32, b: u32| {
        let pair = (a.min(b), a.max(b));
        let is_known = || state.contacts.binary_search_by_key(&pair, |contact| contact.shapes).is_ok();
        let is_new = a != b && is_with_sensor(scratch, pair) && !is_known();
        if is_new && scratch.pairs.non_colliding.may_touch(state, pair) {
            pairs.push(pair);
        }
    };
    for &shape in left {
        let area = MovedShape::of(state, scratch, shape).area(scratch);
        scratch.shapes.broad_phase().each_overlap(area, |other| {
            consider(shape, other);
            ControlFlow::Continue(())
        });
    }
    // A new fat box need not cover the path of its shape. The broad phase may therefore miss a pair of shapes that have
    // both left their box.
    let is_sensor = |shape: &&u32| scratch.shapes.motion().shape(**shape).sensor;
    for &sensor in left.iter().filter(is_sensor) {
        left.iter().for_each(|&shape| consider(sensor, shape));
    }
    pairs.sort_unstable();
    pairs.dedup();
}
