//! Two players in lockstep: a tick is played when both inputs have arrived.
//! Run with `cargo run --features ggrs --example lockstep_match`.
#![expect(clippy::disallowed_types, reason = "the clock of this process")]

mod tug;

use std::error::Error;
use std::time::{Duration, Instant};

use lockstep2d::net::{LinkConditions, NetOptions, Network, Peer};
use lockstep2d::replay::{Limits, verify};

use tug::Tug;

const TICKS: u64 = 300;

fn main() -> Result<(), Box<dyn Error>> {
    // With `Udp::bind("0.0.0.0:7000")?` instead of a port, each peer can be a separate process.
    let network =
        Network::new(LinkConditions { latency: Duration::from_millis(30), ..LinkConditions::default() }, 1);
    let options = NetOptions::lockstep();
    let mut peers = [
        Peer::<Tug, _, _>::host(&(), options, network.port(0))?,
        Peer::join(&(), options, network.port(1), 0, None)?,
    ];
    let start = Instant::now();
    while peers.iter().any(|peer| peer.confirmed() < TICKS) {
        let now = start.elapsed();
        network.set_time(now);
        for peer in &mut peers {
            peer.update(now)?;
            while let Some(event) = peer.next_event() {
                println!("seat {:?}: {event:?}", peer.seat());
            }
            // The players push the ball in opposite directions for one of every two seconds.
            let force = if peer.seat() == Some(0) { 3 } else { -2 };
            let push = if peer.tick() % 120 < 60 { force } else { 0 };
            while peer.is_due() && peer.advance(push)? {}
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    for mut peer in peers {
        let replay = [peer.take_replay(), peer.finish(TICKS)?].concat();
        println!("{} bytes: {}", replay.len(), verify::<Tug>(&replay, &Limits::default()));
    }
    Ok(())
}
