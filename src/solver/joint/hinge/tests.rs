//! Batches of hinges give the same bits on every backend as single hinges, and nearly the same numbers as the scalar
//! point block.

use std::vec;
use std::vec::Vec;

use super::super::super::batches::Batches;
use super::super::super::body::SolverBody;
use super::super::super::body_list::GROUND;
use super::super::super::context::{Bias, Relax};
use super::super::super::limits::Faults;
use super::super::super::point_block::PointBlock;
use super::super::super::row::{Lever, MassFractions, Row};
use super::super::super::settings::{SolverSettings, Tuning};
use super::super::super::softness::Softness;
use super::angle_input::{DriveInput, LimitInput, SpringInput};
use super::input::ratios;
use super::refresh::{FACTOR, gap_factors};
use super::*;
use crate::fx;
use crate::math::{Angle, Fx, Length, Reciprocal, Rng, Rot, Shift, Speed, Unit, Vec2, narrow};
use crate::simd::{Backend, Machine, with_data};

/// Eight hinges in random poses, each between two bodies of its own.
#[derive(Clone)]
struct Setting {
    hinges: HingeSet,
    part: HingeShare,
    bodies: Vec<SolverBody>,
    quads: Vec<Quad>,
    body_rotations: Vec<BodyRotation>,
    ends: Vec<[Lever; 2]>,
    fractions: Vec<MassFractions>,
}

#[derive(Clone, Copy)]
struct Sizes {
    /// Largest length of an arm, in radii of gyration.
    arm: Fx,
    /// Largest component of a velocity or an impulse, in m/s.
    speed: Fx,
    /// Largest component of a gap, in metres.
    gap: Fx,
}

/// Sizes that occur in games.
const COMMON: Sizes = Sizes { arm: fx!(16), speed: fx!(10), gap: fx!(0.1) };
/// Sizes so large that some results are clamped.
const EXTREME: Sizes = Sizes { arm: fx!(500), speed: fx!(511), gap: fx!(2000) };

/// Settings in which anchored hinges are as stiff as other hinges, so that batches can be compared with single hinges.
fn tuning() -> Tuning {
    let tuning = Tuning::new(&SolverSettings::default(), Vec2::new(fx!(0), fx!(-10)), 60);
    Tuning { anchored: tuning.joint, ..tuning }
}

fn random_speed(rng: &mut Rng, size: Fx) -> Speed {
    narrow(rng.range(-size, size))
}

fn random_fractions(rng: &mut Rng) -> MassFractions {
    let a = match rng.below(4) {
        0 => Unit::ZERO,
        1 => Unit::from_bits(1 << rng.below(30)),
        _ => narrow(rng.range(fx!(0), fx!(1))),
    };
    MassFractions { a, b: Unit::ONE - a }
}

impl Setting {
    fn random(rng: &mut Rng, sizes: Sizes) -> Self {
        let mut setting = Setting {
            hinges: HingeSet::default(),
            part: HingeShare::default(),
            bodies: vec![SolverBody::default()],
            quads: vec![Quad::default()],
            body_rotations: vec![BodyRotation::default()],
            ends: Vec::new(),
            fractions: Vec::new(),
        };
        (0..8).for_each(|slot| setting.add(slot, rng, sizes));
        setting
    }

    fn add(&mut self, slot: u32, rng: &mut Rng, sizes: Sizes) {
        let fractions = random_fractions(rng);
        let mut locals: Vec<Vec2<Length>> = Vec::new();
        let (mut ends, mut gyrations) = (Vec::new(), Vec::new());
        for _ in 0..2 {
            let gyration = rng.range(fx!(0.05), fx!(5));
            let reach = crate::math::fx_mul(gyration, rng.range(fx!(0), sizes.arm)).min(fx!(290));
            let local = Rot::from_angle(rng.angle()).apply_wide(Vec2::new(reach, Fx::ZERO)).narrow();
            let rotation = Rot::from_angle(rng.angle());
            gyrations.push(gyration);
            ends.push(Lever { arm: rotation.apply(local), inverse_gyration: Reciprocal::of(gyration) });
            locals.push(local);
            let shift = || Vec2::<Shift>::ZERO;
            self.bodies.push(SolverBody {
                velocity: Vec2::new(random_speed(rng, sizes.speed), random_speed(rng, sizes.speed)),
                spin: random_speed(rng, sizes.speed),
                shift: shift(),
                ..SolverBody::default()
            });
            let ahead = [rng.range(fx!(-0.2), fx!(0.2)), rng.range(fx!(0), fx!(0.02))];
            let [across, along] = ahead.map(|part| narrow::<fixed::types::extra::U30>(part).to_bits());
            self.quads.push(Quad([rotation.cos.to_bits(), rotation.sin.to_bits(), across, along]));
            self.body_rotations.push(BodyRotation {
                rotation,
                turns: i64::from(rng.next_u32()) - (1 << 31),
                ..BodyRotation::default()
            });
        }
        let gap = Vec2::new(rng.range(-sizes.gap, sizes.gap), rng.range(-sizes.gap, sizes.gap));
        let bodies = [2 * slot + 1, 2 * slot + 2];
        let gap_factors = gap_factors([ends[0].inverse_gyration, ends[1].inverse_gyration], fractions);
        let angle = if rng.below(2) == 0 {
            self.hinges.angles.push(angle_input(rng, [ends[0], ends[1]], fractions));
            Some(u32::try_from(self.hinges.angles.len()).unwrap() - 1)
        } else {
            None
        };
        self.hinges.inputs.push(Input {
            slot,
            bodies,
            changed: [(fractions.a, bodies[0]), (fractions.b, bodies[1])]
                .map(|(fraction, body)| if fraction == 0 { GROUND } else { body }),
            angle,
            arms: [locals[0], locals[1]],
            ratios: [0, 1].map(|side| ratios(locals[side], ends[side].inverse_gyration)),
            gap_factors,
            fractions,
            between: ends[0].arm.widen() - ends[1].arm.widen() + gap,
            turns: i64::from(rng.next_u32()) - (1 << 31),
            rest: Angle::ZERO,
            lambda: [random_speed(rng, sizes.speed).to_bits(), random_speed(rng, sizes.speed).to_bits()],
            softness: Softness::RIGID,
            is_tuned: false,
        });
        // The oracle has arms that end in the gap. The batch extends lever ratios by a rounded factor instead, so each
        // arm is extended by the gap times `k` times this factor.
        for ((end, gyration), factor) in ends.iter_mut().zip(gyrations).zip(gap_factors) {
            let share = crate::math::fx_mul(Fx::from_bits(i64::from(factor) << (32 - FACTOR)), gyration);
            let reach = Vec2::new(crate::math::fx_mul(gap.x, share), crate::math::fx_mul(gap.y, share));
            end.arm += reach.narrow();
        }
        self.ends.push([ends[0], ends[1]]);
        self.fractions.push(fractions);
    }

    /// Solves two sub-steps. Returns the faults.
    fn solve(&mut self, machine: Machine) -> Faults {
        let (tuning, mut faults) = (tuning(), 0);
        let Setting { hinges, part, bodies, quads, body_rotations, .. } = self;
        let poses = Poses { quads, body_rotations };
        let context = StepContext::new(machine, &tuning, bodies, &mut faults);
        for _ in 0..2 {
            hinges.expire();
            part.expire();
            hinges.warm_start(poses, &context);
            part.warm_start(poses, &context);
            hinges.solve(Bias, poses, &context);
            part.solve(Bias, poses, &context);
            hinges.solve(Relax, poses, &context);
            part.solve(Relax, poses, &context);
        }
        faults
    }

    /// Solves one relax pass. Returns the faults.
    fn relax(&mut self) -> Faults {
        let (tuning, mut faults) = (tuning(), 0);
        let Setting { hinges, part, bodies, quads, body_rotations, .. } = self;
        let context = StepContext::new(Machine::default(), &tuning, bodies, &mut faults);
        let poses = Poses { quads, body_rotations };
        hinges.solve(Relax, poses, &context);
        part.solve(Relax, poses, &context);
        faults
    }

    /// Impulses in the order of the slots.
    fn impulses(&self) -> Vec<(u32, Vec<i32>)> {
        let mut all = Vec::new();
        self.hinges.overflow.collect(&mut all);
        with_data!(&self.part.ordinary, batches => batches.collect(&mut all));
        with_data!(&self.part.anchored, batches => batches.collect(&mut all));
        all.sort();
        all
    }
}

impl<const N: usize> Batches<Hinges, N> {
    fn collect(&self, all: &mut Vec<(u32, Vec<i32>)>) {
        let mut extras = self.extras.iter();
        for (batch, records) in self.batches.iter().zip(&self.records) {
            let rows = if batch.has_angle { extras.next() } else { None };
            for lane in 0..records.len {
                let mut impulses: Vec<i32> = batch.lambda.iter().map(|lambda| lambda.0[lane]).collect();
                if let Some(rows) = rows {
                    impulses.extend(rows.impulses(lane).map(Speed::to_bits));
                }
                all.push((records.slots[lane], impulses));
            }
        }
    }
}

fn angle_input(rng: &mut Rng, [a, b]: [Lever; 2], fractions: MassFractions) -> AngleInput {
    let (row, _, _) = Row::angular(a.inverse_gyration, b.inverse_gyration, fractions);
    let (e, f) = row.turning_parts();
    let mut turns = || i64::from(rng.next_u32()) - (1 << 31);
    let (target, lower, upper) = (turns(), turns(), turns());
    let mut rate = || rng.range(fx!(0), fx!(300));
    let (stiffness, closed, open) = (rate(), rate(), rate());
    let mut lambda = || random_speed(rng, fx!(100));
    let [first, second, third, fourth] = [lambda(), lambda(), lambda(), lambda()];
    let scale: Unit = narrow(rng.range(fx!(0), fx!(1)));
    let (held, max) = (rng.below(2) == 0, Speed::lit("511"));
    let spring = SpringInput {
        mass_scale: scale,
        impulse_scale: Unit::ONE - scale,
        target,
        stiffness,
        max,
        held,
        lambda: first,
    };
    let drive = DriveInput { bias: second, max: narrow(rng.range(fx!(0), fx!(100))), lambda: second };
    let limit = LimitInput { lower, upper, closed, open, max, lambda: [third.abs(), fourth.abs()] };
    let has = |part: u32| rng.next_u32() & part != 0;
    let [has_spring, has_drive, has_limit] = [1, 2, 4].map(has);
    AngleInput {
        e,
        f,
        spring: has_spring.then_some(spring),
        drive: has_drive.then_some(drive),
        limit: has_limit.then_some(limit),
    }
}

#[test]
fn every_machine_solves_as_one_hinge_at_a_time() {
    let mut rng = Rng::new(1);
    let mut faulty = 0;
    for i in 0..4000 {
        let setting = Setting::random(&mut rng, if i % 2 == 0 { COMMON } else { EXTREME });
        let order = [0, 1, 2, 3, 4, 5, 6, 7];
        let mut alone = setting.clone();
        alone.hinges.push_overflow(order.into_iter());
        let faults = alone.solve(Machine::default());
        faulty += u32::from(faults > 0);
        assert!(alone.bodies.iter().all(|body| body.velocity.x.abs() <= 511 && body.spin.abs() <= 511));
        for backend in Backend::available() {
            let machine = Machine::new(backend).expect("available");
            let mut wide = setting.clone();
            wide.part.fit(machine);
            wide.hinges.push_colour(&mut wide.part, order.into_iter(), |body| body % 3 == 0);
            assert_eq!(wide.solve(machine), faults);
            assert_eq!(wide.impulses(), alone.impulses());
            for (wide, alone) in wide.bodies.iter().zip(&alone.bodies) {
                assert_eq!((wide.velocity, wide.spin), (alone.velocity, alone.spin));
            }
        }
    }
    assert!(faulty > 100, "{faulty} settings reach the clamps");
}

/// The scalar block rotates the arm before it computes a lever ratio, whereas the batch rotates the ratio. Both ratios
/// therefore differ by about 2^-24. The arms are at most 16 radii of gyration long, so the anchors approach at less
/// than 350 m/s. Velocities may differ by 256 units (1.2e-4 m/s). A second iteration may still change impulses by 128
/// units (6.1e-5 m/s).
#[test]
fn a_point_is_solved_as_by_the_scalar_block() {
    let mut rng = Rng::new(2);
    let (mut worst, mut left) = (0, 0);
    for _ in 0..2000 {
        let mut setting = Setting::random(&mut rng, COMMON);
        for input in &mut setting.hinges.inputs {
            (input.angle, input.lambda) = (None, [0; 2]);
        }
        let before = setting.bodies.clone();
        setting.hinges.push_colour(&mut setting.part, 0..8, |_| false);
        setting.part.expire();
        let mut faults = setting.relax();
        let Setting { bodies, ends, fractions, .. } = &setting;
        for (i, (&[a, b], &fractions)) in ends.iter().zip(fractions.iter()).enumerate() {
            let block = PointBlock::new(a, b, fractions, Unit::ONE);
            let (mut a, mut b) = (before[2 * i + 1], before[2 * i + 2]);
            let (ratios, mut lambda) = (block.ratios(), Vec2::ZERO);
            block.solve(&mut a, &mut b, ratios, Vec2::ZERO, &Softness::RIGID, &mut lambda, &mut faults);
            for (wide, scalar) in [(&bodies[2 * i + 1], a), (&bodies[2 * i + 2], b)] {
                let apart = wide.velocity - scalar.velocity;
                let apart = [apart.x, apart.y, wide.spin - scalar.spin].map(|part| part.to_bits().abs());
                worst = apart.into_iter().fold(worst, i32::max);
            }
        }
        let first: Vec<_> = setting.impulses();
        faults += setting.relax();
        for ((_, first), (_, second)) in first.iter().zip(setting.impulses()) {
            let moved = first.iter().zip(second).map(|(first, second)| (second - first).abs());
            left = moved.fold(left, i32::max);
        }
        assert_eq!(faults, 0);
    }
    assert!(left <= 128, "{left} units left");
    assert!(worst <= 256, "{worst} units apart");
}
