use super::*;
use crate::math::Rng;
use crate::simd::Scalar;

#[test]
fn friction_is_shared_out_by_halves_as_far_as_each_point_reaches() {
    let mut rng = Rng::new(31);
    for _ in 0..20_000 {
        let mut batch = Batch::<1> { count: 2, ..Batch::NONE };
        let limits = [0, 1].map(|i| {
            let limit = i64::from(rng.below(1000));
            batch.points[i].friction_ratio.0[0] = 1 << 20;
            batch.points[i].normal_lambda.0[0] = i32::try_from(limit).expect("below 1000");
            limit
        });
        let most = limits[0] + limits[1];
        let whole = i64::from(rng.below(2000)).min(2 * most) - most;
        batch.tangent_lambda.0[0] = i32::try_from(whole).expect("below 2000");
        let shares = shares_of_friction::<Scalar<1>, 1>(&batch).map(|share| i64::from(share[0]));
        assert_eq!(shares[0] + shares[1], whole);
        for (share, limit) in shares.into_iter().zip(limits) {
            assert!(share.abs() <= limit, "{share} of {whole} within {limits:?}");
            let half = (whole.abs() + 1) / 2;
            assert!(half > limits[0].min(limits[1]) || share.abs().abs_diff(half) <= 1, "{shares:?}");
        }
    }
}
