//! Status codes, and the text of the last error.

use std::cell::RefCell;
use std::fmt::Display;

use lockstep2d::body::{GeometryError, WorldError};
use lockstep2d::codec::DecodeError;
use lockstep2d::replay::RecordError;
use lockstep2d::session::{ConfigError, InputSize};
use lockstep2d::world::SnapshotError;

/// Defines the status codes, with their names in C and their descriptions.
macro_rules! statuses {
    ($($(#[doc = $doc:literal])+ $name:ident = $code:literal, $constant:literal;)+) => {
        /// Result of a function.
        #[repr(i32)]
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Status {
            $($(#[doc = $doc])+ $name = $code,)+
        }

        pub(crate) const STATUSES: &[(i32, &str, &[&str])] = &[$(($code, $constant, &[$($doc),+]),)+];
    };
}

statuses! {
    /// The function has succeeded.
    Ok = 0, "LS2D_OK";
    /// There is nothing to return, which is not an error.
    None = 1, "LS2D_NONE";
    /// A pointer that must not be null is null.
    Null = 2, "LS2D_NULL";
    /// A pointer is not aligned for its type.
    Misaligned = 3, "LS2D_MISALIGNED";
    /// No object has the handle: the object was freed, or never existed.
    Handle = 4, "LS2D_HANDLE";
    /// The handle belongs to an object of another kind.
    HandleKind = 5, "LS2D_HANDLE_KIND";
    /// The `size` of a struct does not match this version of the library.
    Size = 6, "LS2D_SIZE";
    /// An argument is out of its range, or the call is not possible at this time.
    Value = 7, "LS2D_VALUE";
    /// The buffer is too short. If the function has a pointer for the number of items, it has written the number
    /// needed.
    Buffer = 8, "LS2D_BUFFER";
    /// A text is invalid, for example not UTF-8.
    Text = 9, "LS2D_TEXT";
    /// The result is undefined, as for a division by zero or the root of a negative number.
    Number = 10, "LS2D_NUMBER";
    /// An internal error in the library. The objects that were passed to the call are unusable.
    Internal = 11, "LS2D_INTERNAL";
    /// An earlier `LS2D_INTERNAL` has left the object unusable. The object can still be freed.
    Broken = 12, "LS2D_BROKEN";
    /// There are already 2^20 objects, or the process has used all of about 4 290 000 000 handles. To save a world
    /// without a new handle, use `ls2d_world_save_into`.
    Exhausted = 13, "LS2D_EXHAUSTED";
    /// The bytes are not a valid encoding of the expected value.
    Decode = 14, "LS2D_DECODE";
    /// Geometry is not valid.
    Geometry = 20, "LS2D_GEOMETRY";
    /// The body is not in the world.
    StaleBody = 21, "LS2D_STALE_BODY";
    /// The shape is not in the world.
    StaleShape = 22, "LS2D_STALE_SHAPE";
    /// The joint is not in the world.
    StaleJoint = 23, "LS2D_STALE_JOINT";
    /// A position is out of range.
    Position = 24, "LS2D_POSITION";
    /// A shape or an anchor is too far from the origin of its body.
    Offset = 25, "LS2D_OFFSET";
    /// A speed is out of range.
    Speed = 26, "LS2D_SPEED";
    /// A density is out of range.
    Density = 27, "LS2D_DENSITY";
    /// A property of a material is out of range.
    Material = 28, "LS2D_MATERIAL";
    /// A mass is out of range.
    Mass = 29, "LS2D_MASS";
    /// A radius of gyration is out of range.
    Gyration = 30, "LS2D_GYRATION";
    /// A damping rate is out of range.
    Damping = 31, "LS2D_DAMPING";
    /// A gravity scale is out of range.
    GravityScale = 32, "LS2D_GRAVITY_SCALE";
    /// A property of an area is out of range, or the shape cannot be an area.
    Area = 33, "LS2D_AREA";
    /// A joint connects a body to itself.
    JointToItself = 34, "LS2D_JOINT_TO_ITSELF";
    /// The bodies of a joint cannot be changed.
    JointBodies = 35, "LS2D_JOINT_BODIES";
    /// The joint does not have the part to change, such as a motor.
    JointPart = 36, "LS2D_JOINT_PART";
    /// A property of a joint is out of range, or its limits are reversed.
    Joint = 37, "LS2D_JOINT";
    /// A setting of the world or a property of an explosion is out of range.
    Setting = 38, "LS2D_SETTING";
    /// A limit of the world, such as `body_limit`, cannot be changed.
    FixedSetting = 39, "LS2D_FIXED_SETTING";
    /// A name is not 1 to 16 ASCII letters, digits, `-` and `_`.
    Name = 40, "LS2D_NAME";
    /// The world would have too many bodies, shapes or joints, or a body too many shapes.
    Full = 41, "LS2D_FULL";
    /// The kind of the body does not allow the change.
    WrongKind = 42, "LS2D_WRONG_KIND";
    /// The bytes are not an encoded world of this version of the library.
    Snapshot = 50, "LS2D_SNAPSHOT";
    /// A replay cannot be recorded, opened or played further.
    Record = 51, "LS2D_RECORD";
    /// A parameter of a match is out of its range.
    Config = 60, "LS2D_CONFIG";
    /// The inputs do not have the expected number of bytes, or the input of an absent player does not consist of zeros.
    Inputs = 61, "LS2D_INPUTS";
    /// This peer does not take part in the match yet.
    NotInMatch = 62, "LS2D_NOT_IN_MATCH";
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Failure {
    pub(crate) status: Status,
    pub(crate) text: String,
}

pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    pub(crate) fn new(status: Status, text: impl Into<String>) -> Self {
        Failure { status, text: text.into() }
    }

    fn of(status: Status, error: &impl Display) -> Self {
        Failure { status, text: error.to_string() }
    }

    pub(crate) fn none() -> Self {
        Failure::new(Status::None, "there is nothing to return")
    }
}

pub(crate) fn value(what: &str, given: impl Display) -> Failure {
    Failure::new(Status::Value, format!("{what} cannot be {given}"))
}

impl From<WorldError> for Failure {
    fn from(error: WorldError) -> Self {
        let status = match error {
            WorldError::Geometry(_) => Status::Geometry,
            WorldError::StaleBody(_) => Status::StaleBody,
            WorldError::StaleShape(_) => Status::StaleShape,
            WorldError::StaleJoint(_) => Status::StaleJoint,
            WorldError::PositionOutOfRange { .. } => Status::Position,
            WorldError::OffsetOutOfRange { .. } => Status::Offset,
            WorldError::SpeedOutOfRange { .. } | WorldError::SleepSpeedOutOfRange { .. } => Status::Speed,
            WorldError::DensityOutOfRange { .. } => Status::Density,
            WorldError::MaterialOutOfRange { .. } => Status::Material,
            WorldError::MassOutOfRange { .. } => Status::Mass,
            WorldError::GyrationOutOfRange { .. } => Status::Gyration,
            WorldError::DampingOutOfRange { .. } => Status::Damping,
            WorldError::GravityScaleOutOfRange { .. } => Status::GravityScale,
            WorldError::AreaOutOfRange { .. } | WorldError::AreaNotSensor | WorldError::AreaOfLine => {
                Status::Area
            }
            WorldError::JointToItself(_) => Status::JointToItself,
            WorldError::JointOfOtherBodies(_) => Status::JointBodies,
            WorldError::JointWithout { .. } => Status::JointPart,
            WorldError::JointOutOfRange { .. } | WorldError::JointLimitReversed { .. } => Status::Joint,
            WorldError::Setting { .. }
            | WorldError::CountSetting { .. }
            | WorldError::ExplosionOutOfRange { .. } => Status::Setting,
            WorldError::FixedSetting { .. } => Status::FixedSetting,
            WorldError::NameInvalid => Status::Name,
            WorldError::Full { .. } => Status::Full,
            WorldError::WrongKind(_) => Status::WrongKind,
        };
        Failure::of(status, &error)
    }
}

macro_rules! failure_from {
    ($($error:ty => $status:ident;)+) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Failure::of(Status::$status, &error)
            }
        })+
    };
}

failure_from! {
    GeometryError => Geometry;
    SnapshotError => Snapshot;
    DecodeError => Decode;
    RecordError => Record;
    ConfigError => Config;
    InputSize => Inputs;
}

thread_local! {
    static LAST: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Stores a failure for `ls2d_last_error`.
pub(crate) fn note(failure: Failure) -> Status {
    let Failure { status, text } = failure;
    LAST.with_borrow_mut(|last| *last = text);
    status
}

pub(crate) fn last_text() -> String {
    LAST.with_borrow(String::clone)
}
