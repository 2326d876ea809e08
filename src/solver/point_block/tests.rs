use super::*;
use crate::fx;
use crate::math::{Fx, Reciprocal, Rng, Rot, narrow};
use crate::solver::body_pair::Remainders;

impl PointBlock {
    /// Solves a rigid block for one iteration. Velocities are measured with the given lever ratios.
    #[expect(clippy::too_many_arguments, reason = "the quantities of the equations above")]
    pub(crate) fn solve(
        &self,
        a: &mut SolverBody,
        b: &mut SolverBody,
        ratios: (Vec2<Ratio>, Vec2<Ratio>),
        bias: Vec2<Speed>,
        softness: &Softness,
        lambda: &mut Vec2<Speed>,
        faults: &mut Faults,
    ) {
        let vr = self.velocity(a, b, ratios, faults);
        let d_x = softness.impulse(vr.x, bias.x, lambda.x, faults);
        let d_y = softness.impulse(vr.y, bias.y, lambda.y, faults);
        let next = Vec2::new(accumulate(lambda.x, d_x, faults), accumulate(lambda.y, d_y, faults));
        let d = next - *lambda;
        *lambda = next;
        self.apply(d, &mut BodyPair { a, b, remainders: &mut Remainders::default(), faults });
    }
}

/// `clamp(L + d, -1023, 1023)`.
fn accumulate(lambda: Speed, d: Speed, faults: &mut Faults) -> Speed {
    let limit = i64::from(IMPULSE_MAX.to_bits());
    let wanted = i64::from(lambda.to_bits()) + i64::from(d.to_bits());
    let within = wanted.clamp(-limit, limit);
    *faults += u64::from(within != wanted);
    Speed::from_bits(saturate(within))
}

/// One update brings the anchors to rest relative to each other: a second update changes `L` by at most 128 units,
/// 6.1e-5 m/s.
#[test]
fn an_update_brings_the_anchors_to_rest() {
    let mut rng = Rng::new(8);
    let (mut faults, mut worst) = (0, 0);
    for _ in 0..100_000 {
        let mut arm = || {
            let gyration = rng.range(fx!(0.05), fx!(10));
            let reach = crate::math::fx_mul(gyration, rng.range(fx!(0), fx!(16)));
            let arm = Rot::from_angle(rng.angle()).apply_wide(Vec2::new(reach, Fx::ZERO)).narrow();
            Lever { arm, inverse_gyration: Reciprocal::of(gyration) }
        };
        let (a, b) = (arm(), arm());
        let share: Unit = narrow(rng.range(fx!(0), fx!(1)));
        let fractions = match rng.below(3) {
            0 => MassFractions { a: Unit::ZERO, b: Unit::ONE },
            _ => MassFractions { a: share, b: Unit::ONE - share },
        };
        let block = PointBlock::new(a, b, fractions, Unit::ONE);
        let mut body = || {
            let mut speed = || narrow(rng.range(fx!(-10), fx!(10)));
            SolverBody { velocity: Vec2::new(speed(), speed()), spin: speed(), ..SolverBody::default() }
        };
        let (mut a, mut b) = (body(), body());
        let (mut lambda, mut before) = (Vec2::ZERO, Vec2::ZERO);
        // The second update removes the rounding errors of the first.
        for _ in 0..2 {
            before = lambda;
            let (ratios, no_bias) = (block.ratios(), Vec2::ZERO);
            block.solve(&mut a, &mut b, ratios, no_bias, &Softness::RIGID, &mut lambda, &mut faults);
        }
        let left = lambda - before;
        worst = worst.max(left.x.to_bits().abs()).max(left.y.to_bits().abs());
    }
    assert_eq!(faults, 0);
    assert!(worst <= 128, "{worst} units left");
}

/// The impulse on bodies that start at rest is at most `most`, except for rounding.
#[test]
fn an_impulse_of_limited_length_is_no_longer() {
    let mut rng = Rng::new(9);
    let mut faults = 0;
    for _ in 0..20_000 {
        let mut lever = || {
            let mut side = || rng.range(fx!(-3), fx!(3));
            let arm = Vec2::new(side(), side()).narrow();
            Lever { arm, inverse_gyration: Reciprocal::of(rng.range(fx!(0.3), fx!(3))) }
        };
        let (a, b) = (lever(), lever());
        let share: Unit = narrow(rng.range(fx!(0), fx!(0.9)));
        let block = PointBlock::new(a, b, MassFractions { a: share, b: Unit::ONE - share }, Unit::ONE);
        let mut speed = |most: Fx| -> Speed { narrow(rng.range(Fx::ZERO, most)) };
        let bias = Vec2::new(speed(fx!(20)), -speed(fx!(20)));
        let most = speed(fx!(3));
        let (mut a, mut b) = (SolverBody::default(), SolverBody::default());
        let (mut lambda, remainders) = (Vec2::ZERO, &mut Remainders::default());
        for _ in 0..3 {
            let goal = PointGoal { bias, push: [0; 2] };
            let bodies = &mut BodyPair { a: &mut a, b: &mut b, remainders, faults: &mut faults };
            block.solve_within(bodies, goal, &Softness::RIGID, most, &mut lambda);
        }
        // `p` is the change of `vB - vA`.
        let p = (b.velocity - a.velocity).widen().length();
        assert!(p <= Fx::from(most) + fx!(0.00001), "{p} of {most}");
    }
    assert_eq!(faults, 0);
}

/// A solved soft block satisfies `impulseScale p = -massScale v - push` along both axes, however long the arms are.
#[test]
fn a_soft_block_is_an_isotropic_spring() {
    let mut rng = Rng::new(10);
    let (mut faults, mut worst) = (0, Fx::ZERO);
    for _ in 0..20_000 {
        let mut lever = || {
            let gyration = rng.range(fx!(0.05), fx!(2));
            let reach = crate::math::fx_mul(gyration, rng.range(fx!(0), fx!(16)));
            let arm = Rot::from_angle(rng.angle()).apply_wide(Vec2::new(reach, Fx::ZERO)).narrow();
            Lever { arm, inverse_gyration: Reciprocal::of(gyration) }
        };
        let (a, b) = (lever(), lever());
        let share: Unit = narrow(rng.range(fx!(0), fx!(1)));
        let fractions = match rng.below(3) {
            0 => MassFractions { a: Unit::ZERO, b: Unit::ONE },
            _ => MassFractions { a: share, b: Unit::ONE - share },
        };
        let softness = Softness::spring(rng.range(fx!(0.1), fx!(20)), rng.range(fx!(0), fx!(2)), 240);
        let block = PointBlock::new(a, b, fractions, softness.mass_scale);
        let mut speed = || narrow(rng.range(fx!(-5), fx!(5)));
        let mut body =
            || SolverBody { velocity: Vec2::new(speed(), speed()), spin: speed(), ..SolverBody::default() };
        let (mut a, mut b) = (body(), body());
        let push = Vec2::new(speed(), speed());
        let start = b.velocity - a.velocity;
        let (mut lambda, remainders) = (Vec2::ZERO, &mut Remainders::default());
        let bodies = &mut BodyPair { a: &mut a, b: &mut b, remainders, faults: &mut faults };
        // The second update starts with the impulse of the first, and changes it only by rounding errors.
        for _ in 0..2 {
            let goal = PointGoal { bias: Vec2::ZERO, push: units_of(push) };
            block.solve_within(bodies, goal, &softness, Speed::MAX, &mut lambda);
        }
        let p = b.velocity - a.velocity - start;
        let v = block.velocity(&a, &b, block.ratios(), &mut faults);
        let off = |p: Speed, v: Speed, push: Speed| {
            let times = |scale: Unit, x: Speed| crate::math::fx_mul(scale.into(), x.into());
            (times(softness.impulse_scale, p) + times(softness.mass_scale, v) + Fx::from(push)).abs()
        };
        worst = worst.max(off(p.x, v.x, push.x)).max(off(p.y, v.y, push.y));
    }
    assert_eq!(faults, 0);
    assert!(worst < fx!(0.0002), "{worst} m/s off");
}
