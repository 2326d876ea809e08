use alloc::vec::Vec;

use super::areas;
use super::continuous;
use super::narrow_phase::will_touch;
use crate::collision::{Contact, Moved, Pair};
use crate::world::cache::Scratch;
use crate::world::islands::wake_island;
use crate::world::state::State;

/// Wakes the islands that active bodies touch, then the islands that the woken bodies touch, and so on. Each round
/// after the first checks only pairs of bodies woken in the previous round. Returns whether an island was woken.
pub(super) fn wake_touched(state: &mut State, scratch: &mut Scratch) -> bool {
    if state.islands.len() == 0 {
        return false;
    }
    let mut any = false;
    let mut pairs = core::mem::take(&mut scratch.pairs.buffers.pairs);
    list_pairs_with_sleepers(state, scratch, &mut pairs);
    while !pairs.is_empty() {
        let first_change = scratch.pairs.changes.shapes().len();
        for &pair in &pairs {
            // Another pair may have woken the island already.
            let (a, b) = state.bodies_of(pair);
            let Some(island) = a.island.or(b.island) else { continue };
            let wakes = match state.sensor_of(pair) {
                None => {
                    // Speculative contacts cannot predict a rotation by a large part of a turn, so the sweep is
                    // consulted as well.
                    will_touch(state, scratch.shapes.poses(), pair) || continuous::wakes(state, scratch, pair)
                }
                Some(_) => areas::wakes(state, scratch, pair),
            };
            if wakes {
                wake_island(state, scratch, island);
                any = true;
            }
        }
        find_pairs_of_woken(state, scratch, first_change, &mut pairs);
    }
    scratch.pairs.buffers.pairs = pairs;
    any
}

/// Lists the contacts with a sleeping body, between two solid shapes or between an area and a shape on which it acts.
fn list_pairs_with_sleepers(state: &State, scratch: &Scratch, pairs: &mut Vec<Pair>) {
    let motion = scratch.shapes.motion();
    let has_sleeper = |contact: &&Contact| {
        let (a, b) = (motion.shape(contact.shapes.0), motion.shape(contact.shapes.1));
        let is_asleep = |body: u32| state.bodies.at(body).is_asleep();
        let connects = !(a.sensor || b.sensor) || state.has_area(contact.shapes);
        connects && (is_asleep(a.body) || is_asleep(b.body))
    };
    pairs.clear();
    pairs.extend(state.contacts.iter().filter(has_sleeper).map(|contact| contact.shapes));
}

/// Finds the pairs of a sleeping body and a body woken since change `first_change`: two solid shapes, or an area and a
/// shape on which it acts.
fn find_pairs_of_woken(state: &State, scratch: &mut Scratch, first_change: usize, pairs: &mut Vec<Pair>) {
    let Scratch { shapes, pairs: cache, meter, .. } = scratch;
    let woken = Moved::Slots(&cache.changes.shapes()[first_change..]);
    let accept = |pair: Pair| {
        let (a, b) = state.bodies_of(pair);
        a.is_asleep() != b.is_asleep()
            && (state.sensor_of(pair).is_none() || state.has_area(pair))
            && cache.non_colliding.may_touch(state, pair)
    };
    let known = state.contacts.len() + state.sleeping_contacts.len();
    shapes.find_pairs(woken, accept, state.config.pair_limit as usize, pairs, known, meter);
}
