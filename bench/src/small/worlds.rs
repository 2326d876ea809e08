//! Worlds of the size of games, built for any number of bodies.

use lockstep2d::body::{BodyDef, BodyId, Chain, Filter, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::SandboxSetup;
use lockstep2d::math::{Angle, Fx, Rot, Vec2};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d_scenes::Builder;

use super::config;

type Setup = Result<SandboxSetup, WorldError>;

/// A body and its position. Its angle is zero.
type Placed = (BodyId, Vec2<Fx>);

fn dynamic(scene: &mut Builder, at: Vec2<Fx>, shape: &ShapeDef) -> Result<Placed, WorldError> {
    let body = scene.spawn(BodyDef::dynamic().position(at), std::slice::from_ref(shape))?;
    Ok((body, at))
}

fn hinge(scene: &mut Builder, a: Placed, b: Placed, at: Vec2<Fx>, hinge: Revolute) -> Result<(), WorldError> {
    let joint = JointDef::new(a.0, b.0, hinge).anchor_a(at - a.1).anchor_b(at - b.1);
    scene.joint(joint)?;
    Ok(())
}

/// Adds a floor with its top at y = 0, and two walls.
fn room(scene: &mut Builder, half_width: Fx) -> Result<(), WorldError> {
    let wall =
        |x: Fx| Polygon::rectangle(fx!(0.5), fx!(60)).map(|wall| ShapeDef::new(wall).offset((x, fx!(60))));
    let floor = Polygon::rectangle(half_width + fx!(1), fx!(0.5))?;
    let shapes = [
        wall(-half_width - fx!(0.5))?,
        wall(half_width + fx!(0.5))?,
        ShapeDef::new(floor).offset((fx!(0), fx!(-0.5))),
    ];
    scene.spawn(BodyDef::fixed(), &shapes)?;
    Ok(())
}

pub fn boxes(bodies: u32) -> Setup {
    pit(bodies, |_| Ok(Polygon::square(fx!(0.45))?.into()))
}

/// Polygons of five to seven corners.
pub fn polygons(bodies: u32) -> Setup {
    pit(bodies, |index| regular(5 + index % 3))
}

pub fn balls(bodies: u32) -> Setup {
    pit(bodies, |_| Ok(Geometry::circle(fx!(0.48))?))
}

pub fn capsules(bodies: u32) -> Setup {
    pit(bodies, |_| capsule())
}

pub fn mixed(bodies: u32) -> Setup {
    pit(bodies, |index| match index % 4 {
        0 => Ok(Polygon::square(fx!(0.45))?.into()),
        1 => regular(5 + index / 4 % 3),
        2 => Ok(Geometry::circle(fx!(0.48))?),
        _ => capsule(),
    })
}

fn capsule() -> Result<Geometry, WorldError> {
    Ok(Geometry::capsule(Vec2::new(fx!(-0.2), fx!(0)), Vec2::new(fx!(0.2), fx!(0)), fx!(0.25))?)
}

/// Regular polygon with a circumradius of 0.48 m.
fn regular(corners: u32) -> Result<Geometry, WorldError> {
    let corner = |index: u32| {
        let angle = Angle::from_turns(Fx::from_num(index) / i64::from(corners));
        Rot::from_angle(angle).apply_wide(Vec2::new(fx!(0.48), fx!(0)))
    };
    let corners: Vec<_> = (0..corners).map(corner).collect();
    Ok(Polygon::hull(&corners)?.into())
}

/// A pit with `isqrt(n)` columns of bodies, at least two. Even rows are shifted by 0.1 m, odd rows by -0.13 m.
fn pit(bodies: u32, shape: impl Fn(u32) -> Result<Geometry, WorldError>) -> Setup {
    let mut scene = Builder::new(config());
    let columns = (2 * bodies.isqrt() / 2).max(2);
    room(&mut scene, Fx::from_num(columns) * fx!(0.55) + fx!(0.5))?;
    for index in 0..bodies {
        let (row, column) = (index / columns, index % columns);
        let shift = if row % 2 == 0 { fx!(0.1) } else { fx!(-0.13) };
        let x = (Fx::from_num(column) - Fx::from_num(columns - 1) / 2) * fx!(1.1) + shift;
        let at = Vec2::new(x, Fx::from_num(row) * fx!(1.1) + fx!(0.6));
        dynamic(&mut scene, at, &ShapeDef::new(shape(index)?))?;
    }
    Ok(scene.finish())
}

/// Ragdolls of six capsules fall on a floor between two walls.
pub fn ragdolls(bodies: u32) -> Setup {
    let mut scene = Builder::new(config());
    let count = (bodies / 6).max(1);
    let columns = count.isqrt().max(1);
    room(&mut scene, Fx::from_num(columns) + fx!(0.5))?;
    for index in 0..count {
        let (row, column) = (index / columns, index % columns);
        let x = Fx::from_num(2 * column) - Fx::from_num(columns - 1) + Fx::from_num(row % 2) / 8;
        ragdoll(&mut scene, Vec2::new(x, Fx::from_num(row) * fx!(2.2) + fx!(1)), index)?;
    }
    Ok(scene.finish())
}

/// Adds a torso with a head, two arms and two legs.
fn ragdoll(scene: &mut Builder, at: Vec2<Fx>, index: u32) -> Result<(), WorldError> {
    let group = -i32::try_from(index + 1).unwrap_or(i32::MAX);
    let mut limb = |x: Fx, y: Fx, half: Fx, radius: Fx| {
        let shape = Geometry::capsule(Vec2::new(fx!(0), -half), Vec2::new(fx!(0), half), radius)?;
        let shape = ShapeDef::new(shape).filter(Filter { group, ..Filter::default() });
        dynamic(scene, at + Vec2::new(x, y), &shape)
    };
    let torso = limb(fx!(0), fx!(0), fx!(0.3), fx!(0.18))?;
    let parts = [
        (limb(fx!(0), fx!(0.65), fx!(0.05), fx!(0.15))?, fx!(0), fx!(0.45)),
        (limb(fx!(-0.25), fx!(0.05), fx!(0.25), fx!(0.08))?, fx!(-0.2), fx!(0.3)),
        (limb(fx!(0.25), fx!(0.05), fx!(0.25), fx!(0.08))?, fx!(0.2), fx!(0.3)),
        (limb(fx!(-0.1), fx!(-0.7), fx!(0.3), fx!(0.1))?, fx!(-0.1), fx!(-0.4)),
        (limb(fx!(0.1), fx!(-0.7), fx!(0.3), fx!(0.1))?, fx!(0.1), fx!(-0.4)),
    ];
    let limited = Revolute::new().limit(fx!(-0.8), fx!(0.8));
    parts.into_iter().try_for_each(|(part, x, y)| hinge(scene, torso, part, at + Vec2::new(x, y), limited))
}

pub fn drum(bodies: u32) -> Setup {
    let mut scene = Builder::new(config());
    crate::growth::add_drum(&mut scene, Vec2::ZERO, bodies)?;
    Ok(scene.finish())
}

pub fn stack(bodies: u32) -> Setup {
    let mut scene = Builder::new(config());
    room(&mut scene, fx!(20))?;
    let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
    let places = (0..bodies).map(|row| Vec2::new(fx!(0), Fx::from_num(row) + fx!(0.5)));
    scene.spawn_each(BodyDef::dynamic(), &[square], places)?;
    Ok(scene.finish())
}

/// Bridges of 22 planks. Each bridge carries a box and a ball.
pub fn bridges(bodies: u32) -> Setup {
    let mut scene = Builder::new(config());
    let post = (scene.spawn(BodyDef::fixed(), &[])?, Vec2::ZERO);
    let plank = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.125))?);
    let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
    for bridge in 0..(bodies / 24).max(1) {
        let start = Vec2::new(Fx::from_num(30 * (bridge % 8)), Fx::from_num(20 * (bridge / 8)));
        let at = |x: Fx, y: Fx| start + Vec2::new(x, y);
        let mut before = post;
        for index in 0..22 {
            let left = Fx::from_num(index);
            let own = dynamic(&mut scene, at(left + fx!(0.5), fx!(0)), &plank)?;
            hinge(&mut scene, before, own, at(left, fx!(0)), Revolute::new())?;
            before = own;
        }
        hinge(&mut scene, before, post, at(fx!(22), fx!(0)), Revolute::new())?;
        dynamic(&mut scene, at(fx!(8), fx!(1)), &square)?;
        dynamic(&mut scene, at(fx!(13), fx!(1)), &ball)?;
    }
    Ok(scene.finish())
}

/// Cars on a hilly chain. A car has three bodies, two of which are driven wheels.
pub fn cars(bodies: u32) -> Setup {
    let mut scene = Builder::new(config());
    let cars = i64::from((bodies / 3).max(1));
    terrain(&mut scene, 8 * cars + 240)?;
    let hull = ShapeDef::new(Polygon::rectangle(fx!(1.2), fx!(0.3))?);
    let tyre = ShapeDef::new(Geometry::circle(fx!(0.4))?).friction(fx!(1.5));
    for car in 0..cars {
        let at = Vec2::new(Fx::from_num(8 * car), fx!(1.6));
        let chassis = dynamic(&mut scene, at, &hull)?;
        for x in [fx!(-0.8), fx!(0.8)] {
            let hub = at + Vec2::new(x, fx!(-0.35));
            let wheel = dynamic(&mut scene, hub, &tyre)?;
            hinge(&mut scene, chassis, wheel, hub, Revolute::new().motor(fx!(-6), fx!(20)))?;
        }
    }
    Ok(scene.finish())
}

/// Adds a closed chain: hills from x = -20 m to x = `width` - 1 m, and a bottom at y = -10 m.
fn terrain(scene: &mut Builder, width: i64) -> Result<(), WorldError> {
    let heights = [fx!(0), fx!(0.3), fx!(0.6), fx!(0.3), fx!(0), fx!(-0.2)];
    let hills = (-20..width).zip(heights.into_iter().cycle());
    let mut points: Vec<_> = hills.map(|(x, y)| Vec2::new(Fx::from_num(x), y)).collect();
    points.reverse();
    points.push(Vec2::new(fx!(-20), fx!(-10)));
    points.push(Vec2::new(Fx::from_num(width - 1), fx!(-10)));
    scene.spawn(BodyDef::fixed(), &Chain::new(&points).closed().one_sided().links()?)?;
    Ok(())
}
