//! Settings of a world.

use serde::{Deserialize, Serialize};

use crate::body::WorldError;
use crate::fx;
use crate::math::{Aabb, Fx, Vec2};
use crate::solver::SolverSettings;

/// Settings of a world. They do not change after it is created, except for gravity.
///
/// ```
/// use lockstep2d::{fx, math::Vec2, world::{Config, World}};
/// let moon = Config { gravity: Vec2::new(fx!(0), fx!(-1.62)), tick_rate: 30, ..Config::default() };
/// let world = World::new(moon)?;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Config {
    /// Ticks per second, 10 to 1000. An integer, so that no time step is rounded.
    pub tick_rate: u32,
    /// Gravity in m/s², within ±100 000 on each axis.
    pub gravity: Vec2<Fx>,
    /// Settings of the solver.
    pub solver: SolverSettings,
    /// Distance in metres at which shapes get contact points before they touch, 0.001 to 1. Pairs that approach each
    /// other get a larger margin, which follows from their speeds at the start of the tick.
    pub speculative_distance: Fx,
    /// Largest margin of the fat boxes in the broad phase in metres, 0.001 to 10. The margin of a shape is at most a
    /// sixteenth of its own extent. A larger margin refits boxes less often, but gives more pairs.
    pub fat_margin: Fx,
    /// Whether bodies at rest fall asleep.
    pub sleeping: bool,
    /// Whether fast bodies are swept against shapes that they might pass through; see [`crate::body::Continuous`].
    #[doc(alias = "ccd")]
    pub continuous: bool,
    /// Lowest approach speed of a hit event in m/s, 0 to 400.
    pub hit_speed: Fx,
    /// Largest number of bodies, at most 2^20.
    pub body_limit: u32,
    /// Largest number of shapes, at most 2^20.
    pub shape_limit: u32,
    /// Largest number of joints, at most 2^20.
    pub joint_limit: u32,
    /// Largest number of pairs of near shapes in a tick, at most 2^20. If there are more, those in the smallest slots
    /// are processed, and the tick counts as a fault. This bounds time and memory for untrusted worlds, in which every
    /// shape may overlap every other one.
    pub pair_limit: u32,
}

impl Default for Config {
    /// 60 Hz, gravity (0, -10) m/s², 4 sub-steps with soft contacts.
    fn default() -> Self {
        Config {
            tick_rate: 60,
            gravity: Vec2::new(fx!(0), fx!(-10)),
            solver: SolverSettings::default(),
            speculative_distance: fx!(0.02),
            fat_margin: fx!(0.1),
            sleeping: true,
            continuous: true,
            hit_speed: fx!(1),
            body_limit: 1 << 20,
            shape_limit: 1 << 20,
            joint_limit: 1 << 20,
            pair_limit: 1 << 18,
        }
    }
}

impl Config {
    /// Distance in metres below which shapes begin to touch: a quarter of the speculative distance. They cease to touch
    /// beyond the speculative distance. The difference keeps a contact that wobbles from beginning and ending
    /// repeatedly.
    #[must_use]
    pub fn touching_distance(&self) -> Fx {
        self.speculative_distance / 4
    }

    /// Margin in metres of the fat box of a shape with the given AABB on a body that can move.
    pub(crate) fn margin_of(&self, bounds: Aabb) -> Fx {
        // The box is in the world, so that the difference does not overflow.
        let half = bounds.upper.wrapping_sub(bounds.centre());
        (half.x.max(half.y) / 16).min(self.fat_margin)
    }

    /// Number of ticks for which a body has to be slow before it may fall asleep: those of half a second.
    #[must_use]
    pub const fn ticks_to_sleep(&self) -> u32 {
        self.tick_rate.div_ceil(2)
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`WorldError::Setting`] with the name of the first setting that is out of range.
    pub fn validate(&self) -> Result<(), WorldError> {
        let Config {
            tick_rate,
            gravity,
            ref solver,
            speculative_distance,
            fat_margin,
            sleeping: _,
            continuous: _,
            hit_speed,
            body_limit,
            shape_limit,
            joint_limit,
            pair_limit,
        } = *self;
        let checks = [
            ((10..=1000).contains(&tick_rate), "tick_rate"),
            (check_gravity(gravity), "gravity"),
            ((fx!(0.001)..=fx!(1)).contains(&speculative_distance), "speculative_distance"),
            ((fx!(0.001)..=fx!(10)).contains(&fat_margin), "fat_margin"),
            ((fx!(0)..=fx!(400)).contains(&hit_speed), "hit_speed"),
            (body_limit <= 1 << 20, "body_limit"),
            (shape_limit <= 1 << 20, "shape_limit"),
            (joint_limit <= 1 << 20, "joint_limit"),
            (pair_limit <= 1 << 20, "pair_limit"),
        ];
        let invalid = checks.into_iter().find(|(valid, _)| !valid).map(|(_, name)| name);
        match invalid.or_else(|| solver.first_invalid(tick_rate)) {
            Some(name) => Err(WorldError::Setting { name }),
            None => Ok(()),
        }
    }
}

/// Whether a gravity in m/s² is in range.
pub(crate) fn check_gravity(gravity: Vec2<Fx>) -> bool {
    let range = fx!(-100000)..=fx!(100000);
    range.contains(&gravity.x) && range.contains(&gravity.y)
}
