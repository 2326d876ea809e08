//! Whole matches: equal hashes, and equal replays that verify.

use std::time::Duration;

use lockstep2d::net::{Event, LinkConditions, NetOptions};
use lockstep2d::replay::{Limits, Verdict, verify};

use super::pushers::Pushers;
use super::sweep;
use super::table::Table;

pub(crate) const MODES: [fn() -> NetOptions; 2] = [NetOptions::lockstep, NetOptions::rollback];

pub(crate) const STORM: LinkConditions = LinkConditions {
    latency: Duration::from_millis(70),
    jitter: Duration::from_millis(60),
    loss: 20,
    doubled: 10,
};

pub(crate) fn verdict(replay: &[u8]) -> Verdict {
    verify::<Pushers>(replay, &Limits::default())
}

fn check_match(options: NetOptions, conditions: LinkConditions, seed: u64, ticks: u64) {
    let mut table = Table::of(4, options, conditions, seed);
    let done = table.play(60 + ticks / 10, |table| table.all_confirmed(ticks));
    assert!(done, "{options:?}: {}", table.describe());
    for events in &table.events {
        assert!(!events.iter().any(|event| matches!(event, Event::Diverged(_))), "{events:?}");
        assert!(!events.iter().any(|event| matches!(event, Event::Left { .. })), "{events:?}");
    }
    let replays = table.finish(ticks);
    assert!(matches!(verdict(&replays[0]), Verdict::Match { .. }), "{}", verdict(&replays[0]));
    assert!(replays.iter().all(|replay| *replay == replays[0]), "replays differ");
}

#[test]
fn four_peers_play_the_same_in_calm_weather() {
    sweep::at_once(MODES, |options| check_match(options(), LinkConditions::default(), 1, 200));
}

/// GGRS reads the clock, so matches run in real time; many run in parallel. The sampled size is eight matches in both
/// modes, half as long.
#[test]
fn fifty_matches_in_a_storm_end_alike() {
    let tempest = LinkConditions { latency: Duration::from_millis(100), ..STORM };
    let seeds = sweep::sample(0..50, 7);
    for seeds in seeds.chunks(25) {
        sweep::at_once(seeds, |&seed| {
            let options = MODES[usize::from(seed % 2 == 0)]();
            check_match(options, tempest, seed, sweep::size(300, 150));
        });
    }
}
