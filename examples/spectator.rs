//! Two players and a spectator that joins late. `cargo run --example spectator`.

mod tug;

use std::error::Error;
use std::time::Duration;

use lockstep2d::lockstep::Game;
use lockstep2d::peer::{LinkConditions, Network, Peer, PeerIdentity, PeerOptions, Port};

use tug::Tug;

fn main() -> Result<(), Box<dyn Error>> {
    let network = Network::new(LinkConditions::latency(Duration::from_millis(30)), 1);
    let options = PeerOptions::rollback();
    let (host, guest) = (PeerIdentity::random(), PeerIdentity::random());
    let mut peers: Vec<Peer<Tug, Port>> = vec![
        Peer::host(&(), options, host, network.port(0))?,
        Peer::join(&(), options, guest, network.port(1), Network::address(0))?,
    ];
    let mut now = Duration::ZERO;
    loop {
        // The time is simulated. A real game passes the time since its start, and sleeps between updates.
        now += Duration::from_millis(1);
        network.set_time(now);
        for peer in &mut peers {
            peer.update(now)?;
            while peer.is_due() {
                // A spectator has no seats.
                let inputs = vec![1; peer.seats().len()];
                peer.advance(&inputs)?;
            }
        }
        if peers.len() == 2 && peers[0].tick() >= 120 {
            // The spectator receives a state, and the inputs of the ticks after that state.
            let me = PeerIdentity::random();
            peers.push(Peer::watch(&(), options, me, network.port(2), Network::address(1))?);
        }
        if let [player, _, watcher] = &peers[..]
            && watcher.tick() >= 240
        {
            let tick = watcher.tick();
            let past = player.history().get(tick).map(|past| past.hash.to_string());
            println!("after {tick} ticks the player had {}", past.unwrap_or_default());
            println!("and the spectator now has   {}", watcher.game().state_hash());
            return Ok(());
        }
    }
}
