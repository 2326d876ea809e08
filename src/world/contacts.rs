//! Contacts of a tick: their manifolds at its start, and the events that follow from them at its end.

use super::events::{ContactEvent, Events, HitEvent, SensorEvent};
use super::look_ahead::{Approach, Horizon, Outlook};
use super::scratch::{Approaching, Poses, Scratch};
use super::state::{Reported, Side, State};
use crate::collision::{AxisHint, Contact, Manifold, Pair, SatCounters, collide, collide_near, may_meet};
use crate::math::{Fx, Length, widen};
use crate::solver::{Surface, TouchingPair};

/// Narrow phase: a manifold for every contact, and the list of those that the solver has to deal with.
pub(super) fn find_manifolds(state: &mut State, scratch: &mut Scratch) {
    let Scratch { hints, manifolds, found, approaches, touching, touched, poses, sat, .. } = scratch;
    hints.resize(state.contacts.len(), AxisHint::default());
    manifolds.clear();
    found.clear();
    approaches.clear();
    *sat = SatCounters::default();
    core::mem::swap(touching, touched);
    touching.clear();
    if core::mem::take(&mut scratch.surfaces_stale) {
        touched.clear();
    }
    let mut touched = touched.iter().peekable();
    let horizon = Horizon::of(&state.config);
    let mut contacts = core::mem::take(&mut state.contacts);
    for ((index, contact), hint) in (0u32..).zip(&mut contacts).zip(hints) {
        let manifold = manifold_of(state, &horizon, poses, contact, hint, sat);
        if manifold.points().is_empty() {
            continue;
        }
        let (a, b) = contact.shapes;
        let (reach_a, reach_b) = (poses.outlook.reach(a), poses.outlook.reach(b));
        if !(reach_a.sensor || reach_b.sensor) {
            while touched.next_if(|pair| pair.shapes < contact.shapes).is_some() {}
            let known = touched.next_if(|pair| pair.shapes == contact.shapes);
            touching.push(TouchingPair {
                contact: index,
                manifold: u32::try_from(manifolds.len()).expect("fewer than 2^32 contacts"),
                shapes: contact.shapes,
                bodies: (reach_a.body, reach_b.body),
                surface: known.map_or_else(|| surface_of(state, poses, contact.shapes), |pair| pair.surface),
            });
            if reach_a.hit_events || reach_b.hit_events {
                approaches.extend(approaching(state, &poses.outlook, index, contact, &manifold));
            }
        }
        found.push(index);
        manifolds.push(manifold);
    }
    state.contacts = contacts;
}

/// Whether two shapes have contact, or come so near within the tick that they have to be solved together.
pub(super) fn touch(state: &State, poses: &Poses, pair: Pair) -> bool {
    let known = state.contacts.binary_search_by_key(&pair, |contact| contact.shapes);
    let mut contact = known.map_or(Contact::new(pair), |index| state.contacts[index]);
    let horizon = Horizon::of(&state.config);
    let (mut hint, mut counters) = (AxisHint::default(), SatCounters::default());
    let manifold = manifold_of(state, &horizon, poses, &mut contact, &mut hint, &mut counters);
    !manifold.points().is_empty()
}

#[inline]
fn manifold_of(
    state: &State,
    horizon: &Horizon,
    poses: &Poses,
    contact: &mut Contact,
    hint: &mut AxisHint,
    counters: &mut SatCounters,
) -> Manifold {
    let (a, b) = contact.shapes;
    let (reach_a, reach_b) = (poses.outlook.reach(a), poses.outlook.reach(b));
    let approach = Approach::new(horizon, reach_a, reach_b);
    if reach_a.sensor || reach_b.sensor {
        return collide(poses.at(a), poses.at(b), Length::ZERO, hint, counters);
    }
    let was_passing = core::mem::take(&mut contact.passing);
    if !may_meet(reach_a.bounds, reach_b.bounds, approach.margin) {
        return Manifold::NONE;
    }
    let (posed_a, posed_b) = (poses.at(a), poses.at(b));
    let mut manifold = collide_near(posed_a, posed_b, approach.margin, hint, counters);
    if manifold.points().is_empty() {
        return manifold;
    }
    if reach_a.one_way || reach_b.one_way {
        let (shape_a, shape_b) = (state.shapes.at(a), state.shapes.at(b));
        let (body_a, body_b) = state.bodies_of((a, b));
        let sides = [(shape_a, body_a, posed_a), (shape_b, body_b, posed_b)];
        contact.passing = approach.lets_pass(sides, &manifold, was_passing);
        if contact.passing {
            return Manifold::NONE;
        }
    }
    approach.keep_reachable(&mut manifold, &poses.outlook, (posed_a, posed_b));
    manifold
}

fn surface_of(state: &State, poses: &Poses, (a, b): Pair) -> Surface {
    let side = |slot: u32| (state.shapes.at(slot).material(), poses.at(slot).outline.radius());
    Surface::between(side(a), side(b))
}

/// The hit that a contact may become.
fn approaching(
    state: &State,
    outlook: &Outlook,
    index: u32,
    contact: &Contact,
    manifold: &Manifold,
) -> Option<Approaching> {
    let (a, b) = contact.shapes;
    let (motion_a, motion_b) = (outlook.motion(outlook.reach(a)), outlook.motion(outlook.reach(b)));
    let normal = manifold.normal.widen();
    let speed_at = |point| (motion_a.velocity_at(point) - motion_b.velocity_at(point)).dot(normal);
    let points = manifold.points().iter().map(|point| manifold.origin + point.anchor.widen());
    let (point, approach_speed) =
        points.map(|point| (point, speed_at(point))).reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    if approach_speed < state.config.hit_speed {
        return None;
    }
    let ContactEvent { shape_a, shape_b } = state.contact_event(contact);
    let event = HitEvent { shape_a, shape_b, point, normal: manifold.normal, approach_speed };
    Some(Approaching { contact: index, event })
}

/// Turns changes of touching into events. A pair touches if it is near at the start of the tick, or if the solver
/// has pushed it apart since: a fast bounce may begin and end between two ticks.
pub(super) fn report(state: &mut State, scratch: &mut Scratch) {
    scratch.events.clear();
    for removed in state.removed_contacts.drain(..) {
        end(Some(removed), &mut scratch.events);
    }
    for contact in scratch.ended.drain(..) {
        if contact.touching {
            end(state.reported(&contact), &mut scratch.events);
        }
    }
    let (near, apart) = (state.config.touching_distance(), state.config.speculative_distance);
    let mut contacts = core::mem::take(&mut state.contacts);
    let Scratch { events, found, manifolds, poses, solver, .. } = scratch;
    let mut found = found.iter().zip(&*manifolds).peekable();
    for (index, contact) in (0u32..).zip(&mut contacts) {
        let manifold = found.next_if(|(contact, _)| **contact == index).map(|(_, manifold)| manifold);
        if manifold.is_none() {
            contact.clear_points();
            if !contact.touching {
                continue;
            }
        }
        let points = manifold.map_or(&[][..], Manifold::points);
        let separation = points.iter().map(|point| widen(point.separation)).min();
        let within = |distance: Fx| separation.is_some_and(|separation| separation <= distance);
        let (a, b) = contact.shapes;
        let touching = if poses.outlook.reach(a).sensor || poses.outlook.reach(b).sensor {
            within(Fx::ZERO)
        } else {
            solver.pushed[index as usize] || within(if contact.touching { apart } else { near })
        };
        if touching != contact.touching {
            contact.touching = touching;
            let report = if touching { begin } else { end };
            report(state.reported(contact), events);
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
