//! Faults on purpose: a bit of memory that flips, to try what is there to notice it.

use super::World;
use super::step::move_body;
use crate::body::{BodyId, Handle, Pose, SPEED_MAX, WORLD_EXTENT_MAX, WorldError};
use crate::math::{Angle, Fx, Speed};

/// A number of a body's motion or of where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The horizontal velocity of its centre of mass.
    VelocityX,
    /// The vertical velocity of its centre of mass.
    VelocityY,
    /// Its spin: the radius of gyration times the angular velocity.
    Spin,
    /// Where its centre of mass is, along the x axis.
    CentreX,
    /// Where its centre of mass is, along the y axis.
    CentreY,
    /// Its rotation.
    Angle,
}

impl Motion {
    /// All of them, the speeds first.
    pub const ALL: [Motion; 6] =
        [Motion::VelocityX, Motion::VelocityY, Motion::Spin, Motion::CentreX, Motion::CentreY, Motion::Angle];

    /// The three speeds.
    pub const SPEEDS: [Motion; 3] = [Motion::VelocityX, Motion::VelocityY, Motion::Spin];

    /// The name that the field has in a view of the state.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Motion::VelocityX => "velocity.x",
            Motion::VelocityY => "velocity.y",
            Motion::Spin => "spin",
            Motion::CentreX => "centre_of_mass.x",
            Motion::CentreY => "centre_of_mass.y",
            Motion::Angle => "angle",
        }
    }

    /// How many bits the number has.
    #[must_use]
    pub fn bits(self) -> u32 {
        match self {
            Motion::CentreX | Motion::CentreY => 64,
            _ => 32,
        }
    }
}

impl World {
    /// Flips one bit of a number of a dynamic body that is awake, as failing memory would, and nothing else: to try what
    /// notices a divergence. The bits of speeds count 2^-21 m/s, those of places 2^-32 m, those of the angle 2^-32 turns;
    /// see [`Motion::bits`].
    ///
    /// # Errors
    /// When the handle is stale, the body is not dynamic or is asleep, there is no such bit, or no body can have that speed
    /// or place or move along that axis; then nothing is changed.
    pub fn flip_bit(&mut self, id: BodyId, motion: Motion, bit: u32) -> Result<(), WorldError> {
        let body = self.state.get().bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let locks = body.settings.locks;
        let locked = match motion {
            Motion::VelocityX | Motion::CentreX => locks.x,
            Motion::VelocityY | Motion::CentreY => locks.y,
            Motion::Spin | Motion::Angle => locks.rotation,
        };
        let is_free = body.is_dynamic() && !body.is_asleep() && body.is_enabled() && !locked;
        if !is_free || bit >= motion.bits() {
            return Err(WorldError::WrongKind(id));
        }
        let mut pose = Pose { centre: body.centre, angle: body.angle };
        match motion {
            Motion::VelocityX | Motion::VelocityY | Motion::Spin => return self.flip_speed(id, motion, bit),
            Motion::CentreX => pose.centre.x = flipped_place(pose.centre.x, bit)?,
            Motion::CentreY => pose.centre.y = flipped_place(pose.centre.y, bit)?,
            Motion::Angle => pose.angle = Angle::from_bits(pose.angle.to_bits() ^ 1 << bit),
        }
        let World { state, scratch, .. } = self;
        move_body(state, scratch, id.slot(), pose);
        Ok(())
    }

    fn flip_speed(&mut self, id: BodyId, motion: Motion, bit: u32) -> Result<(), WorldError> {
        let body = self.state.bodies.at_mut(id.slot());
        let number = match motion {
            Motion::VelocityX => &mut body.velocity.x,
            Motion::VelocityY => &mut body.velocity.y,
            _ => &mut body.spin,
        };
        let flipped = Speed::from_bits(number.to_bits() ^ 1 << bit);
        if !(-SPEED_MAX..=SPEED_MAX).contains(&flipped) {
            return Err(WorldError::SpeedOutOfRange { value: flipped.into() });
        }
        *number = flipped;
        Ok(())
    }
}

fn flipped_place(place: Fx, bit: u32) -> Result<Fx, WorldError> {
    let flipped = Fx::from_bits(place.to_bits() ^ 1 << bit);
    let inside = (-WORLD_EXTENT_MAX..=WORLD_EXTENT_MAX).contains(&flipped);
    if inside { Ok(flipped) } else { Err(WorldError::PositionOutOfRange { value: flipped }) }
}
