//! The weld: a row on the angle and a point block at the anchors, each rigid or a spring.
//!
//! Held where a push does not turn the bodies, as a slider is, a plank on a wall sags a fifth as far. But the anchors of a
//! loaded chain then open four times as wide, and a weld of 1 cm that carries a hundredfold weight gains energy.

use serde::{Deserialize, Serialize};

use super::hinge::AngleParts;
use super::options::{Soft, option_builders};
use super::parts::{Direction, Parts, slot};
use crate::body::WorldError;
use crate::math::Fx;

/// Glue: B's frame stays on A's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Weld {
    /// How the anchors give way; `None` is rigid.
    pub linear: Option<Soft>,
    /// How the angle gives way; `None` is rigid.
    pub angular: Option<Soft>,
}

impl Weld {
    /// A rigid weld: as rigid as the solver is.
    #[must_use]
    pub const fn rigid() -> Self {
        Weld { linear: None, angular: None }
    }

    option_builders! {
        /// Lets the anchors swing apart, with a frequency in Hz.
        linear(hertz, damping_ratio) => Soft { hertz, damping_ratio };
        /// Lets the angle swing, with a frequency in Hz.
        angular(hertz, damping_ratio) => Soft { hertz, damping_ratio };
    }

    pub(super) fn validate(&self) -> Result<(), WorldError> {
        Soft::check(self.linear)?;
        Soft::check(self.angular)
    }

    /// Its row on the angle, if it is a hinge: if its anchors do not give way.
    pub(super) fn angle_parts(&self) -> Option<AngleParts> {
        let spring = self.angular.map(|soft| soft.towards(Fx::ZERO));
        let parts = AngleParts { spring, held: spring.is_none(), drive: None, limit: None };
        self.linear.is_none().then_some(parts)
    }

    /// What it is made of if its anchors give way.
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
