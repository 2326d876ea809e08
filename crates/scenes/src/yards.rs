//! Yards full of debris, hit by a ram, stirred by a pusher or filled from above.

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{Builder, build, rectangle, weightless};
use lockstep2d::body::{BodyDef, BodyKind, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::{Angle, Fx, Rot, Vec2, fx_mul, widen};
use lockstep2d::world::{Command, Config};

pub(super) const SMASH: Scene =
    Scene::new("smash", 300, "a heavy box hits a block of 9600 sleeping boxes, without gravity", |_| {
        build(weightless(), |scene| {
            let ram = rectangle(fx!(4), fx!(4))?.density(fx!(8));
            scene
                .spawn(BodyDef::dynamic().position((fx!(-20), fx!(0))).velocity((fx!(40), fx!(0))), &[ram])?;
            let (origin, apart) = (Vec2::new(fx!(30), fx!(-16)), Vec2::new(fx!(0.4), fx!(0.4)));
            let square = rectangle(fx!(0.2), fx!(0.2))?;
            scene.spawn_each(BodyDef::dynamic().asleep(), &[square], grid(120, 80, origin, apart))?;
            Ok(())
        })
    })
    .golden(90);

/// Positions of a grid, in columns from left to right, and in each column from the bottom up. The first is `origin`.
pub(super) fn grid(
    columns: i32,
    rows: i32,
    origin: Vec2<Fx>,
    apart: Vec2<Fx>,
) -> impl Iterator<Item = Vec2<Fx>> {
    let place = move |column: i32, row: i32| {
        origin + Vec2::new(apart.x.saturating_mul_int(column.into()), apart.y.saturating_mul_int(row.into()))
    };
    (0..columns).flat_map(move |column| (0..rows).map(move |row| place(column, row)))
}

/// Shifts the x coordinates alternately by `first` and `-first`.
fn staggered(places: impl Iterator<Item = Vec2<Fx>>, first: Fx) -> impl Iterator<Item = Vec2<Fx>> {
    places
        .enumerate()
        .map(move |(index, place)| place + Vec2::new(if index % 2 == 0 { first } else { -first }, Fx::ZERO))
}

/// A ground of slightly overlapping boxes, with walls at its ends.
fn yard(half_width: i32, wall_height: i32) -> Result<Vec<ShapeDef>, WorldError> {
    let (flat, upright) = (rectangle(fx!(0.55), fx!(0.5))?, rectangle(fx!(0.5), fx!(0.55))?);
    let ground = (-half_width..=half_width).map(|x| flat.offset((Fx::from_num(x), fx!(0))));
    let wall = |x: i32| (1..=wall_height).map(move |y| upright.offset((Fx::from_num(x), Fx::from_num(y))));
    Ok(ground.chain(wall(-half_width)).chain(wall(half_width)).collect())
}

pub(super) const JUNKYARD: Scene = Scene {
    name: "junkyard",
    about: "8000 pentagons rain into a yard, where a pusher moves back and forth",
    ticks: 800,
    golden_ticks: 40,
    setup: |_| build(Config::default(), fill_junkyard),
    script: push_junk,
};

fn fill_junkyard(scene: &mut Builder) -> Result<(), WorldError> {
    scene.spawn(BodyDef::fixed(), &yard(80, 50)?)?;
    let (origin, apart) = (Vec2::new(fx!(-75), fx!(15)), Vec2::new(fx!(0.75), fx!(1)));
    let places = staggered(grid(200, 40, origin, apart), fx!(-0.1));
    scene.spawn_each(BodyDef::dynamic(), &[ShapeDef::new(golden_pentagon()?)], places)?;
    scene.spawn(BodyDef::kinematic(), &[rectangle(fx!(2), fx!(4))?.offset((fx!(0), fx!(4)))])?;
    Ok(())
}

/// Five points on a circle. The angle from each point to the next is a turn divided by the golden ratio.
fn golden_pentagon() -> Result<Polygon, WorldError> {
    // A turn divided by the golden ratio is pi (sqrt(5) - 1) rad.
    let step = Angle::from_radians(fx!(3.883222077451));
    let mut angle = Angle::ZERO;
    let mut points = Vec::new();
    for _ in 0..5 {
        points.push(Rot::from_angle(angle).apply_wide(Vec2::new(fx!(0.25), fx!(0))));
        angle += step;
    }
    Ok(Polygon::hull(&points)?)
}

/// Moves the pusher to `x = 60 sin(t / 5)` metres, where `t` is the time in seconds.
fn push_junk(tick: u64, game: &Sandbox) -> Vec<Command> {
    let pusher = game.world().bodies().find(|(_, body)| body.kind() == BodyKind::Kinematic);
    let Some((body, _)) = pusher else { return vec![] };
    // The phase grows by one radian in 300 ticks.
    let phase = Angle::from_radians(lockstep2d::math::ratio(i64::try_from(tick).unwrap_or(i64::MAX), 300));
    let position = Vec2::new(fx_mul(fx!(60), widen(phase.sin())), fx!(0));
    vec![Command::MoveTo { body, position, angle: Angle::ZERO }]
}

pub(super) const COMPOUNDS: Scene =
    Scene::new("compounds", 500, "3000 arrowheads, each of two triangles, fall into a yard", |_| {
        build(Config::default(), |scene| {
            let mut ground = yard(40, 100)?;
            let below = Geometry::segment(Vec2::new(fx!(-800), fx!(-80)), Vec2::new(fx!(800), fx!(-80)))?;
            ground.push(ShapeDef::new(below));
            scene.spawn(BodyDef::fixed(), &ground)?;
            let half = |side: Fx| {
                let points = [(-side, fx!(0)), (side / 2, fx!(1)), (fx!(0), fx!(2))];
                Polygon::hull(&points.map(|(x, y)| Vec2::new(x, y)))
                    .map(|half| ShapeDef::new(half).friction(fx!(0.5)))
            };
            let (origin, apart) = (Vec2::new(fx!(-19), fx!(5.575)), Vec2::new(fx!(2), fx!(2.25)));
            let places = staggered(grid(20, 150, origin, apart), fx!(0.25));
            scene.spawn_each(BodyDef::dynamic(), &[half(fx!(1))?, half(fx!(-1))?], places)?;
            Ok(())
        })
    })
    .golden(60);
