//! Each planted fault breaks an invariant in some match.

use lockstep2d::session::Fault;

use super::{storm, sweep};

/// Number of matches, in at least one of which a fault must break an invariant.
const MATCHES: u64 = 300;
/// Number of matches in the long run with a fault that breaks an invariant in about one match of a thousand.
const MATCHES_RARE: u64 = 2000;

/// Each fault, the first seed, and the difference between seeds. The last digit of a seed gives the `Class` of the
/// match, so with a difference of 10 all matches are of one class.
const FAULTS: [(Fault, u64, u64); 13] = [
    (Fault::NoFreeze, 0, 1),
    (Fault::OwnCut, 0, 1),
    (Fault::FinalComplete, 0, 1),
    (Fault::HalfIsEnough, 0, 1),
    (Fault::KeepComplete, 8, 10),
    (Fault::NoRelay, 0, 1),
    (Fault::LocalEnd, 7, 10),
    (Fault::CompetingBallots, 8, 10),
    (Fault::Accuse, 8, 10),
    (Fault::ForgetAccepted, 8, 10),
    (Fault::AcceptBlind, 8, 10),
    (Fault::HastyLeave, 5, 1),
    (Fault::NoRollback, 0, 1),
];

#[test]
fn every_planted_fault_is_noticed() {
    sweep::for_each(FAULTS.to_vec(), |(fault, first, step)| {
        let rare = fault == Fault::AcceptBlind;
        if rare && !sweep::is_long() {
            return;
        }
        let count = if rare { MATCHES_RARE } else { MATCHES };
        let seeds = (0..count).map(|number| first + number * step);
        let noticed =
            seeds.into_iter().find_map(|seed| storm::play(seed, |config| config.fault = Some(fault)).0);
        assert!(noticed.is_some(), "{fault:?} is not noticed in {count} matches");
    });
}
