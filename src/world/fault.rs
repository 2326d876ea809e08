//! Faults on purpose: a bit of memory that flips, to try what is there to notice it.

use super::World;
use crate::body::{Body, BodyId, Handle, SPEED_MAX, WorldError};
use crate::math::Speed;

/// A number of a body's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The horizontal velocity of its centre of mass.
    VelocityX,
    /// The vertical velocity of its centre of mass.
    VelocityY,
    /// Its spin: the radius of gyration times the angular velocity.
    Spin,
}

impl Motion {
    /// All of them.
    pub const ALL: [Motion; 3] = [Motion::VelocityX, Motion::VelocityY, Motion::Spin];

    /// The name that the field has in a view of the state.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Motion::VelocityX => "velocity.x",
            Motion::VelocityY => "velocity.y",
            Motion::Spin => "spin",
        }
    }

    fn of(self, body: &mut Body) -> &mut Speed {
        match self {
            Motion::VelocityX => &mut body.velocity.x,
            Motion::VelocityY => &mut body.velocity.y,
            Motion::Spin => &mut body.spin,
        }
    }
}

impl World {
    /// Flips one of the 32 bits of a number of a dynamic body that is awake, as failing memory would, and nothing else:
    /// to try what notices a divergence. The bits count 2^-21 m/s.
    ///
    /// # Errors
    /// When the handle is stale, the body is not dynamic or is asleep, or no body can have that speed or move along that
    /// axis; then nothing is changed.
    pub fn flip_bit(&mut self, id: BodyId, motion: Motion, bit: u32) -> Result<(), WorldError> {
        let body = self.state.bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let locks = body.settings.locks;
        let locked = match motion {
            Motion::VelocityX => locks.x,
            Motion::VelocityY => locks.y,
            Motion::Spin => locks.rotation,
        };
        if !body.is_dynamic() || body.is_asleep() || !body.is_enabled() || locked {
            return Err(WorldError::WrongKind(id));
        }
        let number = motion.of(self.state.bodies.at_mut(id.slot()));
        let flipped = Speed::from_bits(number.to_bits() ^ 1i32.checked_shl(bit).unwrap_or(0));
        if !(-SPEED_MAX..=SPEED_MAX).contains(&flipped) {
            return Err(WorldError::SpeedOutOfRange { value: flipped.into() });
        }
        *number = flipped;
        Ok(())
    }
}
