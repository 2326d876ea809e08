//! Number types of the flat API, and their conversions.

use lockstep2d::body::{BodyId, JointId, ShapeId};
use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::math::{Angle, Fx, Unit, Vec2, narrow, widen};

use crate::describe::{aliases, records};
use crate::status::{Failure, Outcome, Status};

aliases! {
    /// A fixed-point number in units of 2^-32: the integer 4294967296 stands for 1.
    RawFx(i64) = "ls2d_fx";
    /// An angle in units of 2^-32 turn, counter-clockwise: a quarter turn is 1073741824.
    RawAngle(u32) = "ls2d_angle";
    /// Handle of a body of a world. It is valid until the body is despawned, or until a rollback to a state from before
    /// the spawn of the body. After such a rollback, another body may get the same handle, so a table of sprites should
    /// also compare `user_data`. The lowest 21 bits are the slot. The other bits are the generation, which counts the
    /// earlier bodies in that slot: the first bodies have the handles 0, 1, 2 and so on. Handles of bodies are less
    /// than 2^53, so that a JavaScript number holds them exactly. Only `LS2D_NO_ID`, which refers to nothing, is
    /// larger.
    RawBody(u64) = "ls2d_body";
    /// Handle of a shape of a world, encoded like `ls2d_body`.
    RawShape(u64) = "ls2d_shape";
    /// Handle of a joint of a world, encoded like `ls2d_body`.
    RawJoint(u64) = "ls2d_joint";
}

records! {
    /// A point or a vector.
    struct RawVec2 = "ls2d_vec2" {
        /// Component to the right.
        x: RawFx,
        /// Component upwards.
        y: RawFx,
    }

    /// A state hash of 128 bits.
    struct RawHash = "ls2d_hash" {
        /// The lower half.
        low: u64,
        /// The upper half.
        high: u64,
    }

    /// A random number generator, which a game keeps as part of its state.
    struct RawRng = "ls2d_rng" {
        /// State of the generator.
        state: u64,
        /// Stream of the generator, an odd number.
        increment: u64,
    }
}

/// A handle that refers to nothing.
pub(crate) const NO_ID: u64 = u64::MAX;
/// Number of bits of a handle that hold the slot.
const SLOT_BITS: u32 = 21;

impl RawFx {
    pub(crate) const fn fx(self) -> Fx {
        Fx::from_bits(self.0)
    }

    pub(crate) const fn of(value: Fx) -> Self {
        RawFx(value.to_bits())
    }

    pub(crate) fn of_unit(value: Unit) -> Self {
        RawFx::of(widen(value))
    }
}

impl RawAngle {
    pub(crate) const fn angle(self) -> Angle {
        Angle::from_bits(self.0)
    }

    pub(crate) const fn of(value: Angle) -> Self {
        RawAngle(value.to_bits())
    }
}

impl RawVec2 {
    pub(crate) const ZERO: Self = RawVec2 { x: RawFx(0), y: RawFx(0) };

    pub(crate) const fn vec(self) -> Vec2<Fx> {
        Vec2::new(self.x.fx(), self.y.fx())
    }

    pub(crate) const fn of(value: Vec2<Fx>) -> Self {
        RawVec2 { x: RawFx::of(value.x), y: RawFx::of(value.y) }
    }

    pub(crate) fn of_units(value: Vec2<Unit>) -> Self {
        RawVec2 { x: RawFx::of_unit(value.x), y: RawFx::of_unit(value.y) }
    }

    /// The components, clamped to the range -2 to 2.
    pub(crate) fn units(self) -> Vec2<Unit> {
        Vec2::new(narrow(self.x.fx()), narrow(self.y.fx()))
    }
}

impl RawHash {
    pub(crate) fn of(hash: StateHash) -> Self {
        let [low, high] =
            [hash.0, hash.0 >> 64].map(|bits| u64::try_from(bits & u128::from(u64::MAX)).unwrap_or(0));
        RawHash { low, high }
    }

    #[cfg(feature = "lockstep")]
    pub(crate) fn hash(self) -> StateHash {
        StateHash(u128::from(self.high) << 64 | u128::from(self.low))
    }
}

fn pack(index: u32, generation: u32) -> u64 {
    u64::from(generation) << SLOT_BITS | u64::from(index)
}

/// The canonical encoding of a handle; `None` if the number is not a handle.
fn unpack(packed: u64) -> Option<[u8; 8]> {
    let index = u32::try_from(packed & ((1 << SLOT_BITS) - 1)).ok()?;
    let generation = u32::try_from(packed >> SLOT_BITS).ok()?;
    let mut bytes = [0; 8];
    let (low, high) = bytes.split_at_mut(4);
    low.copy_from_slice(&index.to_le_bytes());
    high.copy_from_slice(&generation.to_le_bytes());
    Some(bytes)
}

macro_rules! identifiers {
    ($($raw:ident, $id:ident, $status:ident, $what:literal;)+) => {
        $(impl $raw {
            /// Converts the number to a handle. A number that is not the encoding of a handle gives the same error as a
            /// stale handle.
            pub(crate) fn id(self) -> Outcome<$id> {
                let stale = || Failure::new(Status::$status, concat!($what, " does not exist"));
                let bytes = unpack(self.0).ok_or_else(stale)?;
                codec::decode(&bytes).map_err(|_| stale())
            }

            pub(crate) fn of(id: $id) -> Self {
                $raw(pack(id.index(), id.generation()))
            }

        })+
    };
}

identifiers! {
    RawBody, BodyId, StaleBody, "the body";
    RawShape, ShapeId, StaleShape, "the shape";
    RawJoint, JointId, StaleJoint, "the joint";
}
