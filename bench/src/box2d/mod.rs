//! Adapter from Box2D to the benchmark's interface.

mod shapes;

use anyhow::{Result, bail, ensure};
use boxdd_sys::ffi::*;
use lockstep2d::body::{BodyDef, BodyId, ShapeDef};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{ContactTuning, JointDef};
use lockstep2d::world::{BodyPose, Config};
use xxhash_rust::xxh3::xxh3_128;

use crate::engine::{BodyState, Builder, Contacts, Counts, Engine, SAVES, Slots, build};
use crate::script::Event;

pub struct Box2d {
    world: b2WorldId,
    config: Config,
    time_step: f32,
    bodies: Slots<b2BodyId>,
    joints: Vec<b2JointId>,
    saves: [Vec<u8>; SAVES],
}

// Invariant of `Box2d`, to which the SAFETY comments refer: the world exists from `new` to `drop`, the handles in
// `bodies` refer to bodies in this world, and no other code has access to the world or its bodies.

impl Box2d {
    pub fn new(config: &Config, threads: usize) -> Result<Self> {
        ensure!(config.solver.iterations == 1, "more than one solver iteration is not supported");
        let ContactTuning::Soft { hertz, damping_ratio, push_speed } = config.solver.contact else {
            bail!("only soft contacts are supported");
        };
        // SAFETY: the function has no preconditions.
        let mut def = unsafe { b2DefaultWorldDef() };
        def.gravity = shapes::vector(config.gravity);
        def.restitutionThreshold = config.solver.restitution_threshold.to_num();
        def.hitEventThreshold = config.hit_speed.to_num();
        def.contactHertz = hertz.to_num();
        def.contactDampingRatio = damping_ratio.to_num();
        def.contactSpeed = push_speed.to_num();
        def.maximumLinearSpeed = config.solver.speed_max.to_num();
        def.enableSleep = config.sleeping;
        def.enableContinuous = config.continuous;
        def.workerCount = i32::try_from(threads)?;
        // SAFETY: the definition is complete; the log function accepts any message.
        let world = unsafe {
            b2SetLogFcn(Some(quiet));
            b2CreateWorld(&def)
        };
        let time_step = 1.0 / config.tick_rate as f32;
        let (bodies, joints, saves) = (Slots::new(), Vec::new(), Default::default());
        Ok(Box2d { world, config: *config, time_step, bodies, joints, saves })
    }
}

impl Drop for Box2d {
    fn drop(&mut self) {
        // SAFETY: by the invariant of `Box2d`.
        unsafe { b2DestroyWorld(self.world) };
    }
}

impl Builder for Box2d {
    const NAME: &str = "Box2D";

    fn spawn(&mut self, id: BodyId, body: &BodyDef, shapes: &[ShapeDef], pose: BodyPose) -> Result<()> {
        let def = shapes::body_def(body, pose)?;
        // SAFETY: by the invariant of `Box2d`.
        let made = unsafe { b2CreateBody(self.world, &def) };
        self.bodies.insert(id, made);
        shapes.iter().try_for_each(|shape| shapes::add_shape(made, shape))
    }

    fn join(&mut self, joint: &JointDef, (a, b): (BodyId, BodyId)) -> Result<()> {
        let ends = [self.bodies.get(a)?, self.bodies.get(b)?];
        let def = shapes::joint_def(joint, ends, &self.config)?;
        // SAFETY: by the invariant of `Box2d`.
        self.joints.push(unsafe { b2CreateRevoluteJoint(self.world, &def) });
        Ok(())
    }

    fn despawn(&mut self, body: BodyId) -> Result<()> {
        let body = self.bodies.remove(body)?;
        // SAFETY: by the invariant of `Box2d`.
        unsafe { b2DestroyBody(body) };
        Ok(())
    }

    fn enable(&mut self, body: BodyId) -> Result<()> {
        let body = self.bodies.get(body)?;
        // SAFETY: by the invariant of `Box2d`.
        unsafe { b2Body_Enable(body) };
        Ok(())
    }

    fn move_to(&mut self, body: BodyId, position: Vec2<Fx>, angle: Angle) -> Result<()> {
        let target = b2Transform { p: shapes::vector(position), q: shapes::rotation(angle) };
        let body = self.bodies.get(body)?;
        // SAFETY: by the invariant of `Box2d`.
        unsafe { b2Body_SetTargetTransform(body, target, self.time_step, true) };
        Ok(())
    }
}

impl Engine for Box2d {
    fn apply(&mut self, event: &Event) -> Result<()> {
        build(self, event)
    }

    fn step(&mut self) {
        let sub_steps = i32::try_from(self.config.solver.sub_steps).unwrap_or(4);
        // SAFETY: by the invariant of `Box2d`.
        unsafe { b2World_Step(self.world, self.time_step, sub_steps) };
    }

    fn bodies(&self) -> Vec<BodyState> {
        let state = |id: b2BodyId| {
            // SAFETY: by the invariant of `Box2d`.
            let (kind, centre, velocity, mass, awake) = unsafe {
                let awake = b2Body_IsEnabled(id) && b2Body_IsAwake(id);
                let (centre, velocity) = (b2Body_GetWorldCenter(id), b2Body_GetLinearVelocity(id));
                (b2Body_GetType(id), centre, velocity, b2Body_GetMass(id), awake)
            };
            (kind != b2BodyType_b2_staticBody).then(|| BodyState {
                dynamic: kind == b2BodyType_b2_dynamicBody,
                awake,
                mass: mass.into(),
                centre: [centre.x.into(), centre.y.into()],
                velocity: [velocity.x.into(), velocity.y.into()],
            })
        };
        self.bodies.iter().filter_map(state).collect()
    }

    fn counts(&self) -> Counts {
        // SAFETY: by the invariant of `Box2d`.
        let counters = unsafe { b2World_GetCounters(self.world) };
        let number = |count: i32| usize::try_from(count).unwrap_or(0);
        Counts {
            bodies: number(counters.bodyCount),
            shapes: number(counters.shapeCount),
            joints: number(counters.jointCount),
        }
    }

    fn contacts(&self) -> Contacts {
        let mut found = Contacts::default();
        for body in self.bodies.iter() {
            // SAFETY: by the invariant of `Box2d`; the buffer has the capacity that is passed.
            let contacts = unsafe {
                if b2Body_GetType(body) == b2BodyType_b2_staticBody {
                    continue;
                }
                let capacity = b2Body_GetContactCapacity(body);
                let mut contacts = Vec::with_capacity(usize::try_from(capacity).unwrap_or(0));
                let count = b2Body_GetContactData(body, contacts.as_mut_ptr(), capacity);
                contacts.set_len(usize::try_from(count).unwrap_or(0));
                contacts
            };
            for contact in contacts.iter().filter(|contact| counts_for(body, contact)) {
                let points =
                    &contact.manifold.points[..usize::try_from(contact.manifold.pointCount).unwrap_or(0)];
                found.pairs += usize::from(!points.is_empty());
                let depths = points.iter().map(|point| -f64::from(point.separation));
                found.deepest = depths.fold(found.deepest, f64::max);
            }
        }
        found
    }

    fn joint_gap(&self) -> Option<f64> {
        // SAFETY: joints that were destroyed with their bodies are skipped.
        let gap = |&joint: &b2JointId| unsafe {
            if !b2Joint_IsValid(joint) {
                return None;
            }
            let a = b2Body_GetWorldPoint(b2Joint_GetBodyA(joint), b2Joint_GetLocalFrameA(joint).p);
            let b = b2Body_GetWorldPoint(b2Joint_GetBodyB(joint), b2Joint_GetLocalFrameB(joint).p);
            Some(f64::from(a.x - b.x).hypot(f64::from(a.y - b.y)))
        };
        self.joints.iter().filter_map(gap).max_by(f64::total_cmp)
    }

    fn save(&mut self, slot: usize) {
        let save = &mut self.saves[slot];
        // SAFETY: by the invariant of `Box2d`; the buffer has the length that is passed.
        unsafe {
            let needed = b2World_Snapshot(self.world, std::ptr::null_mut(), 0);
            save.resize(usize::try_from(needed).unwrap_or(0), 0);
            b2World_Snapshot(self.world, save.as_mut_ptr(), needed);
        }
    }

    fn saved_bytes(&self, slot: usize) -> usize {
        self.saves[slot].len()
    }

    fn restore(&mut self, slot: usize) -> Result<()> {
        let save = &self.saves[slot];
        let length = i32::try_from(save.len())?;
        // SAFETY: by the invariant of `Box2d`; the bytes are a snapshot of this world.
        let restored = unsafe { b2World_Restore(self.world, save.as_ptr(), length) };
        ensure!(restored, "Box2D refused its own snapshot");
        Ok(())
    }

    fn checksum(&self, slot: usize) -> u128 {
        xxh3_128(&self.saves[slot])
    }

    fn hash(&self) -> Option<u128> {
        None
    }
}

/// Replaces Box2D's log, whose messages would mix with the results and distort the times.
unsafe extern "C" fn quiet(_message: *const std::ffi::c_char) {}

/// Whether a contact in the contact list of `body` is counted. A contact between two non-static bodies is in the lists
/// of both bodies, and is counted only in the list of its body A.
fn counts_for(body: b2BodyId, contact: &b2ContactData) -> bool {
    // SAFETY: the shapes of a contact of the last step exist.
    unsafe {
        let (a, b) = (b2Shape_GetBody(contact.shapeIdA), b2Shape_GetBody(contact.shapeIdB));
        let still = |id| b2Body_GetType(id) == b2BodyType_b2_staticBody;
        still(a) || still(b) || a.index1 == body.index1
    }
}
