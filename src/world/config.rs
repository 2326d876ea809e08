//! World settings.

use serde::{Deserialize, Serialize};

use crate::body::WorldError;
use crate::fx;
use crate::math::{Aabb, Fx, Vec2};
use crate::solver::SolverSettings;

/// Settings of a world, fixed when it is made, except for gravity.
///
/// ```
/// use lockstep2d::{fx, math::Vec2, world::{Config, World}};
/// let moon = Config { gravity: Vec2::new(fx!(0), fx!(-1.62)), tick_rate: 30, ..Config::default() };
/// let world = World::new(moon)?;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Config {
    /// Ticks per second, 10 to 1000. An integer, so that no time step is ever rounded.
    pub tick_rate: u32,
    /// Gravity in m/s², ±100 000 on each axis.
    pub gravity: Vec2<Fx>,
    /// How the solver runs.
    pub solver: SolverSettings,
    /// Shapes this near to each other, in metres, already have contact points; 0.001 to 1. Larger margins follow
    /// from the speeds at the start of the tick.
    pub speculative_distance: Fx,
    /// How much larger than needed the boxes of the broad phase are made at most, in metres, 0.001 to 10: larger ones
    /// change less often but give more pairs. At most a sixteenth of the shape's own extent.
    pub fat_margin: Fx,
    /// Whether bodies at rest fall asleep.
    pub sleeping: bool,
    /// Whether fast bodies are swept against what they might pass through; see [`crate::body::Continuous`].
    pub continuous: bool,
    /// Approach speed in m/s from which a contact is a hit, 0 to 400.
    pub hit_speed: Fx,
    /// Most bodies the world may hold, at most 2^20.
    pub body_limit: u32,
    /// Most shapes the world may hold, at most 2^20.
    pub shape_limit: u32,
    /// Most joints the world may hold, at most 2^20.
    pub joint_limit: u32,
    /// Most pairs of near shapes that are looked at in a tick, at most 2^20. Of more, those in the smallest slots
    /// are taken and the tick counts as faulty: a bound on time and memory for worlds that come from strangers,
    /// where every shape may lie on every other.
    pub pair_limit: u32,
}

impl Default for Config {
    /// 60 Hz, gravity (0, -10), 4 soft sub-steps.
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
    /// Shapes nearer than this, in metres, begin to touch: a quarter of the speculative distance, so that a
    /// contact that wobbles does not begin and end in turn.
    #[must_use]
    pub fn touching_distance(&self) -> Fx {
        self.speculative_distance / 4
    }

    /// The margin of the fat box of a shape that moves.
    pub(crate) fn margin_of(&self, bounds: Aabb) -> Fx {
        // Of a box in the world.
        let half = bounds.upper.wrapping_sub(bounds.centre());
        (half.x.max(half.y) / 16).min(self.fat_margin)
    }

    /// For how many ticks a body has to be slow before it sleeps: half a second.
    #[must_use]
    pub const fn ticks_to_sleep(&self) -> u32 {
        self.tick_rate.div_ceil(2)
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`WorldError::Setting`] with the name of the first one that is out of range.
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

pub(crate) fn check_gravity(gravity: Vec2<Fx>) -> bool {
    let range = fx!(-100000)..=fx!(100000);
    range.contains(&gravity.x) && range.contains(&gravity.y)
}
