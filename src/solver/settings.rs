//! Settings of the solver.

use serde::{Deserialize, Serialize};

use super::softness::Softness;
use crate::body::WorldError;
use crate::fx;
use crate::math::{Fx, Rate, Speed, Step, Vec2, narrow};

/// Method by which contacts remove overlap.
///
/// ```
/// use lockstep2d::solver::{ContactTuning, SolverSettings};
/// use lockstep2d::{fx, world::{Config, World}};
/// // Pillows: contacts that yield a few centimetres.
/// let contact = ContactTuning::Soft { hertz: fx!(5), damping_ratio: fx!(1), push_speed: fx!(3) };
/// let solver = SolverSettings { contact, ..SolverSettings::default() };
/// assert!(World::new(Config { solver, ..Config::default() }).is_ok());
/// // A setting out of range is an error that names the setting.
/// let contact = ContactTuning::Soft { hertz: fx!(-1), damping_ratio: fx!(1), push_speed: fx!(3) };
/// let solver = SolverSettings { contact, ..SolverSettings::default() };
/// assert!(World::new(Config { solver, ..Config::default() }).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactTuning {
    /// Stiff damped springs, followed by a relax pass that removes the push-out velocity.
    Soft {
        /// Stiffness in Hz, 1 to 1000, limited to an eighth of the sub-step rate. Contacts with a body that is not
        /// dynamic have twice this stiffness. A stack sinks in proportion to `g / hertz^2`: see
        /// [`Config`](crate::world::Config) for small bodies.
        hertz: Fx,
        /// Damping ratio, 0 to 100.
        damping_ratio: Fx,
        /// Largest speed at which overlap is pushed out, in m/s, 0 to 400.
        push_speed: Fx,
    },
    /// Baumgarte stabilisation (J. Baumgarte, 1972). Simpler than soft contacts, but bodies bounce more.
    Baumgarte {
        /// Share of the overlap beyond the slop that a sub-step removes, 0 to 1.
        share: Fx,
        /// Overlap that is not removed, in metres, 0 to 1, so that contacts persist from tick to tick.
        slop: Fx,
        /// Largest speed at which overlap is pushed out, in m/s, 0 to 400.
        push_speed: Fx,
    },
}

/// Largest number of sub-steps in a tick.
pub(crate) const SUB_STEPS_MAX: u32 = 64;

/// Largest number of sub-steps in a second.
pub(crate) const RATE_MAX: u32 = 4000;

/// Largest displacement of a body in a tick at the speed limit, in metres. See [`SolverSettings::speed_max`].
pub const DISTANCE_MAX: Fx = fx!(15);

/// Settings of the solver.
///
/// ```
/// use lockstep2d::{solver::SolverSettings, world::{Config, World}};
/// // Twice the sub-steps: chains with heavy loads stretch less, and a tick costs more.
/// let solver = SolverSettings { sub_steps: 8, ..SolverSettings::default() };
/// let world = World::new(Config { solver, ..Config::default() })?;
/// # let _ = world;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SolverSettings {
    /// Sub-steps in a tick, 1 to 64. Ticks per second times sub-steps is 60 to 4000. Small bodies need more sub-steps:
    /// see [`Config::for_smallest`](crate::world::Config::for_smallest).
    pub sub_steps: u32,
    /// Iterations in a sub-step, 1 to 16. Additional sub-steps improve the result more than additional iterations.
    pub iterations: u32,
    /// Method by which contacts remove overlap.
    pub contact: ContactTuning,
    /// Stiffness in Hz, 1 to 1000, of joints that have no [softness of their own](crate::solver::JointDef::softness),
    /// limited to a quarter of the sub-step rate. The anchors of a hinge, or of a weld with rigid anchors, have twice
    /// this stiffness if one body has no other joint and the other body is not dynamic.
    pub joint_hertz: Fx,
    /// Damping ratio, 0 to 100, of joints that have no softness of their own.
    pub joint_damping_ratio: Fx,
    /// Approach speed in m/s, 0 to 400, below which shapes do not bounce, unless
    /// [`Material::restitution_threshold`](crate::body::Material::restitution_threshold) is set.
    pub restitution_threshold: Fx,
    /// Speed limit in m/s, 1 to 400, for dynamic bodies and for velocities that a caller sets. The limit also holds for
    /// the radius of gyration times the angular velocity. At fewer than 27 ticks per second the limit is lower, so that
    /// a body moves at most [`DISTANCE_MAX`] in a tick. The limit is applied before contacts and joints act: in the
    /// tick of an impact, a body may be faster.
    pub speed_max: Fx,
}

impl Default for SolverSettings {
    fn default() -> Self {
        SolverSettings {
            sub_steps: 4,
            iterations: 1,
            contact: ContactTuning::Soft { hertz: fx!(30), damping_ratio: fx!(10), push_speed: fx!(3) },
            joint_hertz: fx!(60),
            joint_damping_ratio: fx!(2),
            restitution_threshold: fx!(1),
            speed_max: fx!(400),
        }
    }
}

impl SolverSettings {
    pub(crate) fn speed_limit(&self, tick_rate: u32) -> Fx {
        self.speed_max.min(DISTANCE_MAX * i64::from(tick_rate))
    }

    pub(crate) fn validate(&self, tick_rate: u32) -> Result<(), WorldError> {
        let SolverSettings {
            sub_steps,
            iterations,
            contact,
            joint_hertz,
            joint_damping_ratio,
            restitution_threshold,
            speed_max,
        } = *self;
        check_count("sub_steps", sub_steps, 1, SUB_STEPS_MAX)?;
        check_count("tick_rate x sub_steps", tick_rate.saturating_mul(sub_steps), 60, RATE_MAX)?;
        check_count("iterations", iterations, 1, 16)?;
        check_setting("joint_hertz", joint_hertz, fx!(1), fx!(1000))?;
        check_setting("joint_damping_ratio", joint_damping_ratio, fx!(0), fx!(100))?;
        check_setting("restitution_threshold", restitution_threshold, fx!(0), fx!(400))?;
        check_setting("speed_max", speed_max, fx!(1), fx!(400))?;
        let push_speed = match contact {
            ContactTuning::Soft { hertz, damping_ratio, push_speed } => {
                check_setting("contact.hertz", hertz, fx!(1), fx!(1000))?;
                check_setting("contact.damping_ratio", damping_ratio, fx!(0), fx!(100))?;
                push_speed
            }
            ContactTuning::Baumgarte { share, slop, push_speed } => {
                check_setting("contact.share", share, fx!(0), fx!(1))?;
                check_setting("contact.slop", slop, fx!(0), fx!(1))?;
                push_speed
            }
        };
        check_setting("contact.push_speed", push_speed, fx!(0), fx!(400))
    }
}

pub(crate) fn check_setting(name: &'static str, value: Fx, min: Fx, max: Fx) -> Result<(), WorldError> {
    let in_range = (min..=max).contains(&value);
    if in_range { Ok(()) } else { Err(WorldError::Setting { name, value, min, max }) }
}

pub(crate) fn check_count(name: &'static str, value: u32, min: u32, max: u32) -> Result<(), WorldError> {
    let in_range = (min..=max).contains(&value);
    if in_range { Ok(()) } else { Err(WorldError::CountSetting { name, value, min, max }) }
}

/// The settings of a tick in the formats of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tuning {
    /// Sub-steps per second.
    pub(crate) rate: u32,
    /// Mean time of the sub-steps in seconds since the start of the tick, each counted at its start.
    pub(crate) mean_time: Fx,
    pub(crate) iterations: u32,
    pub(crate) contact: Softness,
    /// Softness of contacts with a body that is not dynamic.
    pub(crate) contact_immovable: Softness,
    pub(crate) slop: Step,
    pub(crate) push_speed: Speed,
    pub(crate) joint: Softness,
    /// Softness of the anchors of anchored hinges, which connect a body without another joint to a body that impulses
    /// do not move.
    pub(crate) anchored: Softness,
    pub(crate) relax: bool,
    pub(crate) speed_max: Speed,
    /// Velocity change by gravity in a sub-step.
    pub(crate) gravity_step: Vec2<Fx>,
}

impl Tuning {
    pub(crate) fn new(settings: &SolverSettings, gravity: Vec2<Fx>, tick_rate: u32) -> Self {
        let rate = tick_rate * settings.sub_steps;
        let at_most = |hertz: Fx, share: i64| hertz.min(Fx::from_num(rate) / share);
        let (contact, contact_immovable, slop, push_speed, relax) = match settings.contact {
            ContactTuning::Soft { hertz, damping_ratio, push_speed } => {
                let hertz = at_most(hertz, 8);
                let soft = |hertz| Softness::spring(hertz, damping_ratio, rate);
                (soft(hertz), soft(hertz * 2), Fx::ZERO, push_speed, true)
            }
            ContactTuning::Baumgarte { share, slop, push_speed } => {
                let bias_rate: Rate = narrow(fx_rate(share, rate));
                let rigid = Softness::rigid_with_rate(bias_rate);
                (rigid, rigid, slop, push_speed, false)
            }
        };
        let joint_hertz = settings.joint_hertz.min(joint_hertz_max(rate));
        let joint = |hertz| Softness::spring(hertz, settings.joint_damping_ratio, rate);
        let over_rate = |g: Fx| {
            Fx::from_bits(crate::math::saturate_wide(crate::math::div_round(g.to_bits().into(), rate.into())))
        };
        Tuning {
            rate,
            mean_time: crate::math::ratio(i64::from(settings.sub_steps) - 1, 2 * i64::from(rate)),
            iterations: settings.iterations,
            contact,
            contact_immovable,
            slop: narrow(slop),
            push_speed: narrow(push_speed),
            joint: joint(joint_hertz),
            anchored: joint(joint_hertz * 2),
            relax,
            speed_max: narrow(settings.speed_limit(tick_rate)),
            gravity_step: Vec2::new(over_rate(gravity.x), over_rate(gravity.y)),
        }
    }
}

impl Tuning {
    pub(crate) fn own_softness(&self, hertz: Fx, damping_ratio: Fx) -> Softness {
        Softness::spring(hertz.min(joint_hertz_max(self.rate)), damping_ratio, self.rate)
    }
}

fn joint_hertz_max(rate: u32) -> Fx {
    Fx::from_num(rate) / 4
}

fn fx_rate(share: Fx, rate: u32) -> Fx {
    crate::math::fx_mul(share, Fx::from_num(rate))
}
