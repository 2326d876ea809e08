//! The engine bevy_rapier2d. The snapshots save the components of its context entity, and the transforms, which Rapier
//! reads.

use bevy::prelude::*;
use bevy_ggrs::{ComponentSnapshotPlugin, RollbackApp, Strategy};
use bevy_rapier2d::plugin::context::RapierContextColliders;
use bevy_rapier2d::plugin::context::RapierContextJoints;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::dynamics::{CCDSolver, IntegrationParameters, IslandManager};
use bevy_rapier2d::rapier::geometry::{DefaultBroadPhase, NarrowPhase};

use crate::ggrs::{self, GgrsApp, Tick};
use crate::scene;

/// Saves and loads `RapierContextSimulation`. The type cannot be cloned, so its fields are copied, except the pipeline,
/// which holds only working memory.
struct Simulation;

struct SimulationState {
    islands: IslandManager,
    broad_phase: DefaultBroadPhase,
    narrow_phase: NarrowPhase,
    ccd_solver: CCDSolver,
    integration_parameters: IntegrationParameters,
}

impl Strategy for Simulation {
    type Target = RapierContextSimulation;
    type Stored = SimulationState;

    fn store(target: &RapierContextSimulation) -> SimulationState {
        SimulationState {
            islands: target.islands.clone(),
            broad_phase: target.broad_phase.clone(),
            narrow_phase: target.narrow_phase.clone(),
            ccd_solver: target.ccd_solver.clone(),
            integration_parameters: target.integration_parameters,
        }
    }

    fn load(stored: &SimulationState) -> RapierContextSimulation {
        let mut target = RapierContextSimulation::default();
        Self::update(&mut target, stored);
        target
    }

    fn update(target: &mut RapierContextSimulation, stored: &SimulationState) {
        target.islands.clone_from(&stored.islands);
        target.broad_phase.clone_from(&stored.broad_phase);
        target.narrow_phase.clone_from(&stored.narrow_phase);
        target.ccd_solver.clone_from(&stored.ccd_solver);
        target.integration_parameters = stored.integration_parameters;
    }
}

pub fn app(bodies: usize) -> GgrsApp {
    let mut app = ggrs::app();
    app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_schedule(Tick))
        .insert_resource(TimestepMode::Fixed { dt: 1.0 / 60.0, substeps: 1 })
        .add_plugins(ComponentSnapshotPlugin::<Simulation>::default())
        .rollback_component_with_clone::<RapierRigidBodySet>()
        .rollback_component_with_clone::<RapierContextColliders>()
        .rollback_component_with_clone::<RapierContextJoints>()
        .rollback_component_with_copy::<Transform>()
        .rollback_component_with_copy::<GlobalTransform>()
        .require_rollback::<RapierContextSimulation>()
        .require_rollback::<RigidBody>();
    let (wide, high) = scene::FLOOR;
    let floor = Transform::from_xyz(0.0, -high, 0.0);
    app.world_mut().spawn((RigidBody::Fixed, Collider::cuboid(wide, high), floor));
    for (x, y) in (0..bodies).map(scene::metres) {
        let square = Collider::cuboid(scene::HALF, scene::HALF);
        let place = Transform::from_xyz(x, y, 0.0);
        app.world_mut().spawn((RigidBody::Dynamic, square, place, Sleeping::disabled()));
    }
    GgrsApp::new(app, state)
}

fn state(world: &mut World) -> Vec<u64> {
    let mut bodies = world.query::<&RapierRigidBodySet>();
    let bodies = bodies.iter(world).flat_map(|set| set.bodies.iter());
    bodies
        .flat_map(|(_, body)| {
            let (place, turn, speed) = (body.translation(), body.rotation(), body.linvel());
            ggrs::bits([place.x, place.y, turn.re, turn.im, speed.x, speed.y, body.angvel()])
        })
        .collect()
}
