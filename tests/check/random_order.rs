//! The check finds the planted fault of `examples/fuzzing`: the random iteration order of a `HashMap`.

use lockstep2d::check::{CheckOptions, Variant, check, check_replay, random_inputs};
use lockstep2d::math::Rng;

use super::harvest::Harvest;

/// The minimised replay contains little more than two fruits and a player who reaches for them.
#[test]
fn random_logs_find_the_order_of_a_hash_map() {
    let mut rng = Rng::new(3);
    let failure = (0..200).find_map(|_| {
        let inputs = random_inputs::<Harvest>(2, 200, &mut rng);
        check::<Harvest>(&7, &inputs, &CheckOptions::default()).err()
    });
    let failure = failure.expect("expected the fault to be found");
    let failure = failure.failure().expect("expected a fault of the game");
    println!("{failure}");
    assert_eq!(failure.minimised.variant, Variant::Again, "{failure}");
    assert!(failure.ticks < 120, "{failure}");
    assert!(failure.failed.0 >= 3, "{failure}");
    assert!(failure.minimised.differences.iter().any(|found| found.field().path().contains("weight")));

    let options = CheckOptions::default().only(&[Variant::Again; 4]);
    let fails = (0..8).filter(|_| check_replay::<Harvest>(&failure.replay, &options).is_err()).count();
    assert!(fails >= 4, "expected at least 4 failures out of 8, found {fails}");
}
