//! Peers that vanish, leave, or are disconnected.

use lockstep2d::net::{Event, LinkConditions, NetError};
use lockstep2d::replay::{Limits, Part, Reader, Verdict};

use super::matches::{MODES, STORM, verdict};
use super::pushers::EMPTY;
use super::sweep;
use super::table::Table;

/// Returns the tick at which the player of seat `gone` left.
fn left_at(events: &[Event], gone: u32) -> Option<u64> {
    events.iter().find_map(|event| match event {
        Event::Left { seat, tick } if *seat == gone => Some(*tick),
        _ => None,
    })
}

fn check_goings(conditions: LinkConditions, gone: usize, seed: u64) {
    sweep::at_once(MODES, |options| {
        let mut table = Table::of(4, options(), conditions, seed);
        assert!(table.play(40, |table| table.all_confirmed(60)), "{}", table.describe());
        // The peer vanishes; its last messages have not reached all other peers.
        table.kill(gone);
        let ended = table.play(60, |table| table.all_confirmed(220));
        assert!(ended, "{}", table.describe());
        let ticks: Vec<_> = (0..4)
            .filter(|at| *at != gone)
            .map(|at| left_at(&table.events[at], u32::try_from(gone).unwrap()))
            .collect();
        assert!(ticks[0].is_some() && ticks.iter().all(|tick| *tick == ticks[0]), "{ticks:?}");
        let replays: Vec<_> =
            table.finish(220).into_iter().enumerate().filter(|(at, _)| *at != gone).collect();
        assert!(matches!(verdict(&replays[0].1), Verdict::Match { .. }), "{}", verdict(&replays[0].1));
        assert!(replays.iter().all(|(_, replay)| *replay == replays[0].1), "replays differ");
        let inputs = inputs_of(&replays[0].1, gone);
        let tick = usize::try_from(ticks[0].unwrap()).unwrap();
        assert!(inputs[..tick].iter().all(|input| *input != EMPTY), "gone too early");
        assert!(inputs[tick..].iter().all(|input| *input == EMPTY), "still there");
    });
}

/// Returns the input of a seat in each tick of a replay.
fn inputs_of(replay: &[u8], seat: usize) -> Vec<u8> {
    let mut inputs = Vec::new();
    let mut reader = Reader::open(replay, &Limits::default()).unwrap();
    while let Some(Part::Inputs(block)) = reader.next_part().unwrap() {
        let mut runs = block.runs();
        while let Some(run) = runs.next_run().unwrap() {
            inputs.extend(std::iter::repeat_n(run.encoded[seat], run.ticks as usize));
        }
    }
    inputs
}

#[test]
fn the_others_go_on_without_a_peer_that_vanishes_and_say_the_same_tick() {
    let cases = [(LinkConditions::default(), 3, 3), (STORM, 2, 4)];
    sweep::at_once(cases, |(conditions, gone, seed)| check_goings(conditions, gone, seed));
}

#[test]
fn nobody_needs_the_host() {
    check_goings(LinkConditions::default(), 0, 5);
}

#[test]
fn a_peer_that_leaves_is_not_waited_for() {
    let mut table = Table::of(3, MODES[1](), LinkConditions::default(), 6);
    assert!(table.play(40, |table| table.all_confirmed(60)));
    table.kill(1).finish(60).unwrap();
    // The departure message is faster than the timeout.
    let noticed = table.play(1, |table| left_at(&table.events[0], 1).is_some());
    assert!(noticed, "{}", table.describe());
    assert!(table.play(20, |table| table.all_confirmed(150)), "{}", table.describe());
}

#[test]
fn a_peer_that_was_silent_for_too_long_is_told() {
    let mut table = Table::of(3, MODES[0](), LinkConditions::default(), 7);
    assert!(table.play(40, |table| table.all_confirmed(60)));
    let sleeper = table.kill(1);
    assert!(table.play(20, |table| left_at(&table.events[0], 1).is_some()));
    table.peers[1] = Some(sleeper);
    let told = table.play(20, |table| table.errors[1].is_some());
    assert!(told, "{}", table.describe());
    assert_eq!(table.errors[1], Some(NetError::Dropped));
}
