//! Limits, motors and springs of joints.

use serde::{Deserialize, Serialize};

use crate::body::WorldError;
use crate::fx;
use crate::math::Fx;

pub(super) const SIZE_MAX: Fx = fx!(1048576);
const HERTZ_MAX: Fx = fx!(1000);
const DAMPING_RATIO_MAX: Fx = fx!(100);

/// The range of a joint's position, in radians or metres, within ±2^20, with `lower <= upper`. In
/// [`Distance::spring_force`](crate::solver::Distance::spring_force), this type is a range of forces in N.
///
/// Under a steady acceleration `a`, a position exceeds its limit by `a / (2 pi f)^2`. Here `f` is the frequency of
/// [`JointDef::softness`](crate::solver::JointDef::softness), or else of
/// [`SolverSettings::joint_hertz`](crate::solver::SolverSettings::joint_hertz), but at most a quarter of the sub-step
/// rate.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, math::Vec2, world::World};
/// use lockstep2d::{fx, solver::{JointLimit, Revolute}};
/// # let mut world = World::default();
/// # let wall = world.spawn(&BodyDef::fixed(), &[])?;
/// # let plank = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.1))?);
/// # let flap = world.spawn(&BodyDef::dynamic().position((fx!(1), fx!(0))), &[plank])?;
/// let hinge = world.add_joint(&world.joint_at(wall, flap, Revolute::new(), (fx!(0), fx!(0)))?)?;
/// // A key unlocks the flap, which then opens downwards by half a radian.
/// world.set_joint_limit(hinge, Some(JointLimit { lower: fx!(-0.5), upper: fx!(0) }))?;
/// (0..120).for_each(|_| world.step());
/// assert!(world.joint_angle(hinge).is_some_and(|angle| (angle + fx!(0.5)).abs() < fx!(0.01)));
/// # let _ = Vec2::<lockstep2d::math::Fx>::ZERO;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JointLimit {
    /// The lower end.
    pub lower: Fx,
    /// The upper end.
    pub upper: Fx,
}

/// A motor: drives the joint to a speed with limited force or torque. At speed 0 it is friction.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, world::World};
/// use lockstep2d::{fx, math::Fx, solver::{Drive, Revolute}};
/// # let mut world = World::default();
/// # let wall = world.spawn(&BodyDef::fixed(), &[])?;
/// # let fan = world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(1))?)])?;
/// // A fan that nothing can slow down: its motor has unlimited torque.
/// let motor = Revolute { motor: Some(Drive { speed: fx!(-3), max: Fx::MAX }), ..Revolute::new() };
/// world.add_joint(&world.joint_at(wall, fan, motor, (fx!(0), fx!(0)))?)?;
/// (0..10).for_each(|_| world.step());
/// assert!(world.body(fan).is_some_and(|fan| (fan.angular_velocity() + fx!(3)).abs() < fx!(0.001)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Drive {
    /// Target speed of B relative to A in rad/s or m/s, within ±2^20.
    pub speed: Fx,
    /// Largest torque in N m or force in N, 0 or more; [`Fx::MAX`] is unlimited.
    pub max: Fx,
}

/// A damped spring with a target.
///
/// A spring on an angle lets two free bodies swing with the frequency `hertz`. A body on a hinge away from its centre
/// of mass swings more slowly. A spring along a line has the stiffness `(2 pi hertz)^2 m` N/m, with the reduced mass
/// `m` of [`Soft`]. If the line does not pass through a body's centre of mass, the spring also turns this body, which
/// raises the frequency.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::{fx, solver::{Distance, JointDef, Spring}};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let ceiling = world.spawn(&BodyDef::fixed(), &[])?;
/// # let lamp = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(-2))), &[square])?;
/// // A lamp on a spring of 2 m that swings once a second, and comes to rest soon.
/// let spring = Spring { hertz: fx!(1), damping_ratio: fx!(0.5), target: fx!(2) };
/// let spring = Distance { spring: Some(spring), ..Distance::new() };
/// world.add_joint(&JointDef::new(ceiling, lamp, spring))?;
/// (0..600).for_each(|_| world.step());
/// // It sags by g / (2 pi f)^2.
/// let sag = fx!(-2) - world.body(lamp).expect("still there").position().y;
/// assert!((sag - fx!(0.2533)).abs() < fx!(0.001), "{sag}");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spring {
    /// Undamped frequency in Hz, above 0, up to 1000. Above a tenth of the sub-step rate, the effective frequency is
    /// lower.
    pub hertz: Fx,
    /// Damping ratio, 0 to 100: 1 is critical damping.
    pub damping_ratio: Fx,
    /// Rest position in rad or m, within ±2^20.
    pub target: Fx,
}

/// Frequency and damping ratio of a spring, or of the rigid parts of a joint
/// ([`JointDef::softness`](crate::solver::JointDef::softness)).
///
/// With an angular spring, two free bodies swing with the frequency `hertz`. With a linear spring between anchors, two
/// point masses swing with this frequency: the stiffness is `(2 pi hertz)^2 m` N/m in all directions. Here `m` is the
/// reduced mass `MA MB / (MA + MB)`, or the mass of the only moving body. A body that hangs on a fixed body sags by
/// `g / (2 pi hertz)^2`. If its anchor is at the distance `r` from the centre of mass, perpendicular to the pull, the
/// frequency and the damping ratio are `sqrt(1 + r^2 / k^2)` times as large, with the radius of gyration `k`.
///
/// At a sub-step rate of `rate` Hz, a linear spring that is stretched by `x` metres adds energy to a body of mass `M`
/// if `(2 pi hertz / rate)^2 m x r / (M k^2)` is above about 1, with `m`, `r` and `k` as above.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, world::World};
/// use lockstep2d::{fx, solver::{JointDef, Soft, Weld}};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let truck = world.spawn(&BodyDef::fixed(), &[])?;
/// # let jelly = world.spawn(&BodyDef::dynamic(), &[square])?;
/// // A load of jelly, soft in its position on the truck and in its angle.
/// let soft = Soft { hertz: fx!(3), damping_ratio: fx!(0.4) };
/// let glue = Weld { linear: Some(soft), angular: Some(soft) };
/// world.add_joint(&JointDef::new(truck, jelly, glue))?;
/// (0..300).for_each(|_| world.step());
/// // It sags by g / (2 pi f)^2.
/// let sag = -world.body(jelly).expect("still there").position().y;
/// assert!((sag - fx!(0.0281)).abs() < fx!(0.001), "{sag}");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Soft {
    /// Undamped frequency in Hz, above 0, up to 1000.
    pub hertz: Fx,
    /// Damping ratio, 0 to 100.
    pub damping_ratio: Fx,
}

impl Soft {
    pub(crate) const fn towards(self, target: Fx) -> Spring {
        Spring { hertz: self.hertz, damping_ratio: self.damping_ratio, target }
    }
}

/// Defines builder methods. Each sets the optional field of its own name to the value after the arrow.
macro_rules! option_builders {
    ($($(#[$doc:meta])* $field:ident($($argument:ident),+) => $value:expr;)+) => {
        $(
            $(#[$doc])*
            #[must_use]
            pub const fn $field(mut self, $($argument: Fx),+) -> Self {
                self.$field = Some($value);
                self
            }
        )+
    };
}
pub(super) use option_builders;

pub(super) fn check_options(
    limit: Option<JointLimit>,
    motor: Option<Drive>,
    spring: Option<Spring>,
) -> Result<(), WorldError> {
    JointLimit::check(limit)?;
    Drive::check(motor)?;
    Spring::check(spring)
}

pub(super) fn check(what: &'static str, value: Fx, min: Fx, max: Fx) -> Result<(), WorldError> {
    let in_range = (min..=max).contains(&value);
    if in_range { Ok(()) } else { Err(WorldError::JointOutOfRange { what, value, min, max }) }
}

pub(super) fn check_sane(what: &'static str, value: Fx) -> Result<(), WorldError> {
    check(what, value, -SIZE_MAX, SIZE_MAX)
}

pub(super) fn check_strength(what: &'static str, value: Fx) -> Result<(), WorldError> {
    check(what, value, Fx::ZERO, Fx::MAX)
}

impl JointLimit {
    fn check(limit: Option<Self>) -> Result<(), WorldError> {
        let Some(JointLimit { lower, upper }) = limit else { return Ok(()) };
        check_sane("lower limit", lower)?;
        check_sane("upper limit", upper)?;
        if lower <= upper { Ok(()) } else { Err(WorldError::JointLimitReversed { lower, upper }) }
    }
}

impl Drive {
    pub(super) fn check(drive: Option<Self>) -> Result<(), WorldError> {
        let Some(Drive { speed, max }) = drive else { return Ok(()) };
        check_sane("motor speed", speed)?;
        check_strength("largest motor force or torque", max)
    }
}

impl Soft {
    /// Checks the ranges of both values. `frequency` and `damping` are their names in an error.
    pub(super) fn check(
        soft: Option<Self>,
        [frequency, damping]: [&'static str; 2],
    ) -> Result<(), WorldError> {
        let Some(Soft { hertz, damping_ratio }) = soft else { return Ok(()) };
        check(frequency, hertz, Fx::DELTA, HERTZ_MAX)?;
        check(damping, damping_ratio, Fx::ZERO, DAMPING_RATIO_MAX)
    }
}

impl Spring {
    fn check(spring: Option<Self>) -> Result<(), WorldError> {
        let Some(Spring { hertz, damping_ratio, target }) = spring else { return Ok(()) };
        let soft = Soft { hertz, damping_ratio };
        Soft::check(Some(soft), ["spring frequency in Hz", "spring damping ratio"])?;
        check_sane("spring target", target)
    }
}
