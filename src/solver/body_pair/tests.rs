use super::*;
use crate::math::Rng;

/// The error of the velocity stays within half a unit.
#[test]
fn the_sum_of_all_changes_is_rounded_once() {
    let mut rng = Rng::new(3);
    for _ in 0..100 {
        let (mut a, mut b) = (SolverBody::default(), SolverBody::default());
        let (mut remainders, mut faults) = (Remainders::default(), 0);
        let (mut sum_a, mut sum_b) = (0, 0);
        for _ in 0..1000 {
            let mut any = || i64::from(rng.next_u32()) - (1 << 30);
            let (change_a, change_b) = (any(), any());
            (sum_a, sum_b) = (sum_a + change_a, sum_b + change_b);
            let [to_a, to_b] = [change_a, change_b].map(|x| Change { x, y: -x, spin: x });
            let pair = (&mut a, &mut b, &mut remainders, &mut faults);
            BodyPair { a: pair.0, b: pair.1, remainders: pair.2, faults: pair.3 }.change(to_a, to_b);
        }
        for (body, sum) in [(a, sum_a), (b, sum_b)] {
            let off = |speed: Speed, sum: i64| (i64::from(speed.to_bits()) << 30).abs_diff(sum);
            assert!(off(body.velocity.x, sum) <= 1 << 29);
            assert!(off(body.velocity.y, -sum) <= 1 << 29);
            assert!(off(body.spin, sum) <= 1 << 29);
        }
        assert_eq!(faults, 0);
    }
}
