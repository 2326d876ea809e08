//! Figures of a world: its counts, and the statistics of its last tick.

use lockstep2d::world::World;

use crate::counts::Counts;

pub(crate) fn of(world: &World) -> [(&'static str, u64); 13] {
    let Counts { bodies, awake, asleep, shapes, joints, pairs } = Counts::of(world);
    let stats = world.stats();
    let count = |number: usize| u64::try_from(number).unwrap_or(u64::MAX);
    [
        ("bodies", count(bodies)),
        ("awake", count(awake)),
        ("asleep", count(asleep)),
        ("shapes", count(shapes)),
        ("joints", count(joints)),
        ("joints_solved", stats.joints.into()),
        ("pairs", count(pairs)),
        ("contacts", stats.contacts.into()),
        ("points", stats.points.into()),
        ("points_kept", stats.points_kept.into()),
        ("points_lost", stats.points_lost.into()),
        ("impacts", stats.impacts.into()),
        ("faults", stats.faults),
    ]
}
