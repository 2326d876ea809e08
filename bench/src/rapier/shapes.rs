//! Converts bodies, shapes and joints of a scene to rapier2d definitions.

use anyhow::{Context, Result, bail, ensure};
use lockstep2d::body::{
    BodyDef, BodyKind, Continuous, Filter, Geometry, MassSource, Mixing, ShapeDef, Sides,
};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{JointDef, JointFrame, JointKind};
use lockstep2d::world::{BodyPose, Config};
use rapier2d::prelude::*;

use crate::engine::{corners, singles};

pub fn vector(v: Vec2<Fx>) -> Vector {
    let [x, y] = singles(v);
    Vector::new(x, y)
}

fn radians(angle: Angle) -> f32 {
    angle.to_radians().to_num()
}

/// Builder of a body. Sleeping is disabled per body, because rapier2d cannot disable it for the whole world.
pub fn body(def: &BodyDef, pose: BodyPose, config: &Config) -> Result<RigidBodyBuilder> {
    ensure!(matches!(def.mass, MassSource::Shapes), "explicit masses are not supported");
    let settings = &def.settings;
    let kind = match def.kind {
        BodyKind::Fixed => RigidBodyType::Fixed,
        BodyKind::Kinematic => RigidBodyType::KinematicVelocityBased,
        BodyKind::Dynamic => RigidBodyType::Dynamic,
    };
    Ok(RigidBodyBuilder::new(kind)
        .pose(Pose::new(vector(pose.position), radians(pose.angle)))
        .linvel(vector(def.velocity))
        .angvel(def.angular_velocity.to_num())
        .linear_damping(settings.linear_damping.to_num())
        .angular_damping(settings.angular_damping.to_num())
        .gravity_scale(settings.gravity_scale.to_num())
        .ccd_enabled(settings.continuous == Continuous::Bullet)
        .can_sleep(config.sleeping && settings.may_sleep)
        .sleeping(def.asleep)
        .enabled(def.enabled))
}

/// Colliders of a body. The links of a chain become one polyline.
pub fn colliders(shapes: &[ShapeDef]) -> Result<Vec<ColliderBuilder>> {
    let mut colliders = Vec::new();
    let is_link = |shape: &&ShapeDef| matches!(shape.geometry, Geometry::Link { .. });
    let links: Vec<_> = shapes.iter().filter(is_link).collect();
    if let Some(first) = links.first() {
        colliders.push(with_material(polyline(&links)?, first)?);
    }
    for shape in shapes.iter().filter(|shape| !is_link(shape)) {
        colliders.push(with_material(collider(shape)?, shape)?);
    }
    Ok(colliders)
}

fn polyline(links: &[&ShapeDef]) -> Result<ColliderBuilder> {
    let (mut points, mut segments) = (Vec::new(), Vec::new());
    for link in links {
        let Geometry::Link { a, b, sides: Sides::Right, .. } = link.geometry else {
            bail!("two-sided chains are not supported");
        };
        let mut index = |point: Vec2<Fx>| {
            let point = vector(point + link.offset);
            let known = points.iter().position(|other| *other == point);
            u32::try_from(known.unwrap_or_else(|| {
                points.push(point);
                points.len() - 1
            }))
        };
        segments.push([index(a)?, index(b)?]);
    }
    Ok(ColliderBuilder::oriented_polyline(points, Some(segments)))
}

fn collider(shape: &ShapeDef) -> Result<ColliderBuilder> {
    ensure!(!shape.sensor && shape.one_way.is_none(), "sensors and one-way shapes are not supported");
    let at = |point: Vec2<Fx>| vector(point + shape.offset);
    let density = shape.density.to_num();
    let collider = match &shape.geometry {
        Geometry::Circle { radius } => {
            ColliderBuilder::ball(radius.to_num()).density(density).translation(vector(shape.offset))
        }
        Geometry::Capsule { a, b, radius } => {
            ColliderBuilder::capsule_from_endpoints(at(*a), at(*b), radius.to_num()).density(density)
        }
        Geometry::Segment { a, b } => ColliderBuilder::segment(at(*a), at(*b)),
        Geometry::Polygon(polygon) => {
            let points = corners(polygon, shape.offset);
            let radius = polygon.radius().to_num();
            // rapier2d ignores the rounding radius when it computes a mass.
            let mass = density * rounded_area(&points, radius);
            let collider = match upright_box(&points) {
                Some((centre, [hx, hy])) if radius == 0.0 => {
                    ColliderBuilder::cuboid(hx, hy).translation(centre)
                }
                Some((centre, [hx, hy])) => ColliderBuilder::round_cuboid(hx, hy, radius).translation(centre),
                None => convex(points, radius).context("rapier2d refused a polygon")?,
            };
            collider.mass(mass)
        }
        Geometry::Link { .. } => bail!("chain links are converted to a polyline, not one by one"),
    };
    Ok(collider)
}

fn convex(points: Vec<[f32; 2]>, radius: f32) -> Option<ColliderBuilder> {
    let points = points.into_iter().map(|[x, y]| Vector::new(x, y)).collect();
    if radius == 0.0 {
        ColliderBuilder::convex_polyline(points)
    } else {
        ColliderBuilder::round_convex_polyline(points, radius)
    }
}

/// Area of a convex polygon rounded by `r`: `A + P r + pi r^2`, with its area `A` and perimeter `P`.
fn rounded_area(points: &[[f32; 2]], radius: f32) -> f32 {
    let next = points.iter().cycle().skip(1);
    let sides = points.iter().zip(next).map(|(a, b)| {
        let (twice_area, length) = (a[0] * b[1] - a[1] * b[0], (b[0] - a[0]).hypot(b[1] - a[1]));
        twice_area / 2.0 + length * radius
    });
    sides.sum::<f32>() + std::f32::consts::PI * radius * radius
}

/// Centre and half extents of an axis-aligned rectangle, for which rapier2d has a shape type.
fn upright_box(points: &[[f32; 2]]) -> Option<(Vector, [f32; 2])> {
    let [a, b, c, d] = points else { return None };
    let turned = |i: usize, j: usize| a[i] == b[i] && c[i] == d[i] && b[j] == c[j] && d[j] == a[j];
    if !turned(0, 1) && !turned(1, 0) {
        return None;
    }
    let middle = |i: usize| (a[i] + c[i]) / 2.0;
    let half = |i: usize| (a[i] - c[i]).abs() / 2.0;
    Some((Vector::new(middle(0), middle(1)), [half(0), half(1)]))
}

fn with_material(collider: ColliderBuilder, shape: &ShapeDef) -> Result<ColliderBuilder> {
    let material = &shape.material;
    ensure!(
        material.friction_mixing == Mixing::GeometricMean,
        "only geometric-mean friction mixing is supported"
    );
    ensure!(material.restitution_mixing == Mixing::Maximum, "only maximum restitution mixing is supported");
    Ok(collider
        .friction(material.friction.to_num())
        .friction_combine_rule(CoefficientCombineRule::GeometricMean)
        .restitution(material.restitution.to_num())
        .restitution_combine_rule(CoefficientCombineRule::Max)
        .collision_groups(groups(&shape.filter)))
}

/// The lowest 4 of the 32 bits of a rapier2d filter stand for categories. The other 28 stand for negative groups.
const CATEGORY_BITS: u32 = 0xF;

/// Filter in rapier2d, which has 32 categories and no group numbers. A negative group `-n` becomes the category of bit
/// `4 + n % 28`. Two shapes in one of these categories do not collide, so ragdolls whose groups differ by a multiple of
/// 28 pass through each other.
fn groups(filter: &Filter) -> InteractionGroups {
    let numbered = |bits: u64| (bits & u64::from(u32::MAX)) as u32;
    let (mut memberships, mut accepted) = (numbered(filter.category), numbered(filter.mask));
    if filter.group < 0 {
        let own = 1 << (4 + filter.group.unsigned_abs() % 28);
        let accepts_its_kind = accepted & memberships != 0;
        accepted &= CATEGORY_BITS;
        if accepts_its_kind {
            accepted |= !CATEGORY_BITS & !own;
        }
        memberships = own;
    }
    let (memberships, accepted) =
        (Group::from_bits_truncate(memberships), Group::from_bits_truncate(accepted));
    InteractionGroups::new(memberships, accepted, InteractionTestMode::And)
}

/// Joint in rapier2d, with rapier2d's default stiffness. With the stiffness of the other engines (60 Hz and a damping
/// ratio of 2), the cloth of `joint_grid` would move at 13 m/s in rapier2d after 100 steps; in the other engines it
/// moves at 1.4 m/s. A joint in rapier2d has one motor per axis, which a spring occupies. The hinges of ragdolls have
/// both a spring and a motor that acts as friction; in rapier2d they lack the friction.
pub fn joint(def: &JointDef) -> Result<GenericJoint> {
    let JointKind::Revolute(hinge) = &def.kind else { bail!("only revolute joints are supported") };
    let frame = |frame: &JointFrame| Pose::new(vector(frame.anchor), radians(frame.angle));
    let mut joint = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
        .local_frame1(frame(&def.frame_a))
        .local_frame2(frame(&def.frame_b))
        .contacts_enabled(def.collide_connected);
    if let Some(limit) = hinge.limit {
        joint = joint.limits(JointAxis::AngX, [limit.lower.to_num(), limit.upper.to_num()]);
    }
    if let Some(spring) = hinge.spring {
        let omega = std::f32::consts::TAU * spring.hertz.to_num::<f32>();
        let damping = 2.0 * spring.damping_ratio.to_num::<f32>() * omega;
        joint = joint.motor_model(JointAxis::AngX, MotorModel::AccelerationBased).motor_position(
            JointAxis::AngX,
            spring.target.to_num(),
            omega * omega,
            damping,
        );
    } else if let Some(motor) = hinge.motor {
        // With this damping, only the maximum torque limits the motor, as in the other engines.
        joint = joint
            .motor_model(JointAxis::AngX, MotorModel::AccelerationBased)
            .motor_velocity(JointAxis::AngX, motor.speed.to_num(), 1e6)
            .motor_max_force(JointAxis::AngX, motor.max.to_num());
    }
    Ok(joint.build())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_groups_leave_themselves_out() {
        let ground = groups(&Filter::default());
        let ragdoll = |number: i32| groups(&Filter { category: 2, mask: 3, group: -number });
        let foot = groups(&Filter { category: 2, mask: 1, group: -1 });
        assert!(ragdoll(1).test(ground) && foot.test(ground) && ragdoll(1).test(ragdoll(2)));
        assert!(!ragdoll(1).test(ragdoll(1)) && !foot.test(ragdoll(2)) && !foot.test(foot));
        let grid = groups(&Filter { category: 2, mask: !2, group: 0 });
        assert!(!grid.test(grid));
    }

    #[test]
    fn areas() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(rounded_area(&square, 0.0), 4.0);
        assert!((rounded_area(&square, 1.0) - 4.0 - 8.0 - std::f32::consts::PI).abs() < 1e-5);
    }

    #[test]
    fn rectangles_are_recognised() {
        let points = [[1.0, 2.0], [5.0, 2.0], [5.0, 3.0], [1.0, 3.0]];
        assert_eq!(upright_box(&points), Some((Vector::new(3.0, 2.5), [2.0, 0.5])));
        assert_eq!(upright_box(&[[1.0, 2.0], [5.0, 2.0], [5.0, 3.0], [1.5, 3.0]]), None);
        assert_eq!(upright_box(&points[..3]), None);
    }
}
