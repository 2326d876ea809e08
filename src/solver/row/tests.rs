use super::super::limits::SPEED_MAX;
use super::*;
use crate::fx;
use crate::math::{Fx, Rng, Rot, mul, narrow};
use crate::solver::body_pair::Remainders;
use crate::solver::softness::Softness;

impl Row {
    /// Solves the row for one iteration. Returns the change `d`.
    #[expect(clippy::too_many_arguments, reason = "the quantities of the equation above, all 32-bit numbers")]
    pub(crate) fn solve(
        &self,
        a: &mut SolverBody,
        b: &mut SolverBody,
        bias: Speed,
        softness: &Softness,
        bounds: (Speed, Speed),
        lambda: &mut Speed,
        faults: &mut Faults,
    ) -> Speed {
        let vn = self.velocity(a, b, faults);
        let bodies = &mut BodyPair { a, b, remainders: &mut Remainders::default(), faults };
        self.accumulate(softness.wanted(vn, bias, *lambda), bounds, lambda, bodies)
    }
}

fn random_speed(rng: &mut Rng, limit: Fx) -> Speed {
    narrow(rng.range(-limit, limit))
}

fn random_body(rng: &mut Rng) -> SolverBody {
    let limit = fx!(20);
    let velocity = Vec2::new(random_speed(rng, limit), random_speed(rng, limit));
    SolverBody { velocity, spin: random_speed(rng, limit), ..SolverBody::default() }
}

/// An arm of up to 2.8 radii of gyration, as convex shapes have.
fn random_lever(rng: &mut Rng) -> Lever {
    let gyration = rng.range(fx!(0.01), fx!(40));
    let reach = crate::math::fx_mul(gyration, rng.range(fx!(0), fx!(2.8)));
    let arm = Rot::from_angle(rng.angle()).apply_wide(Vec2::new(reach, Fx::ZERO)).narrow();
    Lever { arm, inverse_gyration: Reciprocal::of(gyration) }
}

/// Mass ratios from 1:1 to 1:2^30, or a body that no impulse moves.
fn random_fractions(rng: &mut Rng) -> MassFractions {
    let a = match rng.below(4) {
        0 => Unit::ONE,
        1 => Unit::ZERO,
        2 => narrow(rng.range(fx!(0), fx!(1))),
        _ => Unit::from_bits(1 << rng.below(30)),
    };
    MassFractions { a, b: Unit::ONE - a }
}

/// One update leaves a relative velocity of at most 5 units of [`Speed`], 2.4e-6 m/s.
#[test]
fn an_update_removes_the_relative_velocity() {
    let mut rng = Rng::new(4);
    let (mut faults, mut worst) = (0, 0);
    for _ in 0..100_000 {
        let n = Vec2::new(rng.range(fx!(-1), fx!(1)), rng.range(fx!(-1), fx!(1)));
        let Some(n) = n.normalized() else { continue };
        let (a, b) = (random_lever(&mut rng), random_lever(&mut rng));
        let (row, _) = Row::prepare(n, a, b, random_fractions(&mut rng));
        let (mut a, mut b) = (random_body(&mut rng), random_body(&mut rng));
        let bounds = (-IMPULSE_MAX, IMPULSE_MAX);
        let mut lambda = Speed::ZERO;
        row.solve(&mut a, &mut b, Speed::ZERO, &Softness::RIGID, bounds, &mut lambda, &mut faults);
        worst = worst.max(row.velocity(&a, &b, &mut faults).to_bits().abs());
    }
    assert_eq!(faults, 0);
    assert!(worst <= 5, "{worst} units left");
}

/// `MA dvA = -MB dvB` for masses `M`, so `aB dvA = -aA dvB`.
#[test]
fn an_update_keeps_momentum() {
    let mut rng = Rng::new(5);
    for _ in 0..20_000 {
        let (a, b) = (random_lever(&mut rng), random_lever(&mut rng));
        let fractions = random_fractions(&mut rng);
        let (row, _) = Row::prepare(Vec2::X, a, b, fractions);
        let (mut a, mut b) = (SolverBody::default(), SolverBody::default());
        let (remainders, faults) = (&mut Remainders::default(), &mut 0);
        let bodies = &mut BodyPair { a: &mut a, b: &mut b, remainders, faults };
        row.apply(random_speed(&mut rng, fx!(100)), bodies);
        let (left, right): (Speed, Speed) = (mul(fractions.b, a.velocity.x), mul(fractions.a, b.velocity.x));
        assert!((left + right).to_bits().abs() <= 2, "{left} and {right}");
    }
}

#[test]
fn extreme_systems_stay_in_range_and_are_counted() {
    let mut rng = Rng::new(6);
    let mut counted = 0;
    for _ in 0..100_000 {
        let n = Rot::from_angle(rng.angle()).apply(Vec2::X);
        let extreme = |rng: &mut Rng| {
            let mut any = || random_speed(rng, SPEED_MAX.into());
            SolverBody { velocity: Vec2::new(any(), any()), spin: any(), ..SolverBody::default() }
        };
        let long = |rng: &mut Rng| {
            let arm = Vec2::new(rng.range(fx!(-500), fx!(500)), rng.range(fx!(-500), fx!(500))).narrow();
            Lever { arm, inverse_gyration: Reciprocal::of(rng.range(fx!(0.002), fx!(10))) }
        };
        let (a, b) = (long(&mut rng), long(&mut rng));
        let (row, _) = Row::prepare(n, a, b, random_fractions(&mut rng));
        let (mut a, mut b) = (extreme(&mut rng), extreme(&mut rng));
        let bias = random_speed(&mut rng, fx!(1000));
        let mut lambda = random_speed(&mut rng, fx!(1000));
        let bounds = (Speed::ZERO, random_speed(&mut rng, fx!(1000)).abs());
        let mut faults = 0;
        row.solve(&mut a, &mut b, bias, &Softness::RIGID, bounds, &mut lambda, &mut faults);
        for speed in [a.velocity.x, a.velocity.y, a.spin, b.velocity.x, b.velocity.y, b.spin] {
            assert!(speed.abs() <= SPEED_MAX, "{speed}");
        }
        counted += u32::from(faults > 0);
    }
    assert!(counted > 1000, "only {counted} of these were extreme");
}
