//! [`Pose`] and [`Poses`]: the poses and velocities of all bodies after one tick.

use lockstep2d::body::BodyId;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::World;

/// Position and rotation of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pose {
    /// Origin of the body in metres.
    pub position: Vec2<Fx>,
    /// Rotation.
    pub angle: Angle,
}

/// Poses of all bodies, by slot.
#[derive(Clone, Debug, Default)]
pub(crate) struct Poses {
    /// Number of the last capture. An entry with another number belongs to a body that no longer exists.
    capture: u32,
    entries: Vec<Option<Entry>>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    body: BodyId,
    capture: u32,
    pose: Pose,
    /// Velocity of the origin in m/s.
    velocity: Vec2<Fx>,
}

impl Poses {
    pub(crate) fn capture(&mut self, world: Option<&World>) {
        self.capture = self.capture.wrapping_add(1);
        let Some(world) = world else { return self.entries.clear() };
        for (body, state) in world.bodies() {
            let slot = body.index() as usize;
            if self.entries.len() <= slot {
                self.entries.resize(slot + 1, None);
            }
            let pose = Pose { position: state.position(), angle: state.angle() };
            let velocity = state.velocity_at(state.position());
            self.entries[slot] = Some(Entry { body, capture: self.capture, pose, velocity });
        }
    }

    fn entry(&self, body: BodyId) -> Option<&Entry> {
        let entry = self.entries.get(body.index() as usize)?.as_ref();
        entry.filter(|entry| entry.body == body && entry.capture == self.capture)
    }

    pub(crate) fn get(&self, body: BodyId) -> Option<Pose> {
        self.entry(body).map(|entry| entry.pose)
    }

    /// Velocity of the body's origin in m/s.
    pub(crate) fn velocity(&self, body: BodyId) -> Option<Vec2<Fx>> {
        self.entry(body).map(|entry| entry.velocity)
    }

    /// Poses in slot order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (BodyId, Pose)> {
        let entries = self.entries.iter().flatten();
        entries.filter(|entry| entry.capture == self.capture).map(|entry| (entry.body, entry.pose))
    }
}
