//! Scenes that never come to rest.

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, floor, rectangle};
use super::piles::random_polygon;
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul};
use lockstep2d::world::{Command, Config};

pub(super) const DRUM: Scene =
    Scene::new("drum", 600, "a drum with paddles churns 400 boxes, discs and polygons", |seed| {
        build(Config::default(), |scene| {
            let drum = BodyDef::kinematic().position((fx!(0), fx!(10))).angular_velocity(fx!(0.6));
            scene.spawn(drum, &drum_shapes()?)?;
            let mut rng = Rng::new(seed);
            for i in 0..400 {
                let (column, row) = (i % 20, i / 20);
                let x = fx_mul(Fx::from_num(column) - fx!(9.5), fx!(0.62)) + rng.range(fx!(-0.05), fx!(0.05));
                let y = fx_mul(Fx::from_num(row), fx!(0.62)) + fx!(4.2);
                let shape = match i % 3 {
                    0 => rectangle(fx!(0.25), fx!(0.2))?,
                    1 => ShapeDef::new(Geometry::circle(fx!(0.25))?).restitution(fx!(0.2)),
                    _ => ShapeDef::new(Polygon::regular(5, fx!(0.25))?.rounded(fx!(0.02))?),
                };
                scene.spawn(BodyDef::dynamic().position((x, y)), &[shape])?;
            }
            Ok(())
        })
    })
    .golden(300);

/// Shapes of the drum: a ring of 36 plates, and 4 paddles inside. The inner radius of the ring is 10 m, the outer
/// radius 11 m. Neighbouring plates overlap by one degree.
fn drum_shapes() -> Result<Vec<ShapeDef>, WorldError> {
    let mut shapes = Vec::new();
    for i in 0..36 {
        let from = Fx::from_num(10 * i);
        shapes.push(plate((from, from + fx!(11)), (fx!(10), fx!(11)))?);
        if i % 9 == 0 {
            shapes.push(plate((from, from + fx!(2)), (fx!(8.5), fx!(10.2)))?);
        }
    }
    Ok(shapes)
}

/// A ring segment with straight sides, between two angles in degrees and two radii in metres.
pub(super) fn plate(degrees: (Fx, Fx), radii: (Fx, Fx)) -> Result<ShapeDef, WorldError> {
    let corner = |degrees: Fx, radius: Fx| {
        Rot::from_angle(Angle::from_degrees(degrees)).apply_wide(Vec2::new(radius, Fx::ZERO))
    };
    let ((from, to), (inner, outer)) = (degrees, radii);
    let corners = [corner(from, inner), corner(from, outer), corner(to, outer), corner(to, inner)];
    Ok(ShapeDef::new(Polygon::hull(&corners)?))
}

pub(super) const SPAWNING: Scene = Scene {
    name: "spawning",
    about: "bodies are spawned, kicked and despawned by commands",
    ticks: 600,
    golden_ticks: 600,
    setup: |_| {
        build(Config::default(), |scene| {
            floor(scene, fx!(10))?;
            Ok(())
        })
    },
    script: spawn_kick_despawn,
};

/// Every 6 ticks, a body is spawned. Three ticks after each of these ticks, one of the first 40 dynamic bodies is
/// despawned, if there are at least 40. Every 50 ticks, the first dynamic body is kicked.
fn spawn_kick_despawn(tick: u64, game: &Sandbox) -> Vec<Command> {
    let mut rng = Rng::new(tick);
    let dynamic: Vec<_> = game.world().bodies().filter(|(_, body)| body.is_dynamic()).collect();
    let mut commands = vec![];
    if tick.is_multiple_of(6) {
        let body = BodyDef::dynamic().position((rng.range(fx!(-6), fx!(6)), fx!(8))).angle(rng.angle());
        let shape = match rng.below(3) {
            0 => ShapeDef::new(random_polygon(&mut rng)),
            _ => Geometry::circle(rng.range(fx!(0.2), fx!(0.6)))
                .map_or_else(|_| ShapeDef::new(random_polygon(&mut rng)), ShapeDef::new),
        };
        commands.push(Command::Spawn { body, shapes: vec![shape] });
    }
    if tick % 6 == 3 && dynamic.len() >= 40 {
        let victim = dynamic[rng.below(40) as usize].0;
        commands.push(Command::Despawn { body: victim });
    }
    if let (0, Some((id, body))) = (tick % 50, dynamic.first()) {
        let impulse = Vec2::new(rng.range(fx!(-4), fx!(4)), fx!(6)).scale(body.mass());
        commands.push(Command::ApplyImpulse { body: *id, impulse, point: body.centre_of_mass() });
    }
    commands
}
