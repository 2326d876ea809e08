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
    // The network is in memory. With `Udp::bind("0.0.0.0:7000")?` instead of a `Port`, each peer can be a process of
    // its own.
    let conditions = LinkConditions { loss: 10, ..LinkConditions::latency(Duration::from_millis(60)) };
    let network = Network::new(conditions, 1);
    let options = PeerOptions::rollback();
    let (host, guest) = (PeerIdentity::random(), PeerIdentity::random());
    let mut peers: [Peer<Tug, Port>; 2] = [
        Peer::host(&(), options, host, network.port(0))?,
        Peer::join(&(), options, guest, network.port(1), Network::address(0))?,
    ];
    // The session decides on the end, so that all peers stop after the same tick.
    peers[0].end_at(TICKS);
    let mut now = Duration::ZERO;
    while peers.iter().any(|peer| peer.status() != Some(Status::Closed)) {
        // Simulated time. A game passes the real time since its start, and sleeps between updates.
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

/// The players push the ball in opposite directions for one of every two seconds.
fn push(peer: &Peer<Tug, Port>) -> i8 {
    let force = if peer.seats() == [0] { 3 } else { -2 };
    if peer.tick() % 120 < 60 { force } else { 0 }
}
