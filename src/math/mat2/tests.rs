use super::*;
use crate::fx;
use crate::math::{Rng, Unit, narrow};
use fixed::types::extra::U30;

#[test]
fn inverse_undoes_the_matrix() {
    let mut rng = Rng::new(1);
    for _ in 0..2000 {
        let mut entry = || rng.range(fx!(-8), fx!(8));
        let m = Mat2::new(entry(), entry(), entry(), entry());
        let v = Vec2::new(entry(), entry());
        if m.determinant().abs() < fx!(0.5) {
            continue;
        }
        // The errors of two entries of the inverse (half a unit each) are multiplied by components of M v, at most
        // 128. The errors of two components of M v (half a unit each) are multiplied by entries of the inverse, at
        // most 16. With half a unit for the last rounding, the sum is below 145.
        let there = m.inverse().unwrap().apply(m.apply(v)) - v;
        assert!(there.x.abs().to_bits() <= 145 && there.y.abs().to_bits() <= 145, "{m:?} {v:?} {there:?}");
    }
}

#[test]
fn singular_and_extreme_matrices_do_not_panic() {
    let e = Fx::DELTA;
    assert_eq!(Mat2::new(fx!(1), fx!(2), fx!(3), fx!(6)).inverse(), None);
    assert_eq!(Mat2::new(e, Fx::ZERO, Fx::ZERO, e).determinant(), Fx::ZERO);
    let inverse = Mat2::new(e, Fx::ZERO, Fx::ZERO, e).inverse().unwrap();
    assert_eq!(inverse, Mat2::new(Fx::MAX, Fx::ZERO, Fx::ZERO, Fx::MAX));
    for bits in 0..81_u32 {
        let entry = |digit: u32| [Fx::MIN, Fx::ZERO, Fx::MAX][(bits / digit % 3) as usize];
        let m = Mat2::new(entry(1), entry(3), entry(9), entry(27));
        assert_eq!(m.inverse().is_none(), m.determinant() == Fx::ZERO, "{m:?}");
        let _ = m.apply(Vec2::new(Fx::MIN, Fx::MIN));
    }
}

#[test]
fn formats_agree() {
    let mut rng = Rng::new(2);
    for _ in 0..1000 {
        let mut entry = || narrow(rng.range(fx!(-0.5), fx!(0.5)));
        let m: Mat2<Unit> = Mat2::new(entry(), entry(), entry(), entry());
        let v: Vec2<Unit> = Vec2::new(entry(), entry());
        let wide =
            Mat2::new(Fx::from_num(m.a11), Fx::from_num(m.a12), Fx::from_num(m.a21), Fx::from_num(m.a22));
        // In units of `Fx`, the rounding error is at most 2 for the product in `U30` and 0.5 for the product in
        // `Fx`. The difference is an integer, so it is at most 2.
        let apart = m.apply::<_, U30>(v).widen() - wide.apply(v.widen());
        assert!(apart.x.abs().to_bits() <= 2 && apart.y.abs().to_bits() <= 2, "{apart:?}");
        let determinant: Unit = m.determinant();
        assert_eq!(m.transpose().determinant::<U30>(), determinant);
    }
}
