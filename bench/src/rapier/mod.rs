//! Adapter from rapier2d to the benchmark's interface.

mod shapes;

use anyhow::{Context, Result, bail, ensure};
use bincode::config::legacy;
use bincode::serde::{decode_from_slice, encode_into_std_write};
use lockstep2d::body::{BodyDef, BodyId, Geometry, ShapeDef};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{ContactTuning, JointDef};
use lockstep2d::world::{BodyPose, Config};
use rapier2d::pipeline::PhysicsWorld;
use rapier2d::prelude::*;
use xxhash_rust::xxh3::xxh3_128;

use crate::engine::{BodyState, Builder, Contacts, Counts, Engine, SAVES, Slots, build};
use crate::script::Event;

pub struct Rapier {
    world: PhysicsWorld,
    config: Config,
    threads: usize,
    bodies: Slots<RigidBodyHandle>,
    /// Number of chain links minus the number of chains. Each chain is a single collider, but its links count as
    /// shapes.
    extra_links: usize,
    /// Bodies to put to sleep after the first step. If they slept earlier, new contacts in that step would wake them.
    to_sleep: Vec<RigidBodyHandle>,
    saves: [Vec<u8>; SAVES],
}

impl Rapier {
    pub fn new(config: &Config, threads: usize) -> Result<Self> {
        ensure!(config.solver.iterations == 1, "more than one solver iteration is not supported");
        let ContactTuning::Soft { hertz, damping_ratio, push_speed } = config.solver.contact else {
            bail!("only soft contacts are supported");
        };
        let softness = |hertz: f32| SpringCoefficients {
            natural_frequency: hertz,
            damping_ratio: damping_ratio.to_num(),
        };
        let mut world = PhysicsWorld::new();
        world.gravity = shapes::vector(config.gravity);
        let parameters = &mut world.integration_parameters;
        parameters.dt = 1.0 / config.tick_rate as f32;
        parameters.num_solver_iterations = usize::try_from(config.solver.sub_steps)?;
        parameters.contact_softness = softness(hertz.to_num());
        // Contacts with static bodies have twice the frequency, as in the other engines.
        parameters.static_contact_softness = softness(2.0 * hertz.to_num::<f32>());
        parameters.normalized_max_corrective_velocity = push_speed.to_num();
        parameters.normalized_max_linear_velocity = config.solver.speed_max.to_num();
        parameters.max_ccd_substeps = usize::from(config.continuous);
        let mut engine = Rapier {
            world,
            config: *config,
            threads,
            bodies: Slots::new(),
            extra_links: 0,
            to_sleep: Vec::new(),
            saves: Default::default(),
        };
        engine.set_threads()?;
        Ok(engine)
    }

    #[cfg(feature = "rapier-threads")]
    fn set_threads(&mut self) -> Result<()> {
        Ok(self.world.physics_pipeline.configure_thread_pool(self.threads)?)
    }

    #[cfg(not(feature = "rapier-threads"))]
    fn set_threads(&mut self) -> Result<()> {
        ensure!(self.threads == 1, "build with --features rapier-threads");
        Ok(())
    }

    fn body_mut(&mut self, id: BodyId) -> Result<&mut RigidBody> {
        let handle = self.bodies.get(id)?;
        self.world.bodies.get_mut(handle).context("the body does not exist")
    }
}

impl Builder for Rapier {
    const NAME: &str = "rapier2d";

    fn spawn(&mut self, id: BodyId, def: &BodyDef, shapes: &[ShapeDef], pose: BodyPose) -> Result<()> {
        let mut body = shapes::body(def, pose, &self.config)?.build();
        body.activation_mut().normalized_linear_threshold =
            match def.settings.may_sleep && self.config.sleeping {
                true => def.settings.sleep_speed.to_num(),
                false => -1.0,
            };
        let handle = self.world.insert_body(body);
        self.bodies.insert(id, handle);
        if def.asleep {
            self.to_sleep.push(handle);
        }
        for collider in shapes::colliders(shapes)? {
            self.world.insert_collider(collider, Some(handle));
        }
        let links = shapes.iter().filter(|shape| matches!(shape.geometry, Geometry::Link { .. })).count();
        self.extra_links += links.saturating_sub(1);
        Ok(())
    }

    fn join(&mut self, joint: &JointDef, (a, b): (BodyId, BodyId)) -> Result<()> {
        let joint = shapes::joint(joint)?;
        self.world.insert_impulse_joint(self.bodies.get(a)?, self.bodies.get(b)?, joint);
        Ok(())
    }

    fn despawn(&mut self, body: BodyId) -> Result<()> {
        let handle = self.bodies.remove(body)?;
        self.world.remove_body(handle).context("the body does not exist")?;
        Ok(())
    }

    fn enable(&mut self, body: BodyId) -> Result<()> {
        self.body_mut(body)?.set_enabled(true);
        Ok(())
    }

    fn move_to(&mut self, body: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<()> {
        let rate = self.config.tick_rate as f32;
        let target = Pose::new(shapes::vector(position), angle.to_radians().to_num());
        let body = self.body_mut(body)?;
        let way = target.translation - body.translation();
        let turn = (target.rotation * body.rotation().inverse()).angle();
        body.set_linvel(way * rate, true);
        body.set_angvel(turn * rate, true);
        Ok(())
    }
}

impl Engine for Rapier {
    fn apply(&mut self, event: &Event) -> Result<()> {
        build(self, event)
    }

    fn step(&mut self) {
        self.world.step();
        for handle in self.to_sleep.drain(..) {
            if let Some(body) = self.world.bodies.get_mut(handle) {
                body.sleep();
            }
        }
    }

    fn bodies(&self) -> Vec<BodyState> {
        let state = |handle: RigidBodyHandle| {
            let body = self.world.bodies.get(handle)?;
            let (centre, velocity) = (body.center_of_mass(), body.linvel());
            (!body.is_fixed()).then(|| BodyState {
                dynamic: body.is_dynamic(),
                awake: body.is_enabled() && !body.is_sleeping(),
                mass: body.mass().into(),
                centre: [centre.x.into(), centre.y.into()],
                velocity: [velocity.x.into(), velocity.y.into()],
            })
        };
        self.bodies.iter().filter_map(state).collect()
    }

    fn counts(&self) -> Counts {
        Counts {
            bodies: self.world.bodies.len(),
            shapes: self.world.colliders.len() + self.extra_links,
            joints: self.world.impulse_joints.len(),
        }
    }

    fn contacts(&self) -> Contacts {
        let mut found = Contacts::default();
        for pair in self.world.narrow_phase.contact_pairs() {
            let mut points = pair.manifolds().iter().flat_map(|manifold| &manifold.points).peekable();
            found.pairs += usize::from(points.peek().is_some());
            found.deepest = points.map(|point| -f64::from(point.dist)).fold(found.deepest, f64::max);
        }
        found
    }

    fn joint_gap(&self) -> Option<f64> {
        let bodies = &self.world.bodies;
        let gap = |(_, joint): (ImpulseJointHandle, &ImpulseJoint)| {
            let (a, b) = (bodies.get(joint.body1())?, bodies.get(joint.body2())?);
            let a = a.position().transform_point(joint.data.local_frame1.translation);
            let b = b.position().transform_point(joint.data.local_frame2.translation);
            Some(f64::from(a.x - b.x).hypot(f64::from(a.y - b.y)))
        };
        self.world.impulse_joints().filter_map(gap).max_by(f64::total_cmp)
    }

    fn save(&mut self, slot: usize) {
        let save = &mut self.saves[slot];
        save.clear();
        encode_into_std_write(&self.world, save, legacy()).expect("writing to a buffer cannot fail");
    }

    fn saved_bytes(&self, slot: usize) -> usize {
        self.saves[slot].len()
    }

    fn restore(&mut self, slot: usize) -> Result<()> {
        (self.world, _) = decode_from_slice(&self.saves[slot], legacy())?;
        self.set_threads()
    }

    fn checksum(&self, slot: usize) -> u128 {
        xxh3_128(&self.saves[slot])
    }

    fn hash(&self) -> Option<u128> {
        None
    }
}
