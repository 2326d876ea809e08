//! Random assemblies: bodies without shapes, joined in a star, a tree, a chain, a loop, a mesh or a grid.
//!
//! Joints are satisfied at the start and store no energy. Masses differ by a factor of at most 100. Lever arms are at
//! most 16 times as long as the radius of gyration of their body.
#![expect(clippy::disallowed_types, reason = "energies are compared with floating point, not simulated")]
#![expect(clippy::float_arithmetic, reason = "the oracle computes energy in floating point")]
#![allow(dead_code, reason = "all starts and kinds are defined, the tests use those that gain no energy")]

use lockstep2d::body::{BodyDef, BodyId, JointId, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{
    Distance, JointDef, JointKind, LinearDrive, Motor, Prismatic, Revolute, Weld, Wheel,
};
use lockstep2d::world::{Config, World};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// A hub with 3 to 8 limbs.
    Star,
    Tree,
    Chain,
    Loop,
    /// A tree with additional joints.
    Mesh,
    Grid,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mix {
    Weld,
    Hinge,
    SoftWeld,
    Prismatic,
    Wheel,
    Rod,
    Friction,
    /// A random kind among [`MIXES`] for each joint.
    Every,
    /// Motor joints with a linear spring and, in two of three cases, an angular one.
    MotorSpring,
    /// Distance joints whose spring only pulls, only pushes, or exerts at most 50 N.
    LimitedSpring,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    Hit,
    /// All bodies move as one rigid body.
    Spin,
    Scatter,
    /// All bodies are at rest at first, under gravity.
    Hang,
}

pub(crate) const SHAPES: [Shape; 6] =
    [Shape::Star, Shape::Tree, Shape::Chain, Shape::Loop, Shape::Mesh, Shape::Grid];
pub(crate) const MIXES: [Mix; 7] =
    [Mix::Weld, Mix::Hinge, Mix::SoftWeld, Mix::Prismatic, Mix::Wheel, Mix::Rod, Mix::Friction];
pub(crate) const STARTS: [Start; 4] = [Start::Hit, Start::Spin, Start::Scatter, Start::Hang];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    pub(crate) shape: Shape,
    pub(crate) mix: Mix,
    pub(crate) start: Start,
    pub(crate) seed: u64,
}

pub(crate) struct Assembly {
    pub(crate) world: World,
    pub(crate) bodies: Vec<BodyId>,
    pub(crate) joints: Vec<JointId>,
}

struct Plan {
    place: Vec2<Fx>,
    mass: Fx,
    gyration: Fx,
}

pub(crate) fn pick<T: Copy>(rng: &mut Rng, items: &[T]) -> T {
    items[rng.below(u32::try_from(items.len()).expect("few")) as usize]
}

fn length(v: Vec2<Fx>) -> Fx {
    v.length()
}

impl Case {
    /// Number of bodies, and the pairs of bodies that are joined.
    fn links(&self, rng: &mut Rng) -> (usize, Vec<(usize, usize)>) {
        let few = |rng: &mut Rng, low: u32, high: u32| (low + rng.below(high - low + 1)) as usize;
        match self.shape {
            Shape::Star => {
                let limbs = few(rng, 3, 8);
                (limbs + 1, (1..=limbs).map(|i| (0, i)).collect())
            }
            Shape::Tree => {
                let n = few(rng, 3, 12);
                (n, (1..n).map(|i| (few(rng, 0, u32::try_from(i).expect("few") - 1), i)).collect())
            }
            Shape::Chain => {
                let n = few(rng, 3, 12);
                (n, (1..n).map(|i| (i - 1, i)).collect())
            }
            Shape::Loop => {
                let n = few(rng, 3, 12);
                (n, (0..n).map(|i| (i, (i + 1) % n)).collect())
            }
            Shape::Mesh => {
                let n = few(rng, 4, 12);
                let mut links: Vec<_> =
                    (1..n).map(|i| (few(rng, 0, u32::try_from(i).expect("few") - 1), i)).collect();
                for _ in 0..few(rng, 1, 3) {
                    let a = few(rng, 0, u32::try_from(n).expect("few") - 1);
                    let b = few(rng, 0, u32::try_from(n).expect("few") - 1);
                    let pair = (a.min(b), a.max(b));
                    if a != b && !links.contains(&pair) {
                        links.push(pair);
                    }
                }
                (n, links)
            }
            Shape::Grid => {
                let (w, h) = (few(rng, 2, 4), few(rng, 2, 3));
                let mut links = Vec::new();
                for y in 0..h {
                    for x in 0..w {
                        if x + 1 < w {
                            links.push((y * w + x, y * w + x + 1));
                        }
                        if y + 1 < h {
                            links.push((y * w + x, y * w + x + w));
                        }
                    }
                }
                (w * h, links)
            }
        }
    }

    fn places(&self, rng: &mut Rng, n: usize, links: &[(usize, usize)]) -> Vec<Plan> {
        let masses = [fx!(1), fx!(1), fx!(2), fx!(5), fx!(10), fx!(30), fx!(100)];
        let uniform = rng.chance(1, 3);
        let spread = pick(rng, &[fx!(0), fx!(0.2), fx!(1)]);
        (0..n)
            .map(|i| {
                let step = Fx::from_num(i);
                let base = match self.shape {
                    Shape::Star if i == 0 => Vec2::ZERO,
                    Shape::Star => {
                        let turn = Angle::from_degrees(
                            fx_div(fx!(360) * i64::try_from(i).expect("few"), Fx::from_num(n - 1))
                                .expect("some"),
                        );
                        Rot::from_angle(turn).apply_wide(Vec2::new(rng.range(fx!(0.6), fx!(3)), Fx::ZERO))
                    }
                    Shape::Tree | Shape::Mesh => {
                        Vec2::new(rng.range(fx!(-2), fx!(2)), rng.range(fx!(-2), fx!(2)))
                    }
                    Shape::Chain => Vec2::new(step, Fx::ZERO),
                    Shape::Loop => {
                        let turn = Angle::from_degrees(
                            fx_div(fx!(360) * i64::try_from(i).expect("few"), Fx::from_num(n)).expect("some"),
                        );
                        Rot::from_angle(turn).apply_wide(Vec2::new(Fx::from_num(n) / 6, Fx::ZERO))
                    }
                    Shape::Grid => {
                        // In a grid, the first link that leads downwards joins two indices whose difference is the
                        // number of bodies in a row.
                        let w = links.iter().find(|(a, b)| b - a > 1).map_or(2, |(a, b)| b - a);
                        let w = if links.contains(&(0, 2)) && w == 2 { 2 } else { w };
                        Vec2::new(Fx::from_num(i % w), -Fx::from_num(i / w))
                    }
                };
                let off = Vec2::new(rng.range(-spread, spread), rng.range(-spread, spread));
                let place = base + off.scale_half();
                let mass = if uniform { fx!(1) } else { pick(rng, &masses) };
                Plan { place, mass, gyration: pick(rng, &[fx!(0.1), fx!(0.2), fx!(0.3), fx!(0.5), fx!(1)]) }
            })
            .collect()
    }

    fn joint(&self, rng: &mut Rng, a: BodyId, b: BodyId, [pa, pb]: [&Plan; 2]) -> JointDef {
        // The anchor is on or near the line between the centres.
        let part = rng.range(fx!(0.1), fx!(0.9));
        let between = pb.place - pa.place;
        let aside = if rng.chance(1, 3) { fx!(0.5) } else { fx!(0) };
        let aside = Vec2::new(rng.range(-aside, aside), rng.range(-aside, aside));
        let mut anchor = pa.place + Vec2::new(fx_mul(between.x, part), fx_mul(between.y, part)) + aside;
        for plan in [pa, pb] {
            let arm = anchor - plan.place;
            let most = plan.gyration * 16;
            if length(arm) > most {
                let share = fx_div(most, length(arm)).expect("positive");
                anchor = plan.place + Vec2::new(fx_mul(arm.x, share), fx_mul(arm.y, share));
            }
        }
        let frame = rng.angle();
        let hertz = rng.range(fx!(2), fx!(8));
        let ratio = rng.range(fx!(0.1), fx!(1));
        let mix = match self.mix {
            Mix::Every => pick(rng, &MIXES),
            mix => mix,
        };
        let kind: JointKind = match mix {
            Mix::Weld => Weld::rigid().into(),
            Mix::Hinge => match rng.below(4) {
                0 => Revolute::new().limit(fx!(-0.5), fx!(0.5)).into(),
                1 => Revolute::new().spring(hertz, ratio, fx!(0)).into(),
                _ => Revolute::new().into(),
            },
            Mix::SoftWeld => match rng.below(3) {
                0 => Weld::rigid().angular(hertz, ratio).into(),
                1 => Weld::rigid().linear(hertz, ratio).into(),
                _ => Weld::rigid().linear(hertz, ratio).angular(hertz, ratio).into(),
            },
            Mix::Prismatic => match rng.below(3) {
                0 => Prismatic::new().limit(fx!(-0.3), fx!(0.3)).into(),
                1 => Prismatic::new().spring(hertz, ratio, fx!(0)).into(),
                _ => Prismatic::new().limit(fx!(-0.3), fx!(0.3)).spring(hertz, ratio, fx!(0)).into(),
            },
            Mix::Wheel => Wheel::new().limit(fx!(-0.3), fx!(0.3)).spring(hertz, ratio, fx!(0)).into(),
            Mix::Rod | Mix::LimitedSpring => {
                let far = pb.place + aside;
                let arm = far - pb.place;
                let far = if length(arm) > pb.gyration * 16 { pb.place } else { far };
                let near = anchor - (anchor - pa.place).scale_half();
                let apart = length(far - near);
                if apart > fx!(0.05) {
                    let spring = Distance::new().spring(hertz, ratio, apart);
                    let within = spring.limit(apart / 2, apart * 2);
                    let kind: JointKind = match (mix, rng.below(3)) {
                        (Mix::Rod, 0) => Distance::rod(apart).into(),
                        (Mix::Rod, 1) => Distance::rope(apart).into(),
                        (Mix::Rod, _) => within.into(),
                        (_, 0) => spring.spring_force(Fx::MIN, fx!(0)).into(),
                        (_, 1) => within.spring_force(fx!(0), Fx::MAX).into(),
                        _ => within.spring_force(fx!(-50), fx!(50)).into(),
                    };
                    return JointDef::new(a, b, kind).anchor_a(near - pa.place).anchor_b(far - pb.place);
                }
                Revolute::new().into()
            }
            Mix::Friction => {
                let max = rng.range(fx!(0.1), fx!(20));
                let linear = LinearDrive { velocity: Vec2::ZERO, max_force: max };
                Motor { linear: Some(linear), ..Motor::new() }.angular(fx!(0), max).into()
            }
            Mix::MotorSpring => {
                let spring = Motor::new().linear_spring(hertz, ratio, Fx::MAX);
                match rng.below(3) {
                    0 => spring.into(),
                    1 => spring.angular_spring(hertz, ratio, rng.range(fx!(5), fx!(100))).into(),
                    _ => spring.angular_spring(hertz, ratio, Fx::MAX).into(),
                }
            }
            Mix::Every => unreachable!("one kind was picked"),
        };
        let def = JointDef::new(a, b, kind).angle_a(frame).angle_b(frame);
        def.anchor_a(anchor - pa.place).anchor_b(anchor - pb.place)
    }

    pub(crate) fn build(&self) -> Assembly {
        let key = (self.shape as u64) << 8 | (self.mix as u64) << 4 | self.start as u64;
        let mut rng = Rng::with_stream(self.seed, key);
        let gravity = if self.start == Start::Hang { fx!(-10) } else { fx!(0) };
        let config = Config { gravity: Vec2::new(fx!(0), gravity), sleeping: false, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        let (n, links) = self.links(&mut rng);
        let plans = self.places(&mut rng, n, &links);
        let hit = rng.below(u32::try_from(n).expect("few")) as usize;
        let omega = rng.range(fx!(1), fx!(6));
        let mut bodies = Vec::new();
        for (i, plan) in plans.iter().enumerate() {
            let mass = MassSource::Given { mass: plan.mass, centre: Vec2::ZERO, gyration: plan.gyration };
            let def = BodyDef::dynamic().mass(mass).position(plan.place);
            let mut own = || Vec2::new(rng.range(fx!(-3), fx!(3)), rng.range(fx!(-3), fx!(3)));
            let (v, w) = match self.start {
                Start::Hit if i == hit => (own(), rng.range(fx!(-5), fx!(5))),
                Start::Hit | Start::Hang => (Vec2::ZERO, fx!(0)),
                Start::Spin => (plan.place.perp().map_mul(omega), omega),
                Start::Scatter => (own(), rng.range(fx!(-5), fx!(5))),
            };
            bodies.push(world.spawn(&def.velocity(v).angular_velocity(w), &[]).expect("valid"));
        }
        let mut joints = Vec::new();
        if self.start == Start::Hang {
            let wall = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
            let top = hit;
            let reach = plans[top].gyration;
            let at = plans[top].place + Vec2::new(fx!(0), reach);
            let def = JointDef::new(wall, bodies[top], Revolute::new());
            joints.push(world.add_joint(&def.anchor_a(at).anchor_b((fx!(0), reach))).expect("valid"));
        }
        for (a, b) in links {
            let def = self.joint(&mut rng, bodies[a], bodies[b], [&plans[a], &plans[b]]);
            joints.push(world.add_joint(&def).expect("valid"));
        }
        Assembly { world, bodies, joints }
    }
}

trait Scaled {
    fn scale_half(self) -> Self;
    fn map_mul(self, by: Fx) -> Self;
}

impl Scaled for Vec2<Fx> {
    fn scale_half(self) -> Self {
        Vec2::new(self.x / 2, self.y / 2)
    }
    fn map_mul(self, by: Fx) -> Self {
        Vec2::new(fx_mul(self.x, by), fx_mul(self.y, by))
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    /// Largest gain of energy in the run, as a share of the energy at the start. For [`Start::Hang`], as a share of
    /// [`Assembly::scale`].
    pub(crate) gain: f64,
    pub(crate) faults: u64,
    pub(crate) gap: f64,
    /// Change of energy from the start to the end of the run, as the same share as `gain`.
    pub(crate) left: f64,
}

impl Case {
    pub(crate) fn run(&self, ticks: u32) -> Outcome {
        let mut assembly = self.build();
        let start = assembly.energy();
        let scale = if self.start == Start::Hang { assembly.scale() } else { start };
        let (mut gain, mut gap) = (f64::MIN, 0.0f64);
        for _ in 0..ticks {
            assembly.world.step();
            gain = gain.max((assembly.energy() - start) / scale);
            gap = gap.max(assembly.gap());
        }
        let left = (assembly.energy() - start) / scale;
        Outcome { gain, faults: assembly.world.faults(), gap, left }
    }
}
