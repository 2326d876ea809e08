//! Errors of geometry and of world changes.

use core::fmt;

use super::arena::{BodyId, JointId, ShapeId};
use crate::math::Fx;

/// Invalid geometry.
///
/// ```
/// use lockstep2d::{body::{GeometryError, Polygon}, fx, math::Vec2};
/// // A level editor marks the corner at which a drawn outline is wrong.
/// let corners = [(fx!(0), fx!(0)), (fx!(4), fx!(0)), (fx!(1), fx!(1)), (fx!(0), fx!(4))];
/// let outline = corners.map(|(x, y)| Vec2::new(x, y));
/// match Polygon::new(&outline) {
///     Err(GeometryError::NotConvex { vertex }) => assert_eq!(vertex, 1, "the edge from (4, 0) leads inwards"),
///     other => panic!("{other:?}"),
/// }
/// assert_eq!(Polygon::new(&outline[..2]), Err(GeometryError::VertexCount { count: 2 }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryError {
    /// The polygon does not have 3 to 8 vertices.
    VertexCount {
        /// Number of vertices given.
        count: u64,
    },
    /// Two neighbouring vertices are closer than 0.5 mm.
    ShortEdge {
        /// Index of the first of the two vertices.
        vertex: u64,
    },
    /// The outline is convex, but its vertices are in clockwise order.
    Clockwise,
    /// The outline is concave, collinear, or crosses itself.
    NotConvex {
        /// Index of the vertex at which the wrong edge starts. Another vertex is on the outer side or on the line of
        /// this edge.
        vertex: u64,
    },
    /// The chain has fewer than 2 points (3 if it is closed), or more than 4096 links.
    ChainLength {
        /// Number of points given.
        points: u64,
    },
    /// The number of materials of a chain is not 0, 1 or the number of its links.
    MaterialCount {
        /// Number of links.
        links: u64,
        /// Number of materials given.
        materials: u64,
    },
    /// A coordinate, radius or length is out of range.
    SizeOutOfRange {
        /// Name of the size, such as "radius of a circle".
        what: &'static str,
        /// The value, in metres.
        value: Fx,
        /// Smallest value allowed.
        min: Fx,
        /// Largest value allowed. [`Fx::MAX`] means no limit.
        max: Fx,
    },
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GeometryError::VertexCount { count } => write!(f, "a polygon has 3 to 8 vertices, not {count}"),
            GeometryError::ShortEdge { vertex } => {
                write!(f, "the edge from vertex {vertex} is shorter than 0.5 mm")
            }
            GeometryError::Clockwise => write!(
                f,
                "clockwise, not counter-clockwise (reverse the order of the vertices, or use `Polygon::hull`)"
            ),
            GeometryError::NotConvex { vertex } => {
                write!(f, "not convex and counter-clockwise at the edge from vertex {vertex}")
            }
            GeometryError::ChainLength { points } => {
                write!(
                    f,
                    "a chain has 2 points or more, 3 if it is closed, and at most 4096 links: not {points} points"
                )
            }
            GeometryError::MaterialCount { links, materials } => {
                write!(
                    f,
                    "a chain of {links} links takes no materials, one, or one per link: not {materials}"
                )
            }
            GeometryError::SizeOutOfRange { what, value, min, max } => {
                write!(f, "the {what} is {}, not {value}", Range { min, max, unit: " m" })
            }
        }
    }
}

impl core::error::Error for GeometryError {}

/// Formats a range. [`Fx::MIN`] and [`Fx::MAX`] mean no limit. A minimum of [`Fx::DELTA`] means any value above 0.
struct Range<'a> {
    min: &'a Fx,
    max: &'a Fx,
    unit: &'a str,
}

impl fmt::Display for Range<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Range { min, max, unit } = *self;
        if *max == Fx::MAX {
            write!(f, "{min}{unit} or more")
        } else if *min == Fx::MIN {
            write!(f, "{max}{unit} or less")
        } else if *min == Fx::DELTA {
            write!(f, "above 0 and at most {max}{unit}")
        } else if *min < Fx::ZERO && *min == max.saturating_neg() {
            write!(f, "within ±{max}{unit}")
        } else {
            write!(f, "{min} to {max}{unit}")
        }
    }
}

/// Reason why the world rejects a change. A rejected change leaves the world as it was.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, WorldError}, fx, world::World};
/// # let mut world = World::default();
/// let bomb = world.spawn(&BodyDef::dynamic(), &[])?;
/// world.despawn(bomb)?;
/// let before = world.state_hash();
/// // The input of a player arrives after the body has been removed.
/// assert_eq!(world.apply_torque(bomb, fx!(1)), Err(WorldError::StaleBody(bomb)));
/// assert_eq!(world.state_hash(), before, "a refused change leaves no trace");
/// # Ok::<(), WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldError {
    /// The geometry of a shape is invalid.
    Geometry(GeometryError),
    /// No body with this handle exists.
    StaleBody(BodyId),
    /// No shape with this handle exists.
    StaleShape(ShapeId),
    /// No joint with this handle exists.
    StaleJoint(JointId),
    /// A position is further than 2^30 m from the origin on some axis.
    PositionOutOfRange {
        /// The coordinate in metres.
        value: Fx,
    },
    /// A shape, an anchor or a given centre of mass is more than 128 m from its body's origin on some axis. For shapes
    /// and anchors of fixed bodies the limit is 2^30 m.
    OffsetOutOfRange {
        /// The coordinate in metres.
        value: Fx,
        /// Largest distance allowed, in metres.
        max: Fx,
    },
    /// A speed exceeds the limit of the world. The limit also applies to an angular velocity in rad/s times the radius
    /// of gyration in metres.
    SpeedOutOfRange {
        /// Speed in m/s.
        value: Fx,
        /// Largest speed in m/s.
        max: Fx,
    },
    /// A sleep speed is not within 0 to 400 m/s.
    SleepSpeedOutOfRange {
        /// Speed in m/s.
        value: Fx,
    },
    /// The density is negative, or above 2^20 kg/m².
    DensityOutOfRange {
        /// The density in kg/m².
        value: Fx,
    },
    /// A property of a material is out of range.
    MaterialOutOfRange {
        /// Name of the property, such as "friction".
        what: &'static str,
        /// The value.
        value: Fx,
        /// Smallest value allowed.
        min: Fx,
        /// Largest value allowed.
        max: Fx,
    },
    /// A mass is not within 10 mg to 2^30 kg.
    MassOutOfRange {
        /// The mass in kg.
        value: Fx,
    },
    /// A radius of gyration is not within 2 mm to 512 m.
    GyrationOutOfRange {
        /// The radius in metres.
        value: Fx,
    },
    /// A damping rate is not within 0 to 1000 per second.
    DampingOutOfRange {
        /// The requested rate, per second.
        value: Fx,
    },
    /// A gravity scale is not within ±1000.
    GravityScaleOutOfRange {
        /// The requested scale.
        value: Fx,
    },
    /// A property of an area is out of range.
    AreaOutOfRange {
        /// Name of the property, such as "flow".
        what: &'static str,
        /// The value that is out of range. For a vector, the component that is out of range.
        value: Fx,
        /// Smallest value allowed.
        min: Fx,
        /// Largest value allowed.
        max: Fx,
    },
    /// A shape that is not a sensor cannot be an area.
    AreaNotSensor,
    /// A segment or link has no interior, so it cannot be an area.
    AreaOfLine,
    /// A joint connects a body to itself.
    JointToItself(BodyId),
    /// A new definition of a joint names other bodies. The bodies of a joint cannot be changed.
    JointOfOtherBodies(JointId),
    /// The joint does not have the part that was to be changed, such as a motor.
    JointWithout {
        /// The joint.
        joint: JointId,
        /// Name of the part.
        what: &'static str,
    },
    /// A numeric parameter of a joint is out of range.
    JointOutOfRange {
        /// Name of the parameter, such as "motor speed".
        what: &'static str,
        /// The value.
        value: Fx,
        /// Smallest value allowed. [`Fx::MIN`] means no limit, [`Fx::DELTA`] any value above 0.
        min: Fx,
        /// Largest value allowed. [`Fx::MAX`] means no limit.
        max: Fx,
    },
    /// The lower limit of a joint is above the upper one.
    JointLimitReversed {
        /// The lower limit.
        lower: Fx,
        /// The upper limit.
        upper: Fx,
    },
    /// A world setting is out of range.
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The requested value.
        value: Fx,
        /// Smallest value allowed.
        min: Fx,
        /// Largest value allowed.
        max: Fx,
    },
    /// A world setting that is a whole number is out of range.
    CountSetting {
        /// Name of the setting.
        name: &'static str,
        /// The requested value.
        value: u32,
        /// Smallest value allowed.
        min: u32,
        /// Largest value allowed.
        max: u32,
    },
    /// A numeric parameter of an explosion is out of range.
    ExplosionOutOfRange {
        /// Name of the parameter.
        what: &'static str,
        /// The value.
        value: Fx,
        /// Smallest value allowed.
        min: Fx,
        /// Largest value allowed.
        max: Fx,
    },
    /// The change would alter a limit that is fixed when the world is created.
    FixedSetting {
        /// Name of the limit.
        name: &'static str,
    },
    /// A name is not 1 to 16 ASCII letters, digits, `-` and `_`.
    NameInvalid,
    /// The change would exceed a limit on bodies, shapes or joints.
    Full {
        /// Kind of object.
        what: &'static str,
        /// Largest number of such objects.
        limit: u32,
    },
    /// The kind or state of the body does not allow the change. For example, fixed bodies take no forces.
    WrongKind(BodyId),
}

impl From<GeometryError> for WorldError {
    fn from(error: GeometryError) -> Self {
        WorldError::Geometry(error)
    }
}

impl fmt::Display for WorldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WorldError::Geometry(error) => error.fmt(f),
            WorldError::StaleBody(id) => write!(f, "body {id} does not exist"),
            WorldError::StaleShape(id) => write!(f, "shape {id} does not exist"),
            WorldError::StaleJoint(id) => write!(f, "joint {id} does not exist"),
            WorldError::PositionOutOfRange { value } => write!(f, "position {value} m is beyond 2^30 m"),
            WorldError::OffsetOutOfRange { value, max } => {
                write!(
                    f,
                    "a shape, an anchor or a centre of mass is within ±{max} m of its body's origin on each axis, not {value}"
                )
            }
            WorldError::SpeedOutOfRange { value, max } => {
                write!(
                    f,
                    "a speed, or an angular velocity times the radius of gyration, is at most {max} m/s, not {value}"
                )
            }
            WorldError::SleepSpeedOutOfRange { value } => {
                write!(f, "a sleep speed is 0 to 400 m/s, not {value}")
            }
            WorldError::DensityOutOfRange { value } => write!(f, "a density is 0 to 2^20 kg/m², not {value}"),
            WorldError::MaterialOutOfRange { what, value, min, max } => {
                write!(f, "the {what} of a material is {}, not {value}", Range { min, max, unit: "" })
            }
            WorldError::MassOutOfRange { value } => {
                write!(f, "a dynamic body's mass is 1e-5 to 2^30 kg, not {value}")
            }
            WorldError::GyrationOutOfRange { value } => {
                write!(f, "a dynamic body's radius of gyration is 0.002 to 512 m, not {value}")
            }
            WorldError::DampingOutOfRange { value } => {
                write!(f, "damping is 0 to 1000 per second, not {value}")
            }
            WorldError::GravityScaleOutOfRange { value } => {
                write!(f, "gravity scale is within ±1000, not {value}")
            }
            WorldError::AreaOutOfRange { what, value, min, max } => {
                write!(f, "the {what} of an area is {}, not {value}", Range { min, max, unit: "" })
            }
            WorldError::AreaNotSensor => write!(f, "only a sensor can be an area"),
            WorldError::AreaOfLine => write!(f, "a line has no interior, so that it cannot be an area"),
            WorldError::JointToItself(id) => write!(f, "a joint cannot connect body {id} to itself"),
            WorldError::JointOfOtherBodies(id) => write!(f, "the bodies of joint {id} cannot be changed"),
            WorldError::JointWithout { joint, what } => write!(f, "joint {joint} has no {what}"),
            WorldError::JointOutOfRange { what, value, min, max } => {
                write!(f, "a joint's {what} is {}, not {value}", Range { min, max, unit: "" })
            }
            WorldError::JointLimitReversed { lower, upper } => {
                write!(f, "a joint's lower limit of {lower} is above its upper limit of {upper}")
            }
            WorldError::Setting { name, value, min, max } => {
                write!(f, "the world setting `{name}` is {}, not {value}", Range { min, max, unit: "" })
            }
            WorldError::CountSetting { name, value, min, max } => {
                write!(f, "the world setting `{name}` is {min} to {max}, not {value}")
            }
            WorldError::ExplosionOutOfRange { what, value, min, max } => {
                write!(f, "an explosion's {what} is {}, not {value}", Range { min, max, unit: "" })
            }
            WorldError::FixedSetting { name } => write!(f, "the world limit `{name}` cannot be changed"),
            WorldError::NameInvalid => write!(f, "a name is 1 to 16 ASCII letters, digits, `-` and `_`"),
            WorldError::Full { what, limit } => write!(f, "at most {limit} {what} are allowed"),
            WorldError::WrongKind(id) => {
                write!(f, "the kind or state of body {id} does not allow this change")
            }
        }
    }
}

impl core::error::Error for WorldError {}
