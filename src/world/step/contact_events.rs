//! Contact events, hit events, and the ends of sensor overlaps that edits or the pair update have caused. The step
//! reports these events before it moves the bodies. It reports the other sensor events afterwards: see
//! `sensor_events.rs`.

use super::sensor_events::push_sensor_events;
use crate::collision::{Contact, Manifold};
use crate::math::{Fx, fx_mul, widen};
use crate::solver::ContactResults;
use crate::world::cache::{MotionCache, Scratch};
use crate::world::events::{Events, HitEvent};
use crate::world::islands::contact_ended;
use crate::world::state::{Reported, State};

/// Reports pairs that begin or cease to touch. A pair touches if it is near at the start of the tick, or if the solver
/// has pushed it apart. The second condition covers a fast bounce, which may begin and end within the tick.
pub(super) fn report_contacts(state: &mut State, scratch: &mut Scratch) {
    let Scratch { results, pairs, shapes, contacts: cache, solver, .. } = scratch;
    let (events, motion, output) = (&mut results.events, shapes.motion(), cache.output());
    let ContactResults { pushed, hit_impulses } = &solver.results;
    events.clear();
    for removed in state.removed_contacts.drain(..) {
        end(Some(removed), events);
    }
    for contact in pairs.ended.drain(..).filter(|contact| contact.touching) {
        end(reported(state, motion, &contact), events);
        if !is_with_sensor(motion, &contact) || state.has_area(contact.shapes) {
            contact_ended(state, contact.shapes);
        }
    }
    let (near, apart) = (state.config.touching_distance(), state.config.speculative_distance);
    let mut contacts = core::mem::take(&mut state.contacts);
    let mut manifolds = output.contacts.iter().zip(&output.manifolds).peekable();
    for (index, contact) in (0u32..).zip(&mut contacts) {
        let manifold = manifolds.next_if(|(contact, _)| **contact == index).map(|(_, manifold)| manifold);
        if manifold.is_none() {
            contact.clear_points();
            if !contact.touching || is_with_sensor(motion, contact) {
                continue;
            }
        }
        let points = manifold.map_or(&[][..], Manifold::points);
        let separation = points.iter().map(|point| widen(point.separation)).min();
        let within = |distance: Fx| separation.is_some_and(|separation| separation <= distance);
        let touching = pushed[index as usize] || within(if contact.touching { apart } else { near });
        if touching != contact.touching {
            contact.touching = touching;
            let report = if touching { begin } else { end };
            report(reported(state, motion, contact), events);
            if !touching && !is_with_sensor(motion, contact) {
                contact_ended(state, contact.shapes);
            }
        }
    }
    state.contacts = contacts;
    let hits = output.approaches.iter().filter(|hit| pushed[hit.contact as usize]);
    events.hits.extend(hits.map(|hit| {
        let speed = widen(hit_impulses[hit.contact as usize]);
        let mass = state.reduced_mass(state.contacts[hit.contact as usize].shapes);
        HitEvent { impulse: fx_mul(speed, mass), ..hit.event }
    }));
    events.contact_end.sort_unstable();
    events.sensor_end.sort_unstable();
}

fn is_with_sensor(motion: &MotionCache, contact: &Contact) -> bool {
    motion.shape(contact.shapes.0).sensor || motion.shape(contact.shapes.1).sensor
}

/// Like [`State::reported`], but reads only the motion cache for a pair of solid shapes.
fn reported(state: &State, motion: &MotionCache, contact: &Contact) -> Option<Reported> {
    if is_with_sensor(motion, contact) {
        return state.reported(contact);
    }
    let (a, b) = (motion.shape(contact.shapes.0), motion.shape(contact.shapes.1));
    let reported = (a.is_reported || b.is_reported)
        .then(|| Reported { shapes: state.contact_event(contact), sensor: None });
    debug_assert_eq!(reported, state.reported(contact));
    reported
}

fn begin(pair: Option<Reported>, events: &mut Events) {
    // Only for solid shapes: `sensor_events.rs` reports sensors.
    events.contact_begin.extend(pair.map(|pair| pair.shapes));
}

fn end(pair: Option<Reported>, events: &mut Events) {
    match pair {
        None => {}
        Some(Reported { shapes, sensor: None }) => events.contact_end.push(shapes),
        Some(Reported { shapes, sensor: Some(side) }) => {
            let ids = (shapes.shape_a, shapes.shape_b);
            push_sensor_events(&mut events.sensor_end, ids, side, Fx::ZERO);
        }
    }
}
