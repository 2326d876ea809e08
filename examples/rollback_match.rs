//! Two players with rollback: missing inputs are guessed, and ticks with wrong guesses are played again. `cargo run
//! --example rollback_match`.

mod tug;

use std::error::Error;
use std::time::Duration;

use lockstep2d::peer::{LinkConditions, Network, Peer, PeerIdentity, PeerOptions, Port};
use lockstep2d::replay::{Limits, verify};
use lockstep2d::session::Status;

use tug::Tug;

const TICKS: u64 = 300;

fn main() -> Result<(), Box<dyn Error>> {
    // The network is in memory. To run each peer in its own process, use `Udp::bind("0.0.0.0:7000")?` instead of a
    // `Port`.
    let conditions = LinkConditions { loss: 10, ..LinkConditions::latency(Duration::from_millis(60)) };
    let network = Network::new(conditions, 1);
    let options = PeerOptions::rollback();
    let (host, guest) = (PeerIdentity::random(), PeerIdentity::random());
    let mut peers: [Peer<Tug, Port>; 2] = [
        Peer::host(&(), options, host, network.port(0))?,
        Peer::join(&(), options, guest, network.port(1), Network::address(0))?,
    ];
    // The peers agree on the end of the match, so that all of them stop after the same tick.
    peers[0].end_at(TICKS);
    let mut now = Duration::ZERO;
    while peers.iter().any(|peer| peer.status() != Some(Status::Closed)) {
        // The time is simulated. A real game passes the time since its start, and sleeps between updates.
        now += Duration::from_millis(1);
        network.set_time(now);
        for peer in &mut peers {
            peer.update(now)?;
            while let Some(event) = peer.next_event() {
                println!("{now:?}: seats {:?}: {event:?}", peer.seats());
            }
            while peer.is_due() {
                peer.advance(&[push(peer)])?;
            }
        }
    }
    for mut peer in peers {
        let statistics = peer.session().map(|session| session.statistics());
        println!("ticks played again: {:?}", statistics.map(|statistics| statistics.replayed));
        let replay = [peer.take_replay(), peer.finish()?.replay].concat();
        println!("{} bytes: {}", replay.len(), verify::<Tug>(&replay, &Limits::default()));
    }
    Ok(())
}

/// Input of a player: the players push the ball in opposite directions for one second, and pause for the next one.
fn push(peer: &Peer<Tug, Port>) -> i8 {
    let force = if peer.seats() == [0] { 3 } else { -2 };
    if peer.tick() % 120 < 60 { force } else { 0 }
}
