//! Generates joints of every kind. Most parameters are moderate, some are beyond their limits.

use lockstep2d::body::BodyId;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::{
    Distance, Drive, Gear, JointDef, JointKind, JointLimit, LinearDrive, Motor, Prismatic, Pull, Pulley,
    Rack, Revolute, Soft, Spring, Threshold, ThresholdAction, Weld, Wheel,
};

use crate::source::Source;

/// A joint between two bodies, with parameters that may be invalid.
pub fn joint(source: &mut Source<'_>, a: BodyId, b: BodyId) -> JointDef {
    let mut def = JointDef::new(a, b, kind(source));
    let anchor = |source: &mut Source<'_>| match source.below(4) {
        0 => Vec2::ZERO,
        1 | 2 => source.mostly_vec(-800, 800),
        _ => {
            let far = source.mostly_vec(-128_000, 128_000);
            // Anchors on fixed bodies may be far from the origin of the body, so some anchors are further away than
            // those of other bodies may be.
            if far.x.to_bits() & 1 == 0 { far } else { Vec2::new(far.x.saturating_mul(fx!(9)), far.y) }
        }
    };
    (def.frame_a.anchor, def.frame_b.anchor) = (anchor(source), anchor(source));
    if source.one_in(3) {
        (def.frame_a.angle, def.frame_b.angle) = (source.angle(), source.angle());
    }
    finish(source, def)
}

/// Sets the properties that all kinds of joints have: whether connected bodies collide, thresholds, user data and
/// softness.
pub fn finish(source: &mut Source<'_>, mut def: JointDef) -> JointDef {
    def.collide_connected = source.one_in(2);
    if source.one_in(4) {
        let most = |source: &mut Source<'_>| source.one_in(2).then(|| source.mostly(0, 500_000));
        let action = source.pick(&[ThresholdAction::Event, ThresholdAction::Break]);
        def.threshold = Threshold { force: most(source), torque: most(source), action };
    }
    if source.one_in(8) {
        def.user_data = source.word();
        def.enabled = def.user_data & 3 != 0;
        def.softness = (def.user_data & 12 == 0).then(|| a_soft(source));
    }
    def
}

/// A kind of joint with parameters that may be invalid.
pub fn kind(source: &mut Source<'_>) -> JointKind {
    match source.below(12) {
        0 | 1 => Revolute { limit: limit(source), motor: drive(source), spring: spring(source) }.into(),
        2 => Prismatic { limit: limit(source), motor: drive(source), spring: spring(source) }.into(),
        3 | 4 => distance(source).into(),
        5 => Weld { linear: soft(source), angular: soft(source) }.into(),
        6 => Wheel { limit: limit(source), motor: drive(source), spring: spring(source) }.into(),
        7 => motor(source).into(),
        8 => gear(source).into(),
        9 => Rack::new(source.mostly(-2000, 2000)).into(),
        10 => pulley(source).into(),
        _ => JointKind::Filter,
    }
}

fn gear(source: &mut Source<'_>) -> Gear {
    let teeth = |source: &mut Source<'_>| match source.below(8) {
        0 => source.word() as i32,
        1 => source.pick(&[0, 1000, 1001, -1000]),
        2 => -(source.below(60) as i32),
        _ => source.below(60) as i32,
    };
    Gear::new(teeth(source), teeth(source))
}

fn pulley(source: &mut Source<'_>) -> Pulley {
    let wheel = |source: &mut Source<'_>| source.mostly_vec(-4000, 8000);
    let pulley = Pulley::new(wheel(source), wheel(source), source.mostly(0, 12_000));
    if source.one_in(2) { pulley } else { pulley.ratio(source.mostly(250, 4000)) }
}

fn limit(source: &mut Source<'_>) -> Option<JointLimit> {
    source.one_in(3).then(|| {
        let lower = source.mostly(-2000, 1000);
        let width = source.mostly(0, 3000);
        let upper = if source.one_in(8) { width } else { lower.saturating_add(width) };
        JointLimit { lower, upper }
    })
}

fn most(source: &mut Source<'_>) -> Fx {
    match source.below(4) {
        0 => Fx::MAX,
        1 => Fx::ZERO,
        _ => source.mostly(0, 100_000),
    }
}

fn drive(source: &mut Source<'_>) -> Option<Drive> {
    source.one_in(3).then(|| Drive { speed: source.mostly(-10_000, 10_000), max: most(source) })
}

fn soft(source: &mut Source<'_>) -> Option<Soft> {
    source.one_in(2).then(|| a_soft(source))
}

fn a_soft(source: &mut Source<'_>) -> Soft {
    let hertz =
        if source.is_ordinary() { source.thousandths(500, 10_000) } else { source.mostly(1, 1_000_000) };
    Soft { hertz, damping_ratio: source.mostly(0, 2000) }
}

fn spring(source: &mut Source<'_>) -> Option<Spring> {
    source.one_in(3).then(|| {
        let Soft { hertz, damping_ratio } = a_soft(source);
        Spring { hertz, damping_ratio, target: source.mostly(-1000, 1000) }
    })
}

fn distance(source: &mut Source<'_>) -> Distance {
    let positive = |mut limit: JointLimit| {
        limit.lower = limit.lower.max(Fx::ZERO);
        limit.upper = limit.upper.max(limit.lower);
        limit
    };
    let mut joint = Distance::new();
    if source.one_in(3) {
        joint.rod = Some(source.mostly(1, 2000));
    }
    joint.limit = limit(source).map(positive);
    joint.motor = drive(source);
    joint.spring = spring(source);
    if let Some(spring) = &mut joint.spring {
        spring.target = spring.target.saturating_abs();
        if source.one_in(2) {
            let (lower, upper) = (most(source).saturating_neg(), most(source));
            joint.spring_force = Some(JointLimit { lower, upper });
        }
    }
    joint
}

fn motor(source: &mut Source<'_>) -> Motor {
    let pull =
        |source: &mut Source<'_>| source.one_in(2).then(|| Pull { soft: a_soft(source), max: most(source) });
    let mut joint = Motor { linear_spring: pull(source), angular_spring: pull(source), ..Motor::new() };
    joint.angular = drive(source);
    if source.one_in(3) {
        let velocity = source.mostly_vec(-10_000, 10_000);
        joint.linear = Some(LinearDrive { velocity, max_force: most(source) });
    }
    joint
}

/// A kind of joint with moderate parameters, for neighbouring bodies whose anchors are at the same point.
pub fn ordinary_kind(source: &mut Source<'_>) -> JointKind {
    let strength = source.thousandths(1000, 20_000);
    let speed = source.thousandths(-3000, 3000);
    let (hertz, damping) = (source.thousandths(500, 6000), source.thousandths(100, 1500));
    match source.below(15) {
        0 | 1 => Revolute::new().into(),
        2 => Revolute::new().limit(fx!(-0.5), fx!(0.7)).into(),
        3 => Revolute::new().motor(speed, strength).into(),
        4 => Revolute::new().spring(hertz, damping, fx!(0)).into(),
        5 => Prismatic::new().limit(fx!(-0.5), fx!(0.5)).motor(speed, strength).into(),
        6 => Wheel::new()
            .spring(hertz, damping, fx!(0))
            .limit(fx!(-0.3), fx!(0.3))
            .motor(speed, strength)
            .into(),
        7 => Weld::rigid().into(),
        8 => Weld::rigid().linear(hertz, damping).angular(hertz, damping).into(),
        9 => Distance::rope(fx!(0.6)).into(),
        10 => Distance::new().spring(hertz, damping, fx!(0.4)).into(),
        11 => Gear::new(1 + source.below(40) as i32, 1 + source.below(40) as i32).into(),
        12 => Rack::new(source.thousandths(100, 500)).into(),
        13 => pulley(source).into(),
        _ => Motor::new().linear(Vec2::ZERO, strength).angular(fx!(0), strength).into(),
    }
}
