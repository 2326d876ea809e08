//! Bodies, shapes and joints of a world.

use lockstep2d::body::{Body, Shape};
use lockstep2d::solver::Joint;
use lockstep2d::world::World;

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::{RawBody, RawFx, RawJoint, RawShape, RawVec2};
use crate::records::{BodyInfo, RawAabb, RawJointDef, RawPose, RawShapeDef};
use crate::status::{Failure, Outcome, Status};
use crate::table::with;

pub(super) fn body(world: &World, raw: RawBody) -> Outcome<&Body> {
    let stale = || Failure::new(Status::StaleBody, "the body does not exist");
    world.body(raw.id()?).ok_or_else(stale)
}

fn shape(world: &World, raw: RawShape) -> Outcome<&Shape> {
    let stale = || Failure::new(Status::StaleShape, "the shape does not exist");
    world.shape(raw.id()?).ok_or_else(stale)
}

fn joint(world: &World, raw: RawJoint) -> Outcome<&Joint> {
    let stale = || Failure::new(Status::StaleJoint, "the joint does not exist");
    world.joint(raw.id()?).ok_or_else(stale)
}

api! {
    /// Properties of a body.
    fn ls2d_body_get(world: u32, id: RawBody, info: Out<'_, BodyInfo>) {
        let mut info = info;
        with(world, |world: &mut World| info.set(BodyInfo::of(body(world, id)?)))
    }

    /// All bodies in slot order.
    fn ls2d_world_bodies(world: u32, bodies: Out<'_, RawBody>, capacity: usize, count: Out<'_, usize>) {
        let (mut bodies, mut count) = (bodies, count);
        with(world, |world: &mut World| {
            let all: Vec<RawBody> = world.bodies().map(|(id, _)| RawBody::of(id)).collect();
            bodies.set_all(capacity, &mut count, &all)
        })
    }

    /// Poses of all bodies in slot order.
    fn ls2d_world_poses(world: u32, poses: Out<'_, RawPose>, capacity: usize, count: Out<'_, usize>) {
        let (mut poses, mut count) = (poses, count);
        with(world, |world: &mut World| {
            let all: Vec<RawPose> = world.bodies().map(|(id, body)| RawPose::of(id, body)).collect();
            poses.set_all(capacity, &mut count, &all)
        })
    }

    /// Shapes of a body in order of attachment.
    fn ls2d_body_shapes(
        world: u32,
        id: RawBody,
        shapes: Out<'_, RawShape>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (mut shapes, mut count) = (shapes, count);
        with(world, |world: &mut World| {
            let all: Vec<RawShape> = body(world, id)?.shapes().iter().map(|&id| RawShape::of(id)).collect();
            shapes.set_all(capacity, &mut count, &all)
        })
    }

    /// Joints of a body in slot order.
    fn ls2d_body_joints(
        world: u32,
        id: RawBody,
        joints: Out<'_, RawJoint>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (mut joints, mut count) = (joints, count);
        with(world, |world: &mut World| {
            body(world, id)?;
            let all: Vec<RawJoint> = world.joints_of(id.id()?).into_iter().map(RawJoint::of).collect();
            joints.set_all(capacity, &mut count, &all)
        })
    }

    /// Name of a body: 16 bytes, padded with zeros.
    fn ls2d_body_name(world: u32, id: RawBody, name: Out<'_, [u8; 16]>) {
        let mut name = name;
        with(world, |world: &mut World| {
            let mut bytes = [0; 16];
            let found = body(world, id)?.name();
            let text = found.as_ref().map(lockstep2d::body::Name::as_str).unwrap_or_default();
            bytes.iter_mut().zip(text.bytes()).for_each(|(place, byte)| *place = byte);
            name.set(bytes)
        })
    }

    /// Velocity in m/s of a body at a point of the world in metres.
    fn ls2d_body_velocity_at(world: u32, id: RawBody, x: RawFx, y: RawFx, velocity: Out<'_, RawVec2>) {
        let mut velocity = velocity;
        with(world, |world: &mut World| {
            velocity.set(RawVec2::of(body(world, id)?.velocity_at(RawVec2 { x, y }.vec())))
        })
    }

    /// Definition of a shape, and handle of its body. Each pointer to a result may be null.
    fn ls2d_shape_get(world: u32, id: RawShape, def: Out<'_, RawShapeDef>, owner: Out<'_, RawBody>) {
        let (mut def, mut owner) = (def, owner);
        with(world, |world: &mut World| {
            let found = shape(world, id)?;
            def.set_if_wanted(RawShapeDef::of(found.def()))?;
            owner.set_if_wanted(RawBody::of(found.body()))
        })
    }

    /// The fat AABB of a shape: its axis-aligned bounding box in the world with a margin, in metres.
    fn ls2d_shape_box(world: u32, id: RawShape, area: Out<'_, RawAabb>) {
        let mut area = area;
        with(world, |world: &mut World| area.set(RawAabb::of(shape(world, id)?.fat_aabb())))
    }

    /// Shapes that a sensor overlaps, in slot order.
    fn ls2d_sensor_overlaps(
        world: u32,
        id: RawShape,
        shapes: Out<'_, RawShape>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (mut shapes, mut count) = (shapes, count);
        with(world, |world: &mut World| {
            shape(world, id)?;
            let all: Vec<RawShape> = world.sensor_overlaps(id.id()?).into_iter().map(RawShape::of).collect();
            shapes.set_all(capacity, &mut count, &all)
        })
    }

    /// All joints in slot order.
    fn ls2d_world_joints(world: u32, joints: Out<'_, RawJoint>, capacity: usize, count: Out<'_, usize>) {
        let (mut joints, mut count) = (joints, count);
        with(world, |world: &mut World| {
            let all: Vec<RawJoint> = world.joints().map(|(id, _)| RawJoint::of(id)).collect();
            joints.set_all(capacity, &mut count, &all)
        })
    }

    /// Definition of a joint.
    fn ls2d_joint_get(world: u32, id: RawJoint, def: Out<'_, RawJointDef>) {
        let mut def = def;
        with(world, |world: &mut World| def.set(RawJointDef::of(joint(world, id)?.def())))
    }

    /// The anchors of a joint in the world, in metres.
    fn ls2d_joint_anchors(world: u32, id: RawJoint, a: Out<'_, RawVec2>, b: Out<'_, RawVec2>) {
        let (mut a, mut b) = (a, b);
        with(world, |world: &mut World| {
            joint(world, id)?;
            let (on_a, on_b) = world.joint_anchors(id.id()?).ok_or_else(Failure::none)?;
            a.set_if_wanted(RawVec2::of(on_a))?;
            b.set_if_wanted(RawVec2::of(on_b))
        })
    }

    /// Angle of the joint's frame on B relative to its frame on A in rad, counter-clockwise, including whole turns.
    fn ls2d_joint_angle(world: u32, id: RawJoint, angle: Out<'_, RawFx>) {
        let mut angle = angle;
        with(world, |world: &mut World| {
            joint(world, id)?;
            angle.set(RawFx::of(world.joint_angle(id.id()?).ok_or_else(Failure::none)?))
        })
    }

    /// Force in N that a joint exerted on body B in the last sub-step, and torque in N m about B's anchor.
    fn ls2d_joint_force(world: u32, id: RawJoint, force: Out<'_, RawVec2>, torque: Out<'_, RawFx>) {
        let (mut force, mut torque) = (force, torque);
        with(world, |world: &mut World| {
            joint(world, id)?;
            let (on_b, turning) = world.joint_force(id.id()?).ok_or_else(Failure::none)?;
            force.set_if_wanted(RawVec2::of(on_b))?;
            torque.set_if_wanted(RawFx::of(turning))
        })
    }

    /// Copies the definition of a joint, and sets its anchors and angles for the current poses of its bodies: both
    /// anchors are at the point `anchor` of the world, in metres. The x axes of the joint's frames have the direction
    /// `axis` in the world; a zero vector stands for the x axis. A gear, rack or pulley is adapted so that it has no
    /// position error.
    fn ls2d_joint_at(
        world: u32,
        from: In<'_, RawJointDef>,
        anchor: In<'_, RawVec2>,
        axis: In<'_, RawVec2>,
        def: Out<'_, RawJointDef>,
    ) {
        let mut def = def;
        let (from, anchor, axis) = (from.get()?.def()?, anchor.get()?.vec(), axis.get()?.vec());
        with(world, |world: &mut World| {
            let placed = world.joint_along(from.body_a, from.body_b, from.kind, anchor, axis)?;
            let placed = lockstep2d::solver::JointDef { frame_a: placed.frame_a, frame_b: placed.frame_b, ..from };
            def.set(RawJointDef::of(&world.fit_joint(&placed)?))
        })
    }
}
