//! Integrating several bodies at a time gives the same bits as integrating them one by one.

use std::vec::Vec;

use super::super::settings::SolverSettings;
use super::*;
use crate::fx;
use crate::math::Rng;
use crate::simd::{Backend, Machine};

fn random_speed(rng: &mut Rng, size: Fx) -> Speed {
    narrow(rng.range(-size, size))
}

/// A body that is usually dynamic and without locked axes.
fn random_mover(index: u32, rng: &mut Rng) -> MovingBody {
    let one_in = |rng: &mut Rng, count| rng.below(count) == 0;
    let step = [0; 3].map(|_| random_speed(rng, fx!(1)).to_bits());
    let mut factor = || match rng.below(4) {
        0 => rng.next_u32() >> 2,
        _ => 1 << 30,
    };
    let factors = [factor(), factor()].map(|factor| i32::try_from(factor).expect("at most 1"));
    let dynamic = !one_in(rng, 40);
    let locks = MotionLocks { x: one_in(rng, 40), y: one_in(rng, 40), rotation: false };
    let extras = -i32::from(!dynamic || locks.x || locks.y);
    MovingBody {
        step: Quad([step[0], step[1], step[2], 0]),
        factors: Quad([factors[0], factors[1], extras, 0]),
        index,
        dynamic,
        locks,
    }
}

fn random_body(rng: &mut Rng) -> SolverBody {
    // Some bodies are near the limits.
    let (fast, far) = match rng.below(40) {
        0 => (fx!(511), fx!(15.999)),
        1 => (fx!(400), fx!(15.9)),
        2 => (fx!(280), fx!(15)),
        _ => (fx!(50), fx!(1)),
    };
    let mut speed = || random_speed(rng, fast);
    let (velocity, spin) = (Vec2::new(speed(), speed()), speed());
    let mut shift = || narrow(rng.range(-far, far));
    SolverBody { velocity, spin, shift: Vec2::new(shift(), shift()), turn: shift(), ..SolverBody::default() }
}

#[test]
fn every_machine_integrates_as_one_body_at_a_time() {
    let mut rng = Rng::new(1);
    let (mut unusual, mut all_faults) = (0, 0);
    for round in 0..4000 {
        let settings = SolverSettings { sub_steps: [1, 4, 16][round % 3], ..SolverSettings::default() };
        let tuning = Tuning::new(&settings, Vec2::ZERO, [60, 75, 250][round / 3 % 3]);
        let count = 1 + rng.below(20);
        let moving: Vec<_> = (1..=count).map(|index| random_mover(index, &mut rng)).collect();
        unusual += moving.iter().filter(|moving| moving.has_extras()).count();
        let bodies: Vec<_> = (0..=count).map(|_| random_body(&mut rng)).collect();
        let (mut alone, mut faults) = (bodies.clone(), 0);
        for moving in &moving {
            let body = &mut alone[moving.index as usize];
            moving.integrate_velocity(body, tuning.speed_max);
            moving.integrate_displacement(body, SubStep::of(tuning.rate), &mut faults);
        }
        all_faults += faults;
        let numbers = |body: &SolverBody| (body.velocity, body.spin, body.shift, body.turn);
        for backend in Backend::available() {
            let machine = Machine::new(backend).expect("available");
            let (mut wide, mut wide_faults) = (bodies.clone(), 0);
            let context = StepContext::new(machine, &tuning, &mut wide, &mut wide_faults);
            integrate_velocities(&moving, &context);
            integrate_displacements(&moving, &context);
            assert_eq!(wide_faults, faults);
            assert!(wide.iter().map(numbers).eq(alone.iter().map(numbers)), "{backend:?}: {moving:?}");
        }
    }
    assert!(unusual > 1000 && all_faults > 100, "{unusual} special bodies, {all_faults} faults");
}

#[test]
fn a_damped_speed_is_rounded_towards_rest_in_lanes_too() {
    let tuning = Tuning::new(&SolverSettings::default(), Vec2::ZERO, 60);
    let factors = [0, 1, 1 << 29, (1 << 30) - 1, 1 << 30];
    for (factor, speed) in factors.into_iter().flat_map(|factor| (-9..10).map(move |speed| (factor, speed))) {
        let moving = |index| MovingBody {
            step: Quad::default(),
            factors: Quad([factor, factor, 0, 0]),
            index,
            dynamic: true,
            locks: MotionLocks::default(),
        };
        let moving: Vec<_> = (1..=8).map(moving).collect();
        let speed = Speed::from_bits(speed);
        let body = SolverBody { velocity: Vec2::new(speed, -speed), spin: speed, ..SolverBody::default() };
        let mut bodies = [body; 9];
        let mut faults = 0;
        let context = StepContext::new(Machine::default(), &tuning, &mut bodies, &mut faults);
        integrate_velocities(&moving, &context);
        let expected = towards_rest(speed, Unit::from_bits(factor));
        let found = bodies.last().expect("nine");
        assert_eq!((found.velocity, found.spin), (Vec2::new(expected, -expected), expected));
    }
}
