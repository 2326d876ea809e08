//! Ragdolls: eleven capsules that are held together by hinges with limits, friction and springs (Box2D's "human").

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, floor, rectangle};
use lockstep2d::body::{BodyDef, BodyId, Filter, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::Config;

/// Collision category of the ground.
const GROUND: u64 = 1;
/// Collision category of ragdolls.
const RAGDOLL_CATEGORY: u64 = 2;

/// A bone: a vertical capsule, and the hinge to its parent. Heights are in metres above the origin of the ragdoll.
pub(super) struct Bone {
    /// Index of the parent bone.
    pub(super) parent: usize,
    height: Fx,
    /// Heights of the ends of the capsule's segment, relative to `height`.
    ends: (Fx, Fx),
    radius: Fx,
    /// Height of the hinge.
    pivot: Fx,
    /// Limits of the hinge in units of pi.
    limit: (Fx, Fx),
    /// Maximum friction torque of the hinge, in units of 0.05 N m.
    strength: Fx,
    extra: Extra,
}

enum Extra {
    None,
    /// Bone with linear damping.
    Damped,
    /// Lower leg: has a foot, an additional shape with little friction that collides only with the ground.
    Foot,
    /// Bone with linear damping. Its hinge is bent by an eighth of a turn when the angle of the hinge is 0.
    Bent,
}

const fn bone(parent: usize, height: Fx, ends: (Fx, Fx), radius: Fx, extra: Extra) -> Bone {
    let limit = (Fx::ZERO, Fx::ZERO);
    Bone { parent, height, ends, radius, pivot: Fx::ZERO, limit, strength: Fx::ZERO, extra }
}

const HIP: Bone = bone(0, fx!(0.95), (fx!(-0.02), fx!(0.02)), fx!(0.095), Extra::None);
const TORSO: Bone = bone(0, fx!(1.2), (fx!(-0.135), fx!(0.135)), fx!(0.09), Extra::None).hinge(
    fx!(1),
    (fx!(-0.25), fx!(0)),
    fx!(0.5),
);
const HEAD: Bone = bone(1, fx!(1.475), (fx!(-0.038), fx!(0.039)), fx!(0.075), Extra::Damped).hinge(
    fx!(1.4),
    (fx!(-0.3), fx!(0.1)),
    fx!(0.25),
);
const UPPER_LEG: Bone = bone(0, fx!(0.775), (fx!(-0.125), fx!(0.125)), fx!(0.06), Extra::None).hinge(
    fx!(0.9),
    (fx!(-0.05), fx!(0.4)),
    fx!(1),
);
const UPPER_ARM: Bone = bone(1, fx!(1.225), (fx!(-0.125), fx!(0.125)), fx!(0.035), Extra::None).hinge(
    fx!(1.35),
    (fx!(-0.1), fx!(0.8)),
    fx!(0.5),
);

const fn lower_leg(upper: usize) -> Bone {
    bone(upper, fx!(0.475), (fx!(-0.155), fx!(0.125)), fx!(0.045), Extra::Foot).hinge(
        fx!(0.625),
        (fx!(-0.5), fx!(-0.02)),
        fx!(0.5),
    )
}

const fn lower_arm(upper: usize) -> Bone {
    bone(upper, fx!(0.975), (fx!(-0.125), fx!(0.125)), fx!(0.03), Extra::Bent).hinge(
        fx!(1.1),
        (fx!(-0.2), fx!(0.3)),
        fx!(0.1),
    )
}

/// Bones of a ragdoll. Parents come before their children.
pub(super) const BONES: [Bone; 11] = [
    HIP,
    TORSO,
    HEAD,
    UPPER_LEG,
    lower_leg(3),
    UPPER_LEG,
    lower_leg(5),
    UPPER_ARM,
    lower_arm(7),
    UPPER_ARM,
    lower_arm(9),
];

impl Bone {
    const fn hinge(mut self, pivot: Fx, limit: (Fx, Fx), strength: Fx) -> Bone {
        self.pivot = pivot;
        self.limit = limit;
        self.strength = strength;
        self
    }

    /// Body definition, without the position.
    pub(super) fn body(&self) -> BodyDef {
        let damping = match self.extra {
            Extra::Damped | Extra::Bent => fx!(0.1),
            Extra::None | Extra::Foot => fx!(0),
        };
        BodyDef::dynamic().linear_damping(damping).sleep_speed(fx!(0.1))
    }

    /// Position of the bone for a ragdoll at `place`.
    pub(super) fn position(&self, place: Vec2<Fx>) -> Vec2<Fx> {
        place + Vec2::new(fx!(0), self.height)
    }

    /// Shapes of the bone. `ragdoll` is the number of the ragdoll, at least 1. Shapes of the same ragdoll do not
    /// collide with each other.
    pub(super) fn shapes(&self, ragdoll: i32) -> Result<Vec<ShapeDef>, WorldError> {
        let filter = Filter { category: RAGDOLL_CATEGORY, mask: GROUND | RAGDOLL_CATEGORY, group: -ragdoll };
        let (low, high) = (Vec2::new(fx!(0), self.ends.0), Vec2::new(fx!(0), self.ends.1));
        let capsule =
            ShapeDef::new(Geometry::capsule(low, high, self.radius)?).friction(fx!(0.2)).filter(filter);
        if !matches!(self.extra, Extra::Foot) {
            return Ok(vec![capsule]);
        }
        let sole = [
            (fx!(-0.03), fx!(-0.185)),
            (fx!(0.11), fx!(-0.185)),
            (fx!(0.11), fx!(-0.16)),
            (fx!(-0.03), fx!(-0.14)),
        ];
        let foot = Polygon::hull(&sole.map(|(x, y)| Vec2::new(x, y)))?.rounded(fx!(0.015))?;
        let foot = ShapeDef::new(foot).friction(fx!(0.05)).filter(Filter { mask: GROUND, ..filter });
        Ok(vec![capsule, foot])
    }

    pub(super) fn joint(&self, parent: BodyId, own: BodyId) -> JointDef {
        let (lower, upper) = self.limit;
        let hinge = Revolute::new()
            .limit(fx_mul(lower, PI), fx_mul(upper, PI))
            .motor(fx!(0), fx_mul(self.strength, fx!(0.05)))
            .spring(fx!(5), fx!(0.5), fx!(0));
        let bend = if matches!(self.extra, Extra::Bent) { Angle::EIGHTH } else { Angle::ZERO };
        JointDef::new(parent, own, hinge)
            .anchor_a((fx!(0), self.pivot - BONES[self.parent].height))
            .anchor_b((fx!(0), self.pivot - self.height))
            .angle_a(bend)
    }
}

pub(super) const RAGDOLL: Scene =
    Scene::new("ragdoll", 400, "a ragdoll falls down a few steps and comes to rest", |_| {
        build(Config::default(), |scene| {
            floor(scene, fx!(20))?;
            for step in 1..=3 {
                let half_width = fx!(2) - Fx::from_num(step) / 4;
                let stair = rectangle(half_width, fx!(0.15))?;
                let y = fx!(0.3) * step - fx!(0.15);
                scene.spawn(BodyDef::fixed().position((half_width - fx!(4), y)), &[stair])?;
            }
            let place = Vec2::new(fx!(-1.6), fx!(2));
            let mut bodies = Vec::new();
            for bone in &BONES {
                let at = bone.position(place);
                let own = scene.spawn(bone.body().position(at), &bone.shapes(1)?)?;
                if let Some(&parent) = bodies.get(bone.parent) {
                    scene.joint(bone.joint(parent, own))?;
                }
                bodies.push(own);
            }
            Ok(())
        })
    })
    .golden(320);
