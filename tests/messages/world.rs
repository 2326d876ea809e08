//! Messages about shapes, bodies, joints and settings.

use lockstep2d::body::{BodyId, Geometry, GeometryError, JointId, Polygon, ShapeId, WorldError};
use lockstep2d::codec;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Section, Violation};

use crate::says;

/// Encoding of a handle: slot 7 in generation 2.
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
            GeometryError::Clockwise,
            "clockwise, not counter-clockwise (reverse the order of the vertices, or use `Polygon::hull`)",
        ),
    ]);
}

/// Each message names the size and the given value.
#[test]
fn sizes_out_of_range() {
    let origin = (fx!(0), fx!(0));
    let refused = |shape: Result<Geometry, GeometryError>| shape.expect_err("refused");
    let polygon = |shape: Result<Polygon, GeometryError>| shape.expect_err("refused");
    let square = || Polygon::square(fx!(100)).expect("valid");
    let tip = [(fx!(0), fx!(0)), (fx!(121), fx!(0)), (fx!(0), fx!(1))].map(|(x, y)| Vec2::new(x, y));
    says([
        (refused(Geometry::circle(fx!(-1))), "the radius of a circle is 0.002 to 110 m, not -1"),
        (refused(Geometry::circle(fx!(0.0001))), "the radius of a circle is 0.002 to 110 m, not 0.0001"),
        (refused(Geometry::segment(origin, origin)), "the length of a segment is 0.002 m or more, not 0"),
        (
            refused(Geometry::capsule(origin, (fx!(0), fx!(110)), fx!(0.5))),
            "the coordinate of a capsule's end is within ±109.5 m, not 110",
        ),
        (polygon(Polygon::square(fx!(200))), "the half extent of a square is 0.00025 to 110 m, not 200"),
        (polygon(Polygon::square(fx!(0))), "the half extent of a square is 0.00025 to 110 m, not 0"),
        (
            polygon(Polygon::rectangle(fx!(-1), fx!(1))),
            "the half width of a rectangle is 0.00025 to 110 m, not -1",
        ),
        (
            polygon(Polygon::rectangle(fx!(1), fx!(111))),
            "the half height of a rectangle is 0.00025 to 110 m, not 111",
        ),
        (
            polygon(Polygon::regular(5, fx!(-200))),
            "the radius of a regular polygon is within ±110 m, not -200",
        ),
        (polygon(Polygon::new(&tip)), "the coordinate of a vertex is within ±110 m, not 121"),
        (polygon(square().rounded(fx!(11))), "the rounding radius of a polygon is 0 to 10 m, not 11"),
    ]);
    assert_eq!(Polygon::new(&[tip[0], tip[2], Vec2::new(fx!(1), fx!(0))]), Err(GeometryError::Clockwise));
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
        (WorldError::WrongKind(body), "the kind or state of body 7v2 does not allow this change"),
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
            WorldError::OffsetOutOfRange { value, max: fx!(2) },
            "a shape, an anchor or a centre of mass is within ±2 m of its body's origin on each axis, not 2.25",
        ),
        (
            WorldError::SpeedOutOfRange { value, max: fx!(2) },
            "a speed, or an angular velocity times the radius of gyration, is at most 2 m/s, not 2.25",
        ),
        (WorldError::SleepSpeedOutOfRange { value: fx!(-1) }, "a sleep speed is 0 to 400 m/s, not -1"),
        (WorldError::DensityOutOfRange { value }, "a density is 0 to 2^20 kg/m², not 2.25"),
        (
            WorldError::MaterialOutOfRange { what: "restitution", value, min: fx!(0), max: fx!(1.5) },
            "the restitution of a material is 0 to 1.5, not 2.25",
        ),
        (WorldError::MassOutOfRange { value }, "a dynamic body's mass is 1e-5 to 2^30 kg, not 2.25"),
        (
            WorldError::GyrationOutOfRange { value },
            "a dynamic body's radius of gyration is 0.002 to 512 m, not 2.25",
        ),
        (WorldError::DampingOutOfRange { value }, "damping is 0 to 1000 per second, not 2.25"),
        (WorldError::GravityScaleOutOfRange { value }, "gravity scale is within ±1000, not 2.25"),
        (WorldError::AreaNotSensor, "only a sensor can be an area"),
        (WorldError::AreaOfLine, "a line has no interior, so that it cannot be an area"),
        (
            WorldError::AreaOutOfRange { what: "flow", value, min: fx!(-2), max: fx!(2) },
            "the flow of an area is within ±2, not 2.25",
        ),
        (
            WorldError::JointLimitReversed { lower: value, upper: fx!(-1) },
            "a joint's lower limit of 2.25 is above its upper limit of -1",
        ),
        (
            WorldError::CountSetting { name: "tick_rate", value: 0, min: 10, max: 1000 },
            "the world setting `tick_rate` is 10 to 1000, not 0",
        ),
        (
            WorldError::Setting { name: "fat_margin", value: fx!(0), min: fx!(0.001), max: fx!(10) },
            "the world setting `fat_margin` is 0.001 to 10, not 0",
        ),
        (
            WorldError::ExplosionOutOfRange { what: "radius in m", value, min: fx!(0), max: fx!(2) },
            "an explosion's radius in m is 0 to 2, not 2.25",
        ),
        (WorldError::FixedSetting { name: "pair_limit" }, "the world limit `pair_limit` cannot be changed"),
        (WorldError::NameInvalid, "a name is 1 to 16 ASCII letters, digits, `-` and `_`"),
        (WorldError::Full { what: "bodies", limit: 12 }, "at most 12 bodies are allowed"),
    ]);
}

/// The form in which a message prints a range depends on the ends of the range.
#[test]
fn ranges() {
    let joint = |min, max| WorldError::JointOutOfRange { what: "motor speed", value: fx!(-7.5), min, max };
    says([
        (joint(fx!(0.25), fx!(4)), "a joint's motor speed is 0.25 to 4, not -7.5"),
        (joint(fx!(-4), fx!(4)), "a joint's motor speed is within ±4, not -7.5"),
        (joint(fx!(0), Fx::MAX), "a joint's motor speed is 0 or more, not -7.5"),
        (joint(Fx::MIN, fx!(-8)), "a joint's motor speed is -8 or less, not -7.5"),
        (joint(Fx::DELTA, fx!(4)), "a joint's motor speed is above 0 and at most 4, not -7.5"),
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
