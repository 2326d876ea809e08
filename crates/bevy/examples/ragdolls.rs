//! Ragdolls in a drum, built from entities. Drag them with the mouse.

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d::{PointerDragPlugin, SpawnBody, SpawnJoint, build_level};
use bevy_lockstep2d_examples::app;
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::math::{Fx, Vec2 as FixedVec2};
use lockstep2d::solver::Revolute;
use lockstep2d::world::Config;

/// A bone: a vertical capsule with its centre, half length and radius, in metres. `hinge` is the index of the parent
/// bone, and the height of the hinge in metres.
struct Bone {
    centre: (Fx, Fx),
    half: Fx,
    radius: Fx,
    hinge: Option<(usize, Fx)>,
}

const fn bone(x: Fx, y: Fx, half: Fx, radius: Fx, hinge: Option<(usize, Fx)>) -> Bone {
    Bone { centre: (x, y), half, radius, hinge }
}

const BONES: [Bone; 10] = [
    bone(fx!(0), fx!(1.25), fx!(0.25), fx!(0.16), None),
    bone(fx!(0), fx!(1.8), fx!(0.05), fx!(0.15), Some((0, fx!(1.62)))),
    bone(fx!(-0.1), fx!(0.75), fx!(0.18), fx!(0.09), Some((0, fx!(0.95)))),
    bone(fx!(-0.1), fx!(0.3), fx!(0.18), fx!(0.08), Some((2, fx!(0.52)))),
    bone(fx!(0.1), fx!(0.75), fx!(0.18), fx!(0.09), Some((0, fx!(0.95)))),
    bone(fx!(0.1), fx!(0.3), fx!(0.18), fx!(0.08), Some((4, fx!(0.52)))),
    bone(fx!(-0.22), fx!(1.3), fx!(0.15), fx!(0.07), Some((0, fx!(1.47)))),
    bone(fx!(-0.22), fx!(0.95), fx!(0.15), fx!(0.06), Some((6, fx!(1.12)))),
    bone(fx!(0.22), fx!(1.3), fx!(0.15), fx!(0.07), Some((0, fx!(1.47)))),
    bone(fx!(0.22), fx!(0.95), fx!(0.15), fx!(0.06), Some((8, fx!(1.12)))),
];

fn spawn_ragdoll(world: &mut World, (x, y): (Fx, Fx)) -> Result<(), WorldError> {
    let mut bodies: Vec<Entity> = Vec::new();
    for Bone { centre, half, radius, hinge } in BONES {
        let ends = [fx!(0) - half, half].map(|y| FixedVec2::new(fx!(0), y));
        let shape = ShapeDef::new(Geometry::capsule(ends[0], ends[1], radius)?).friction(fx!(0.4));
        let place = (x + centre.0, y + centre.1);
        let entity = world.spawn(SpawnBody::new(BodyDef::dynamic().position(place), shape)).id();
        if let Some((parent, height)) = hinge {
            let hinge = Revolute::new().limit(fx!(-0.8), fx!(0.8));
            let joint = SpawnJoint::new([bodies[parent], entity], hinge, (x + centre.0, y + height));
            world.entity_mut(entity).insert(joint);
        }
        bodies.push(entity);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut app = app::<Sandbox>("ragdolls", 20.0, Vec2::new(0.0, 4.0));
    let world = app.world_mut();
    for (x, y, wide, high) in [(0, -1, 8, 1), (-8, 5, 1, 7), (8, 5, 1, 7)].map(|of: (i32, i32, i32, i32)| {
        let [x, y, wide, high] = [of.0, of.1, of.2, of.3].map(Fx::from_num);
        (x, y, wide, high)
    }) {
        let wall = ShapeDef::new(Polygon::rectangle(wide, high)?);
        world.spawn(SpawnBody::new(BodyDef::fixed().position((x, y)), wall));
    }
    for number in 0..12 {
        let (column, row) = (number % 4, number / 4);
        spawn_ragdoll(
            world,
            (Fx::from_num(3 * column - 5) + Fx::from_num(row) / 4, Fx::from_num(1 + 3 * row)),
        )?;
    }
    let commands = build_level(world, Config::default())?;
    app.add_plugins(PointerDragPlugin)
        .insert_resource(Lockstep::<Sandbox>::local(&SandboxSetup { commands, ..SandboxSetup::default() })?)
        .run();
    Ok(())
}
