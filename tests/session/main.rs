//! Whole matches of session cores in simulated time, over links that delay, lose, double, reorder and cut.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_lossless,
    reason = "the numbers of a test are small"
)]

#[cfg(feature = "__faults")]
mod faults;
mod game;
mod healing;
mod invariants;
mod joins;
mod net;
mod pace;
mod sim;
mod stories;
mod storm;
#[path = "../common/sweep.rs"]
mod sweep;

/// Seeds of a full run. It may take 30 minutes on two cores.
const SEEDS: u64 = 100_000;
/// Seeds of a sampled run.
const SAMPLE: u64 = 100;

#[test]
fn every_invariant_holds_in_storms() {
    sweep::for_each((0..sweep::size(SEEDS, SAMPLE)).collect(), |seed| {
        let (failure, figures) = storm::play(seed, |_| ());
        assert_eq!(failure, None, "seed {seed}: {figures:?}");
        assert!(figures.ticks > 20, "seed {seed}: {figures:?}");
    });
}
