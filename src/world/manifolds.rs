//! The narrow phase of a tick: a manifold for every contact whose shapes are near. Those of boxes are found eight at a
//! time.

use alloc::vec::Vec;
use core::ops::Range;

use super::events::{ContactEvent, HitEvent};
use super::look_ahead::{Approach, Closing, Horizon, approach};
use super::outlook::Outlook;
use super::scratch::{Approaching, Poses, Scratch};
use super::state::State;
use crate::collision::{AxisHint, BoxPairs, Contact, Manifold, Pair, SatCounters, collide, collide_near};
use crate::lanes::Machine;
use crate::math::{Length, Step, saturate, widen};
use crate::solver::{Surface, SurfaceSide, TouchingPair};

/// Fewest contacts that are worth a job of their own.
const JOB_MIN: usize = 512;

/// How many contacts are looked at before boxes are collided: so many that few lanes stay empty, and so few that what is
/// known of them stays near.
const BLOCK: usize = 64;

/// How many contacts before it is looked at the second shape of one is asked for: those lie anywhere.
const CONTACTS_AHEAD: usize = 8;

/// A contact whose shapes may meet.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Its place among those of the job.
    index: usize,
    closing: Closing,
    /// Its place among the pairs of boxes, if it is one.
    pair: Option<usize>,
}

/// What a part of the narrow phase has found, in the order of its contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    /// The manifolds that have points, and where their contacts are.
    pub(super) manifolds: Vec<Manifold>,
    pub(super) contacts: Vec<u32>,
    /// Of these contacts, those with sensors.
    pub(super) sensors: Vec<u32>,
    /// Those that the solver has to deal with.
    pub(super) touching: Vec<TouchingPair>,
    /// Approaches that become hits if the shapes push each other in this tick.
    pub(super) approaches: Vec<Approaching>,
    pub(super) sat: SatCounters,
    /// Those of the block that is being looked at.
    candidates: Vec<Candidate>,
    boxes: BoxPairs,
}

/// Narrow phase: a manifold for every contact, and the list of those that the solver has to deal with. The contacts
/// are divided into jobs; what those find is put together in order, so that it is the same however many there are.
pub(super) fn find_manifolds(state: &mut State, scratch: &mut Scratch) {
    let Scratch { hints, found, found_parts: parts, touched, poses, solver, .. } = scratch;
    hints.resize(state.contacts.len(), AxisHint::default());
    core::mem::swap(&mut found.touching, touched);
    if core::mem::take(&mut scratch.surfaces_stale) {
        touched.clear();
    }
    let mut contacts = core::mem::take(&mut state.contacts);
    let share = solver.threads.share(contacts.len(), JOB_MIN);
    parts.resize_with(contacts.len().div_ceil(share).max(1), Found::default);
    core::mem::swap(&mut parts[0], found);
    parts.iter_mut().for_each(Found::clear);
    let (horizon, machine) = (Horizon::of(&state.config), solver.machine);
    let search = Search { state, poses, touched, horizon, machine };
    let chunks = contacts.chunks_mut(share).zip(hints.chunks_mut(share));
    let jobs = (0u32..).step_by(share).zip(chunks).zip(parts.iter_mut());
    solver.threads.run(jobs, |((first, (contacts, hints)), part)| {
        search.run(Job { contacts, hints, first }, part);
        0
    });
    core::mem::swap(&mut parts[0], found);
    parts[1..].iter().for_each(|part| found.append(part));
    state.contacts = contacts;
}

impl Found {
    /// Forgets everything but the room for it.
    pub(super) fn clear(&mut self) {
        self.manifolds.clear();
        self.contacts.clear();
        self.sensors.clear();
        self.touching.clear();
        self.approaches.clear();
        self.candidates.clear();
        self.boxes.clear();
        self.sat = SatCounters::default();
    }

    /// Adds what has been found further on.
    fn append(&mut self, further: &Found) {
        let first = place_of(&self.manifolds);
        let touching = further.touching.iter();
        self.touching.extend(touching.map(|pair| TouchingPair { manifold: first + pair.manifold, ..*pair }));
        self.manifolds.extend_from_slice(&further.manifolds);
        self.contacts.extend_from_slice(&further.contacts);
        self.sensors.extend_from_slice(&further.sensors);
        self.approaches.extend_from_slice(&further.approaches);
        self.sat.hint_hits += further.sat.hint_hits;
        self.sat.searches += further.sat.searches;
    }
}

/// Where the next manifold goes.
fn place_of(manifolds: &[Manifold]) -> u32 {
    u32::try_from(manifolds.len()).expect("fewer than 2^32 contacts")
}

/// What all jobs of the narrow phase read.
struct Search<'a> {
    state: &'a State,
    poses: &'a Poses,
    /// What touched in the tick before, sorted by pair.
    touched: &'a [TouchingPair],
    horizon: Horizon,
    machine: Machine,
}

/// The contacts that a job looks at, what separated each in the last tick, and where the first one is in the state.
struct Job<'a> {
    contacts: &'a mut [Contact],
    hints: &'a mut [AxisHint],
    first: u32,
}

impl Search<'_> {
    fn run(&self, mut job: Job<'_>, found: &mut Found) {
        let Some(pair) = job.contacts.first().map(|contact| contact.shapes) else { return };
        let mut touched = &self.touched[self.touched.partition_point(|known| known.shapes < pair)..];
        for start in (0..job.contacts.len()).step_by(BLOCK) {
            let block = start..job.contacts.len().min(start + BLOCK);
            self.list_candidates(&mut job, block, found);
            touched = self.find_touching(&mut job, touched, found);
        }
    }

    /// Lists the contacts of a block whose shapes may meet, and finds the manifolds of those between boxes.
    fn list_candidates(&self, job: &mut Job<'_>, block: Range<usize>, found: &mut Found) {
        let Search { poses, horizon, machine, .. } = self;
        let Found { candidates, boxes, .. } = found;
        candidates.clear();
        boxes.clear();
        for index in block {
            if let Some(ahead) = job.contacts.get(index + CONTACTS_AHEAD) {
                poses.outlook.prefetch(ahead.shapes.1);
                poses.boxes.prefetch(ahead.shapes.1);
            }
            let contact = &mut job.contacts[index];
            let (a, b) = contact.shapes;
            let (reach_a, reach_b) = (poses.outlook.reach(a), poses.outlook.reach(b));
            let closing = Closing::of(horizon, reach_a, reach_b);
            if !closing.may_meet(reach_a, reach_b) {
                contact.passing = false;
                continue;
            }
            let pair = if machine.has_vectors() && reach_a.small_box && reach_b.small_box {
                let radii = [reach_a.radius, reach_b.radius];
                boxes.push(contact.shapes, reach_a.way_to(reach_b), radii, closing.margin)
            } else {
                None
            };
            if pair.is_none() {
                poses.prefetch(b);
            }
            if closing.is_fast() {
                poses.outlook.prefetch_motions(reach_a, reach_b);
            }
            candidates.push(Candidate { index, closing, pair });
        }
        boxes.collide(*machine, &poses.boxes);
    }

    /// Completes the manifolds of a block's candidates, keeps those that have points, and lists what touches. Returns what
    /// touched in the tick before and comes behind.
    fn find_touching<'t>(
        &self,
        job: &mut Job<'_>,
        mut touched: &'t [TouchingPair],
        found: &mut Found,
    ) -> &'t [TouchingPair] {
        let Search { state, poses, horizon, .. } = self;
        let Found { candidates, boxes, contacts, sensors, manifolds, touching, approaches, sat } = found;
        for &Candidate { index, closing, pair } in candidates.iter() {
            let (contact, hint) = (&mut job.contacts[index], &mut job.hints[index]);
            let (a, b) = contact.shapes;
            let (reach_a, reach_b) = (poses.outlook.reach(a), poses.outlook.reach(b));
            let approach = Approach { horizon, a: reach_a, b: reach_b, closing };
            let is_found = pair.is_some_and(|pair| boxes.append_to(manifolds, pair, reach_a.centre()));
            if is_found {
                sat.searches += 1;
            } else {
                manifolds.push(manifold_of(poses, &approach, contact.shapes, hint, sat));
            }
            let place = place_of(manifolds) - 1;
            let Some(manifold) = manifolds.last_mut() else { continue };
            keep_reachable(state, poses, &approach, contact, manifold);
            if manifold.points().is_empty() {
                manifolds.pop();
                continue;
            }
            let index = job.first + u32::try_from(index).expect("fewer than 2^32 contacts");
            contacts.push(index);
            if reach_a.sensor || reach_b.sensor {
                sensors.push(index);
                continue;
            }
            if reach_a.hit_events || reach_b.hit_events {
                approaches.extend(approaching(state, &poses.outlook, index, contact, manifold));
            }
            while touched.first().is_some_and(|known| known.shapes < contact.shapes) {
                touched = &touched[1..];
            }
            let surface = match touched.first() {
                Some(known) if known.shapes == contact.shapes => known.surface,
                _ => surface_of(state, poses, contact.shapes),
            };
            touching.push(TouchingPair {
                contact: index,
                manifold: place,
                shapes: contact.shapes,
                bodies: (reach_a.body, reach_b.body),
                surface,
            });
        }
        touched
    }
}

/// Whether two shapes have contact, or come so near within the tick that they have to be solved together.
pub(super) fn touch(state: &State, poses: &Poses, pair: Pair) -> bool {
    let known = state.contacts.binary_search_by_key(&pair, |contact| contact.shapes);
    let mut contact = known.map_or(Contact::new(pair), |index| state.contacts[index]);
    let horizon = Horizon::of(&state.config);
    let (a, b) = (poses.outlook.reach(pair.0), poses.outlook.reach(pair.1));
    let closing = Closing::of(&horizon, a, b);
    let approach = Approach { horizon: &horizon, a, b, closing };
    closing.may_meet(a, b) && {
        let (mut hint, mut counters) = (AxisHint::default(), SatCounters::default());
        let mut manifold = manifold_of(poses, &approach, pair, &mut hint, &mut counters);
        keep_reachable(state, poses, &approach, &mut contact, &mut manifold);
        !manifold.points().is_empty()
    }
}

/// The contact of two shapes that may meet.
#[inline(always)]
fn manifold_of(
    poses: &Poses,
    approach: &Approach,
    (a, b): Pair,
    hint: &mut AxisHint,
    counters: &mut SatCounters,
) -> Manifold {
    let (posed_a, posed_b) = (poses.at(a), poses.at(b));
    if approach.a.sensor || approach.b.sensor {
        return collide(posed_a, posed_b, Length::ZERO, hint, counters);
    }
    collide_near(posed_a, posed_b, approach.closing.margin, hint, counters)
}

/// Drops the points of two shapes that pass by each other, or through.
#[inline(always)]
fn keep_reachable(
    state: &State,
    poses: &Poses,
    approach: &Approach,
    contact: &mut Contact,
    manifold: &mut Manifold,
) {
    let was_passing = core::mem::take(&mut contact.passing);
    let Approach { a: reach_a, b: reach_b, .. } = approach;
    if manifold.points().is_empty() || reach_a.sensor || reach_b.sensor {
        return;
    }
    let (a, b) = contact.shapes;
    // Few contacts need them, and they are large.
    let posed = || (poses.at(a), poses.at(b));
    if reach_a.one_way || reach_b.one_way {
        let (posed_a, posed_b) = posed();
        let (shape_a, shape_b) = (state.shapes.at(a), state.shapes.at(b));
        let (body_a, body_b) = state.bodies_of((a, b));
        let sides = [(shape_a, body_a, posed_a), (shape_b, body_b, posed_b)];
        contact.passing = approach.lets_pass(sides, manifold, was_passing);
        if contact.passing {
            *manifold = Manifold::NONE;
            return;
        }
    }
    approach.keep_reachable(manifold, &poses.outlook, posed);
}

fn surface_of(state: &State, poses: &Poses, (a, b): Pair) -> Surface {
    let side = |slot: u32| SurfaceSide {
        material: state.shapes.at(slot).material(),
        radius: poses.at(slot).outline.radius(),
    };
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
    let way_at = approach(motion_a, motion_b, manifold);
    let ways = manifold.points().iter().map(|point| (point, way_at(point)));
    let (point, way) = ways.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let approach_speed =
        widen(Step::from_bits(saturate(way))).saturating_mul_int(state.config.tick_rate.into());
    if approach_speed < state.config.hit_speed {
        return None;
    }
    let point = manifold.origin + point.anchor.widen();
    let ContactEvent { shape_a, shape_b } = state.contact_event(contact);
    let event = HitEvent { shape_a, shape_b, point, normal: manifold.normal, approach_speed };
    Some(Approaching { contact: index, event })
}
