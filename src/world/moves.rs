//! What a tick reports at its end: which bodies have moved, and where they are.

use alloc::vec::Vec;

use super::events::MoveEvent;
use super::rollback::PackedBodies;
use super::scratch::Scratch;
use super::state::State;
use crate::body::{Body, BodyId, Handle};
use crate::math::{Angle, Fx, Vec2};

/// By body slot, how the origin of a body lay about its centre of mass when that was last asked for: most bodies have not
/// turned since, and to turn it takes longer than all else that is reported.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origins(Vec<Origin>);

#[derive(Clone, Copy, Debug, Default)]
struct Origin {
    /// Of the body, and its centre of mass in its own frame.
    angle: Angle,
    centre: Vec2<Fx>,
    /// The same in world axes.
    turned: Vec2<Fx>,
}

impl Origins {
    /// [`Body::position`] of the body in a slot.
    fn position(&mut self, slot: u32, body: &Body) -> Vec2<Fx> {
        let (angle, centre) = (body.angle, body.mass.centre);
        if centre == Vec2::ZERO {
            return body.centre;
        }
        if self.0.len() <= slot as usize {
            self.0.resize(slot as usize + 1, Origin::default());
        }
        let known = &mut self.0[slot as usize];
        if (known.angle, known.centre) != (angle, centre) {
            *known = Origin { angle, centre, turned: body.rotation().apply_wide(centre) };
        }
        body.centre - known.turned
    }
}

/// Lists the bodies that have moved or fallen asleep, and packs all bodies on the way if that is wanted.
pub(super) fn report(state: &State, scratch: &mut Scratch, packed: Option<&mut PackedBodies>) {
    let Scratch { roster, solver, events, origins, .. } = scratch;
    let mut report = |id: BodyId, body: &Body| {
        let (fell_asleep, solved) = (body.is_asleep(), solver.body(id.slot()));
        if fell_asleep || solved.shift != Vec2::ZERO || solved.turn != 0 {
            let (position, angle) = (origins.position(id.slot(), body), body.angle());
            debug_assert_eq!(position, body.position());
            events.moved.push(MoveEvent { body: id, position, angle, fell_asleep });
        }
    };
    let Some(packed) = packed else {
        let bodies = &state.bodies;
        return roster.bodies.iter().for_each(|&slot| report(bodies.handle_at(slot), bodies.at(slot)));
    };
    let mut moving = roster.bodies.iter().peekable();
    packed.fill(state, |id, body| {
        if moving.next_if_eq(&&id.slot()).is_some() {
            report(id, body);
        }
    });
}
