//! The weld joint: a row on the angle and a point block at the anchors, each rigid or a spring.
//!
//! The point block acts at the anchors. If it acted at the point at which its impulse does not rotate the bodies
//! relative to each other, a plank welded to a wall would sag only a fifth as far. But the gaps of a loaded chain of
//! planks would be four times as wide. A weld of two boxes of 1 cm that carries 100 times their mass would even gain
//! energy.

use serde::{Deserialize, Serialize};

use super::hinge::AngleParts;
use super::options::{Soft, option_builders};
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::math::Fx;

/// A weld: B's frame stays on A's.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let a = world.spawn(&BodyDef::fixed(), &[])?;
/// # let b = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0))), &[square])?;
/// use lockstep2d::solver::{JointDef, Weld};
/// // A springboard: its anchors are rigid, its angle yields with 2 Hz.
/// let board = Weld::rigid().angular(fx!(2), fx!(0.3));
/// world.add_joint(&JointDef::new(a, b, board).anchor_b((fx!(-2), fx!(0))))?;
/// (0..300).for_each(|_| world.step());
/// assert!(world.body(b).is_some_and(|board| board.angle().to_radians() < fx!(0)));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[doc(alias = "fixed joint")]
#[doc(alias = "FixedJoint")]
#[doc(alias = "WeldJoint")]
pub struct Weld {
    /// Softness of the anchors in all directions ([`Soft`]); `None` is rigid. However far the spring is stretched, it
    /// conserves angular momentum.
    pub linear: Option<Soft>,
    /// Softness of the angle; `None` is rigid.
    pub angular: Option<Soft>,
}

impl Weld {
    /// A rigid weld.
    #[must_use]
    pub const fn rigid() -> Self {
        Weld { linear: None, angular: None }
    }

    option_builders! {
        /// Makes the anchors soft, with a frequency in Hz, as for two point masses.
        linear(hertz, damping_ratio) => Soft { hertz, damping_ratio };
        /// Makes the angle soft, with a frequency in Hz.
        angular(hertz, damping_ratio) => Soft { hertz, damping_ratio };
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        Soft::check(self.linear, ["linear frequency in Hz", "linear damping ratio"])?;
        Soft::check(self.angular, ["angular frequency in Hz", "angular damping ratio"])
    }

    /// The row on the angle of a weld that is solved as a hinge, because its anchors are rigid. Otherwise `None`.
    pub(super) fn angle_parts(&self) -> Option<AngleParts> {
        let spring = self.angular.map(|soft| soft.towards(Fx::ZERO));
        let parts = AngleParts { spring, held: spring.is_none(), drive: None, limit: None };
        self.linear.is_none().then_some(parts)
    }

    pub(super) fn prepare(&self, parts: &mut Parts<'_>) {
        match self.angular {
            Some(soft) => parts.spring(Direction::Angle, Some(soft.towards(Fx::ZERO))),
            None => parts.hold(slot::SPRING, Direction::Angle, Fx::ZERO),
        }
        if let Some(soft) = self.linear {
            parts.pull(slot::HOLD, soft, Fx::MAX);
        }
    }
}
