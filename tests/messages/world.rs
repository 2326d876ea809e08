//! Messages about shapes, bodies, joints and settings.

use lockstep2d::body::{BodyId, GeometryError, JointId, ShapeId, WorldError};
use lockstep2d::codec;
use lockstep2d::fx;
use lockstep2d::world::{Section, Violation};

use crate::says;

/// Encoded handle of slot 7 in generation 2.
const SLOT_7: [u8; 8] = [7, 0, 0, 0, 2, 0, 0, 0];

#[test]
fn geometry() {
    says([
        (GeometryError::VertexCount { count: 9 }, "a polygon has 3 to 8 vertices, not 9"),
        (GeometryError::ShortEdge { vertex: 2 }, "the edge from vertex 2 is shorter than 0.5 mm"),
        (
            GeometryError::NotConvex { vertex: 4 },
            "not convex and counter-clockwise at the edge from vertex 4",
        ),
        (
            GeometryError::ChainLength { points: 1 },
            "a chain has 2 points or more, 3 if it is closed, and at most 4096 links: not 1 points",
        ),
        (
            GeometryError::MaterialCount { links: 5, materials: 2 },
            "a chain of 5 links takes no materials, one, or one per link: not 2",
        ),
        (
            GeometryError::SizeOutOfRange { value: fx!(-1.5) },
            "a size or coordinate of -1.5 m is out of range",
        ),
    ]);
}

#[test]
fn what_a_handle_names() {
    let body: BodyId = codec::decode(&SLOT_7).expect("two numbers");
    let shape: ShapeId = codec::decode(&SLOT_7).expect("two numbers");
    let joint: JointId = codec::decode(&SLOT_7).expect("two numbers");
    says([
        (WorldError::StaleBody(body), "body 7v2 does not exist"),
        (WorldError::StaleShape(shape), "shape 7v2 does not exist"),
        (WorldError::StaleJoint(joint), "joint 7v2 does not exist"),
        (WorldError::JointToItself(body), "a joint cannot connect body 7v2 to itself"),
        (WorldError::JointOfOtherBodies(joint), "the bodies of joint 7v2 cannot be changed"),
        (WorldError::JointWithout { joint, what: "motor" }, "joint 7v2 has no motor"),
        (WorldError::WrongKind(body), "the kind of body 7v2 does not allow this change"),
    ]);
}

#[test]
fn values_out_of_range() {
    let value = fx!(2.25);
    says([
        (
            WorldError::Geometry(GeometryError::VertexCount { count: 2 }),
            "a polygon has 3 to 8 vertices, not 2",
        ),
        (WorldError::PositionOutOfRange { value }, "position 2.25 m is beyond 2^30 m"),
        (
            WorldError::OffsetOutOfRange { value },
            "a shape or anchor at 2.25 m from its body's origin is out of range",
        ),
        (WorldError::SpeedOutOfRange { value }, "speed 2.25 is above the world's limit"),
        (WorldError::DensityOutOfRange { value }, "density 2.25 kg/m² is out of range"),
        (
            WorldError::MaterialOutOfRange,
            "friction is 0 to 16, restitution 0 to 1.5, rolling resistance 0 to 1, a restitution threshold 0 to 400 m/s, \
         and surface speed is within ±400 m/s",
        ),
        (WorldError::MassOutOfRange { value }, "a dynamic body's mass is 1e-5 to 2^30 kg, not 2.25"),
        (
            WorldError::GyrationOutOfRange { value },
            "a dynamic body's radius of gyration is 0.002 to 512 m, not 2.25",
        ),
        (WorldError::DampingOutOfRange { value }, "damping is 0 to 1000 per second, not 2.25"),
        (WorldError::GravityScaleOutOfRange { value }, "gravity scale is within ±1000, not 2.25"),
        (WorldError::AreaOutOfRange { what: "sensor" }, "only a sensor can be an area"),
        (
            WorldError::AreaOutOfRange { what: "geometry" },
            "a line has no inside, so that it cannot be an area",
        ),
        (WorldError::AreaOutOfRange { what: "flow" }, "the flow of an area is out of range"),
        (WorldError::JointOutOfRange { what: "length" }, "the length of a joint is out of range"),
        (WorldError::Setting { name: "tick_rate" }, "the world setting `tick_rate` is out of range"),
        (WorldError::FixedSetting { name: "pair_limit" }, "the world limit `pair_limit` cannot be changed"),
        (WorldError::NameInvalid, "a name is 1 to 16 ASCII letters, digits, `-` and `_`"),
        (WorldError::Full { what: "bodies", limit: 12 }, "the world already holds 12 bodies"),
    ]);
}

#[test]
fn states() {
    says([(Violation { what: "more bodies than allowed".into() }, "more bodies than allowed")]);
    says([
        (Section::World, "world"),
        (Section::Bodies, "bodies"),
        (Section::Shapes, "shapes"),
        (Section::Joints, "joints"),
        (Section::Contacts, "contacts"),
        (Section::Islands, "islands"),
        (Section::Random, "random"),
    ]);
}
