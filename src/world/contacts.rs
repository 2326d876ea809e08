//! Contacts of a tick: their manifolds at its start, and the events that follow from them at its end.

use super::events::{ContactEvent, Events, HitEvent, SensorEvent};
use super::look_ahead::Approach;
use super::scratch::{Approaching, Poses, Scratch};
use super::state::{Reported, Side, State};
use crate::body::Handle;
use crate::collision::{AxisHint, Contact, Manifold, Pair, SatCounters, collide};
use crate::math::{Fx, Length, widen};
use crate::solver::{Surface, TouchingPair};

/// Narrow phase: a manifold for every contact, and the list of those that the solver has to deal with.
pub(super) fn find_manifolds(state: &mut State, scratch: &mut Scratch) {
    scratch.hints.resize(state.contacts.len(), AxisHint::default());
    scratch.manifolds.clear();
    scratch.touching.clear();
    scratch.approaches.clear();
    scratch.sat = SatCounters::default();
    let mut contacts = core::mem::take(&mut state.contacts);
    for (index, contact) in (0u32..).zip(&mut contacts) {
        let hint = &mut scratch.hints[index as usize];
        let manifold = manifold_of(state, &scratch.poses, contact, hint, &mut scratch.sat);
        if !manifold.points().is_empty() && state.sensor_of(contact.shapes).is_none() {
            scratch.touching.push(touching_pair(state, &scratch.poses, index, contact));
            scratch.approaches.extend(approaching(state, index, contact, &manifold));
        }
        scratch.manifolds.push(manifold);
    }
    state.contacts = contacts;
}

/// Whether two shapes have contact, or come so near within the tick that they have to be solved together.
pub(super) fn touch(state: &State, poses: &Poses, pair: Pair) -> bool {
    let known = state.contacts.binary_search_by_key(&pair, |contact| contact.shapes);
    let mut contact = known.map_or(Contact::new(pair), |index| state.contacts[index]);
    let manifold =
        manifold_of(state, poses, &mut contact, &mut AxisHint::default(), &mut SatCounters::default());
    !manifold.points().is_empty()
}

fn manifold_of(
    state: &State,
    poses: &Poses,
    contact: &mut Contact,
    hint: &mut AxisHint,
    counters: &mut SatCounters,
) -> Manifold {
    let (a, b) = contact.shapes;
    let (posed_a, posed_b) = (poses.at(a), poses.at(b));
    if state.sensor_of((a, b)).is_some() {
        return collide(posed_a, posed_b, Length::ZERO, hint, counters);
    }
    let (body_a, body_b) = state.bodies_of((a, b));
    let approach = Approach::new(state, (body_a, posed_a), (body_b, posed_b));
    let mut manifold = collide(posed_a, posed_b, approach.margin, hint, counters);
    contact.passing =
        approach.lets_pass((state.shapes.at(a), state.shapes.at(b)), &manifold, contact.passing);
    if contact.passing {
        return Manifold::NONE;
    }
    approach.keep_reachable(&mut manifold);
    manifold
}

fn touching_pair(state: &State, poses: &Poses, index: u32, contact: &Contact) -> TouchingPair {
    let (shape_a, shape_b) = (state.shapes.at(contact.shapes.0), state.shapes.at(contact.shapes.1));
    let radius = |slot: u32| poses.at(slot).outline.radius();
    let surface = Surface::between(
        (shape_a.material(), radius(contact.shapes.0)),
        (shape_b.material(), radius(contact.shapes.1)),
    );
    TouchingPair { contact: index, bodies: (shape_a.body().slot(), shape_b.body().slot()), surface }
}

/// The hit that a contact may become.
fn approaching(state: &State, index: u32, contact: &Contact, manifold: &Manifold) -> Option<Approaching> {
    let (shape_a, shape_b) = (state.shapes.at(contact.shapes.0), state.shapes.at(contact.shapes.1));
    if !(shape_a.def.events.hit || shape_b.def.events.hit) {
        return None;
    }
    let (body_a, body_b) = state.bodies_of(contact.shapes);
    let normal = manifold.normal.widen();
    let speed_at =
        |point: crate::math::Vec2<Fx>| (body_a.velocity_at(point) - body_b.velocity_at(point)).dot(normal);
    let points = manifold.points().iter().map(|point| manifold.origin + point.anchor.widen());
    let (point, approach_speed) =
        points.map(|point| (point, speed_at(point))).reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let ContactEvent { shape_a, shape_b } = state.contact_event(contact);
    let event = HitEvent { shape_a, shape_b, point, normal: manifold.normal, approach_speed };
    (approach_speed >= state.config.hit_speed).then_some(Approaching { contact: index, event })
}

/// Turns changes of touching into events. A pair touches if it is near at the start of the tick, or if the solver
/// has pushed it apart since: a fast bounce may begin and end between two ticks.
pub(super) fn report(state: &mut State, scratch: &mut Scratch) {
    scratch.events.clear();
    for removed in core::mem::take(&mut state.removed_contacts) {
        end(Some(removed), &mut scratch.events);
    }
    for contact in core::mem::take(&mut scratch.ended) {
        if contact.touching {
            end(state.reported(&contact), &mut scratch.events);
        }
    }
    let (near, apart) = (state.config.touching_distance(), state.config.speculative_distance);
    let mut contacts = core::mem::take(&mut state.contacts);
    for (index, contact) in contacts.iter_mut().enumerate() {
        let points = scratch.manifolds[index].points();
        let separation = points.iter().map(|point| widen(point.separation)).min();
        let within = |distance: Fx| separation.is_some_and(|separation| separation <= distance);
        let touching = match state.sensor_of(contact.shapes) {
            Some(_) => within(Fx::ZERO),
            None => scratch.solver.pushed[index] || within(if contact.touching { apart } else { near }),
        };
        if touching != contact.touching {
            contact.touching = touching;
            let report = if touching { begin } else { end };
            report(state.reported(contact), &mut scratch.events);
        }
        if separation.is_none() {
            contact.clear_points();
        }
    }
    state.contacts = contacts;
    let Scratch { events, approaches, solver, .. } = scratch;
    let hits = approaches.iter().filter(|hit| solver.pushed[hit.contact as usize]);
    events.hits.extend(hits.map(|hit| hit.event));
    events.contact_end.sort_unstable();
    events.sensor_begin.sort_unstable();
    events.sensor_end.sort_unstable();
}

fn begin(pair: Option<Reported>, events: &mut Events) {
    match pair {
        None => {}
        Some(Reported { shapes, sensor: None }) => events.contact_begin.push(shapes),
        Some(Reported { shapes, sensor: Some(side) }) => events.sensor_begin.push(sensor_event(shapes, side)),
    }
}

fn end(pair: Option<Reported>, events: &mut Events) {
    match pair {
        None => {}
        Some(Reported { shapes, sensor: None }) => events.contact_end.push(shapes),
        Some(Reported { shapes, sensor: Some(side) }) => events.sensor_end.push(sensor_event(shapes, side)),
    }
}

fn sensor_event(shapes: ContactEvent, sensor: Side) -> SensorEvent {
    match sensor {
        Side::A => SensorEvent { sensor: shapes.shape_a, visitor: shapes.shape_b },
        Side::B => SensorEvent { sensor: shapes.shape_b, visitor: shapes.shape_a },
    }
}
