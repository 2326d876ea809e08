//! Settings of a world.

use serde::{Deserialize, Serialize};

use crate::body::WorldError;
use crate::fx;
use crate::math::{Aabb, Fx, Vec2, fx_div, fx_mul, sqrt};
use crate::solver::{ContactTuning, RATE_MAX, SUB_STEPS_MAX, SolverSettings, check_count, check_setting};

/// Settings of a world. [`World::set_config`](crate::world::World::set_config) changes them, except for the limits.
///
/// # Small bodies
///
/// Soft contacts are springs that yield in proportion to `g / hertz^2`, whatever the size of the bodies. With the
/// default 30 Hz a stack of 8 boxes on the ground sinks by 19.6 mm: 2 % of a box of 1 m, but 20 % of one of 10 cm. The
/// stiffness in Hz is at most an eighth of the sub-step rate. With 60 ticks per second and gravity of 10 m/s²,
/// [`Config::for_smallest`] gives:
///
/// | smallest box | sub-steps | contact stiffness | speculative distance | 8 boxes sink by (share of a box) |
/// |---|---|---|---|---|
/// | 0.9 m and more | 4 (default) | 30 Hz (default) | 1.8 to 2 cm (default) | at most 2.5 % |
/// | 0.3 m | 7 | 52.5 Hz | 6 mm | 2.2 % |
/// | 0.1 m | 12 | 90 Hz | 2 mm | 2.3 % |
/// | 3 cm | 22 | 165 Hz | 1 mm | 2.3 % |
/// | 1 cm | 37 | 277.5 Hz | 1 mm | 2.4 % |
/// | 5 mm | 52 | 390 Hz | 1 mm | 2.4 % |
///
/// Only gravity divided by size matters: boxes of 10 cm under 1 m/s² need the same settings as boxes of 1 m under 10
/// m/s². A dynamic body with mass needs a radius of gyration of at least 2 mm and a mass of at least 10 mg. Small
/// bodies may also need a lower [`SolverSettings::restitution_threshold`] and
/// [`sleep_speed`](crate::body::BodySettings::sleep_speed).
///
/// ```
/// use lockstep2d::{fx, math::Vec2, world::{Config, World}};
/// let moon = Config { gravity: Vec2::new(fx!(0), fx!(-1.62)), tick_rate: 30, ..Config::default() };
/// let world = World::new(moon)?;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Config {
    /// Ticks per second, 10 to 1000.
    pub tick_rate: u32,
    /// Gravity in m/s², within ±100 000 on each axis.
    pub gravity: Vec2<Fx>,
    /// Settings of the solver.
    pub solver: SolverSettings,
    /// Distance in metres at which shapes get contact points before they touch, 0.001 to 1. For approaching pairs the
    /// distance is larger.
    pub speculative_distance: Fx,
    /// Largest margin of fat boxes in metres, 0.001 to 10. On a body that can move, the margin is a 32nd of the larger
    /// side of the shape's AABB, limited to this value. With larger margins, fat boxes change less often, but more of
    /// them overlap.
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
    /// Largest number of pairs of shapes in a tick, at most 2^20: see
    /// [`World::pair_count`](crate::world::World::pair_count). If there are more, the tick leaves out the pairs of the
    /// shapes in the largest slots, and counts one fault. The limit bounds the time and memory of a tick for untrusted
    /// worlds. It does not limit pairs of sleeping bodies.
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
    /// Distance in metres within which shapes begin to touch: a quarter of the speculative distance. Touching shapes
    /// cease to touch only beyond the speculative distance, so that a wobbling contact does not begin and end
    /// repeatedly.
    #[must_use]
    pub fn touching_distance(&self) -> Fx {
        self.speculative_distance / 4
    }

    /// Margin in metres of the fat box of a shape with the given AABB on a body that can move.
    pub(crate) fn margin_of(&self, bounds: Aabb) -> Fx {
        // The box is within the world extent, so that the difference does not overflow.
        let half = bounds.upper.wrapping_sub(bounds.centre());
        (half.x.max(half.y) / 16).min(self.fat_margin)
    }

    /// Number of ticks for which a body has to be slow before it may sleep: half a second, rounded up.
    #[must_use]
    pub const fn ticks_to_sleep(&self) -> u32 {
        self.tick_rate.div_ceil(2)
    }

    /// Returns these settings with enough sub-steps and contact stiffness for a stack of 8 boxes of `size` metres to
    /// sink by less than 2.5 % of a box; see [`Config`]. Also reduces the speculative distance to a fiftieth of `size`,
    /// but not below 1 mm. Settings that already suffice stay as they are. Set gravity and the tick rate before the
    /// call.
    ///
    /// The needed number of sub-steps per second is `sqrt(4800 g / size)`. The result has at most 64 sub-steps per tick
    /// and 4000 per second, enough for boxes of 5 mm at 60 ticks per second and 10 m/s². The stiffness changes only for
    /// [soft](ContactTuning::Soft) contacts.
    ///
    /// ```
    /// use lockstep2d::{fx, world::{Config, World}};
    /// let dice = Config::default().for_smallest(fx!(0.01));
    /// assert_eq!(dice.solver.sub_steps, 37);
    /// let world = World::new(dice)?;
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    pub fn for_smallest(mut self, size: Fx) -> Self {
        // A stack of 8 boxes sinks by 1.96 % of a box times (30 Hz / f)^2 (g / 10 m/s^2) / (size / 1 m). The stiffness
        // `f` is an eighth of the sub-step rate, so for 2.4 % the square of the rate is 4800 g / size.
        let size = size.max(fx!(0.001));
        let squared = fx_div(fx_mul(fx!(4800), self.gravity.length()), size).unwrap_or(Fx::MAX);
        let needed = sqrt(squared).unwrap_or(Fx::ZERO).ceil().to_num::<u32>();
        let most = (RATE_MAX / self.tick_rate.max(1)).min(SUB_STEPS_MAX);
        let solver = &mut self.solver;
        solver.sub_steps = needed.div_ceil(self.tick_rate.max(1)).min(most).max(solver.sub_steps);
        if let ContactTuning::Soft { hertz, .. } = &mut solver.contact {
            let wanted = Fx::from_num(needed.min(RATE_MAX)) / 8;
            if *hertz < wanted {
                *hertz = Fx::from_num(self.tick_rate.saturating_mul(solver.sub_steps).min(RATE_MAX)) / 8;
            }
        }
        // The default of 2 cm is a fiftieth of 1 m, so boxes of 1 m and more keep it.
        self.speculative_distance = self.speculative_distance.min((size / 50).max(SPECULATIVE_DISTANCE_MIN));
        self
    }

    /// The name of the first limit in which `other` differs.
    pub(crate) fn first_changed_limit(&self, other: &Config) -> Option<&'static str> {
        let limits = [
            (self.body_limit, other.body_limit, "body_limit"),
            (self.shape_limit, other.shape_limit, "shape_limit"),
            (self.joint_limit, other.joint_limit, "joint_limit"),
            (self.pair_limit, other.pair_limit, "pair_limit"),
        ];
        limits.into_iter().find(|(own, other, _)| own != other).map(|(.., name)| name)
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`WorldError::Setting`] or [`WorldError::CountSetting`] for the first setting that is out of range.
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
        check_count("tick_rate", tick_rate, 10, 1000)?;
        check_gravity(gravity)?;
        check_setting("speculative_distance", speculative_distance, SPECULATIVE_DISTANCE_MIN, fx!(1))?;
        check_setting("fat_margin", fat_margin, fx!(0.001), fx!(10))?;
        check_setting("hit_speed", hit_speed, fx!(0), fx!(400))?;
        check_count("body_limit", body_limit, 0, 1 << 20)?;
        check_count("shape_limit", shape_limit, 0, 1 << 20)?;
        check_count("joint_limit", joint_limit, 0, 1 << 20)?;
        check_count("pair_limit", pair_limit, 0, 1 << 20)?;
        solver.validate(tick_rate)
    }
}

/// Smallest [`Config::speculative_distance`] in metres.
const SPECULATIVE_DISTANCE_MIN: Fx = fx!(0.001);

pub(crate) fn check_gravity(gravity: Vec2<Fx>) -> Result<(), WorldError> {
    [gravity.x, gravity.y]
        .into_iter()
        .try_for_each(|g| check_setting("gravity", g, fx!(-100000), fx!(100000)))
}
