//! Mistakes that are planted in the protocol break an invariant in some match: the simulation can find such mistakes.

use lockstep2d::session::Fault;

use super::{storm, sweep};

/// Each fault, and the seeds of which at least one has to notice it.
const FAULTS: [(Fault, &[u64]); 13] = [
    (Fault::NoFreeze, &[0, 1, 2, 4]),
    (Fault::OwnCut, &[0, 1, 2, 4]),
    (Fault::FinalComplete, &[0, 1, 2, 4]),
    (Fault::HalfIsEnough, &[1, 8, 16, 18]),
    (Fault::KeepComplete, &[10, 12, 23]),
    (Fault::NoRelay, &[0, 4, 6]),
    (Fault::LocalEnd, &[9, 20, 22]),
    (Fault::Duel, &[26, 28, 30]),
    (Fault::Accuse, &[10, 28]),
    (Fault::ForgetAccepted, &[]),
    (Fault::AcceptBlind, &[]),
    (Fault::HastyLeave, &[8, 16, 25]),
    (Fault::NoRollback, &[0, 1, 2]),
];

#[test]
fn every_planted_fault_is_noticed() {
    sweep::for_each(FAULTS.to_vec(), |(fault, seeds)| {
        let noticed =
            seeds.iter().any(|&seed| storm::play(seed, |config| config.fault = Some(fault)).0.is_some());
        assert!(noticed, "{fault:?} in the seeds {seeds:?}");
        let sound = seeds.iter().all(|&seed| storm::play(seed, |_| ()).0.is_none());
        assert!(sound, "without {fault:?} the seeds {seeds:?} break nothing");
    });
}
