//! Impacts behind an earlier impact of the same body.
//!
//! The manifold at an impact is found on the straight path of the tick. A body that hits something earlier leaves this
//! path. Behind a floor, for example, it would hit the lower end of a wall, with a normal that does not exist above the
//! floor. A later impact therefore gets the manifold at the start of the tick. It gets none if the first impact is with
//! a body that impulses do not move, and the other shape belongs to a dynamic body behind the plane of that impact.
//! Shapes that miss each other on their paths get none either, unless one of them leaves its path earlier.
//!
//! The impacts are examined in the order of time. An impact without a manifold does not take place, so that no body
//! leaves its path there.

use super::contact_events::fast_approach;
use crate::collision::{Contact, Manifold};
use crate::math::{Fx, Step, Unit, Vec2, fx_div, fx_mul, widen};
use crate::world::cache::{
    ContactCache, ImpactOrder, MotionCache, NarrowPhaseOutput, PendingHit, PendingImpact,
};
use crate::world::state::State;

/// Fraction of a tick, a 256th, within which impacts count as simultaneous.
const SIMULTANEOUS: Unit = Unit::lit("0.00390625");

/// Replaces or removes the manifolds of impacts that are later than another impact of a dynamic body.
pub(super) fn withdraw_later_ones(
    contacts: &mut [Contact],
    state: &State,
    motion: &MotionCache,
    touching: Step,
    cache: &mut ContactCache,
) {
    let (output, order) = cache.output_mut();
    let NarrowPhaseOutput { manifolds, approaches, impacts, .. } = output;
    let ImpactOrder { by_time, firsts, removed } = order;
    // Impacts at the start of the tick are later than no other impact.
    if impacts.iter().all(|impact| impact.fraction == 0 && !impact.misses) {
        return;
    }
    by_time.clear();
    by_time.extend((0u32..).zip(&*impacts).map(|(index, impact)| (impact.fraction, index)));
    by_time.sort_unstable();
    firsts.clear();
    firsts.resize(state.bodies.slot_count(), None);
    removed.clear();
    for &(fraction, index) in &*by_time {
        let impact = &impacts[index as usize];
        // The first impacts of the bodies, if they are earlier than this one.
        let earlier = impact.bodies.map(|body| {
            let first = firsts[body as usize].map(|first: u32| &impacts[first as usize]);
            first.filter(|first| fraction - first.fraction > SIMULTANEOUS)
        });
        let is_first = earlier.iter().all(Option::is_none);
        let is_hidden = [0, 1].into_iter().any(|side| {
            earlier[side].is_some_and(|first| hides(first, impact, side, manifolds, state, touching))
        });
        if is_first && impact.misses || is_hidden {
            removed.push(impact.manifold);
            continue;
        }
        if !impact.misses {
            for body in impact.bodies.into_iter().filter(|&body| state.bodies.at(body).is_dynamic()) {
                firsts[body as usize].get_or_insert(index);
            }
        }
        if !is_first {
            let contact = &mut contacts[impact.contact as usize];
            let manifold = &mut manifolds[impact.manifold as usize];
            (*manifold, contact.kept) = impact.start;
            if let Ok(at) = approaches.binary_search_by_key(&impact.contact, |hit| hit.contact) {
                match fast_approach(state, motion, impact.contact, contact, manifold, [Vec2::ZERO; 2]) {
                    Some(hit) => approaches[at] = at_surface(hit, contact, manifold, state, motion),
                    None => {
                        approaches.remove(at);
                    }
                }
            }
        }
    }
    if !removed.is_empty() {
        removed.sort_unstable();
        output.remove(removed);
    }
}

/// The hit event of a manifold at the start of the tick, whose points are half-way between the surfaces. Moves the point
/// along the normal, with the mean displacement of the bodies, to where the surfaces meet.
fn at_surface(
    hit: PendingHit,
    contact: &Contact,
    manifold: &Manifold,
    state: &State,
    motion: &MotionCache,
) -> PendingHit {
    let PendingHit { mut event, .. } = hit;
    let gap = manifold.points().iter().map(|point| widen(point.separation)).min().unwrap_or_default();
    let seconds = fx_div(gap, event.approach_speed).unwrap_or_default();
    let fraction = (seconds * i64::from(state.config.tick_rate)).clamp(Fx::ZERO, Fx::ONE);
    let (a, b) = contact.shapes;
    let [a, b] = [a, b].map(|shape| motion.motion(motion.shape(shape)).shift_until(Unit::ONE));
    let normal = event.normal.widen();
    event.point += normal.scale(fx_mul(normal.dot(a + b) / 2, fraction));
    PendingHit { event, ..hit }
}

/// Whether the first impact of the body on one side of a later impact stops the body before it reaches the other one.
fn hides(
    first: &PendingImpact,
    later: &PendingImpact,
    side: usize,
    manifolds: &[Manifold],
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
    let plane = facing(first_side, manifolds[first.manifold as usize]);
    let start = facing(side, later.start.0);
    let Some(touch) = plane.points().first() else { return false };
    let touch = plane.origin + touch.anchor.widen();
    start.points().iter().all(|point| {
        let half = widen(point.separation >> 1);
        let surface: Vec2<Fx> = start.origin + point.anchor.widen() + start.normal.widen().scale(half);
        (surface - touch).dot(plane.normal.widen()) > widen(touching)
    })
}
