//! Solving a batch without checks gives the same bits as with checks, on every backend.

use super::super::super::batches::{BatchParts, Operation};
use super::super::super::body::SolverBody;
use super::super::super::context::{Bias, Relax};
use super::super::super::settings::SolverSettings;
use super::super::batch::Point;
use super::super::input::Input;
use super::super::rows::fill;
use super::super::store::Records;
use super::super::{Constants, Contacts, PointOrder, Solve, WarmStart};
use super::*;
use crate::fx;
use crate::math::{Fx, Length, Reciprocal, Rng, Rot, Step, Vec2, narrow};
use crate::simd::{Backend, Ints, Kernel, Machine, Quad, WIDTH};
use crate::solver::row::MassFractions;
use crate::solver::settings::Tuning;
use core::cell::Cell;
use std::vec::Vec;

/// A random contact within the bounds of unchecked contacts, or just beyond them.
fn input(rng: &mut Rng, count: u8) -> Input {
    let n = Rot::from_angle(rng.angle()).apply(Vec2::X);
    let mass = |rng: &mut Rng| if rng.below(5) == 0 { fx!(0) } else { rng.range(fx!(0.1), fx!(20)) };
    let fractions = MassFractions::of_masses(mass(rng), mass(rng));
    let gyrations = [rng.range(fx!(0.2), fx!(1)), rng.range(fx!(0.2), fx!(1))].map(Reciprocal::of);
    let [a, b] = gyrations.map(Reciprocal::parts);
    let reach = if rng.below(20) == 0 { fx!(1.5) } else { fx!(0.4) };
    let mut length = |_| {
        let length: Length = narrow(rng.range(-reach, reach));
        length.to_bits()
    };
    let (to_origin, anchors) = (core::array::from_fn(&mut length), core::array::from_fn(&mut length));
    let mut separation = || {
        let far = if rng.below(20) == 0 { fx!(0.3) } else { fx!(0.02) };
        let separation: Step = narrow(rng.range(-far, far));
        separation.to_bits()
    };
    let separations = [separation(), separation()];
    let speed = |rng: &mut Rng| number(rng, fx!(70), fx!(0.5)).abs();
    let friction = narrow::<fixed::types::extra::U20>(rng.range(fx!(0), fx!(1.2))).to_bits();
    Input {
        count,
        shares: Quad([n.x.to_bits(), n.y.to_bits(), fractions.a.to_bits(), fractions.b.to_bits()]),
        gyrations: Quad([a.0, b.0, a.1, b.1]),
        to_origin: Quad(to_origin),
        anchors: Quad(anchors),
        carried: Quad([speed(rng), speed(rng), speed(rng), 0]),
        rest: Quad([separations[0], separations[1], friction, 0]),
        ..Input::NONE
    }
}

/// A random number in the format of a speed, usually small.
fn number(rng: &mut Rng, large: Fx, small: Fx) -> i32 {
    let limit = if rng.below(200) == 0 { large } else { small };
    let speed: Speed = narrow(rng.range(-limit, limit));
    speed.to_bits()
}

struct Trial<'a> {
    inputs: &'a [Input],
    bodies: Vec<SolverBody>,
    unchecked: bool,
    constants: Constants,
    end: Option<TrialEnd>,
}

#[derive(Debug, PartialEq)]
struct TrialEnd {
    numbers: Vec<i32>,
    pushed: [u32; 2],
    faults: Faults,
    unchecked: bool,
}

struct Applied<'a> {
    batch: Batch<WIDTH>,
    record: Records<WIDTH>,
    cells: &'a [Cell<SolverBody>],
    faults: Faults,
}

impl Applied<'_> {
    #[inline(always)]
    fn apply<L: Lanes<WIDTH>>(&mut self, operation: impl Operation<Contacts>) {
        let Applied { batch, record, cells, faults } = self;
        operation.apply::<L, WIDTH>(BatchParts { batch, record, extra: None, bodies: cells, faults });
    }
}

impl Kernel<WIDTH> for &mut Trial<'_> {
    #[inline(always)]
    fn run<L: Lanes<WIDTH>>(self) {
        let count = usize::from(self.inputs[0].count);
        let mut batch = Batch::<WIDTH> { count, ..Batch::NONE };
        let mut record = Records::NONE;
        let inputs = core::array::from_fn(|lane| self.inputs[lane]);
        fill::<L, WIDTH>(&inputs, &mut batch, &mut record.denominators);
        for lane in 0..WIDTH {
            let index = u32::try_from(lane).expect("few lanes");
            (batch.bodies[0][lane], batch.bodies[1][lane]) = (1 + 2 * index, 2 + 2 * index);
        }
        batch.changed = batch.bodies;
        batch.unchecked = self.unchecked && Unchecked::<L, WIDTH>::suits(&batch, None);
        let (faults, cells) = (0, SolverBody::cells(&mut self.bodies));
        let constants = self.constants;
        let mut applied = Applied { batch, record, cells, faults };
        applied.apply::<L>(WarmStart);
        applied.apply::<L>(Solve { pass: Bias, order: PointOrder::Forward, constants });
        applied.apply::<L>(Solve { pass: Relax, order: PointOrder::Backward, constants });
        applied.apply::<L>(Solve { pass: Bias, order: PointOrder::Backward, constants });
        let Applied { batch, faults, .. } = applied;
        let mut numbers = Vec::new();
        let mut take = |ints: &Ints<WIDTH>| numbers.extend_from_slice(&ints.0);
        for Point { normal_lambda, separation, .. } in &batch.points[..count] {
            take(normal_lambda);
            take(separation);
        }
        take(&batch.tangent_lambda);
        for body in cells.iter().map(Cell::get) {
            numbers.extend([body.velocity.x, body.velocity.y, body.spin].map(Speed::to_bits));
        }
        self.end = Some(TrialEnd { numbers, pushed: batch.pushed, faults, unchecked: batch.unchecked });
    }
}

#[test]
fn unchecked_contacts_end_as_checked_ones() {
    let mut rng = Rng::new(29);
    let tuning = Tuning::new(&SolverSettings::default(), Vec2::ZERO, 60);
    let constants = Constants::new(&tuning);
    let (mut unchecked, mut wild) = (0, 0);
    for round in 0..8000 {
        let count = 1 + u8::from(round % 3 != 0);
        let inputs: Vec<Input> = (0..WIDTH).map(|_| input(&mut rng, count)).collect();
        let bodies: Vec<SolverBody> = (0..=2 * WIDTH)
            .map(|_| {
                let mut body = SolverBody::default();
                let mut speed = || number(&mut rng, fx!(100), fx!(3));
                body.set_motion(speed(), speed(), speed());
                let mut shift = || number(&mut rng, fx!(80), fx!(1));
                body.set_shift(shift(), shift(), shift());
                body
            })
            .collect();
        for backend in Backend::available() {
            let machine = Machine::new(backend).expect("available");
            let run = |unchecked: bool| {
                let mut trial =
                    Trial { inputs: &inputs, bodies: bodies.clone(), unchecked, constants, end: None };
                machine.run_wide(&mut trial);
                trial.end.expect("run")
            };
            let (fast, checked) = (run(true), run(false));
            (unchecked, wild) = (unchecked + u32::from(fast.unchecked), wild + u32::from(!fast.unchecked));
            assert_eq!(TrialEnd { unchecked: false, ..fast }, checked, "{backend:?}: {inputs:?} {bodies:?}");
        }
    }
    assert!(unchecked > 2000 && wild > 2000, "{unchecked} trials were within the bounds and {wild} were not");
}

/// Impulses `d` that are applied to a row. At first, all velocity components equal `start`.
struct Applying {
    row: Row<WIDTH>,
    d: Ints<WIDTH>,
    start: i32,
    end: [Ints<WIDTH>; 6],
}

impl Kernel<WIDTH> for &mut Applying {
    #[inline(always)]
    fn run<L: Lanes<WIDTH>>(self) {
        let start = || L::splat(self.start);
        let body = || VelocityW { x: start(), y: start(), turn: start() };
        let (mut pair, mut faults) = (BodyPairW::<L, WIDTH> { a: body(), b: body() }, 0);
        Saturating::<L, WIDTH>::new(&mut faults).apply(&mut pair, &self.row, L::load(&self.d));
        let BodyPairW { a, b } = pair;
        for (end, speed) in self.end.iter_mut().zip([a.x, a.y, a.turn, b.x, b.y, b.turn]) {
            L::store(speed, end);
        }
    }
}

/// Whether `apply` takes one step or several depends on the impulses in all lanes. The result in a lane must depend
/// only on its own impulse.
#[test]
fn an_impulse_changes_velocities_alike_beside_any_other() {
    let mut rng = Rng::new(31);
    for round in 0..300 {
        let mut gains = || {
            Ints(core::array::from_fn(|_| {
                // With equal masses, a gain is exactly one half.
                let half = 1 << 29;
                [half, -half, (rng.next_u32() >> 2).cast_signed() - half][rng.below(3) as usize]
            }))
        };
        let (a, b) = ([(); 3].map(|()| gains()), [(); 3].map(|()| gains()));
        let row = Row { a, b, ..Row::NONE };
        let start = [0, Speed::lit("300").to_bits(), Speed::lit("-300").to_bits()][round % 3];
        for first in [-HALF, 1 - HALF, HALF - 1, -1, 1, 12_345_678 - HALF] {
            for backend in Backend::available() {
                let end = |second: i32| {
                    let d = Ints(core::array::from_fn(|lane| if lane == 0 { first } else { second }));
                    let mut applying = Applying { row: row.clone(), d, start, end: [Ints::ZERO; 6] };
                    Machine::new(backend).expect("available").run_wide(&mut applying);
                    applying.end.map(|speeds| speeds.0[0])
                };
                for second in [HALF, -HALF - 1, i32::MIN, i32::MAX] {
                    assert_eq!(end(second), end(0), "{backend:?}: {first} beside {second}");
                }
            }
        }
    }
}
