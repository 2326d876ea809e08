//! Stacks, pyramids and heaps, which test how well the solver supports weight.

use super::Scene;
use super::builder::{Builder, build, floor, rectangle, sleepless};
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::world::Config;

pub(super) const BOX_STACK: Scene =
    Scene::new("box_stack", 600, "ten boxes on top of each other stand still", |_| {
        build(Config::default(), |scene| {
            floor(scene, fx!(20))?;
            let square = rectangle(fx!(0.5), fx!(0.5))?;
            for i in 0..10 {
                let y = Fx::from_num(i) + fx!(0.5);
                scene.spawn(BodyDef::dynamic().position((fx!(0), y)), &[square])?;
            }
            Ok(())
        })
    });

pub(super) const HEAVY_ON_LIGHT: Scene =
    Scene::new("heavy_on_light", 600, "a box rests on another of a hundredth of its mass", |_| {
        build(Config::default(), |scene| {
            floor(scene, fx!(20))?;
            let light = rectangle(fx!(0.5), fx!(0.5))?;
            scene.spawn(BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[light])?;
            scene.spawn(BodyDef::dynamic().position((fx!(0), fx!(1.5))), &[light.density(fx!(100))])?;
            Ok(())
        })
    });

pub(super) const PYRAMID: Scene =
    Scene::new("pyramid", 600, "a pyramid of 30 rows settles until nothing moves", |_| {
        build(Config::default(), |scene| {
            floor(scene, fx!(40))?;
            pyramid(scene, 30)
        })
    })
    .golden(300);

pub(super) const LARGE_PYRAMID: Scene =
    Scene::new("large_pyramid", 500, "a pyramid of 5050 boxes stands", |_| {
        build(sleepless(), |scene| {
            floor(scene, fx!(100))?;
            pyramid(scene, 100)
        })
    })
    .golden(40);

fn pyramid(scene: &mut Builder, base: i32) -> Result<(), WorldError> {
    let left = Vec2::new(-Fx::from_num(base) / 2, fx!(0));
    scene.spawn_each(BodyDef::dynamic(), &[rectangle(fx!(0.5), fx!(0.5))?], pyramid_places(left, base))?;
    Ok(())
}

/// Centres of the unit boxes of a pyramid. Row `i`, counted from 0 at the bottom, has the boxes `j` from `i` to
/// `base - 1`. The centres are at `x = (i + 1) / 2 + (j - i)`, `y = (2 i + 1) / 2` relative to `left`, the left end of
/// the lowest row.
fn pyramid_places(left: Vec2<Fx>, base: i32) -> impl Iterator<Item = Vec2<Fx>> {
    let place = move |i: i32, j: i32| {
        left + Vec2::new(Fx::from_num(i + 1) / 2 + Fx::from_num(j - i), Fx::from_num(2 * i + 1) / 2)
    };
    (0..base).flat_map(move |i| (i..base).map(move |j| place(i, j)))
}

pub(super) const MANY_PYRAMIDS: Scene =
    Scene::new("many_pyramids", 200, "400 pyramids of 55 boxes on 20 shelves", |_| {
        build(sleepless(), |scene| {
            let shelf = |row: i32| {
                let y = Fx::from_num(11 * row);
                Geometry::segment(Vec2::new(fx!(-110), y), Vec2::new(fx!(110), y)).map(ShapeDef::new)
            };
            let shelves = (0..20).map(shelf).collect::<Result<alloc::vec::Vec<_>, _>>()?;
            scene.spawn(BodyDef::fixed(), &shelves)?;
            let left = |row: i32, column: i32| {
                Vec2::new(Fx::from_num(11 * column) - fx!(109.5), Fx::from_num(11 * row))
            };
            let corners = (0..20).flat_map(|row| (0..20).map(move |column| left(row, column)));
            let places = corners.flat_map(|left| pyramid_places(left, 10));
            scene.spawn_each(BodyDef::dynamic(), &[rectangle(fx!(0.5), fx!(0.5))?], places)?;
            Ok(())
        })
    })
    .golden(12);

pub(super) const HUNDRED_POLYGONS: Scene =
    Scene::new("hundred_polygons", 600, "100 random convex polygons fall into a box", |seed| {
        build(Config::default(), |scene| {
            let mut rng = Rng::new(seed);
            floor(scene, fx!(12))?;
            for side in [fx!(-11), fx!(11)] {
                scene.spawn(BodyDef::fixed().position((side, fx!(10))), &[rectangle(fx!(1), fx!(10))?])?;
            }
            for i in 0..100 {
                let shape = ShapeDef::new(random_polygon(&mut rng)).restitution(rng.range(fx!(0), fx!(0.3)));
                let x = Fx::from_num(i % 8 - 4) * 2 + fx!(1) + rng.range(fx!(-0.2), fx!(0.2));
                let y = Fx::from_num(i / 8) * 2 + fx!(2);
                scene.spawn(BodyDef::dynamic().position((x, y)).angle(rng.angle()), &[shape])?;
            }
            Ok(())
        })
    })
    .golden(400);

/// The hull of 3 to 8 points at 0.3 to 0.9 m from the origin. On average, every third polygon is rounded.
pub(super) fn random_polygon(rng: &mut Rng) -> Polygon {
    loop {
        let corners = rng.below(6) + 3;
        let points: alloc::vec::Vec<_> = (0..corners)
            .map(|_| {
                let direction = lockstep2d::math::Rot::from_angle(rng.angle());
                direction.apply_wide(Vec2::new(rng.range(fx!(0.3), fx!(0.9)), Fx::ZERO))
            })
            .collect();
        let rounding = if rng.below(3) == 0 { rng.range(fx!(0.02), fx!(0.1)) } else { Fx::ZERO };
        // Rejects polygons that are at most 0.3 m wide, which are hard to see. The loop then generates another polygon.
        let wide_enough = |polygon: &Polygon| {
            polygon.vertices().iter().zip(polygon.normals()).all(|(&vertex, &normal)| {
                let depth = |other: &Vec2<lockstep2d::math::Length>| -> lockstep2d::math::Length {
                    (vertex - *other).dot(normal)
                };
                polygon
                    .vertices()
                    .iter()
                    .map(depth)
                    .max()
                    .is_some_and(|deepest| deepest > lockstep2d::math::Length::lit("0.3"))
            })
        };
        let polygon = Polygon::hull(&points).and_then(|polygon| polygon.rounded(rounding));
        if let Some(polygon) = polygon.ok().filter(wide_enough) {
            return polygon;
        }
    }
}
