//! The rotated offset of each body's origin from its centre of mass.

use alloc::vec::Vec;

use crate::body::Body;
use crate::math::{Angle, Fx, Vec2};

/// Offset of the centre of mass from the origin in world axes, by body slot. Most bodies have not turned since the last
/// tick, and computing a rotation costs more than the rest of a move event.
#[derive(Clone, Debug, Default)]
pub(crate) struct OriginCache(Vec<Entry>);

#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    /// Key: the body's rotation and its centre of mass in its own frame.
    angle: Angle,
    centre: Vec2<Fx>,
    /// The centre of mass in world axes about the origin.
    rotated: Vec2<Fx>,
}

impl OriginCache {
    /// Returns [`Body::position`] of the body in a slot.
    pub(crate) fn position(&mut self, slot: u32, body: &Body) -> Vec2<Fx> {
        let (angle, centre) = (body.angle, body.mass.centre);
        if centre == Vec2::ZERO {
            return body.centre;
        }
        if self.0.len() <= slot as usize {
            self.0.resize(slot as usize + 1, Entry::default());
        }
        let entry = &mut self.0[slot as usize];
        if (entry.angle, entry.centre) != (angle, centre) {
            *entry = Entry { angle, centre, rotated: body.rotation().apply_wide(centre) };
        }
        body.centre - entry.rotated
    }
}
