//! A peer that leaves a match for another one.

use std::time::Duration;

use lockstep2d::peer::{Network, PeerOptions};
use lockstep2d::session::Status;

use super::Table;

/// The other match begins with tick 0, so it cannot continue the replay, which has ticks of the first match.
#[test]
fn a_peer_that_changes_the_match_has_no_replay() {
    let options = PeerOptions { start_with: 1, ..PeerOptions::lockstep() };
    let mut table = Table::new(10, 0);
    table.host(options);
    table.join(options, 0);
    table.play(2000);
    table.host(PeerOptions { start_with: 2, ..options });
    assert!(table.peer(1).confirmed() > 60);
    table.peer(1).ask(Network::address(2));
    table.play(500);
    let taken = table.replays[1].len();
    table.play(2500);
    assert_eq!((table.peer(1).status(), table.replays[1].len()), (Some(Status::Playing), taken));
    let end = table.peers[1].take().expect("valid").finish().expect("valid");
    assert!(end.ticks > 60 && end.replay.is_empty());
}

/// The end that a peer has set for one match does not end the next one.
#[test]
fn the_end_of_a_match_is_not_that_of_the_next_one() {
    let options = PeerOptions { start_with: 1, ..PeerOptions::lockstep() };
    let mut table = Table::new(10, 0);
    table.host(options);
    table.join(options, 0);
    table.play(2000);
    table.host(PeerOptions { start_with: 2, ..options });
    table.peer(1).end_at(200);
    table.peer(1).ask(Network::address(2));
    table.play(6000);
    assert_eq!(table.peer(1).status(), Some(Status::Playing));
    assert!(table.peer(1).confirmed() > 250, "{}", table.peer(1).confirmed());
}

/// Events are in the queue until the program fetches them.
#[test]
fn no_event_of_a_match_is_delivered_after_it() {
    let mut table = Table::new(10, 0);
    table.host(PeerOptions { start_with: 1, ..PeerOptions::lockstep() });
    let now = table.network.time() + Duration::from_millis(1);
    let peer = table.peer(0);
    peer.update(now).expect("valid");
    peer.leave();
    peer.update(now + Duration::from_millis(1)).expect("valid");
    assert!(peer.next_event().is_some(), "the match has begun");
    peer.ask(Network::address(2));
    assert_eq!(peer.next_event(), None);
}
