use crate::body::{BodyId, Handle, Pose, SPEED_MAX, WORLD_EXTENT_MAX, WorldError};
use crate::math::{Angle, Fx, Speed};
use crate::world::World;
use crate::world::movement::move_body;

/// A component of a body's velocity or pose.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
/// use lockstep2d::world::BodyField;
/// # let mut world = World::default();
/// let ball = world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(0.5))?)])?;
/// // Flips one bit, as failing memory may, to test how a game reacts when peers diverge.
/// let mut broken = world.clone();
/// broken.flip_bit(ball, BodyField::VelocityX, 0)?;
/// assert_ne!(world.state_hash(), broken.state_hash());
/// broken.flip_bit(ball, BodyField::VelocityX, 0)?;
/// assert_eq!(world.state_hash(), broken.state_hash());
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyField {
    /// Horizontal velocity of the body's centre of mass.
    VelocityX,
    /// Vertical velocity of the body's centre of mass.
    VelocityY,
    /// Radius of gyration times angular velocity.
    Spin,
    /// X coordinate of the body's centre of mass.
    CentreX,
    /// Y coordinate of the body's centre of mass.
    CentreY,
    /// Rotation of the body.
    Angle,
}

impl BodyField {
    /// All fields, speeds first.
    pub const ALL: [BodyField; 6] = [
        BodyField::VelocityX,
        BodyField::VelocityY,
        BodyField::Spin,
        BodyField::CentreX,
        BodyField::CentreY,
        BodyField::Angle,
    ];

    /// The three speeds.
    pub const SPEEDS: [BodyField; 3] = [BodyField::VelocityX, BodyField::VelocityY, BodyField::Spin];

    /// Returns the name of the field in the human-readable form of a snapshot.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            BodyField::VelocityX => "velocity.x",
            BodyField::VelocityY => "velocity.y",
            BodyField::Spin => "spin",
            BodyField::CentreX => "centre_of_mass.x",
            BodyField::CentreY => "centre_of_mass.y",
            BodyField::Angle => "angle",
        }
    }

    /// Returns the size of the field in bits.
    #[must_use]
    pub fn bits(self) -> u32 {
        match self {
            BodyField::CentreX | BodyField::CentreY => 64,
            _ => 32,
        }
    }
}

impl World {
    /// Flips one bit of a field of an awake dynamic body, to test the detection of divergence. Bit 0 is the lowest: it
    /// is 2^-21 m/s of a speed, 2^-32 m of a coordinate and 2^-32 turns of the angle.
    ///
    /// # Errors
    /// [`WorldError`] if the handle is stale, the body is disabled, asleep or not dynamic, the bit does not exist, the
    /// axis or the rotation is locked, or the result is out of range.
    pub fn flip_bit(&mut self, id: BodyId, field: BodyField, bit: u32) -> Result<(), WorldError> {
        let body = self.state.get().bodies.get(id).ok_or(WorldError::StaleBody(id))?;
        let locks = body.settings.locks;
        let locked = match field {
            BodyField::VelocityX | BodyField::CentreX => locks.x,
            BodyField::VelocityY | BodyField::CentreY => locks.y,
            BodyField::Spin | BodyField::Angle => locks.rotation,
        };
        let is_free = body.is_dynamic() && !body.is_asleep() && body.is_enabled() && !locked;
        if !is_free || bit >= field.bits() {
            return Err(WorldError::WrongKind(id));
        }
        let mut pose = Pose { centre: body.centre, angle: body.angle };
        match field {
            BodyField::VelocityX | BodyField::VelocityY | BodyField::Spin => {
                return self.flip_speed(id, field, bit);
            }
            BodyField::CentreX => pose.centre.x = flipped_place(pose.centre.x, bit)?,
            BodyField::CentreY => pose.centre.y = flipped_place(pose.centre.y, bit)?,
            BodyField::Angle => pose.angle = Angle::from_bits(pose.angle.to_bits() ^ 1 << bit),
        }
        let World { state, scratch, .. } = self;
        move_body(state, scratch, id.slot(), pose);
        Ok(())
    }

    fn flip_speed(&mut self, id: BodyId, field: BodyField, bit: u32) -> Result<(), WorldError> {
        let body = self.state.bodies.at_mut(id.slot());
        let number = match field {
            BodyField::VelocityX => &mut body.velocity.x,
            BodyField::VelocityY => &mut body.velocity.y,
            _ => &mut body.spin,
        };
        let flipped = Speed::from_bits(number.to_bits() ^ 1 << bit);
        if !(-SPEED_MAX..=SPEED_MAX).contains(&flipped) {
            return Err(WorldError::SpeedOutOfRange { value: flipped.into(), max: SPEED_MAX.into() });
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
