//! Contact events, hit events, and the ends of sensor overlaps that edits or the pair update have caused. The step
//! reports these events before it moves the bodies. It reports the other sensor events afterwards: see
//! `sensor_events.rs`.

use alloc::vec::Vec;

use super::sensor_events::push_sensor_events;
use crate::body::Handle;
use crate::collision::{Contact, Manifold, Pair};
use crate::math::{Fx, fx_mul, widen};
use crate::solver::ContactResults;
use crate::world::cache::{MotionCache, Scratch};
use crate::world::events::{ContactEvent, Events, HitEvent};
use crate::world::islands::contact_ended;
use crate::world::state::{Reported, State};

/// Reports pairs that begin or cease to touch. A pair begins to touch if the shapes are within the touching distance at
/// the start of the tick, and ceases to touch if they are further apart than the speculative distance. In addition,
/// every pair that the solver has pushed apart touches. This covers a fast bounce, which may begin and end within the
/// tick.
pub(super) fn report_contacts(state: &mut State, scratch: &mut Scratch) {
    let Scratch { results, pairs, shapes, contacts: cache, solver, .. } = scratch;
    let (events, motion, output) = (&mut results.events, shapes.motion(), cache.output());
    let ContactResults { pushed, hit_impulses } = &solver.results;
    events.clear();
    let mut changed = core::mem::take(&mut state.edited_contacts);
    for contact in pairs.ended.drain(..).filter(|contact| contact.touching) {
        changed.extend(reported(state, motion, &contact));
        if !is_with_sensor(motion, &contact) || state.has_area(contact.shapes) {
            contact_ended(state, contact.shapes);
        }
    }
    let untold = report_changed(state, &mut changed, events);
    state.edited_contacts = changed;
    let mut untold = untold.into_iter().peekable();
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
        let was_touching = core::mem::replace(&mut contact.touching, touching);
        let was_told = was_touching && untold.next_if_eq(&contact.shapes).is_none();
        if touching != was_told {
            let report = if touching { begin } else { end };
            report(reported(state, motion, contact), events);
        }
        if was_touching && !touching && !is_with_sensor(motion, contact) {
            contact_ended(state, contact.shapes);
        }
    }
    state.contacts = contacts;
    let hits = output.approaches.iter().filter(|hit| pushed[hit.contact as usize]);
    events.hits.extend(hits.map(|hit| {
        let speed = widen(hit_impulses[hit.contact as usize]);
        let mass = state.reduced_mass(state.contacts[hit.contact as usize].shapes);
        HitEvent { impulse: fx_mul(speed, mass), ..hit.event }
    }));
    events.contact_begin.sort_unstable();
    events.contact_end.sort_unstable();
    events.sensor_end.sort_unstable();
}

/// Reports the pairs whose events edits or the pair update have changed, and clears their list. Returns, in order, the
/// active pairs that touched at the end of the last tick, but whose begin has not been reported.
///
/// A pair has events while it touches and the event switches of a shape are on. `changed` has an entry for each time
/// that a pair began or ceased to have events. If a pair has an even number of entries, these changes cancel out.
fn report_changed(state: &State, changed: &mut Vec<Reported>, events: &mut Events) -> Vec<Pair> {
    let touches = |list: &[Contact], pair: &Reported| {
        // The events of sensors are not switched in this list, but a snapshot may have such an entry.
        if pair.sensor.is_some() {
            return false;
        }
        let ContactEvent { shape_a, shape_b } = pair.shapes;
        let found = list.binary_search_by_key(&(shape_a.slot(), shape_b.slot()), |contact| contact.shapes);
        found.is_ok_and(|at| list[at].touching && state.reported(&list[at]) == Some(*pair))
    };
    changed.sort_unstable();
    let mut untold = Vec::new();
    for pair in
        changed.chunk_by(PartialEq::eq).filter(|entries| entries.len() % 2 == 1).map(|entries| entries[0])
    {
        if touches(&state.contacts, &pair) {
            untold.push((pair.shapes.shape_a.slot(), pair.shapes.shape_b.slot()));
        } else if touches(&state.sleeping_contacts, &pair) {
            // An edit has put the bodies to sleep.
            begin(Some(pair), events);
        } else {
            end(Some(pair), events);
        }
    }
    changed.clear();
    untold
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
