//! What the contacts of a tick lead to at its end: whether shapes touch, and the events that follow from it.

use super::events::{ContactEvent, Events, SensorEvent};
use super::scratch::{Poses, Scratch};
use super::state::{Reported, Side, State};
use crate::collision::{Contact, Manifold};
use crate::math::{Fx, widen};

/// Turns changes of touching into events. A pair touches if it is near at the start of the tick, or if the solver
/// has pushed it apart since: a fast bounce may begin and end between two ticks.
pub(super) fn report(state: &mut State, scratch: &mut Scratch) {
    scratch.events.clear();
    for removed in state.removed_contacts.drain(..) {
        end(Some(removed), &mut scratch.events);
    }
    let Scratch { events, ended, poses, .. } = scratch;
    for contact in ended.drain(..).filter(|contact| contact.touching) {
        end(reported(state, poses, &contact), events);
    }
    let (near, apart) = (state.config.touching_distance(), state.config.speculative_distance);
    let mut contacts = core::mem::take(&mut state.contacts);
    let Scratch { events, found, poses, solver, .. } = scratch;
    let mut sensors = found.sensors.iter().peekable();
    let mut found = found.contacts.iter().zip(&found.manifolds).peekable();
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
        let touching = if sensors.next_if_eq(&&index).is_some() {
            within(Fx::ZERO)
        } else {
            solver.pushed[index as usize] || within(if contact.touching { apart } else { near })
        };
        if touching != contact.touching {
            contact.touching = touching;
            let report = if touching { begin } else { end };
            report(reported(state, poses, contact), events);
        }
    }
    state.contacts = contacts;
    let Scratch { events, found, solver, .. } = scratch;
    let hits = found.approaches.iter().filter(|hit| solver.pushed[hit.contact as usize]);
    events.hits.extend(hits.map(|hit| hit.event));
    events.contact_end.sort_unstable();
    events.sensor_begin.sort_unstable();
    events.sensor_end.sort_unstable();
}

/// [`State::reported`], from what is known of the shapes without a look at them.
fn reported(state: &State, poses: &Poses, contact: &Contact) -> Option<Reported> {
    let (a, b) = (poses.outlook.reach(contact.shapes.0), poses.outlook.reach(contact.shapes.1));
    let reported = (a.is_reported || b.is_reported).then(|| Reported {
        shapes: state.contact_event(contact),
        sensor: if a.sensor { Some(Side::A) } else { b.sensor.then_some(Side::B) },
    });
    debug_assert_eq!(reported, state.reported(contact));
    reported
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
