//! Whole matches in simulated time, over links that delay, drop, duplicate, reorder and fail.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_lossless,
    reason = "the numbers of a test are small"
)]

mod absences;
mod departures;
mod ends;
#[cfg(feature = "__faults")]
mod faults;
mod game;
mod healing;
mod invariants;
mod joins;
mod net;
mod pace;
mod same_address;
mod sim;
mod stories;
mod storm;
mod times;
mod without_players;

use std::sync::atomic::{AtomicU64, Ordering};

use lockstep2d_tests::sweep;

/// Number of seeds of a full run, which takes up to 30 minutes on two cores.
const SEEDS: u64 = 100_000;
/// Number of seeds of a sampled run.
const SAMPLE: u64 = 100;

/// A match in which enough peers survive and are connected plays more ticks than this.
const TICKS_MIN: u64 = 20;
/// Almost all matches play at least this many ticks: the first planned end is after 4 s.
const TICKS_USUAL: u64 = 40;

#[test]
fn every_invariant_holds_in_storms() {
    let seeds = sweep::size(SEEDS, SAMPLE);
    let short = AtomicU64::new(0);
    sweep::for_each((0..seeds).collect(), |seed| {
        let (failure, figures) = storm::play(seed, |_| ());
        assert_eq!(failure, None, "seed {seed}: {figures:?}");
        // A match whose peers have finished may also count as one without a quorum, so `finished` is tested as well.
        let stopped = figures.no_quorum == 1 && figures.finished == 0;
        assert!(figures.ticks > TICKS_MIN || stopped, "seed {seed}: {figures:?}");
        short.fetch_add(u64::from(figures.ticks < TICKS_USUAL), Ordering::Relaxed);
    });
    let short = short.into_inner();
    assert!(short * 50 <= seeds, "{short} of {seeds} matches have fewer than {TICKS_USUAL} ticks");
}
