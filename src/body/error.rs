//! Errors of geometry, and of changes to a world.

use core::fmt;

use super::arena::{BodyId, JointId, ShapeId};
use crate::math::Fx;

/// Geometry that cannot be simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryError {
    /// A polygon has 3 to 8 vertices.
    VertexCount {
        /// How many there were.
        count: u64,
    },
    /// Two neighbouring vertices are closer than 0.5 mm.
    ShortEdge {
        /// The first of the two.
        vertex: u64,
    },
    /// The outline is concave, clockwise, collinear, or crosses itself.
    NotConvex {
        /// The first vertex of an edge with another vertex on its wrong side.
        vertex: u64,
    },
    /// A chain has at least 2 points, 3 if it is closed, and at most 4096 links.
    ChainLength {
        /// How many points there were.
        points: u64,
    },
    /// A chain has no materials, one for all links, or one for each.
    MaterialCount {
        /// How many links there are.
        links: u64,
        /// How many materials there were.
        materials: u64,
    },
    /// A coordinate, radius or length is too small or too large.
    SizeOutOfRange {
        /// The value in metres.
        value: Fx,
    },
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GeometryError::VertexCount { count } => write!(f, "a polygon has 3 to 8 vertices, not {count}"),
            GeometryError::ShortEdge { vertex } => {
                write!(f, "the edge from vertex {vertex} is shorter than 0.5 mm")
            }
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
                write!(f, "{materials} materials for the {links} links of a chain")
            }
            GeometryError::SizeOutOfRange { value } => {
                write!(f, "a size or coordinate of {value} m is out of range")
            }
        }
    }
}

impl core::error::Error for GeometryError {}

/// A change that the world refuses. The world is as it was before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldError {
    /// The geometry of a shape is not valid.
    Geometry(GeometryError),
    /// The handle names a body that is gone, or was never here.
    StaleBody(BodyId),
    /// The handle names a shape that is gone, or was never here.
    StaleShape(ShapeId),
    /// The handle names a joint that is gone, or was never here.
    StaleJoint(JointId),
    /// A position is further than 2^30 m from the origin on some axis.
    PositionOutOfRange {
        /// The coordinate in metres.
        value: Fx,
    },
    /// A shape or anchor is further than 128 m from its movable body's origin on some axis, or 2^30 m from a fixed
    /// one's.
    OffsetOutOfRange {
        /// The coordinate in metres.
        value: Fx,
    },
    /// A speed is above the limit of the world, in m/s, or in rad/s times the radius of gyration.
    SpeedOutOfRange {
        /// The speed asked for.
        value: Fx,
    },
    /// The density is negative, or above 2^20 kg/m².
    DensityOutOfRange {
        /// The density in kg/m².
        value: Fx,
    },
    /// Friction is not within 0 to 16, restitution or rolling resistance not within 0 to 1, or a surface speed not
    /// within ±400 m/s.
    MaterialOutOfRange,
    /// A dynamic body's mass is not within 10 mg to 2^30 kg: it has no shape with area and density, or too much.
    MassOutOfRange {
        /// The mass in kg.
        value: Fx,
    },
    /// A dynamic body's radius of gyration is not within 2 mm to 512 m.
    GyrationOutOfRange {
        /// The radius in metres.
        value: Fx,
    },
    /// A damping rate is not within 0 to 1000 per second.
    DampingOutOfRange {
        /// The rate asked for.
        value: Fx,
    },
    /// A gravity scale is not within ±1000.
    GravityScaleOutOfRange {
        /// The scale asked for.
        value: Fx,
    },
    /// A joint between a body and itself.
    JointToItself(BodyId),
    /// Neither body of a joint is dynamic, so nothing could move.
    JointWithoutDynamicBody,
    /// A joint stays between its bodies as long as it lives.
    JointOfOtherBodies(JointId),
    /// Something of a joint is out of range.
    JointOutOfRange {
        /// What.
        what: &'static str,
    },
    /// A world setting is out of range.
    Setting {
        /// Which one.
        name: &'static str,
    },
    /// The world holds as many bodies, shapes or joints as it may.
    Full {
        /// What there are too many of.
        what: &'static str,
        /// How many there may be.
        limit: u32,
    },
    /// Only dynamic bodies take forces and impulses, and fixed ones do not move.
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
            WorldError::StaleBody(id) => write!(f, "no body {id}"),
            WorldError::StaleShape(id) => write!(f, "no shape {id}"),
            WorldError::StaleJoint(id) => write!(f, "no joint {id}"),
            WorldError::PositionOutOfRange { value } => write!(f, "position {value} m is beyond 2^30 m"),
            WorldError::OffsetOutOfRange { value } => {
                write!(f, "a shape or anchor reaches {value} m from its body's origin")
            }
            WorldError::SpeedOutOfRange { value } => write!(f, "speed {value} is above the world's limit"),
            WorldError::DensityOutOfRange { value } => write!(f, "density {value} kg/m² is out of range"),
            WorldError::MaterialOutOfRange => write!(
                f,
                "friction is 0 to 16, restitution and rolling resistance are 0 to 1, and surface speed is within ±400 m/s"
            ),
            WorldError::MassOutOfRange { value } => {
                write!(
                    f,
                    "a dynamic body's mass is 1e-5 to 2^30 kg, not {value}: give a shape area and density"
                )
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
            WorldError::JointToItself(id) => write!(f, "a joint between body {id} and itself"),
            WorldError::JointWithoutDynamicBody => write!(f, "neither body of the joint is dynamic"),
            WorldError::JointOfOtherBodies(id) => write!(f, "joint {id} is between other bodies"),
            WorldError::JointOutOfRange { what } => write!(f, "the {what} of a joint is out of range"),
            WorldError::Setting { name } => write!(f, "the world setting `{name}` is out of range"),
            WorldError::Full { what, limit } => write!(f, "the world already holds {limit} {what}"),
            WorldError::WrongKind(id) => write!(f, "body {id} is not of a kind that can do this"),
        }
    }
}

impl core::error::Error for WorldError {}
