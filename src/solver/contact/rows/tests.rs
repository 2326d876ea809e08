//! Every backend computes the rows that the equations give. These tests evaluate the equations one number at a time.

use super::super::super::row::MassFractions;
use super::*;
use crate::fx;
use crate::math::{Reciprocal, Rng, Rot, Speed, Unit, Vec2};
use crate::simd::{Backend, Kernel, Machine, Quad, Scalar, WIDTH};
use std::vec::Vec;

#[test]
fn friction_ratio_is_friction_times_the_ratio_of_denominators() {
    let one = 1i64 << 30;
    assert_eq!(friction_ratio(fx!(0.5), one), FrictionRatio::lit("0.5"));
    assert_eq!(friction_ratio(fx!(0.5), 4 * one), FrictionRatio::lit("2"));
    assert_eq!(friction_ratio(fx!(0.5), one / 4), FrictionRatio::lit("0.125"));
    assert_eq!(
        friction_ratio(fx!(16), 16130 * one),
        FrictionRatio::MAX,
        "the friction ratio saturates and does not wrap"
    );
}

struct FillRows<'a, const N: usize> {
    inputs: &'a [Input],
    made: &'a mut Made<N>,
}

struct Made<const N: usize> {
    batch: Batch<N>,
    denominators: Denominators<N>,
}

impl<const N: usize> Made<N> {
    fn of_points(count: usize) -> Self {
        Made { batch: Batch { count, ..Batch::NONE }, denominators: Denominators::NONE }
    }
}

impl<const N: usize> Kernel<N> for FillRows<'_, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let FillRows { inputs, made } = self;
        let inputs = core::array::from_fn(|lane| inputs[lane]);
        fill::<L, N>(&inputs, &mut made.batch, &mut made.denominators);
    }
}

/// A random number. The ends of the range are frequent.
fn any(rng: &mut Rng, limit: i32) -> i32 {
    match rng.below(8) {
        0 => limit,
        1 => -limit,
        2 => 0,
        _ => (i32::from_le_bytes(rng.next_u32().to_le_bytes()) >> rng.below(31)).clamp(-limit, limit),
    }
}

fn random_input(rng: &mut Rng) -> Input {
    let n: Vec2<Unit> = match rng.below(4) {
        0 => Vec2::Y,
        1 => -Vec2::X,
        _ => Rot::from_angle(rng.angle()).apply(Vec2::X),
    };
    let mass = |rng: &mut Rng| match rng.below(4) {
        0 => fx!(0),
        1 => fx!(1),
        _ => Fx::from_bits(1i64 << rng.below(62)),
    };
    let fractions = MassFractions::of_masses(mass(rng), mass(rng));
    let mut gyration = || match rng.below(4) {
        0 => Reciprocal::ZERO.parts(),
        1 => Reciprocal::of(fx!(0.002)).parts(),
        2 => Reciprocal::of(fx!(512)).parts(),
        _ => Reciprocal::of(rng.range(fx!(0.002), fx!(512))).parts(),
    };
    let (a, b) = (gyration(), gyration());
    let mut quad = |limit: i32| Quad(core::array::from_fn(|_| any(rng, limit)));
    Input {
        shares: Quad([n.x.to_bits(), n.y.to_bits(), fractions.a.to_bits(), fractions.b.to_bits()]),
        gyrations: Quad([a.0, b.0, a.1, b.1]),
        to_origin: quad(i32::MAX),
        anchors: quad(i32::MAX),
        carried: quad(i32::MAX),
        rest: Quad(quad(i32::MAX).0.map(i32::abs)),
        ..Input::NONE
    }
}

fn rounded(x: i128, shift: u32) -> i128 {
    if shift == 0 { x } else { (x + (1 << (shift - 1))) >> shift }
}

fn limited(x: i128, limit: i32) -> i32 {
    i32::try_from(x.clamp(-i128::from(limit), limit.into())).expect("clamped")
}

struct Naive {
    e: [i32; 2],
    gains: [[i32; 3]; 2],
    denominator: i128,
    inverse: i32,
}

/// The points at which friction acts on A and B: the anchor minus and plus half the gap.
fn surfaces(input: &Input, anchor: [i32; 2], [x, y]: [i32; 2]) -> [[i32; 2]; 2] {
    let half = rounded(input.rest.0[3].into(), 1);
    let lift = [x, y].map(|n| limited(rounded(i128::from(n) * half, 24), i32::MAX));
    [-1, 1].map(|sign| [0, 1].map(|axis| anchor[axis].wrapping_add(sign * lift[axis])))
}

fn anchor(input: &Input, points: &[usize]) -> [i32; 2] {
    [0, 1].map(|axis| {
        let sum: i128 = points.iter().map(|point| i128::from(input.anchors.0[2 * point + axis])).sum();
        limited(rounded(sum, points.len().ilog2()), i32::MAX)
    })
}

fn naive_row(input: &Input, anchors: [[i32; 2]; 2], n: [i32; 2]) -> Naive {
    let wide = |a: i32| i128::from(a);
    let Quad([_, _, fraction_a, fraction_b]) = input.shares;
    let fractions = [fraction_a, fraction_b];
    let e = [0, 1].map(|side| {
        let arm = |axis: usize| wide(input.to_origin.0[2 * side + axis].saturating_add(anchors[side][axis]));
        let c = rounded(arm(0) * wide(n[1]) - arm(1) * wide(n[0]), 24);
        let (mantissa, exponent) = (input.gyrations.0[side], input.gyrations.0[2 + side].unsigned_abs());
        limited(rounded(c * wide(mantissa), exponent.saturating_sub(2)), RATIO_MAX.to_bits())
    });
    let square = |side: usize| rounded(wide(fractions[side]) * wide(e[side]), 30) * wide(e[side]);
    let moving = wide(fraction_a) + wide(fraction_b);
    let denominator = (square(0) + square(1) + (moving << 18)) >> 18;
    let inverse = limited((1 << 60) / denominator.max(1 << 30), i32::MAX);
    let gains = [0, 1].map(|side| {
        let g = rounded(wide(fractions[side]) * wide(inverse), 30);
        [n[0], n[1], e[side]].map(|part| limited(rounded(g * wide(part), 24), i32::MAX))
    });
    Naive { e, gains, denominator, inverse }
}

/// Checks a lane. The second point of a contact with one point is a copy of the first.
fn check<const N: usize>(input: &Input, lane: usize, made: &Made<N>) {
    let Made { batch, denominators } = made;
    let mut input = *input;
    let Quad([_, _, _, count]) = input.carried;
    assert_eq!(batch.both.0[lane], -i32::from(count == 2));
    if count == 1 {
        let (Quad([x, y, ..]), Quad([separation, _, friction, gap])) = (input.anchors, input.rest);
        (input.anchors, input.rest) = (Quad([x, y, x, y]), Quad([separation, separation, friction, gap]));
    }
    let input = &input;
    let Quad([x, y, fraction_a, fraction_b]) = input.shares;
    let [x, y] = [x, y].map(|n| limited(rounded(n.into(), 6), i32::MAX));
    assert_eq!([batch.n_x.0[lane], batch.n_y.0[lane]], [x, y]);
    assert_eq!(batch.immovable.0[lane], -i32::from(fraction_a == 0 || fraction_b == 0));
    let check_row = |row: &Row<N>, inverse: &Ints<N>, naive: &Naive| {
        assert_eq!([row.e_a.0[lane], row.e_b.0[lane]], naive.e, "{input:?}");
        assert_eq!([&row.a, &row.b].map(|gains| [0, 1, 2].map(|part| gains[part].0[lane])), naive.gains);
        assert_eq!(inverse.0[lane], naive.inverse);
    };
    let lambda = |place: usize, row: &Naive, limit: Speed| {
        let p = i128::from(input.carried.0[place]);
        limited(rounded(p * row.denominator, 30), limit.to_bits())
    };
    let half_way = anchor(input, &[0, 1][..batch.count]);
    let tangent = naive_row(input, surfaces(input, half_way, [x, y]), [-y, x]);
    check_row(&batch.tangent, &denominators.tangent.inverse, &tangent);
    assert_eq!(batch.tangent_lambda.0[lane], lambda(2, &tangent, TANGENT_MAX));
    let friction = input.rest.0[2];
    for (i, point) in batch.points.iter().enumerate().take(batch.count) {
        let separation = limited(rounded(input.rest.0[i].into(), 1), i32::MAX);
        assert_eq!([point.separation.0[lane], point.first_separation.0[lane]], [separation; 2]);
        let normal = naive_row(input, [anchor(input, &[i]); 2], [x, y]);
        check_row(&point.normal, &denominators.normals[i].inverse, &normal);
        let ratio = rounded(tangent.denominator * i128::from(normal.inverse), 30);
        assert_eq!(
            point.friction_ratio.0[lane],
            limited(rounded(i128::from(friction) * ratio, 30), i32::MAX)
        );
        assert_eq!(point.normal_lambda.0[lane], lambda(i, &normal, IMPULSE_MAX).max(0));
    }
}

#[test]
fn every_backend_makes_the_rows_of_the_equations() {
    let mut rng = Rng::new(7);
    for round in 0..20_000 {
        let points = 1 + round % 2;
        let mut input = |_| {
            let mut input = random_input(&mut rng);
            input.carried.0[3] = 1 + i32::try_from(rng.below(2)).expect("small") * (points - 1);
            input
        };
        let inputs: Vec<Input> = (0..WIDTH).map(&mut input).collect();
        let count = usize::try_from(points).expect("1 or 2");
        for backend in Backend::available() {
            let mut made = Made::<WIDTH>::of_points(count);
            let machine = Machine::new(backend).expect("available");
            machine.run_wide(FillRows { inputs: &inputs, made: &mut made });
            inputs.iter().enumerate().for_each(|(lane, input)| check(input, lane, &made));
        }
        let mut made = Made::<1>::of_points(count);
        FillRows { inputs: &inputs, made: &mut made }.run::<Scalar<1>>();
        check(&inputs[0], 0, &made);
    }
}
