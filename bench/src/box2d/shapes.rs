//! Converts bodies, shapes and joints of a scene to Box2D definitions.

use anyhow::{Context, Result, bail, ensure};
use boxdd_sys::ffi::*;
use lockstep2d::body::{BodyDef, BodyKind, Continuous, Geometry, MassSource, ShapeDef, Sides};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{JointDef, JointFrame, JointKind};
use lockstep2d::world::{BodyPose, Config};

use crate::engine::{corners, singles};

pub fn vector(v: Vec2<Fx>) -> b2Vec2 {
    let [x, y] = singles(v);
    b2Vec2 { x, y }
}

pub fn rotation(angle: Angle) -> b2Rot {
    b2Rot { c: angle.cos().to_num(), s: angle.sin().to_num() }
}

pub fn body_def(body: &BodyDef, pose: BodyPose) -> Result<b2BodyDef> {
    ensure!(matches!(body.mass, MassSource::Shapes), "explicit masses are not supported");
    let settings = &body.settings;
    // SAFETY: the function has no preconditions.
    let mut def = unsafe { b2DefaultBodyDef() };
    def.type_ = match body.kind {
        BodyKind::Fixed => b2BodyType_b2_staticBody,
        BodyKind::Kinematic => b2BodyType_b2_kinematicBody,
        BodyKind::Dynamic => b2BodyType_b2_dynamicBody,
    };
    def.position = vector(pose.position);
    def.rotation = rotation(pose.angle);
    def.linearVelocity = vector(body.velocity);
    def.angularVelocity = body.angular_velocity.to_num();
    def.linearDamping = settings.linear_damping.to_num();
    def.angularDamping = settings.angular_damping.to_num();
    def.gravityScale = settings.gravity_scale.to_num();
    def.sleepThreshold = settings.sleep_speed.to_num();
    def.enableSleep = settings.may_sleep;
    def.isBullet = settings.continuous == Continuous::Bullet;
    def.isAwake = !body.asleep;
    def.isEnabled = body.enabled;
    Ok(def)
}

/// Adds a shape. Contact and sensor events stay off, which is Box2D's default and saves time.
pub fn add_shape(body: b2BodyId, shape: &ShapeDef) -> Result<()> {
    ensure!(!shape.sensor && shape.one_way.is_none(), "sensors and one-way shapes are not supported");
    // SAFETY: the function has no preconditions.
    let mut def = unsafe { b2DefaultShapeDef() };
    def.density = shape.density.to_num();
    def.material.friction = shape.material.friction.to_num();
    def.material.restitution = shape.material.restitution.to_num();
    let filter = shape.filter;
    def.filter = b2Filter { categoryBits: filter.category, maskBits: filter.mask, groupIndex: filter.group };
    def.enableHitEvents = shape.events.hit;
    let at = |point: Vec2<Fx>| vector(point + shape.offset);
    // SAFETY: the body belongs to an existing world; every function copies the definition and the geometry.
    unsafe {
        match &shape.geometry {
            Geometry::Circle { radius } => {
                let circle = b2Circle { center: vector(shape.offset), radius: radius.to_num() };
                b2CreateCircleShape(body, &def, &circle);
            }
            Geometry::Capsule { a, b, radius } => {
                let capsule = b2Capsule { center1: at(*a), center2: at(*b), radius: radius.to_num() };
                b2CreateCapsuleShape(body, &def, &capsule);
            }
            Geometry::Segment { a, b } => {
                b2CreateSegmentShape(body, &def, &b2Segment { point1: at(*a), point2: at(*b) });
            }
            Geometry::Polygon(polygon) => {
                let points: Vec<_> =
                    corners(polygon, shape.offset).into_iter().map(|[x, y]| b2Vec2 { x, y }).collect();
                let hull = b2ComputeHull(points.as_ptr(), i32::try_from(points.len())?);
                ensure!(
                    usize::try_from(hull.count)? == points.len(),
                    "Box2D should keep all corners of a polygon in its hull"
                );
                b2CreatePolygonShape(body, &def, &b2MakePolygon(&hull, polygon.radius().to_num()));
            }
            Geometry::Link { a, b, before, after, sides } => {
                ensure!(*sides == Sides::Right, "two-sided chains are not supported");
                let (before, after) =
                    before.zip(*after).context("the end links of open chains are not supported")?;
                let segment = b2Segment { point1: at(*a), point2: at(*b) };
                let link = b2ChainSegment { ghost1: at(before), segment, ghost2: at(after), chainId: -1 };
                b2CreateChainSegmentShape(body, &def, &link);
            }
        }
    }
    Ok(())
}

fn frame(frame: &JointFrame) -> b2Transform {
    b2Transform { p: vector(frame.anchor), q: rotation(frame.angle) }
}

/// Definition of a joint. The scenes contain only revolute joints.
pub fn joint_def(joint: &JointDef, ends: [b2BodyId; 2], config: &Config) -> Result<b2RevoluteJointDef> {
    let JointKind::Revolute(hinge) = &joint.kind else { bail!("only revolute joints are supported") };
    // SAFETY: the function has no preconditions.
    let mut def = unsafe { b2DefaultRevoluteJointDef() };
    [def.base.bodyIdA, def.base.bodyIdB] = ends;
    def.base.localFrameA = frame(&joint.frame_a);
    def.base.localFrameB = frame(&joint.frame_b);
    def.base.collideConnected = joint.collide_connected;
    def.base.constraintHertz = config.solver.joint_hertz.to_num();
    def.base.constraintDampingRatio = config.solver.joint_damping_ratio.to_num();
    if let Some(limit) = hinge.limit {
        def.enableLimit = true;
        (def.lowerAngle, def.upperAngle) = (limit.lower.to_num(), limit.upper.to_num());
    }
    if let Some(motor) = hinge.motor {
        def.enableMotor = true;
        (def.motorSpeed, def.maxMotorTorque) = (motor.speed.to_num(), motor.max.to_num());
    }
    if let Some(spring) = hinge.spring {
        def.enableSpring = true;
        (def.hertz, def.dampingRatio) = (spring.hertz.to_num(), spring.damping_ratio.to_num());
        def.targetAngle = spring.target.to_num();
    }
    Ok(def)
}
