//! Sleeping: bodies that rest, and everything they are in contact with or joined to, stop together and cost nothing
//! until something wakes them.
//!
//! A body is sleepy once it has been slower than its `sleep_speed` for half a second. An island is what contacts and
//! joints between dynamic bodies connect; it falls asleep when all its bodies are sleepy. It wakes as a whole:
//! - when an active body comes into contact with one of its bodies,
//! - when a force, an impulse, a velocity, another place or another property is given to one of its bodies,
//! - when a joint is added to or removed from one of its bodies,
//! - when a body or a shape that touches or overlaps its boxes is moved by hand, changed or removed,
//! - when gravity changes.
//!
//! Bodies that touch a kinematic body which moves do not grow sleepy.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::manifolds::Found;
use super::pairs;
use super::scratch::Scratch;
use super::state::{Island, State};
use crate::body::{Body, BodyKind, Handle, IslandId};
use crate::collision::{AxisHint, Contact};
use crate::math::{Fx, Shift, Speed, Vec2, narrow};
use crate::solver::SolverBody;

/// The bodies and joints that a tick has to do with, in slot order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Roster {
    /// Dynamic bodies that are awake, and kinematic ones.
    pub(crate) bodies: Vec<u32>,
    /// Joints of which a body is awake.
    pub(crate) joints: Vec<u32>,
    /// Those of them that do not bear everything.
    pub(crate) breakable: Vec<u32>,
    current: bool,
}

impl Roster {
    /// Says that bodies or joints have come, gone, woken or fallen asleep.
    pub(crate) fn invalidate(&mut self) {
        self.current = false;
    }

    pub(crate) fn refresh(&mut self, state: &State) {
        if core::mem::replace(&mut self.current, true) {
            return;
        }
        self.bodies.clear();
        self.bodies.extend(state.bodies.iter().filter(|(_, body)| works(body)).map(|(id, _)| id.slot()));
        self.joints.clear();
        self.joints.extend(state.joints.iter().filter_map(|(id, joint)| {
            let (a, b) = joint.def().bodies();
            let (a, b) = (state.bodies.at(a.slot()), state.bodies.at(b.slot()));
            let held = a.enabled && b.enabled && joint.is_solved();
            (held && (is_awake(a) || is_awake(b))).then_some(id.slot())
        }));
        self.breakable.clear();
        let breaks = |&&slot: &&u32| state.joints.at(slot).def().threshold.is_set();
        self.breakable.extend(self.joints.iter().filter(breaks));
    }
}

/// Whether a body takes part in every tick.
fn works(body: &Body) -> bool {
    body.enabled && body.kind() != BodyKind::Fixed && !body.is_asleep()
}

/// Whether a body is dynamic and simulated.
fn is_awake(body: &Body) -> bool {
    body.is_dynamic() && body.enabled && !body.is_asleep()
}

/// Disjoint sets of body slots (R. Tarjan, "Efficiency of a Good But Not Linear Set Union Algorithm", 1975). Only
/// which bodies end up together is used, and that does not depend on the order of unions.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnionFind {
    parents: Vec<u32>,
    /// For each root, whether a body of its set cannot sleep yet.
    restless: Vec<bool>,
}

impl UnionFind {
    /// Each body for itself.
    pub(super) fn reset(&mut self, slots: &[u32], slot_count: usize) {
        self.parents.resize(slot_count, 0);
        self.restless.resize(slot_count, false);
        for &slot in slots {
            self.parents[slot as usize] = slot;
        }
    }

    pub(super) fn root(&mut self, mut slot: u32) -> u32 {
        while self.parents[slot as usize] != slot {
            let grandparent = self.parents[self.parents[slot as usize] as usize];
            self.parents[slot as usize] = grandparent;
            slot = grandparent;
        }
        slot
    }

    /// The smallest slot of a set is its root.
    pub(super) fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}

/// Wakes an island. Its contacts are looked at again when the pairs are next updated.
pub(super) fn wake(state: &mut State, scratch: &mut Scratch, island: IslandId) {
    let Some(island) = state.islands.remove(island) else { return };
    for slot in island.bodies {
        let body = state.bodies.at_mut(slot);
        body.island = None;
        body.rest_ticks = 0;
        scratch.changes.body(body);
    }
    scratch.changes.resting = true;
    scratch.roster.invalidate();
}

/// Wakes what active bodies have come into contact with, and what that is in contact with in turn: wave after wave,
/// each of which looks only at the pairs of those that the one before has woken.
pub(super) fn wake_touched(state: &mut State, scratch: &mut Scratch) {
    if state.islands.len() == 0 {
        return;
    }
    let outlook = &scratch.poses.outlook;
    let has_sleeper = |contact: &&Contact| {
        let (a, b) = (outlook.reach(contact.shapes.0), outlook.reach(contact.shapes.1));
        let asleep = |body: u32| state.bodies.at(body).is_asleep();
        !(a.sensor || b.sensor) && (asleep(a.body) || asleep(b.body))
    };
    scratch.pairs.clear();
    scratch.pairs.extend(state.contacts.iter().filter(has_sleeper).map(|contact| contact.shapes));
    while !scratch.pairs.is_empty() {
        let first_change = scratch.changes.shapes.len();
        let wave = core::mem::take(&mut scratch.pairs);
        for &pair in &wave {
            // Another pair may have woken it already.
            let (a, b) = state.bodies_of(pair);
            let Some(island) = a.island.or(b.island) else { continue };
            if super::manifolds::touch(state, &scratch.poses, pair) {
                wake(state, scratch, island);
            }
        }
        scratch.pairs = wave;
        pairs::find_sleepers(state, scratch, first_change);
    }
    pairs::update(state, scratch);
}

/// Counts for how long bodies have been at rest, and lets islands of sleepy bodies fall asleep.
pub(super) fn fall_asleep(state: &mut State, scratch: &mut Scratch) {
    if !state.config.sleeping {
        return;
    }
    let limit = state.config.ticks_to_sleep();
    if scratch.kinematic {
        keep_awake_on_moving_ground(state, scratch);
        keep_awake_on_moving_anchors(state, scratch);
    }
    let mut any_sleepy = false;
    for &slot in &scratch.roster.bodies {
        let body = state.bodies.at_mut(slot);
        if body.is_dynamic() {
            let slow = is_slow(body, scratch.solver.body(slot), state.config.tick_rate);
            body.rest_ticks = if slow { body.rest_ticks.saturating_add(1).min(limit) } else { 0 };
        }
        any_sleepy |= body.is_dynamic() && body.rest_ticks == limit;
    }
    if any_sleepy {
        scratch.union.reset(&scratch.roster.bodies, state.bodies.slot_count());
        unite_joined(state, scratch);
        unite_touching(state, &mut scratch.union, &state.contacts);
        put_to_sleep(state, scratch, |body| body.rest_ticks == limit);
    }
}

/// Puts a body to sleep, and all that it is in contact with or joined to.
pub(super) fn force_sleep(state: &mut State, scratch: &mut Scratch, slot: u32) {
    scratch.roster.refresh(state);
    scratch.union.reset(&scratch.roster.bodies, state.bodies.slot_count());
    unite_joined(state, scratch);
    unite_touching(state, &mut scratch.union, &state.contacts);
    // What has been woken since the last tick still has its contacts there.
    unite_touching(state, &mut scratch.union, &state.resting);
    let root = scratch.union.root(slot);
    for &other in &scratch.roster.bodies {
        // Not a count that a body reaches by itself: it marks those that are meant.
        if scratch.union.root(other) == root {
            state.bodies.at_mut(other).rest_ticks = u32::MAX;
        }
    }
    put_to_sleep(state, scratch, |body| body.rest_ticks == u32::MAX);
}

fn keep_awake_on_moving_ground(state: &mut State, scratch: &Scratch) {
    for pair in &scratch.found.touching {
        keep_awake(state, scratch, pair.bodies);
    }
}

/// What hangs from a body that moves does not rest either.
fn keep_awake_on_moving_anchors(state: &mut State, scratch: &Scratch) {
    for &joint in &scratch.roster.joints {
        let (a, b) = state.joints.at(joint).def().bodies();
        keep_awake(state, scratch, (a.slot(), b.slot()));
    }
}

fn keep_awake(state: &mut State, scratch: &Scratch, (a, b): (u32, u32)) {
    let bodies = &mut state.bodies;
    for (ground, other) in [(a, b), (b, a)] {
        // One that is moved to a place has already stopped there.
        let moved = || {
            let solved = scratch.solver.body(ground);
            solved.velocity != Vec2::ZERO || solved.spin != 0
        };
        if bodies.at(ground).kind() == BodyKind::Kinematic && moved() {
            bodies.at_mut(other).rest_ticks = 0;
        }
    }
}

/// Whether a body was slow in this tick. Both its velocity and how far it came count: overlap is pushed out without
/// a velocity that lasts.
fn is_slow(body: &Body, solved: &SolverBody, tick_rate: u32) -> bool {
    let square = |x: i32| i64::from(x) * i64::from(x);
    // Twice the speed at the radius of gyration is about that of the outline. Displacements may have saturated.
    let fastest =
        |x: i32, y: i32, turn: i32| square(x).saturating_add(square(y)).max(square(turn).saturating_mul(4));
    let limit: Speed = narrow(body.settings.sleep_speed);
    let reach: Shift = narrow(body.settings.sleep_speed / i64::from(tick_rate));
    let (v, d) = (body.velocity, solved.shift);
    body.settings.may_sleep
        && fastest(v.x.to_bits(), v.y.to_bits(), body.spin.to_bits()) < square(limit.to_bits())
        && fastest(d.x.to_bits(), d.y.to_bits(), solved.turn.to_bits()) < square(reach.to_bits())
}

/// Unites the bodies of every joint.
fn unite_joined(state: &State, scratch: &mut Scratch) {
    let Scratch { roster, union, .. } = scratch;
    for &joint in &roster.joints {
        let (a, b) = state.joints.at(joint).def().bodies();
        unite(state, union, a.slot(), b.slot());
    }
}

/// Unites the bodies of every contact.
pub(super) fn unite_touching(state: &State, union: &mut UnionFind, contacts: &[Contact]) {
    for contact in contacts.iter().filter(|contact| contact.count > 0) {
        let (a, b) = contact.shapes;
        unite(state, union, state.shapes.at(a).body().slot(), state.shapes.at(b).body().slot());
    }
}

pub(super) fn unite(state: &State, union: &mut UnionFind, a: u32, b: u32) {
    if is_awake(state.bodies.at(a)) && is_awake(state.bodies.at(b)) {
        union.unite(a, b);
    }
}

/// Makes an island of every set of bodies that are all sleepy.
fn put_to_sleep(state: &mut State, scratch: &mut Scratch, sleepy: impl Fn(&Body) -> bool) {
    let Scratch { roster, union, .. } = scratch;
    for &slot in &roster.bodies {
        union.restless[slot as usize] = false;
    }
    for &slot in &roster.bodies {
        let root = union.root(slot);
        union.restless[root as usize] |= !sleepy(state.bodies.at(slot));
    }
    let mut asleep = false;
    for &slot in &roster.bodies {
        let root = union.root(slot);
        if union.restless[root as usize] {
            continue;
        }
        // Slots are in order and the root is the smallest: its island is there before the others come.
        let island = match state.bodies.at(root).island {
            Some(island) => island,
            None => state.islands.insert(Island { bodies: Vec::new() }),
        };
        state.islands.redefine(island.slot()).bodies.push(slot);
        let body = state.bodies.at_mut(slot);
        body.island = Some(island);
        body.rest_ticks = 0;
        body.stop();
        (body.force, body.torque) = (Vec2::ZERO, Fx::ZERO);
        asleep = true;
    }
    if asleep {
        scratch.roster.invalidate();
        // Boxes may have parted since the pairs were looked at.
        scratch.changes.resting = true;
        rest_contacts(state, scratch);
    }
}

/// Wakes the island of a body, and lets the body itself begin to rest anew.
pub(super) fn wake_body(state: &mut State, scratch: &mut Scratch, slot: u32) {
    let body = state.bodies.at_mut(slot);
    let was_active = body.is_active();
    body.rest_ticks = 0;
    match body.island {
        Some(island) => wake(state, scratch, island),
        None if body.is_active() && !was_active => {
            scratch.changes.body(body);
            scratch.changes.resting = true;
        }
        None => {}
    }
}

/// Wakes a body and everything whose boxes overlap its own: it is about to change, or has just changed.
pub(super) fn disturb(state: &mut State, scratch: &mut Scratch, slot: u32) {
    wake_body(state, scratch, slot);
    for index in 0..state.bodies.at(slot).shapes().len() {
        let shape = state.bodies.at(slot).shapes()[index];
        disturb_around(state, scratch, shape.slot());
    }
}

/// Wakes everything whose boxes overlap that of a shape.
pub(super) fn disturb_around(state: &mut State, scratch: &mut Scratch, shape: u32) {
    // Only who sleeps and kinematic bodies at rest can be woken. Many shapes may lie here, and most worlds that are
    // being set up have neither.
    if state.islands.len() == 0 && !scratch.kinematic {
        return;
    }
    let mut neighbours = Vec::new();
    scratch.broad_phase.each_overlap(state.shapes.at(shape).fat, |other| {
        let slot = state.shapes.at(other).body().slot();
        let body = state.bodies.at(slot);
        if body.kind() != BodyKind::Fixed && !body.is_active() {
            neighbours.push(slot);
        }
        ControlFlow::Continue(())
    });
    // The broad phase finds them in any order.
    neighbours.sort_unstable();
    for body in neighbours {
        wake_body(state, scratch, body);
    }
}

/// Sets the contacts aside of which no body is active any more, with their manifolds.
fn rest_contacts(state: &mut State, scratch: &mut Scratch) {
    if scratch.hints.len() != state.contacts.len() {
        // There are none since a restore, or since a contact was removed.
        scratch.hints.resize(state.contacts.len(), AxisHint::default());
    }
    let Scratch { found: Found { manifolds, contacts: found, .. }, hints, parked, merged, .. } = scratch;
    let mut contacts = core::mem::take(&mut state.contacts);
    parked.clear();
    let (mut kept, mut next, mut kept_manifolds) = (0, 0, 0);
    for index in 0..contacts.len() {
        let (a, b) = state.bodies_of(contacts[index].shapes);
        let active = a.is_active() || b.is_active();
        if found.get(next).is_some_and(|&contact| contact as usize == index) {
            if active {
                manifolds.swap(kept_manifolds, next);
                found[kept_manifolds] =
                    found[next] - u32::try_from(index - kept).expect("fewer than 2^32 contacts");
                kept_manifolds += 1;
            }
            next += 1;
        }
        if active {
            contacts.swap(kept, index);
            hints.swap(kept, index);
            kept += 1;
        } else {
            parked.push(contacts[index]);
        }
    }
    contacts.truncate(kept);
    hints.truncate(kept);
    manifolds.truncate(kept_manifolds);
    found.truncate(kept_manifolds);
    state.contacts = contacts;
    pairs::merge(&mut state.resting, parked, &mut merged.contacts);
}
