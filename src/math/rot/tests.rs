use super::*;
use crate::fx;
use crate::math::{Length, Rng, Speed, narrow};

fn draw(rng: &mut Rng, size: Fx) -> Vec2<Fx> {
    Vec2::new(rng.range(-size, size), rng.range(-size, size))
}

#[test]
fn quarter_turns_are_exact() {
    let v = Vec2::new(Length::lit("3.25"), Length::lit("-1.5"));
    let quarter = Rot::from_angle(Angle::QUARTER);
    assert_eq!(quarter.apply(v), v.perp());
    assert_eq!(quarter.apply_inverse(v.perp()), v);
    assert_eq!(Rot::default().apply(v), v);
    assert_eq!(quarter.then(quarter), Rot::from_angle(Angle::HALF));
}

#[test]
fn narrow_and_wide_round_the_same_value() {
    let mut rng = Rng::new(1);
    for _ in 0..10_000 {
        let turn = Rot::from_angle(rng.angle());
        let v: Vec2<Length> = draw(&mut rng, fx!(300)).narrow();
        let wide = turn.apply_wide(v.widen());
        // Rounding twice can differ by a unit from rounding once.
        let apart = wide.narrow() - turn.apply(v);
        assert!(apart.x.abs() <= Length::DELTA && apart.y.abs() <= Length::DELTA, "{turn:?} {v:?}");
        assert!((wide.x - Fx::from_num(turn.apply(v).x)).abs() <= narrow_half());
        let back = turn.apply_inverse(turn.apply(v)) - v;
        // Rounding contributes at most 1.3 units, and the error of cos^2 + sin^2 less than 2.7 units for 300 m.
        assert!(back.x.abs().to_bits() <= 4 && back.y.abs().to_bits() <= 4, "{turn:?} {v:?} {back:?}");
    }
}

fn narrow_half() -> Fx {
    Fx::from_bits(1 << 9)
}

#[test]
fn composition_adds_angles() {
    let mut rng = Rng::new(2);
    for _ in 0..10_000 {
        let (a, b) = (rng.angle(), rng.angle());
        let both = Rot::from_angle(a).then(Rot::from_angle(b));
        let sum = Rot::from_angle(a + b);
        // In units of 2^-30, each factor contributes at most 0.79 sqrt 2, rounding of the product 0.5, and `sum`
        // 0.79: below 4.
        let apart = (both.cos - sum.cos).abs().max((both.sin - sum.sin).abs());
        assert!(apart.to_bits() <= 3, "{a:?} {b:?} {apart}");
    }
}

#[test]
fn the_far_corners_saturate() {
    let turn = Rot::from_angle(Angle::EIGHTH);
    let corner = Vec2::new(Fx::MIN, Fx::MIN);
    assert_eq!(turn.apply_wide(corner).y, Fx::MIN);
    assert_eq!(turn.apply_inverse_wide(corner).x, Fx::MIN);
    let corner = Vec2::new(Speed::MAX, Speed::MAX);
    assert_eq!(turn.apply(corner), Vec2::new(narrow(fx!(0)), Speed::MAX));
    let broken = Rot { cos: Unit::MIN, sin: Unit::MIN };
    assert_eq!(broken.apply_inverse_wide(Vec2::new(Fx::MIN, Fx::MIN)).x, Fx::MAX);
}
