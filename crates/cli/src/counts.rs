//! [`Counts`]: the numbers of bodies, shapes, joints and pairs in a world.

use std::fmt;

use lockstep2d::world::World;
use serde::Serialize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Counts {
    pub(crate) bodies: usize,
    /// Number of bodies that a tick simulates: all except fixed, disabled and sleeping bodies.
    pub(crate) awake: usize,
    pub(crate) asleep: usize,
    pub(crate) shapes: usize,
    pub(crate) joints: usize,
    pub(crate) pairs: usize,
}

impl Counts {
    pub(crate) fn of(world: &World) -> Self {
        Counts {
            bodies: world.body_count(),
            awake: world.awake_body_count(),
            asleep: world.bodies().filter(|(_, body)| body.is_asleep()).count(),
            shapes: world.shape_count(),
            joints: world.joint_count(),
            pairs: world.pair_count(),
        }
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Counts { bodies, awake, asleep, shapes, joints, pairs } = self;
        write!(
            f,
            "bodies {bodies} (awake {awake}, asleep {asleep}), shapes {shapes}, joints {joints}, pairs {pairs}"
        )
    }
}
