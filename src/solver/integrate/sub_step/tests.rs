use super::*;
use crate::math::Rng;
use crate::simd::Scalar;
use std::vec::Vec;

#[test]
fn a_distance_is_the_rounded_quotient() {
    let mut rng = Rng::new(1);
    for rate in 60..=4000 {
        let sub_step = SubStep::of(rate);
        let ends = [i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX];
        let random = core::iter::repeat_with(|| i32::from_le_bytes(rng.next_u32().to_le_bytes())).take(50);
        // Speeds around a tie.
        let ties: Vec<i32> = (0..50).map(|i| (i * i32::try_from(rate).unwrap()) / 64 - 40 + i).collect();
        for bits in random.collect::<Vec<_>>().into_iter().chain(ends).chain(ties) {
            let rate = i64::from(rate);
            let expected = ((i64::from(bits) << 6) + rate).div_euclid(2 * rate);
            assert_eq!(i64::from(sub_step.distance(Speed::from_bits(bits)).to_bits()), expected);
            let [wide] = sub_step.distances::<Scalar<1>, 1>([bits]);
            assert_eq!(i64::from(wide), expected, "{bits} at {rate} Hz");
        }
    }
}
