//! Messages about the findings of a check.

use lockstep2d::check::{CheckError, Failure, Fault, Finding, Guess, Variant};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::inspect::{Difference, differences, fields};
use lockstep2d::replay::{Flaw, RecordError, Verdict};
use lockstep2d::world::{Backend, Phase};

use crate::says;

fn finding(variant: Variant, fault: Fault) -> Finding {
    Finding { variant, fault, tick: 9, played: 9, phase: None, rollback: None, differences: Vec::new() }
}

fn differing(count: usize) -> Vec<Difference> {
    let (a, b) = (fields(&vec![1; count]).expect("numbers"), fields(&vec![2; count]).expect("numbers"));
    differences(&a, &b)
}

#[test]
fn variants() {
    says([
        (Variant::Again, "played again"),
        (Variant::HashPolled, "with hash, work, claims and save polled twice"),
        (Variant::HashUnpolled, "with the hash polled only at the end"),
        (Variant::Reloaded, "reloaded from bytes into a new game"),
        (Variant::RolledBack, "rolled back"),
        (Variant::ClearedScratch, "with cleared scratch"),
        (Variant::Backend(Backend::Scalar), "with the backend Scalar"),
        (Variant::BroadPhase(BroadPhaseKind::BruteForce), "with the broad phase BruteForce"),
        (Variant::Threads(3), "on 3 threads"),
        (Variant::ByteSwapped, "with bytes of another tick swapped into its save"),
        (Variant::Recorded, "recorded and verified"),
    ]);
}

#[test]
fn faults() {
    let verdict = Verdict::Malformed { offset: 0, flaw: Flaw::Magic };
    says([
        (Fault::Hash, "the state hash differs from the reference run"),
        (Fault::Phase, "the results differ from the reference run"),
        (Fault::Loaded, "the loaded state has another hash than the saved state"),
        (Fault::Encoding, "the save has other bytes after decoding and encoding"),
        (Fault::SavedAgain, "saving the loaded state leads to other bytes"),
        (Fault::Unreadable { why: "a bad tag".into() }, "the save cannot be decoded: a bad tag"),
        (Fault::Refused { why: "no floor".into() }, "the setup can no longer start a game: no floor"),
        (Fault::Answers { of: "work" }, "`work` returns different results for the same state"),
        (
            Fault::Unhashed,
            "two states with the same hash but different saves reach different hashes with the same inputs",
        ),
        (
            Fault::Verdict(verdict),
            "the recording does not verify: malformed: at byte 0: this is not a replay file",
        ),
        (Fault::Unrecordable(RecordError::TickRate), "the recording cannot be finished: a tick rate of zero"),
    ]);
}

#[test]
fn a_finding_says_where() {
    let mut found = finding(Variant::RolledBack, Fault::Hash);
    (found.rollback, found.phase) = (Some((1, Guess::Held)), Some(Phase::Solve));
    found.differences = differing(2);
    let text = found.to_string();
    let start = "rolled back by 1 tick after guessing that inputs are held: after tick 9, phase Solve, the state \
                 hash differs from the reference run\n    [0]: 1 | 2\n    [1]: 1 | 2\nusually a cache or a field \
                 that `load` does not restore";
    assert!(text.starts_with(start), "{text}");
    found.rollback = Some((3, Guess::Default));
    assert!(found.to_string().starts_with("rolled back by 3 ticks after guessing default inputs: "));
    found.rollback = Some((3, Guess::Right));
    assert!(found.to_string().starts_with("rolled back by 3 ticks: after tick 9"));
}

#[test]
fn a_finding_is_not_endless() {
    let mut found = finding(Variant::Again, Fault::Hash);
    let same = "\n    the saves are equal: the difference is in state that is not saved\nusually a HashMap";
    assert!(found.to_string().contains(same), "{found}");
    found.differences = differing(1000);
    let text = found.to_string();
    let lines = text.lines().filter(|line| line.contains("1 | 2")).count();
    assert!(lines < 50 && text.contains(&format!("\n    and {} more\n", 1000 - lines)), "{text}");
}

/// Each kind of fault has its own hint.
#[test]
fn what_it_usually_is() {
    let too_much =
        Verdict::LimitExceeded { limit: lockstep2d::replay::LimitKind::TickWork, value: 2, max: 1 };
    let all = [
        (Variant::Again, Fault::Hash, "a HashMap or HashSet that is iterated"),
        (Variant::HashPolled, Fault::Answers { of: "save" }, "state that changes when it is read"),
        (Variant::HashUnpolled, Fault::Hash, "state that changes when it is read"),
        (Variant::ByteSwapped, Fault::Unhashed, "a field that `state_hash` leaves out"),
        (Variant::Reloaded, Fault::Encoding, "a HashMap or HashSet in the save"),
        (
            Variant::Reloaded,
            Fault::Unreadable { why: String::new() },
            "a Serialize and a Deserialize that do not match",
        ),
        (Variant::Reloaded, Fault::Hash, "a field that is missing from `Save`"),
        (Variant::RolledBack, Fault::Hash, "a cache or a field that `load` does not restore"),
        (Variant::Recorded, Fault::Verdict(too_much), "`work` returns more than the limits allow"),
    ];
    for (variant, fault, expected) in all {
        let hint = finding(variant, fault.clone()).hint();
        assert!(hint.starts_with(expected), "{variant}, {fault}: {hint}");
    }
}

#[test]
fn failures() {
    let found = finding(Variant::Again, Fault::Hash);
    let mut failure = Failure {
        finding: found.clone(),
        minimised: found.clone(),
        replay: Vec::new(),
        ticks: 4,
        failed: (3, 4),
    };
    assert_eq!(
        failure.to_string(),
        format!("{found}\na replay of 4 ticks fails in this way 3 times out of 4")
    );
    failure.minimised.tick = 4;
    let shorter = failure.minimised.to_string();
    assert!(failure.to_string().ends_with(&format!("3 times out of 4:\n{shorter}")), "{failure}");
    assert_eq!(format!("{failure:?}"), failure.to_string());
    says([
        (CheckError::Record(RecordError::TickRate), "nothing to check: a tick rate of zero"),
        (
            CheckError::Replay(Verdict::Malformed { offset: 0, flaw: Flaw::Magic }),
            "nothing to check: malformed: at byte 0: this is not a replay file",
        ),
    ]);
    let error = CheckError::Failed(Box::new(failure.clone()));
    assert_eq!(error.to_string(), failure.to_string());
    assert_eq!(error.failure(), Some(&failure));
    assert_eq!(CheckError::Record(RecordError::TickRate).failure(), None);
}
