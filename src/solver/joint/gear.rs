//! Gears: a pair of toothed wheels, and a wheel on a rack.
//!
//! The impulse acts on both bodies at the pitch point, along the common tangent of the wheels. Axles may move: a planet
//! gear on a turning arm is two hinges and a gear.
//!
//! With `NA` and `NB` teeth, the angles `a` and `b` of the frames and the angle `p` of the line from A's anchor to B's
//! anchor, the error of the mesh is:
//!
//! ```text
//! C = NA (a - p) + NB (b - p)        in teeth; wheels that turn against each other have teeth of the same sign
//! ```
//!
//! `C` is known up to whole teeth from the pose alone, because a turn of a wheel is a whole number of teeth. The mesh
//! therefore does not drift. Wheels that are forced out of mesh by more than half a tooth skip a tooth.

use serde::{Deserialize, Serialize};

use super::options::check;
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::fx;
use crate::math::Fx;

const TEETH_MAX: Fx = fx!(1000);
const RADIUS_MIN: Fx = fx!(0.001);
const RADIUS_MAX: Fx = fx!(128);

/// Checks the magnitude of a number. The error states the range for the sign of the number.
fn check_either_sign(what: &'static str, value: Fx, min: Fx, max: Fx) -> Result<(), WorldError> {
    if value < Fx::ZERO { check(what, value, -max, -min) } else { check(what, value, min, max) }
}

/// A gear: two wheels about the anchors, whose teeth mesh.
///
/// Relative to the line between the anchors, B turns by `-teeth_a / teeth_b` times the turn of A.
///
/// Wheels with teeth of the same sign are beside each other and turn in opposite directions. A wheel with a negative
/// number of teeth is a ring around the other wheel. The two then turn the same way, as with a belt.
///
/// The gear does not fix the distance of the wheels: give each wheel a hinge, to the ground or to a common body.
/// [`World::fit_joint`](crate::world::World::fit_joint) sets the angles of the frames so that the teeth mesh.
///
/// ```
/// use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, solver::{Gear, JointDef, Revolute}, world::World};
/// let mut world = World::default();
/// let ground = world.spawn(&BodyDef::fixed(), &[])?;
/// let disc = |radius| Geometry::circle(radius).map(ShapeDef::new);
/// let small = world.spawn(&BodyDef::dynamic(), &[disc(fx!(1))?])?;
/// let large = world.spawn(&BodyDef::dynamic().position((fx!(3), fx!(0))), &[disc(fx!(2))?])?;
/// let crank = Revolute::new().motor(fx!(4), fx!(1000));
/// world.add_joint(&world.joint_at(ground, small, crank, (fx!(0), fx!(0)))?)?;
/// world.add_joint(&world.joint_at(ground, large, Revolute::new(), (fx!(3), fx!(0)))?)?;
/// world.add_joint(&world.fit_joint(&JointDef::new(small, large, Gear::new(20, 40)))?)?;
/// for _ in 0..60 {
///     world.step();
/// }
/// let speed = world.body(large).expect("still there").angular_velocity();
/// assert!((speed + fx!(2)).abs() < fx!(0.001));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "GearJoint")]
#[doc(alias = "cog")]
#[doc(alias = "belt")]
pub struct Gear {
    /// Teeth of A's wheel: 1 to 1000, or -1 to -1000 for a ring.
    pub teeth_a: i32,
    /// Teeth of B's wheel, in the same ranges. At most one of the wheels is a ring.
    pub teeth_b: i32,
}

impl Gear {
    /// A gear with the numbers of teeth of A and B.
    #[must_use]
    pub const fn new(teeth_a: i32, teeth_b: i32) -> Self {
        Gear { teeth_a, teeth_b }
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        let [a, b] = [self.teeth_a, self.teeth_b].map(Fx::from_num);
        check_either_sign("number of teeth on A", a, Fx::ONE, TEETH_MAX)?;
        check_either_sign("number of teeth on B", b, Fx::ONE, TEETH_MAX)?;
        // Two rings cannot be around each other.
        let one_ring = "number of teeth on B, as A is a ring,";
        if a < Fx::ZERO { check(one_ring, b, Fx::ONE, TEETH_MAX) } else { Ok(()) }
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        parts.hold(slot::HOLD, Direction::Coupled(parts.coupling), Fx::ZERO);
    }
}

/// A wheel on a rack: A turns about its anchor and rolls along the x axis of B's frame.
///
/// The pitch line is at the distance `radius` to the right of the x axis. The joint does not keep the wheel on the
/// rack: give the wheel a hinge and the rack a slider. If the rack is fixed, give the wheel a
/// [`Wheel`](crate::solver::Wheel) joint. [`World::fit_joint`](crate::world::World::fit_joint) moves B's anchor so that
/// the joint has no position error.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, world::World};
/// use lockstep2d::solver::{JointDef, Prismatic, Rack, Revolute};
/// use lockstep2d::fx;
/// # let mut world = World::default();
/// # let ground = world.spawn(&BodyDef::fixed(), &[])?;
/// # let (wheel, bar) = (Geometry::circle(fx!(0.4))?, Polygon::rectangle(fx!(2), fx!(0.1))?);
/// # let pinion = BodyDef::dynamic().position((fx!(0), fx!(0.5)));
/// # let pinion = world.spawn(&pinion, &[ShapeDef::new(wheel)])?;
/// # let gate = world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(bar)])?;
/// // A pinion of 0.5 m turns at 2 rad/s on the rack of a sliding gate.
/// let motor = Revolute::new().motor(fx!(2), fx!(1000));
/// world.add_joint(&world.joint_at(ground, pinion, motor, (fx!(0), fx!(0.5)))?)?;
/// world.add_joint(&JointDef::new(ground, gate, Prismatic::new()))?;
/// world.add_joint(&world.fit_joint(&JointDef::new(pinion, gate, Rack::new(fx!(0.5))))?)?;
/// (0..30).for_each(|_| world.step());
/// let speed = world.body(gate).expect("still there").velocity().x;
/// assert!((speed - fx!(1)).abs() < fx!(0.01), "{speed}");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "pinion")]
#[doc(alias = "rack and pinion")]
pub struct Rack {
    /// Pitch radius of the wheel in metres, 0.001 to 128. Negative for a rack on the other side.
    pub radius: Fx,
}

impl Rack {
    /// A rack for a wheel with the given pitch radius in metres.
    #[must_use]
    pub const fn new(radius: Fx) -> Self {
        Rack { radius }
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        check_either_sign("radius in m", self.radius, RADIUS_MIN, RADIUS_MAX)
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        parts.hold(slot::HOLD, Direction::Coupled(parts.coupling), Fx::ZERO);
    }
}
