//! Every planted fault is found by the variant for its kind.

use lockstep2d::check::{
    CheckError, CheckOptions, Checker, Depths, Failure, Fault, Variant, check, check_replay, random_inputs,
};
use lockstep2d::math::Rng;
use lockstep2d::replay::Verdict;

use super::toy::{Mistake, Toy};

/// Checks a toy with a planted fault, and returns the failure. The replay of the failure must fail in the same way.
fn failure(mistake: Mistake) -> Failure {
    let inputs = random_inputs::<Toy>(2, 300, &mut Rng::new(1));
    let failure = match check::<Toy>(&mistake, &inputs, &CheckOptions::default()) {
        Err(CheckError::Failed(failure)) => *failure,
        other => panic!("{mistake:?}: {other:?}"),
    };
    assert!(failure.failed.0 >= 3 && failure.failed.1 == 4, "{failure}");
    let only = CheckOptions::default().only(&[failure.minimised.variant]);
    if failure.minimised.variant != Variant::Recorded {
        let again = (0..8).find_map(|_| check_replay::<Toy>(&failure.replay, &only).err()).unwrap();
        assert_eq!(again.failure().unwrap().minimised.variant, failure.minimised.variant, "{again}");
    }
    failure
}

/// Paths of the fields that differ.
fn fields(failure: &Failure) -> Vec<&str> {
    failure.minimised.differences.iter().map(|difference| difference.field().path()).collect()
}

fn found(failure: &Failure) -> (Variant, &Fault) {
    (failure.minimised.variant, &failure.minimised.fault)
}

#[test]
fn a_good_game_passes() {
    let inputs = random_inputs::<Toy>(2, 300, &mut Rng::new(1));
    for depths in [Depths::InTurn, Depths::Each] {
        let options = CheckOptions { depths, ..CheckOptions::default() };
        let checked = check::<Toy>(&Mistake::None, &inputs, &options).unwrap();
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
    let failure = failure(Mistake::SaveLacksField);
    assert_eq!(found(&failure), (Variant::Reloaded, &Fault::Loaded));
    // In the minimised log, the two players walk up to each other, and one hits.
    assert!((3..=5).contains(&failure.ticks), "{failure}");
    assert!(failure.to_string().contains("the difference is in state that is not saved"), "{failure}");
}

#[test]
fn a_field_that_save_and_hash_lack_is_found_when_it_tells() {
    let failure = failure(Mistake::BothLackField);
    assert_eq!(found(&failure), (Variant::Reloaded, &Fault::Hash));
    assert!(fields(&failure)[0].starts_with("state.hits"), "{failure}");
    assert!((4..=8).contains(&failure.ticks), "{failure}");
}

#[test]
fn a_field_that_the_hash_lacks_is_found() {
    let failure = failure(Mistake::HashLacksField);
    assert_eq!(found(&failure), (Variant::ByteSwapped, &Fault::Unhashed));
    assert!(fields(&failure)[0].starts_with("state.cooldown"), "{failure}");
}

#[test]
fn state_outside_of_the_game_is_found() {
    let failure = failure(Mistake::Global);
    assert_eq!(found(&failure), (Variant::Again, &Fault::Hash));
    assert!(fields(&failure)[0].starts_with("state.hits"), "{failure}");
}

#[test]
fn a_cache_that_load_leaves_is_found() {
    let failure = failure(Mistake::LoadKeepsCache);
    assert!(matches!(found(&failure), (Variant::RolledBack | Variant::Reloaded, &Fault::Hash)), "{failure}");
}

#[test]
fn a_memory_that_load_leaves_is_found() {
    let failure = failure(Mistake::StaleMemory);
    assert!(matches!(found(&failure), (Variant::RolledBack | Variant::Reloaded, &Fault::Hash)), "{failure}");
    assert!(fields(&failure)[0].starts_with("state.hits"), "{failure}");
}

/// Checks a log and then its minimised replay, with the same options.
fn check_twice(mistake: Mistake, inputs: &[Vec<u8>], options: &CheckOptions) {
    let error = check::<Toy>(&mistake, inputs, options).unwrap_err();
    let failure = error.failure().unwrap();
    let what = format!("{mistake:?}, every {}, {} ticks: {failure}", options.every, inputs.len());
    assert_eq!(failure.failed, (4, 4), "{what}");
    let again = check_replay::<Toy>(&failure.replay, options).expect_err(&what);
    let again = again.failure().unwrap();
    assert_eq!(again.finding.variant, failure.minimised.variant, "{what}");
    assert_eq!(again.ticks, failure.ticks, "{what}");
}

#[test]
fn a_minimised_replay_fails_with_the_options_of_its_check() {
    let inputs = random_inputs::<Toy>(2, 300, &mut Rng::new(1));
    for every in [1, 5, 10] {
        for (mistake, variant) in [
            (Mistake::SaveLacksField, Variant::Reloaded),
            (Mistake::BothLackField, Variant::Reloaded),
            (Mistake::LoadKeepsCache, Variant::RolledBack),
        ] {
            check_twice(mistake, &inputs, &CheckOptions::default().every(every).only(&[variant]));
        }
    }
}

/// Only a wrong prediction reveals this fault. The log is too short to play each prediction in its turn.
#[test]
fn a_short_log_is_rolled_back_with_every_prediction() {
    let inputs = [[1, 6], [0, 0], [0, 0], [1, 6]].map(Vec::from);
    for depths in [Depths::InTurn, Depths::Each] {
        let options = CheckOptions { depths, ..CheckOptions::default().only(&[Variant::RolledBack]) };
        check_twice(Mistake::StaleMemory, &inputs, &options);
    }
}

#[test]
fn a_hash_that_changes_the_state_is_found() {
    let counts = failure(Mistake::HashCounts);
    assert!(matches!(found(&counts).0, Variant::HashPolled | Variant::HashUnpolled), "{counts}");
    // The fault is invisible if the hash is polled after every tick.
    let tidies = failure(Mistake::HashTidies);
    assert_eq!(found(&tidies), (Variant::HashUnpolled, &Fault::Hash));
    assert_eq!(tidies.ticks, 8);
}

#[test]
fn a_save_with_a_random_order_is_found() {
    let failure = failure(Mistake::SaveIsUnordered);
    assert!(matches!(
        found(&failure),
        (Variant::HashPolled, Fault::Answers { of: "save" })
            | (Variant::Reloaded, Fault::Encoding | Fault::SavedAgain)
    ));
    assert!(failure.ticks <= 6, "{failure}");
}

#[test]
fn answers_that_change_are_found() {
    assert_eq!(
        found(&failure(Mistake::ClaimsCount)),
        (Variant::HashPolled, &Fault::Answers { of: "claims" })
    );
    assert_eq!(found(&failure(Mistake::WorkCounts)), (Variant::HashPolled, &Fault::Answers { of: "work" }));
}

#[test]
fn what_cannot_be_recorded_or_verified_is_found() {
    assert!(matches!(found(&failure(Mistake::ClaimsTwice)), (Variant::Recorded, Fault::Unrecordable(_))));
    assert!(matches!(
        found(&failure(Mistake::ClaimsGlobal)),
        (Variant::Again, Fault::Answers { of: "claims" })
    ));
    let failure = failure(Mistake::WorkIsHuge);
    assert!(matches!(found(&failure), (Variant::Recorded, Fault::Verdict(Verdict::LimitExceeded { .. }))));
}

#[test]
fn a_replay_contains_the_tick_that_exceeds_a_limit() {
    for budget in [0, CheckOptions::default().budget] {
        let inputs = random_inputs::<Toy>(2, 60, &mut Rng::new(1));
        let options = CheckOptions { budget, ..CheckOptions::default().only(&[Variant::Reloaded]) };
        let error = check::<Toy>(&Mistake::TenthIsHuge, &inputs, &options).unwrap_err();
        let failure = error.failure().unwrap();
        assert_eq!((failure.ticks, failure.minimised.tick), (10, 9), "{failure}");
        let again = check_replay::<Toy>(&failure.replay, &options);
        assert!(matches!(again, Err(CheckError::Replay(Verdict::LimitExceeded { .. }))), "{again:?}");
    }
}

/// If a log fails, the check plays it several more times, to measure how often it fails. With a long log, these runs
/// must leave enough of the work budget for the minimisation.
#[test]
fn an_early_fault_of_a_long_log_is_minimised() {
    let mut inputs = random_inputs::<Toy>(2, 300, &mut Rng::new(1));
    inputs.resize(15_000, vec![0; 2]);
    let options = CheckOptions::default().only(&[Variant::Reloaded]);
    let error = check::<Toy>(&Mistake::SaveLacksField, &inputs, &options).unwrap_err();
    let failure = error.failure().unwrap();
    assert!(failure.ticks <= 5, "{failure}");
}

/// The run without any variant already exceeds the work limit, so the fault is not reported as one of the recording.
#[test]
fn a_limit_that_is_exceeded_is_not_called_a_fault_of_the_recording() {
    let options = CheckOptions::default().only(&[]);
    let mut checker = Checker::<Toy>::new(&Mistake::WorkIsHuge, &options).unwrap();
    let finding = checker.step(&[0; 2]).unwrap_err().to_string();
    assert!(finding.starts_with("played within the limits: after tick 0 limit exceeded: "), "{finding}");
}

#[test]
fn a_save_that_is_not_read_is_found() {
    let failure = failure(Mistake::Unreadable);
    assert!(matches!(found(&failure), (Variant::Reloaded, Fault::Unreadable { .. })), "{failure}");
    assert_eq!((failure.ticks, failure.minimised.tick), (9, 9));
}

#[test]
fn a_log_that_is_none_is_no_failure_of_the_game() {
    let error = check::<Toy>(&Mistake::None, &[vec![0; 3]], &CheckOptions::default()).unwrap_err();
    assert!(matches!(error, CheckError::Record(_)), "{error}");
    let error = check_replay::<Toy>(b"none", &CheckOptions::default()).unwrap_err();
    assert!(matches!(error, CheckError::Replay(_)), "{error}");
}
