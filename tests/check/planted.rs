//! Every planted fault is found, by the variant that detects this kind of fault.

use lockstep2d::check::{
    CheckError, CheckOptions, Depths, Failure, Fault, Variant, check, check_replay, random_inputs,
};
use lockstep2d::math::Rng;
use lockstep2d::replay::Verdict;

use super::toy::Toy;

/// Returns the failure of a toy, whose replay must reproduce it.
fn failure<const MISTAKE: usize>() -> Failure {
    let inputs = random_inputs::<Toy<MISTAKE>>(2, 300, &mut Rng::new(1));
    let failure = match check::<Toy<MISTAKE>>(&(), &inputs, &CheckOptions::default()) {
        Err(CheckError::Failed(failure)) => *failure,
        other => panic!("mistake {MISTAKE}: {other:?}"),
    };
    assert!(failure.failed.0 >= 3 && failure.failed.1 == 4, "{failure}");
    let only =
        CheckOptions { depths: Depths::Each, ..CheckOptions::default().only(&[failure.minimised.variant]) };
    if failure.minimised.variant != Variant::Recorded {
        let again = (0..8).find_map(|_| check_replay::<Toy<MISTAKE>>(&failure.replay, &only).err()).unwrap();
        assert_eq!(again.failure().unwrap().minimised.variant, failure.minimised.variant, "{again}");
    }
    failure
}

/// Returns the paths of the fields that differ.
fn fields(failure: &Failure) -> Vec<&str> {
    failure.minimised.differences.iter().map(|difference| difference.field().path()).collect()
}

fn found(failure: &Failure) -> (Variant, &Fault) {
    (failure.minimised.variant, &failure.minimised.fault)
}

#[test]
fn a_good_game_passes() {
    let inputs = random_inputs::<Toy<0>>(2, 300, &mut Rng::new(1));
    for depths in [Depths::InTurn, Depths::Each] {
        let options = CheckOptions { depths, ..CheckOptions::default() };
        let checked = check::<Toy<0>>(&(), &inputs, &options).unwrap();
        assert_eq!(checked.ticks, 300);
        assert_eq!(
            checked.variants,
            [
                Variant::Again,
                Variant::HashPolled,
                Variant::HashUnpolled,
                Variant::Reloaded,
                Variant::RolledBack,
                Variant::ByteSwapped,
                Variant::Recorded
            ]
        );
    }
}

#[test]
fn a_field_that_the_save_lacks_is_found() {
    let failure = failure::<1>();
    assert_eq!(found(&failure), (Variant::Reloaded, &Fault::Loaded));
    // The minimised log has two players who walk up to each other, and one hit.
    assert!((3..=5).contains(&failure.ticks), "{failure}");
    assert!(failure.to_string().contains("the difference is in state that is not saved"), "{failure}");
}

#[test]
fn a_field_that_save_and_hash_lack_is_found_when_it_tells() {
    let failure = failure::<2>();
    assert_eq!(found(&failure), (Variant::Reloaded, &Fault::Hash));
    assert!(fields(&failure)[0].starts_with("state.hits"), "{failure}");
    assert!((4..=8).contains(&failure.ticks), "{failure}");
}

#[test]
fn a_field_that_the_hash_lacks_is_found() {
    let failure = failure::<3>();
    assert_eq!(found(&failure), (Variant::ByteSwapped, &Fault::Unhashed));
    assert!(fields(&failure)[0].starts_with("state.cooldown"), "{failure}");
}

#[test]
fn state_outside_of_the_game_is_found() {
    let failure = failure::<4>();
    assert_eq!(found(&failure), (Variant::Again, &Fault::Hash));
    assert!(fields(&failure)[0].starts_with("state.hits"), "{failure}");
}

#[test]
fn a_cache_that_load_leaves_is_found() {
    let failure = failure::<5>();
    assert!(matches!(found(&failure), (Variant::RolledBack | Variant::Reloaded, &Fault::Hash)), "{failure}");
}

#[test]
fn a_memory_that_load_leaves_is_found() {
    let failure = failure::<6>();
    assert!(matches!(found(&failure), (Variant::RolledBack | Variant::Reloaded, &Fault::Hash)), "{failure}");
    assert!(fields(&failure)[0].starts_with("state.hits"), "{failure}");
}

#[test]
fn a_hash_that_changes_the_state_is_found() {
    let counts = failure::<7>();
    assert!(matches!(found(&counts).0, Variant::HashPolled | Variant::HashUnpolled), "{counts}");
    // The fault is invisible if the hash is polled after every tick.
    let tidies = failure::<8>();
    assert_eq!(found(&tidies), (Variant::HashUnpolled, &Fault::Hash));
    assert_eq!(tidies.ticks, 8);
}

#[test]
fn a_save_with_a_random_order_is_found() {
    let failure = failure::<9>();
    assert!(matches!(
        found(&failure),
        (Variant::HashPolled, Fault::Answers { of: "save" })
            | (Variant::Reloaded, Fault::Encoding | Fault::SavedAgain)
    ));
    assert!(failure.ticks <= 6, "{failure}");
}

#[test]
fn answers_that_change_are_found() {
    assert_eq!(found(&failure::<10>()), (Variant::HashPolled, &Fault::Answers { of: "claims" }));
    assert_eq!(found(&failure::<11>()), (Variant::HashPolled, &Fault::Answers { of: "work" }));
}

#[test]
fn what_cannot_be_recorded_or_verified_is_found() {
    assert!(matches!(found(&failure::<12>()), (Variant::Recorded, Fault::Unrecordable(_))));
    assert!(matches!(found(&failure::<13>()), (Variant::Again, Fault::Answers { of: "claims" })));
    let failure = failure::<15>();
    assert!(matches!(found(&failure), (Variant::Recorded, Fault::Verdict(Verdict::LimitExceeded { .. }))));
}

#[test]
fn a_save_that_is_not_read_is_found() {
    let failure = failure::<14>();
    assert!(matches!(found(&failure), (Variant::Reloaded, Fault::Unreadable { .. })), "{failure}");
    assert_eq!((failure.ticks, failure.minimised.tick), (9, 9));
}

#[test]
fn a_log_that_is_none_is_no_failure_of_the_game() {
    let error = check::<Toy<0>>(&(), &[vec![0; 3]], &CheckOptions::default()).unwrap_err();
    assert!(matches!(error, CheckError::Record(_)), "{error}");
    let error = check_replay::<Toy<0>>(b"none", &CheckOptions::default()).unwrap_err();
    assert!(matches!(error, CheckError::Replay(_)), "{error}");
}
