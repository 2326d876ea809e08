//! A scene with as many bodies as a typical game shows.

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, floor, rectangle};
use super::piles::random_polygon;
use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::world::{Command, Config};

pub(super) const GAME: Scene = Scene {
    name: "game",
    about: "100 random polygons and 50 discs in a box that is shaken",
    ticks: 900,
    golden_ticks: 400,
    setup: |seed| {
        build(Config::default(), |scene| {
            let mut rng = Rng::new(seed);
            floor(scene, fx!(12))?;
            for side in [fx!(-11), fx!(11)] {
                scene.spawn(BodyDef::fixed().position((side, fx!(20))), &[rectangle(fx!(1), fx!(20))?])?;
            }
            for i in 0..150 {
                let shape = match i % 3 {
                    2 => ShapeDef::new(Geometry::circle(rng.range(fx!(0.3), fx!(0.6)))?),
                    _ => ShapeDef::new(random_polygon(&mut rng)),
                };
                let x = Fx::from_num(i % 9 - 4) * 2 + rng.range(fx!(-0.1), fx!(0.1));
                let y = Fx::from_num(i / 9) * 2 + fx!(1);
                scene.spawn(BodyDef::dynamic().position((x, y)).angle(rng.angle()), &[shape])?;
            }
            Ok(())
        })
    },
    script: shake,
};

/// Throws all dynamic bodies upwards every 5 s.
fn shake(tick: u64, game: &Sandbox) -> Vec<Command> {
    if tick == 0 || !tick.is_multiple_of(300) {
        return vec![];
    }
    let mut rng = Rng::new(tick);
    let dynamic = game.world().bodies().filter(|(_, body)| body.is_dynamic());
    dynamic
        .map(|(id, body)| {
            let velocity = Vec2::new(rng.range(fx!(-4), fx!(4)), rng.range(fx!(4), fx!(8)));
            let impulse = velocity.scale(body.mass());
            Command::ApplyImpulse { body: id, impulse, point: body.centre_of_mass() }
        })
        .collect()
}
