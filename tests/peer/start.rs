//! The first seconds of a match.

use lockstep2d::peer::PeerOptions;
use lockstep2d::session::Status;

use super::Table;

/// Both players know the latency from the time of joining.
#[test]
fn lockstep_plays_at_full_speed_from_the_start() {
    let options = PeerOptions { start_with: 2, ..PeerOptions::lockstep() };
    let mut table = Table::new(150, 0);
    table.host(options);
    table.join(options, 0);
    while table.peer(0).status() != Some(Status::Playing) || table.peer(0).tick() == 0 {
        table.play(10);
    }
    let delays = [0, 1].map(|at| table.peer(at).session().expect("valid").delay());
    table.play(2000);
    assert!(table.peer(0).tick() >= 120, "{} ticks in 2 s, delays {delays:?}", table.peer(0).tick());
}
