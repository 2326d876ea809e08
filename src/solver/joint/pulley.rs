//! The pulley: a rope over two fixed wheels, `J v = nA.(vA + wA x rA) + ratio nB.(vB + wB x rB)`, where `nA` and `nB`
//! point from the wheels to the anchors (Box2D 2.4).

use serde::{Deserialize, Serialize};

use super::options::{SIZE_MAX, check};
use super::parts::{Direction, Parts};
use crate::body::{WORLD_EXTENT_MAX, WorldError};
use crate::fx;
use crate::math::{Fx, Vec2, fx_mul};

const RATIO_MIN: Fx = fx!(0.25);
const RATIO_MAX: Fx = fx!(4);

/// A pulley: a rope from A's anchor over two wheels to B's anchor.
///
/// The length on A's side plus `ratio` times the length on B's side is at most `length`.
///
/// The rope only pulls. The force on B is `ratio` times the force on A, as in a tackle in which B hangs from `ratio`
/// strands.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let light = world.spawn(&BodyDef::dynamic().position((fx!(-1), fx!(0))), &[square])?;
/// # let heavy = world.spawn(&BodyDef::dynamic().position((fx!(1), fx!(0))), &[square.density(fx!(2))])?;
/// use lockstep2d::solver::{JointDef, Pulley};
/// // Two wheels 5 m above the bodies, and a rope that is just taut.
/// let rope = Pulley::new((fx!(-1), fx!(5)), (fx!(1), fx!(5)), fx!(10));
/// world.add_joint(&JointDef::new(light, heavy, rope))?;
/// (0..30).for_each(|_| world.step());
/// assert!(world.body(light).is_some_and(|body| body.position().y > fx!(0.3)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "PulleyJoint")]
#[doc(alias = "tackle")]
pub struct Pulley {
    /// Position of the wheel on A's side, in metres in the world, within ±2^30.
    pub wheel_a: Vec2<Fx>,
    /// Position of the wheel on B's side, in metres in the world, within ±2^30.
    pub wheel_b: Vec2<Fx>,
    /// Length of the rope in metres, 0 to 2^20, without the part between the wheels.
    pub length: Fx,
    /// Factor by which the length on B's side counts, 0.25 to 4.
    pub ratio: Fx,
}

impl Pulley {
    /// A rope with a length in metres over two wheels in the world, with the ratio 1.
    #[must_use]
    pub fn new(wheel_a: impl Into<Vec2<Fx>>, wheel_b: impl Into<Vec2<Fx>>, length: Fx) -> Self {
        Pulley { wheel_a: wheel_a.into(), wheel_b: wheel_b.into(), length, ratio: Fx::ONE }
    }

    /// Sets the factor by which the length on B's side counts.
    #[must_use]
    pub const fn ratio(mut self, ratio: Fx) -> Self {
        self.ratio = ratio;
        self
    }

    /// Length in metres of a taut rope with its anchors at two points of the world.
    pub(super) fn taut_length(&self, on_a: Vec2<Fx>, on_b: Vec2<Fx>) -> Fx {
        let beside = fx_mul(self.ratio, self.wheel_b.distance(on_b));
        self.wheel_a.distance(on_a).saturating_add(beside)
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        let Pulley { wheel_a, wheel_b, length, ratio } = *self;
        for coordinate in [wheel_a.x, wheel_a.y, wheel_b.x, wheel_b.y] {
            check("wheel coordinate in m", coordinate, -WORLD_EXTENT_MAX, WORLD_EXTENT_MAX)?;
        }
        check("rope length in m", length, Fx::ZERO, SIZE_MAX)?;
        check("ratio", ratio, RATIO_MIN, RATIO_MAX)
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        parts.upper(Direction::Coupled(parts.coupling), self.length);
    }
}
