//! Machines that rotate and churn their contents.

use alloc::vec::Vec;

use super::Scene;
use super::builder::{Builder, build, rectangle};
use super::drum::plate;
use super::yards::grid;
use lockstep2d::body::{BodyDef, Chain, EventSwitches, Geometry, Material, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rot, Vec2};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::Config;

/// Angular velocity of the tumbler and the washer: 25 degrees per second, in rad/s.
const TURNING: Fx = fx!(0.436332312999);

pub(super) const SPINNER: Scene = Scene::new(
    "spinner",
    500,
    "a rotor of 40 m stirs 6076 bodies in a ring; the bodies overlap at the start",
    |_| {
        build(Config::default(), |scene| {
            // The points of the one-sided chain are in clockwise order, so that it is solid from the inside.
            let point = |i: i32| {
                let direction = Rot::from_angle(Angle::from_degrees(Fx::from_num(-i)));
                Vec2::new(fx!(0), fx!(32)) + direction.apply_wide(Vec2::new(fx!(40), fx!(0)))
            };
            let points: Vec<_> = (0..360).map(point).collect();
            let slippery = Material { friction: fx!(0.1), ..Material::default() };
            let ring = Chain::new(&points).closed().one_sided().materials(&[slippery]).links()?;
            let ring = scene.spawn(BodyDef::fixed(), &ring)?;
            let rotor =
                ShapeDef::new(Polygon::rectangle(fx!(0.4), fx!(20))?.rounded(fx!(0.2))?).friction(fx!(0));
            let rotor =
                scene.spawn(BodyDef::dynamic().position((fx!(0), fx!(12))).never_sleeps(), &[rotor])?;
            let axle = Revolute::new().motor(fx!(5), Fx::MAX);
            scene.joint(JointDef::new(ring, rotor, axle).anchor_a((fx!(0), fx!(12))))?;
            fill_ring(scene)
        })
    },
)
.golden(20);

/// Fills the ring with rows of 92 bodies, from the bottom up. Capsules, discs and squares alternate.
fn fill_ring(scene: &mut Builder) -> Result<(), WorldError> {
    let (a, b) = (Vec2::new(fx!(-0.25), fx!(0)), Vec2::new(fx!(0.25), fx!(0)));
    let capsule = Geometry::capsule(a, b, fx!(0.25))?;
    let geometries = [capsule, Geometry::circle(fx!(0.35))?, Polygon::square(fx!(0.35))?.into()];
    for (geometry, first) in geometries.into_iter().zip(0..) {
        let shape = ShapeDef::new(geometry).friction(fx!(0.1)).restitution(fx!(0.1)).density(fx!(0.25));
        let place = |i: i32| Vec2::new(Fx::from_num(i % 92) / 2 - fx!(23), Fx::from_num(i / 92) / 2 + fx!(2));
        scene.spawn_each(BodyDef::dynamic(), &[shape], (first..6076).step_by(3).map(place))?;
    }
    Ok(())
}

pub(super) const TUMBLER: Scene =
    Scene::new("tumbler", 750, "a motor turns a box with 2025 small ones in it", |_| {
        build(Config::default(), |scene| {
            let ground = scene.spawn(BodyDef::fixed(), &[])?;
            let (upright, flat) = (rectangle(fx!(0.5), fx!(10))?, rectangle(fx!(10), fx!(0.5))?);
            let walls = [
                upright.offset((fx!(10), fx!(0))),
                upright.offset((fx!(-10), fx!(0))),
                flat.offset((fx!(0), fx!(10))),
                flat.offset((fx!(0), fx!(-10))),
            ];
            let walls = walls.map(|wall| wall.density(fx!(50)));
            let container = scene.spawn(BodyDef::dynamic().position((fx!(0), fx!(10))), &walls)?;
            let axle = Revolute::new().motor(TURNING, fx!(100000000));
            scene.joint(JointDef::new(ground, container, axle).anchor_a((fx!(0), fx!(10))))?;
            let (origin, apart) = (Vec2::new(fx!(-9), fx!(1)), Vec2::new(fx!(0.4), fx!(0.4)));
            let square = rectangle(fx!(0.125), fx!(0.125))?;
            scene.spawn_each(BodyDef::dynamic(), &[square], grid(45, 45, origin, apart))?;
            Ok(())
        })
    })
    .golden(150);

pub(super) const WASHER: Scene =
    Scene::new("washer", 500, "a drum with paddles washes 8100 boxes that report their hits", |_| {
        build(Config::default(), |scene| {
            let drum = BodyDef::kinematic().position((fx!(0), fx!(10)));
            let drum = drum.velocity((fx!(0.001), fx!(-0.002))).angular_velocity(TURNING);
            scene.spawn(drum, &washer_shapes()?)?;
            let events = EventSwitches { hit: true, ..EventSwitches::default() };
            let square = rectangle(fx!(0.1), fx!(0.1))?.events(events);
            let (origin, apart) = (Vec2::new(fx!(-9.9), fx!(0.1)), Vec2::new(fx!(0.21), fx!(0.21)));
            scene.spawn_each(BodyDef::dynamic(), &[square], grid(90, 90, origin, apart))?;
            Ok(())
        })
    })
    .golden(20);

/// Shapes of the washer: a ring of 36 plates, and 4 paddles inside. The inner radius of the ring is 16 m, the outer
/// radius 18 m. Neighbouring plates overlap by two degrees.
fn washer_shapes() -> Result<Vec<ShapeDef>, WorldError> {
    let mut shapes = Vec::new();
    for i in 0..36 {
        let (from, to) = (Fx::from_num(10 * i), Fx::from_num(10 * i + 10));
        shapes.push(plate((from - fx!(1), to + fx!(1)), (fx!(16), fx!(18)))?);
        if i % 9 == 0 {
            shapes.push(plate((from, to), (fx!(14), fx!(16)))?);
        }
    }
    Ok(shapes)
}
