//! [`Measures`]: the energies of a world, and two errors of the solver that should stay small.
//!
//! The values are floats because they are only drawn. Only correctly rounded operations of IEEE 754 are used, so the
//! plot is the same on every machine.
#![expect(
    clippy::disallowed_types,
    clippy::float_arithmetic,
    reason = "nothing drawn flows back into a simulation"
)]

use lockstep2d::math::Fx;
use lockstep2d::world::World;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Measures {
    /// Kinetic energy of all enabled dynamic bodies, in J.
    pub(crate) kinetic: f64,
    /// Potential energy of these bodies in the world's gravity, in J. A body at the origin has none.
    pub(crate) potential: f64,
    /// [`World::deepest_overlap`], in metres.
    pub(crate) overlap: f64,
    /// [`World::widest_joint_gap`], in metres.
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
        let (overlap, gap) = (number(world.deepest_overlap()), number(world.widest_joint_gap()));
        Measures { kinetic, potential, overlap, gap }
    }
}

fn number(value: Fx) -> f64 {
    value.to_num()
}
