//! Impacts behind an earlier impact of the same body.
//!
//! The manifold at an impact is found on the straight path of the tick. A body that hits something earlier leaves this
//! path. Behind a floor, for example, it would hit the lower end of a wall, with a normal that does not exist above the
//! floor. A later impact therefore gets the manifold at the start of the tick. If the other shape is behind the plane of
//! the first impact, which the body does not cross, it gets no manifold.

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
    add_touching(output, poses.motion(), touching, order);
    if output.impacts.len() < 2 {
        return;
    }
    list(output, &state.bodies, order);
    find_later(output, order);
    let ImpactOrder { by_body, later, hidden } = order;
    for impact in &*later {
        let impact = &output.impacts[*impact as usize];
        let is_behind = impact.bodies.into_iter().any(|body| {
            let at = by_body.partition_point(|&(other, ..)| other < body);
            let first = by_body.get(at).filter(|first| first.0 == body && is_later(impact, first.1));
            first.is_some_and(|&(.., first)| is_behind(body, impact, &output.impacts[first as usize], output))
        });
        if is_behind {
            hidden.push(impact.manifold);
        }
    }
    for impact in &*later {
        let impact = &output.impacts[*impact as usize];
        let (manifold, kept) = impact.start;
        output.manifolds[impact.manifold as usize] = manifold;
        contacts[impact.contact as usize].kept = kept;
    }
    if !hidden.is_empty() {
        output.remove(hidden);
    }
}

/// Sorts the impacts of dynamic bodies by body and time.
fn list(output: &NarrowPhaseOutput, bodies: &Arena<Body, BodyId>, order: &mut ImpactOrder) {
    let by_body = &mut order.by_body;
    by_body.clear();
    for (index, impact) in (0u32..).zip(&output.impacts) {
        let dynamic = impact.bodies.into_iter().filter(|&body| bodies.at(body).is_dynamic());
        by_body.extend(dynamic.map(|body| (body, impact.fraction, index)));
    }
    by_body.sort_unstable();
}

/// Adds the contacts of the listed bodies whose shapes touch at the start of the tick, and approach in the tick by more
/// than the touching distance. They are impacts at the start of the tick.
fn add_touching(output: &mut NarrowPhaseOutput, motion: &MotionCache, touching: Step, order: &ImpactOrder) {
    let NarrowPhaseOutput { manifolds, touching: contacts, impacts, .. } = output;
    let is_listed = |body: u32| order.by_body.binary_search_by_key(&body, |&(body, ..)| body).is_ok();
    for pair in contacts.iter().filter(|pair| is_listed(pair.bodies.0) || is_listed(pair.bodies.1)) {
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
                start: (manifold, KeptManifold::NONE),
            });
        }
    }
}

/// Lists the impacts that are later than the first one of a body.
fn find_later(output: &NarrowPhaseOutput, order: &mut ImpactOrder) {
    let ImpactOrder { by_body, later, hidden } = order;
    later.clear();
    hidden.clear();
    for of_body in by_body.chunk_by(|a, b| a.0 == b.0) {
        let (_, first, _) = of_body[0];
        let impacts = of_body.iter().map(|&(.., impact)| impact);
        later.extend(impacts.filter(|&impact| is_later(&output.impacts[impact as usize], first)));
    }
    later.sort_unstable();
    later.dedup();
}

fn is_later(impact: &PendingImpact, first: Unit) -> bool {
    impact.fraction - first > SIMULTANEOUS
}

/// Whether the shape that a body hits in a later impact is behind the plane of the body's first impact.
fn is_behind(body: u32, later: &PendingImpact, first: &PendingImpact, output: &NarrowPhaseOutput) -> bool {
    let facing = |impact: &PendingImpact, manifold: Manifold| {
        if impact.bodies[0] == body { manifold } else { manifold.swapped() }
    };
    let plane = facing(first, output.manifolds[first.manifold as usize]);
    let start = facing(later, later.start.0);
    let Some(touch) = plane.points().first() else { return false };
    let touch = plane.origin + touch.anchor.widen();
    start.points().iter().all(|point| {
        let half = widen(point.separation >> 1);
        let surface: Vec2<Fx> = start.origin + point.anchor.widen() + start.normal.widen().scale(half);
        (surface - touch).dot(plane.normal.widen()) > 0
    })
}
