//! [`Measures`]: what of a world has to stay the same, or small.
//!
//! These are for pictures, not for comparisons, and so they are floats. Only what IEEE 754 defines to the last bit is
//! done with them, so that the same replay gives the same plot on every machine.
#![expect(
    clippy::disallowed_types,
    clippy::float_arithmetic,
    reason = "nothing drawn flows back into a simulation"
)]

use lockstep2d::math::{Fx, widen};
use lockstep2d::world::World;

/// What of a world has to stay the same, or small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Measures {
    /// Of all bodies, in J.
    pub(crate) kinetic: f64,
    /// Of all bodies that fall, in J; 0 at the origin.
    pub(crate) potential: f64,
    /// The deepest of all contacts, in metres; 0 if none overlaps.
    pub(crate) overlap: f64,
    /// The widest of all joints, in metres.
    pub(crate) gap: f64,
}

impl Measures {
    pub(crate) fn of(world: &World) -> Self {
        let (mut kinetic, mut potential) = (0.0, 0.0);
        let gravity = world.config().gravity;
        for (_, body) in world.bodies().filter(|(_, body)| body.is_dynamic() && body.is_enabled()) {
            kinetic += number(body.kinetic_energy());
            let place = body.centre_of_mass();
            let fall = number(gravity.x) * number(place.x) + number(gravity.y) * number(place.y);
            potential -= number(body.mass()) * number(body.settings().gravity_scale) * fall;
        }
        let overlaps = world.contacts().flat_map(|contact| contact.manifold.points());
        let overlap = overlaps.map(|point| -number(widen(point.separation))).fold(0.0, f64::max);
        let anchors = world.joints().filter_map(|(id, _)| world.joint_anchors(id));
        let gap = anchors.map(|(a, b)| number(a.distance(b))).fold(0.0, f64::max);
        Measures { kinetic, potential, overlap, gap }
    }
}

fn number(value: Fx) -> f64 {
    value.to_num()
}
