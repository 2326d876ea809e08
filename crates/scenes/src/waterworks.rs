//! Areas, gears, a rack, a pulley and a platform without mass, in one scene.

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{Builder, build, rectangle};
use lockstep2d::body::{Area, BodyDef, BodyId, Falloff, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{Gear, JointDef, Prismatic, Pulley, Rack, Revolute};
use lockstep2d::world::{Command, Config, World};

pub(super) const WATERWORKS: Scene = Scene {
    name: "waterworks",
    about: "boats and corks in two pools and a current, gears that raise a gate, buckets on a pulley, a magnet",
    ticks: 900,
    golden_ticks: 600,
    setup: |_| {
        build(Config::default(), |scene| {
            let basin = basin(scene)?;
            mill(scene, basin)?;
            buckets(scene)?;
            floats(scene)?;
            magnet(scene)
        })
    },
    script: |tick, game| play(tick, game.world()).unwrap_or_default(),
};

/// The water in the pools.
fn water() -> Area {
    Area::fluid(fx!(1)).drag(fx!(2), fx!(2))
}

/// Adds two pools that touch, with their surfaces at height 0. The right pool has a current to the right, and a wind to
/// the left above it. [`play`] expects the basin to be the first body.
fn basin(scene: &mut Builder) -> Result<BodyId, WorldError> {
    let wall = |x| Ok::<_, WorldError>(rectangle(fx!(0.5), fx!(4))?.offset((x, fx!(-1))));
    let floor = rectangle(fx!(12), fx!(0.5))?.offset((fx!(0), fx!(-4.5)));
    let pool = rectangle(fx!(5.5), fx!(2))?;
    let wind = Area::new().flow((fx!(-5), fx!(0))).drag(fx!(0.5), fx!(0)).force((fx!(-0.5), fx!(0)));
    let shapes = [
        pool.offset((fx!(-5.5), fx!(-2))).area(water()),
        pool.offset((fx!(5.5), fx!(-2))).area(water().flow((fx!(1), fx!(0)))),
        rectangle(fx!(5), fx!(1.5))?.offset((fx!(6), fx!(2))).area(wind),
        floor,
        wall(fx!(-11.5))?,
        wall(fx!(11.5))?,
    ];
    scene.spawn(BodyDef::fixed(), &shapes)
}

/// Adds a crank that turns a train of wheels. The last wheel moves a gate by a rack.
fn mill(scene: &mut Builder, ground: BodyId) -> Result<(), WorldError> {
    let wheels = [(fx!(-8), fx!(0.5)), (fx!(-6.5), fx!(1)), (fx!(-5), fx!(0.5))];
    let mut bodies = Vec::new();
    for (x, radius) in wheels {
        let body = BodyDef::dynamic().position((x, fx!(6)));
        let wheel = scene.spawn(body, &[ShapeDef::new(Geometry::circle(radius)?)])?;
        let hinge = if bodies.is_empty() { Revolute::new().motor(fx!(3), fx!(30)) } else { Revolute::new() };
        scene.joint(JointDef::new(ground, wheel, hinge).anchor_a((x, fx!(6))))?;
        bodies.push(wheel);
    }
    let mesh = |teeth_a, teeth_b| Gear::new(teeth_a, teeth_b);
    // The wheels are in mesh at the start, because all their angles are 0.
    scene.joint(JointDef::new(bodies[0], bodies[1], mesh(10, 20)))?;
    scene.joint(JointDef::new(bodies[1], bodies[2], mesh(20, 10)))?;
    let gate = BodyDef::dynamic().position((fx!(-4.5), fx!(6)));
    let gate = scene.spawn(gate, &[rectangle(fx!(0.1), fx!(2))?.density(fx!(0.5))])?;
    let rails = Prismatic::new().limit(fx!(-3), fx!(3));
    let rails = JointDef::new(ground, gate, rails).anchor_a((fx!(-4.5), fx!(6)));
    scene.joint(rails.angle_a(Angle::QUARTER).angle_b(Angle::QUARTER))?;
    let rack = JointDef::new(bodies[2], gate, Rack::new(fx!(0.5))).angle_b(Angle::QUARTER);
    scene.joint(rack.angle_a(Angle::QUARTER)).map(|_| ())
}

/// Adds two buckets on a pulley. The heavier bucket pulls up the lighter one.
fn buckets(scene: &mut Builder) -> Result<(), WorldError> {
    let sides = [
        rectangle(fx!(0.5), fx!(0.1))?.offset((fx!(0), fx!(-0.5))),
        rectangle(fx!(0.1), fx!(0.5))?.offset((fx!(-0.5), fx!(0))),
        rectangle(fx!(0.1), fx!(0.5))?.offset((fx!(0.5), fx!(0))),
    ];
    let left = scene.spawn(BodyDef::dynamic().position((fx!(-1.5), fx!(3))), &sides)?;
    let heavy = sides.map(|side| side.density(fx!(4)));
    let right = scene.spawn(BodyDef::dynamic().position((fx!(1.5), fx!(3))), &heavy)?;
    let rope = Pulley::new((fx!(-1.5), fx!(9)), (fx!(1.5), fx!(9)), fx!(16.5)).ratio(fx!(2));
    let joint = JointDef::new(left, right, rope).anchor_a((fx!(0), fx!(0.5))).anchor_b((fx!(0), fx!(0.5)));
    scene.joint(joint.colliding()).map(|_| ())
}

/// Adds bodies of several densities above the pools, and light leaves that the wind moves.
fn floats(scene: &mut Builder) -> Result<(), WorldError> {
    let end = Vec2::new(fx!(0.4), fx!(0));
    let forms = [
        rectangle(fx!(1.5), fx!(0.25))?.density(fx!(0.4)),
        ShapeDef::new(Geometry::circle(fx!(0.4))?).density(fx!(0.3)),
        ShapeDef::new(Geometry::capsule(-end, end, fx!(0.25))?).density(fx!(0.7)),
        ShapeDef::new(Polygon::regular(5, fx!(0.5))?.rounded(fx!(0.1))?).density(fx!(0.9)),
        ShapeDef::new(Polygon::square(fx!(0.3))?).density(fx!(3)),
    ];
    for (index, form) in (0i64..).zip(forms) {
        for x in [-10, 1] {
            let x = Fx::from_num(x + 2 * index);
            let turn = Angle::from_bits(u32::try_from(index).unwrap_or(0) << 28);
            scene.spawn(BodyDef::dynamic().position((x, fx!(2))).angle(turn), &[form])?;
        }
    }
    let leaf = ShapeDef::new(Polygon::rectangle(fx!(0.15), fx!(0.05))?).density(fx!(0.1));
    let places = (0..6).map(|index| Vec2::new(fx!(4) + Fx::from_num(index), fx!(3)));
    scene.spawn_each(BodyDef::dynamic(), &[leaf], places).map(|_| ())
}

/// Adds a body without mass, whose velocity is not changed by forces. It passes over the water, and attracts the bodies
/// below.
fn magnet(scene: &mut Builder) -> Result<(), WorldError> {
    let pull = Area::new().attraction(fx!(18), fx!(1), Falloff::Inverse);
    let field = ShapeDef::new(Geometry::circle(fx!(3))?).area(pull);
    let tray = rectangle(fx!(0.8), fx!(0.1))?;
    let body = BodyDef::dynamic().position((fx!(-9), fx!(2.2))).velocity((fx!(1), fx!(0)));
    scene.spawn(body, &[field.density(fx!(0)), tray.density(fx!(0))]).map(|_| ())
}

/// Turns the crank back and forth, makes the left pool denser, and ends the current in the right pool.
fn play(tick: u64, world: &World) -> Option<Vec<Command>> {
    let basin = world.bodies().next()?.0;
    let &[left, right, ..] = world.body(basin)?.shapes() else { return None };
    let change = |shape, area: Area| {
        let def = world.shape(shape)?.def().area(area);
        Some(vec![Command::SetShape { shape, def }])
    };
    match tick {
        300 => change(left, water().density(fx!(2))),
        450 => change(right, water()),
        120 | 360 => {
            // The crank is the first joint.
            let (joint, crank) = world.joints().next()?;
            let mut def = *crank.def();
            def.kind = Revolute::new().motor(if tick == 120 { fx!(-3) } else { fx!(2) }, fx!(30)).into();
            Some(vec![Command::SetJoint { joint, def }])
        }
        _ => None,
    }
}
