//! The engine Avian. The snapshots save Avian's components of bodies and colliders, and its resources that last longer
//! than a tick.

use avian2d::collider_tree::{ColliderTreeOptimization, ColliderTrees, MovedProxies};
use avian2d::collision::collider::EnlargedAabb;
use avian2d::dynamics::solver::constraint_graph::ConstraintGraph;
use avian2d::dynamics::solver::islands::{BodyIslandNode, PhysicsIslands};
use avian2d::physics_transform::PhysicsTransformConfig;
use avian2d::prelude::*;
use bevy::prelude::*;
use bevy_ggrs::RollbackApp;

use crate::ggrs::{self, GgrsApp, Tick};
use crate::scene;

pub fn app(bodies: usize) -> GgrsApp {
    let mut app = ggrs::app();
    app.add_plugins(PhysicsPlugins::new(Tick))
        .insert_resource(ColliderTreeOptimization { use_async_tasks: false, ..default() })
        // Positions are the state, and transforms only show them.
        .insert_resource(PhysicsTransformConfig { transform_to_position: false, ..default() })
        .rollback_component_with_copy::<Position>()
        .rollback_component_with_copy::<Rotation>()
        .rollback_component_with_copy::<LinearVelocity>()
        .rollback_component_with_copy::<AngularVelocity>()
        .rollback_component_with_copy::<ColliderAabb>()
        .rollback_component_with_copy::<EnlargedAabb>()
        .rollback_component_with_clone::<BodyIslandNode>()
        .rollback_resource_with_clone::<ContactGraph>()
        .rollback_resource_with_clone::<ConstraintGraph>()
        .rollback_resource_with_clone::<PhysicsIslands>()
        .rollback_resource_with_clone::<ColliderTrees>()
        .rollback_resource_with_clone::<MovedProxies>()
        .require_rollback::<RigidBody>();
    let (wide, high) = scene::FLOOR;
    let floor = Position::from_xy(0.0, -high);
    app.world_mut().spawn((RigidBody::Static, Collider::rectangle(2.0 * wide, 2.0 * high), floor));
    for (x, y) in (0..bodies).map(scene::metres) {
        let square = Collider::rectangle(2.0 * scene::HALF, 2.0 * scene::HALF);
        app.world_mut().spawn((RigidBody::Dynamic, square, Position::from_xy(x, y), SleepingDisabled));
    }
    GgrsApp::new(app, state)
}

fn state(world: &mut World) -> Vec<u64> {
    let mut bodies = world.query::<(Entity, &Position, &Rotation, &LinearVelocity, &AngularVelocity)>();
    let mut bodies: Vec<_> = bodies.iter(world).collect();
    bodies.sort_by_key(|(entity, ..)| *entity);
    bodies
        .into_iter()
        .flat_map(|(_, place, turn, speed, spin)| {
            ggrs::bits([place.x, place.y, turn.cos, turn.sin, speed.x, speed.y, spin.0])
        })
        .collect()
}
