//! Two players and a spectator that joins late. Run with `cargo run --features ggrs --example spectator`.
#![expect(clippy::disallowed_types, reason = "the clock of this process")]

mod tug;

use std::error::Error;
use std::time::{Duration, Instant};

use lockstep2d::net::{LinkConditions, NetOptions, Network, Peer};

use tug::Tug;

fn main() -> Result<(), Box<dyn Error>> {
    let network =
        Network::new(LinkConditions { latency: Duration::from_millis(30), ..LinkConditions::default() }, 1);
    let options = NetOptions::rollback();
    let mut peers = vec![
        Peer::<Tug, _, _>::host(&(), options, network.port(0))?,
        Peer::join(&(), options, network.port(1), 0, None)?,
    ];
    let start = Instant::now();
    loop {
        let now = start.elapsed();
        network.set_time(now);
        for peer in &mut peers {
            peer.update(now)?;
            while peer.is_due() && peer.advance(1)? {}
        }
        if peers.len() == 2 && peers[0].tick() >= 120 {
            // The spectator receives a state of the match and the inputs since then, and catches up.
            peers.push(Peer::watch(&(), options, network.port(2), 0)?);
        }
        if let [player, _, watcher] = &peers[..]
            && watcher.tick() >= 240
        {
            let tick = watcher.tick();
            let hash =
                |peer: &Peer<Tug, _, _>| peer.history().get(tick).map(|moment| moment.hash.to_string());
            println!("after {tick} ticks the player has {:?}", hash(player));
            println!("and the spectator       has {:?}", hash(watcher));
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
