//! Contacts of a tick: their manifolds at its start, and the events that follow from them at its end.

use alloc::vec::Vec;

use super::events::{ContactEvent, Events, HitEvent, SensorEvent};
use super::look_ahead::{Approach, Horizon, Outlook, approach};
use super::scratch::{Approaching, Poses, Scratch};
use super::state::{Reported, Side, State};
use crate::collision::{AxisHint, Contact, Manifold, Pair, SatCounters, collide, collide_near};
use crate::math::{Fx, Length, Step, saturate, widen};
use crate::solver::{Surface, TouchingPair};

/// Fewest contacts that are worth a job of their own.
const JOB_MIN: usize = 512;

/// What a part of the narrow phase has found, in the order of its contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    /// The manifolds that have points, and where their contacts are.
    pub(super) manifolds: Vec<Manifold>,
    pub(super) contacts: Vec<u32>,
    /// Those that the solver has to deal with.
    pub(super) touching: Vec<TouchingPair>,
    /// Approaches that become hits if the shapes push each other in this tick.
    pub(super) approaches: Vec<Approaching>,
    pub(super) sat: SatCounters,
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
    let search = Search { state, poses, touched, horizon: Horizon::of(&state.config) };
    let chunks = contacts.chunks_mut(share).zip(hints.chunks_mut(share));
    let jobs = (0u32..).step_by(share).zip(chunks).zip(parts.iter_mut());
    solver.threads.run(jobs, |((first, (contacts, hints)), part)| {
        search.run(first, contacts, hints, part);
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
        self.touching.clear();
        self.approaches.clear();
        self.sat = SatCounters::default();
    }

    /// Adds what has been found further on.
    fn append(&mut self, further: &Found) {
        let first = place_of(&self.manifolds);
        let touching = further.touching.iter();
        self.touching.extend(touching.map(|pair| TouchingPair { manifold: first + pair.manifold, ..*pair }));
        self.manifolds.extend_from_slice(&further.manifolds);
        self.contacts.extend_from_slice(&further.contacts);
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
}

impl Search<'_> {
    /// Looks at some contacts, of which the first one has a place in the state.
    fn run(&self, first: u32, contacts: &mut [Contact], hints: &mut [AxisHint], found: &mut Found) {
        let Search { state, poses, touched, horizon } = self;
        let Some(pair) = contacts.first().map(|contact| contact.shapes) else { return };
        let mut touched = touched[touched.partition_point(|known| known.shapes < pair)..].iter();
        let mut next = touched.next();
        for ((index, contact), hint) in (first..).zip(contacts).zip(hints) {
            let (a, b) = contact.shapes;
            let (reach_a, reach_b) = (poses.outlook.reach(a), poses.outlook.reach(b));
            let approach = Approach::new(horizon, reach_a, reach_b);
            if !approach.may_meet() {
                contact.passing = false;
                continue;
            }
            let manifold = manifold_of(state, poses, &approach, contact, hint, &mut found.sat);
            if manifold.points().is_empty() {
                continue;
            }
            if !(reach_a.sensor || reach_b.sensor) {
                while next.is_some_and(|known| known.shapes < contact.shapes) {
                    next = touched.next();
                }
                let surface = match next {
                    Some(known) if known.shapes == contact.shapes => known.surface,
                    _ => surface_of(state, poses, contact.shapes),
                };
                found.touching.push(TouchingPair {
                    contact: index,
                    manifold: place_of(&found.manifolds),
                    shapes: contact.shapes,
                    bodies: (reach_a.body, reach_b.body),
                    surface,
                });
                if reach_a.hit_events || reach_b.hit_events {
                    found.approaches.extend(approaching(state, &poses.outlook, index, contact, &manifold));
                }
            }
            found.contacts.push(index);
            found.manifolds.push(manifold);
        }
    }
}

/// Whether two shapes have contact, or come so near within the tick that they have to be solved together.
pub(super) fn touch(state: &State, poses: &Poses, pair: Pair) -> bool {
    let known = state.contacts.binary_search_by_key(&pair, |contact| contact.shapes);
    let mut contact = known.map_or(Contact::new(pair), |index| state.contacts[index]);
    let horizon = Horizon::of(&state.config);
    let (mut hint, mut counters) = (AxisHint::default(), SatCounters::default());
    let approach = Approach::new(&horizon, poses.outlook.reach(pair.0), poses.outlook.reach(pair.1));
    approach.may_meet() && {
        let manifold = manifold_of(state, poses, &approach, &mut contact, &mut hint, &mut counters);
        !manifold.points().is_empty()
    }
}

/// The contact of two shapes that may meet.
#[inline(always)]
fn manifold_of(
    state: &State,
    poses: &Poses,
    approach: &Approach,
    contact: &mut Contact,
    hint: &mut AxisHint,
    counters: &mut SatCounters,
) -> Manifold {
    let was_passing = core::mem::take(&mut contact.passing);
    let (a, b) = contact.shapes;
    let (reach_a, reach_b) = (poses.outlook.reach(a), poses.outlook.reach(b));
    if reach_a.sensor || reach_b.sensor {
        return collide(poses.at(a), poses.at(b), Length::ZERO, hint, counters);
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
    let Scratch { events, found, poses, solver, .. } = scratch;
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
    let Scratch { events, found, solver, .. } = scratch;
    let hits = found.approaches.iter().filter(|hit| solver.pushed[hit.contact as usize]);
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
