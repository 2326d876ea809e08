//! A ball and a box fall onto a platform. Drag them with the mouse; Space throws them up.

use bevy::prelude::*;
use bevy_lockstep2d::PointerDragPlugin;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d_examples::app;
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::math::Vec2 as FixedVec2;
use lockstep2d::world::Command;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let spawn = |body, shape| Command::Spawn { body, shapes: vec![shape] };
    let platform = ShapeDef::new(Polygon::rectangle(fx!(5), fx!(0.5))?);
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?).restitution(fx!(0.6));
    let square = ShapeDef::new(Polygon::square(fx!(0.4))?);
    let commands = vec![
        spawn(BodyDef::fixed().position((fx!(0), fx!(-2))), platform),
        spawn(BodyDef::dynamic().position((fx!(0.2), fx!(3))), ball),
        spawn(BodyDef::dynamic().position((fx!(-2), fx!(2))), square),
    ];
    app::<Sandbox>("hello", 15.0, Vec2::ZERO)
        .add_plugins(PointerDragPlugin)
        .insert_resource(Lockstep::<Sandbox>::local(&SandboxSetup { commands, ..SandboxSetup::default() })?)
        .add_systems(bevy::app::RunFixedMainLoop, throw.in_set(LockstepSystems::Inputs))
        .add_systems(Update, (name_hits, on_space_log))
        .run();
    Ok(())
}

/// Gives every dynamic body an upward impulse in the next tick.
fn throw(
    keys: Res<ButtonInput<KeyCode>>,
    lockstep: Res<Lockstep<Sandbox>>,
    mut inputs: ResMut<Inputs<Sandbox>>,
) {
    if !keys.just_pressed(KeyCode::Space) {
        return;
    }
    let bodies = lockstep.world().into_iter().flat_map(|world| world.bodies());
    for (id, body) in bodies.filter(|(_, body)| body.is_dynamic()) {
        let impulse = FixedVec2::new(fx!(0), fx!(6)).scale(body.mass());
        inputs.once(0).push(Command::ApplyImpulse { body: id, impulse, point: body.centre_of_mass() });
    }
}

/// Prints the speeds of hits.
fn name_hits(mut events: MessageReader<ConfirmedEvent>) {
    for event in events.read() {
        if let WorldEvent::Hit(hit) = event.event {
            println!("tick {}: a hit at {:.1} m/s", event.tick, hit.approach_speed.to_num::<f32>());
        }
    }
}

fn on_space_log(keys: Res<ButtonInput<KeyCode>>, status: Res<LockstepStatus>) {
    if keys.just_pressed(KeyCode::Space) {
        println!("thrown at tick {}", status.tick);
    }
}
