//! Matches survive long or repeated disturbances: outages, slow handshakes, repeated departures and joins.

use std::time::Duration;

use lockstep2d::net::{Event, LinkConditions, NetOptions, Peer};
use lockstep2d::replay::Verdict;

use super::matches::{MODES, verdict};
use super::pushers::Setup;
use super::sweep;
use super::table::Table;

/// A total outage that is shorter than the timeout disconnects nobody.
#[test]
fn a_hole_in_the_network_is_no_end() {
    sweep::at_once(MODES, |options| {
        let mut table = Table::of(3, options(), LinkConditions::default(), 31);
        assert!(table.play(40, |table| table.all_confirmed(60)), "{}", table.describe());
        for millis in [300, 1400] {
            table.network.set_conditions(LinkConditions { loss: 100, ..LinkConditions::default() });
            table.play_for(Duration::from_millis(millis));
            table.network.set_conditions(LinkConditions::default());
            table.play_for(Duration::from_millis(500));
        }
        let tick = table.peers[0].as_ref().unwrap().tick() + 60;
        assert!(table.play(40, |table| table.all_confirmed(tick)), "{}", table.describe());
        let left = |event: &Event| matches!(event, Event::Left { .. } | Event::Diverged(_));
        assert!(!table.events.iter().flatten().any(left), "{}", table.describe());
        let replays = table.finish(tick);
        assert!(matches!(verdict(&replays[0]), Verdict::Match { .. }));
        assert!(replays.iter().all(|replay| *replay == replays[0]), "replays differ");
    });
}

/// The GGRS handshake takes five round trips, which last five times as long as the timeout here.
#[test]
fn who_answers_slowly_is_not_silent() {
    sweep::at_once(MODES, |options| {
        let options = NetOptions { timeout: Duration::from_millis(600), ..options() };
        let conditions = LinkConditions { latency: Duration::from_millis(300), ..LinkConditions::default() };
        let mut table = Table::of(3, options, conditions, 33);
        assert!(table.play(40, |table| table.all_confirmed(60)), "{}", table.describe());
        let left = |event: &Event| matches!(event, Event::Left { .. });
        assert!(!table.events.iter().flatten().any(left), "{}", table.describe());
    });
}

/// A player leaves and rejoins repeatedly, always in the same seat.
#[test]
fn a_player_comes_and_goes_ten_times() {
    let options = NetOptions::rollback();
    let mut table = Table::of(3, options, LinkConditions::default(), 32);
    assert!(table.play(40, |table| table.all_confirmed(30)));
    for time in 0..10 {
        table.kill(2).finish(0).unwrap();
        let gone = table.play(20, |table| table.peers[0].as_ref().unwrap().seats() == [0, 1]);
        assert!(gone, "time {time}: {}", table.describe());
        let port = table.network.port(100 + time);
        table.peers[2] = Some(Peer::join(&Setup::default(), options, port, 1, Some(2)).unwrap());
        let back = table.play(20, |table| table.peers[2].as_ref().unwrap().seat() == Some(2));
        assert!(back, "time {time}: {}", table.describe());
        let tick = table.peers[0].as_ref().unwrap().tick() + 20;
        assert!(table.play(20, |table| table.all_confirmed(tick)), "time {time}: {}", table.describe());
        let hashes = table.hashes(tick);
        assert!(hashes.len() == 3 && hashes.iter().all(|hash| *hash == hashes[0]), "time {time}");
    }
    table.kill(2);
    let tick = table.peers.iter().flatten().map(|peer| peer.confirmed()).min().unwrap();
    let replays = table.finish(tick);
    assert!(matches!(verdict(&replays[0]), Verdict::Match { .. }), "{}", verdict(&replays[0]));
    assert_eq!(replays[0], replays[1]);
}
