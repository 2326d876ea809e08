//! Impacts behind an earlier impact of the same body.
//!
//! The manifold at an impact is found on the straight path of the tick. A body that hits something earlier leaves this
//! path. Behind a floor, for example, it would hit the lower end of a wall, with a normal that does not exist above the
//! floor. A later impact therefore gets the manifold at the start of the tick. It gets none if the first impact is with
//! a body that impulses do not move, and the other shape belongs to a dynamic body behind the plane of that impact.
//! Shapes that miss each other on their paths get none either, unless one of them leaves its path earlier.

use super::speculative::approach;
use crate::body::{Arena, Body, BodyId};
use crate::collision::{Contact, KeptManifold, Manifold, ManifoldPoint};
use crate::math::{Fx, Step, Unit, Vec2, widen};
use crate::world::cache::{ContactCache, ImpactOrder, MotionCache, NarrowPhaseOutput, PendingImpact, Poses};
use crate::world::state::State;

/// Fraction of a tick, a 256th, within which impacts count as simultaneous.
const SIMULTANEOUS: Unit = Unit::lit("0.00390625");

/// Replaces or removes the manifolds of impacts that are later than another impact of a dynamic body.
pub(super) fn withdraw_later_ones(
    contacts: &mut [Contact],
    state: &State,
    poses: &Poses,
    touching: Step,
    cache: &mut ContactCache,
) {
    let (output, order) = cache.output_mut();
    if output.impacts.is_empty() {
        return;
    }
    list(output, &state.bodies, order);
    let pending = count(output);
    add_touching(output, poses.motion(), touching, order);
    list(output, &state.bodies, order);
    judge(output, pending, state, touching, order);
    for &impact in &order.later {
        let impact = &output.impacts[impact as usize];
        let (manifold, kept) = impact.start;
        output.manifolds[impact.manifold as usize] = manifold;
        contacts[impact.contact as usize].kept = kept;
    }
    if !order.removed.is_empty() {
        output.remove(&order.removed);
    }
}

fn count(output: &NarrowPhaseOutput) -> u32 {
    u32::try_from(output.impacts.len()).expect("fewer than 2^32 contacts")
}

/// Sorts the impacts of dynamic bodies by body and time.
fn list(output: &NarrowPhaseOutput, bodies: &Arena<Body, BodyId>, order: &mut ImpactOrder) {
    let by_body = &mut order.by_body;
    by_body.clear();
    for (index, impact) in (0u32..).zip(&output.impacts).filter(|(_, impact)| !impact.misses) {
        let dynamic = impact.bodies.into_iter().filter(|&body| bodies.at(body).is_dynamic());
        by_body.extend(dynamic.map(|body| (body, impact.fraction, index)));
    }
    by_body.sort_unstable();
}

/// Adds the contacts of the listed bodies whose shapes touch at the start of the tick, and approach in the tick by more
/// than the touching distance. They are impacts at the start of the tick.
fn add_touching(output: &mut NarrowPhaseOutput, motion: &MotionCache, touching: Step, order: &ImpactOrder) {
    let NarrowPhaseOutput { manifolds, touching: contacts, impacts, .. } = output;
    let is_listed = |body: u32| {
        let at = order.by_body.partition_point(|&(other, ..)| other < body);
        order.by_body.get(at).is_some_and(|&(other, ..)| other == body)
    };
    let pending = impacts.len();
    for pair in contacts.iter().filter(|pair| is_listed(pair.bodies.0) || is_listed(pair.bodies.1)) {
        // The impacts up to `pending` are in the order of their manifolds.
        if impacts[..pending].binary_search_by_key(&pair.manifold, |impact| impact.manifold).is_ok() {
            continue;
        }
        let manifold = manifolds[pair.manifold as usize];
        let motions = [pair.shapes.0, pair.shapes.1].map(|shape| motion.motion(motion.shape(shape)));
        let closing_at = approach(motions[0], motions[1], &manifold);
        let hits = |point: &ManifoldPoint| {
            point.separation <= touching && closing_at(point) > i64::from(touching.to_bits())
        };
        if manifold.points().iter().any(hits) {
            impacts.push(PendingImpact {
                manifold: pair.manifold,
                contact: pair.contact,
                bodies: [pair.bodies.0, pair.bodies.1],
                fraction: Unit::ZERO,
                misses: false,
                start: (manifold, KeptManifold::NONE),
            });
        }
    }
}

/// Lists the later ones among the first `pending` impacts, and those whose manifolds are removed.
fn judge(output: &NarrowPhaseOutput, pending: u32, state: &State, touching: Step, order: &mut ImpactOrder) {
    let ImpactOrder { by_body, later, removed } = order;
    later.clear();
    removed.clear();
    for (index, impact) in (0..pending).zip(&output.impacts) {
        // The first impacts of the bodies, if they are earlier than this one.
        let earlier = impact.bodies.map(|body| {
            let at = by_body.partition_point(|&(other, ..)| other < body);
            let first = by_body
                .get(at)
                .filter(|&&(other, first, _)| other == body && impact.fraction - first > SIMULTANEOUS);
            first.map(|&(.., first)| &output.impacts[first as usize])
        });
        let is_first = earlier.iter().all(Option::is_none);
        let is_hidden = [0, 1].into_iter().any(|side| {
            earlier[side].is_some_and(|first| hides(first, impact, side, output, state, touching))
        });
        if is_first && impact.misses || is_hidden {
            removed.push(impact.manifold);
        } else if !is_first {
            later.push(index);
        }
    }
}

/// Whether the first impact of the body on one side of a later impact stops the body before it reaches the other one.
fn hides(
    first: &PendingImpact,
    later: &PendingImpact,
    side: usize,
    output: &NarrowPhaseOutput,
    state: &State,
    touching: Step,
) -> bool {
    let body = later.bodies[side];
    let facing = |side: usize, manifold: Manifold| if side == 0 { manifold } else { manifold.swapped() };
    let first_side = usize::from(first.bodies[0] != body);
    let is_dynamic = |body: u32| state.bodies.at(body).is_dynamic();
    if is_dynamic(first.bodies[1 - first_side]) || !is_dynamic(later.bodies[1 - side]) {
        return false;
    }
    let plane = facing(first_side, output.manifolds[first.manifold as usize]);
    let start = facing(side, later.start.0);
    let Some(touch) = plane.points().first() else { return false };
    let touch = plane.origin + touch.anchor.widen();
    start.points().iter().all(|point| {
        let half = widen(point.separation >> 1);
        let surface: Vec2<Fx> = start.origin + point.anchor.widen() + start.normal.widen().scale(half);
        (surface - touch).dot(plane.normal.widen()) > widen(touching)
    })
}
