//! Random sequences of calls with random, often wrong arguments: every call returns a code, no handle leaks, and the
//! same sequence gives the same codes and the same hashes.

use lockstep2d::math::Rng;

use super::{done, hash_of};
use crate::*;

/// A caller with some handles and ids, right and wrong ones.
struct Caller {
    rng: Rng,
    handles: Vec<u32>,
    bodies: Vec<RawBody>,
    shapes: Vec<RawShape>,
    joints: Vec<RawJoint>,
    codes: Vec<i32>,
}

impl Caller {
    fn pick<T: Copy>(rng: &mut Rng, items: &[T], wrong: T) -> T {
        let place = usize::try_from(rng.below_u64(items.len() as u64 + 1)).unwrap();
        items.get(place).copied().unwrap_or(wrong)
    }

    fn handle(&mut self) -> u32 {
        let wrong = self.rng.next_u32();
        Self::pick(&mut self.rng, &self.handles, wrong)
    }

    fn body(&mut self) -> RawBody {
        let wrong = RawBody(self.rng.next_u64());
        Self::pick(&mut self.rng, &self.bodies, wrong)
    }

    fn number(&mut self) -> RawFx {
        match self.rng.below(8) {
            0 => RawFx(i64::from_ne_bytes(self.rng.next_u64().to_ne_bytes())),
            1 => RawFx(i64::MAX),
            2 => RawFx(i64::MIN),
            _ => RawFx(i64::from(self.rng.below(64)) * (1 << 30) - (1 << 34)),
        }
    }

    /// Fills a struct of plain fields: sets random words of it to random values.
    fn spoil<const N: usize>(&mut self, words: [&mut RawFx; N]) {
        for word in words {
            if self.rng.below(4) == 0 {
                *word = self.number();
            }
        }
    }

    fn shape(&mut self) -> RawShapeDef {
        let mut shape =
            RawShapeDef::of(&lockstep2d::body::ShapeDef::new(lockstep2d::body::Geometry::Circle {
                radius: lockstep2d::math::Fx::ONE,
            }));
        shape.kind = self.rng.below(9);
        shape.count = self.rng.below(10);
        for index in 0..8 {
            (shape.points[index].x, shape.points[index].y) = (self.number(), self.number());
        }
        if self.rng.below(4) == 0 {
            shape.flags = self.rng.below(1 << 13);
        }
        self.spoil([&mut shape.radius, &mut shape.density, &mut shape.friction, &mut shape.offset.x]);
        shape
    }

    fn joint(&mut self) -> RawJointDef {
        let kind = self.rng.below(11);
        let mut joint = RawJointDef::of_kind(kind).unwrap_or(RawJointDef::of_kind(0).unwrap());
        joint.flags |= self.rng.below(1 << 14) & self.rng.below(1 << 14);
        (joint.body_a, joint.body_b) = (self.body(), self.body());
        self.spoil([
            &mut joint.limit_lower,
            &mut joint.limit_upper,
            &mut joint.motor_max,
            &mut joint.spring_hertz,
            &mut joint.length,
            &mut joint.anchor_a.x,
        ]);
        joint
    }

    fn new_object(&mut self) -> i32 {
        let mut handle = 0;
        let source = self.handle();
        let status = match self.rng.below(5) {
            0 => ls2d_world_new(In::null(), Out::of(&mut handle)),
            1 => ls2d_commands_new(Out::of(&mut handle)),
            2 => ls2d_world_save(source, Out::of(&mut handle)),
            3 => ls2d_world_encode(source, Out::of(&mut handle)),
            _ => ls2d_commands_encode(source, Out::of(&mut handle)),
        };
        if status == 0 && self.handles.len() < 12 {
            self.handles.push(handle);
        } else if status == 0 {
            done(ls2d_free(handle));
        }
        status
    }

    fn call(&mut self) -> i32 {
        let (target, other, body) = (self.handle(), self.handle(), self.body());
        let [a, b, c, d] = std::array::from_fn(|_| self.number());
        match self.rng.below(16) {
            0 => self.new_object(),
            1 => {
                let shapes = [self.shape(), self.shape()];
                let mut def = RawBodyDef::of(&lockstep2d::body::BodyDef::dynamic());
                def.kind = self.rng.below(4);
                self.spoil([&mut def.position.x, &mut def.position.y, &mut def.velocity.x, &mut def.mass]);
                let mut id = RawBody(u64::MAX);
                let count = usize::from(self.rng.below(2) == 0) + 1;
                let status = ls2d_spawn(target, In::of(&def), In::all(&shapes), count, Out::of(&mut id));
                self.bodies.extend((id.0 != u64::MAX).then_some(id));
                status
            }
            2 => {
                let (joint, mut id) = (self.joint(), RawJoint(u64::MAX));
                let status = ls2d_add_joint(target, In::of(&joint), Out::of(&mut id));
                self.joints.extend((id.0 != u64::MAX).then_some(id));
                status
            }
            3 => {
                let (shape, mut id) = (self.shape(), RawShape(u64::MAX));
                let status = ls2d_add_shape(target, body, In::of(&shape), Out::of(&mut id));
                self.shapes.extend((id.0 != u64::MAX).then_some(id));
                status
            }
            4 | 5 => ls2d_world_step(target),
            6 => ls2d_apply_impulse(target, body, a, b, c, d),
            7 => ls2d_set_transform(target, body, a, b, RawAngle(self.rng.next_u32())),
            8 => ls2d_world_execute(target, other, Out::null()),
            9 => ls2d_world_restore(target, other),
            10 => ls2d_despawn(target, body),
            11 => {
                let mut hit = RawRayHit::default_hit();
                ls2d_cast_ray(target, a, b, c, d, In::null(), Out::of(&mut hit))
            }
            12 => {
                let (mut rows, mut count) = ([0.0; 10], 0);
                ls2d_draw_poses(target, Out::all(&mut rows), 10, Out::of(&mut count))
            }
            13 => {
                let wrong = RawShape(self.rng.next_u64());
                let shape = Self::pick(&mut self.rng, &self.shapes, wrong);
                ls2d_remove_shape(target, shape)
            }
            14 => {
                let wrong = RawJoint(self.rng.next_u64());
                let joint = Self::pick(&mut self.rng, &self.joints, wrong);
                ls2d_remove_joint(target, joint)
            }
            _ => self.free(target),
        }
    }

    fn free(&mut self, target: u32) -> i32 {
        if self.rng.below(3) > 0 {
            return 0;
        }
        let status = ls2d_free(target);
        // Half of the stale handles go on being used.
        if self.rng.below(2) == 0 {
            self.handles.retain(|&handle| handle != target);
        }
        status
    }
}

/// Codes of a sequence, and the hashes of the worlds at its end.
fn run(seed: u64) -> (Vec<i32>, Vec<String>) {
    let (handles, bodies, codes) = (Vec::new(), Vec::new(), Vec::new());
    let mut caller =
        Caller { rng: Rng::new(seed), handles, bodies, shapes: Vec::new(), joints: Vec::new(), codes };
    for _ in 0..400 {
        let code = caller.call();
        assert_ne!(code, Status::Internal as i32, "seed {seed}, call {}", caller.codes.len());
        caller.codes.push(code);
    }
    let mut hashes = Vec::new();
    for handle in caller.handles {
        let mut tick = 0;
        if ls2d_world_tick(handle, Out::of(&mut tick)) == 0 {
            hashes.push(hash_of(handle).to_string());
        }
        let freed = ls2d_free(handle);
        assert!(freed == 0 || freed == Status::Handle as i32);
    }
    (caller.codes, hashes)
}

#[test]
fn every_sequence_of_calls_returns_codes() {
    let seeds = std::env::var("SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(200);
    let (mut worlds, mut done_calls) = (0, 0);
    for seed in 0..seeds {
        let (codes, hashes) = run(seed);
        worlds += hashes.len();
        done_calls += codes.iter().filter(|&&code| code == 0).count();
        if seed % 10 == 0 {
            assert_eq!(hashes, run(seed).1, "seed {seed}: the same calls give the same worlds");
        }
    }
    assert!(worlds > 100 && done_calls > 10_000, "{worlds} worlds, {done_calls} calls that were done");
}
