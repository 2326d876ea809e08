//! Runs a signalling server and a headless player that hosts the room `bot`, for the page `index.html#bot`.
//!
//! `bot [PORT [TICKS]]`: the server listens on `PORT` (3536 by default). With `TICKS`, the match ends after this number
//! of ticks. The program then verifies the replay and prints the hash of the last state.

use std::net::Ipv4Addr;
use std::thread::sleep;
use std::time::{Duration, Instant};

use bevy_lockstep2d_examples::versus::{Versus, bot_pad};
use lockstep2d::lockstep::Game;
use lockstep2d::peer::{Peer, PeerEvent, PeerIdentity, PeerOptions};
use lockstep2d::replay::{Limits, verify};
use lockstep2d::session::Status;
use lockstep2d_matchbox::Matchbox;
use matchbox_signaling::SignalingServer;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let port = arguments.next().map_or(Ok(3536), |port| port.parse())?;
    let end: Option<u64> = arguments.next().map(|ticks| ticks.parse()).transpose()?;

    let runtime = tokio::runtime::Runtime::new()?;
    let guard = runtime.enter();
    let mut server = SignalingServer::full_mesh_builder((Ipv4Addr::LOCALHOST, port)).build();
    let address = server.bind()?;
    runtime.spawn(server.serve());
    drop(guard);
    println!("ws://{address}, room bot");

    let room = Matchbox::connect(&format!("ws://{address}/versus-bot"));
    let mut peer = Peer::<Versus, _>::host(&(), PeerOptions::rollback(), PeerIdentity::random(), room)?;
    if let Some(ticks) = end {
        peer.end_at(ticks);
    }
    let start = Instant::now();
    while peer.status() != Some(Status::Closed) {
        sleep(Duration::from_millis(2));
        peer.update(start.elapsed())?;
        while peer.is_due() {
            peer.advance(&[bot_pad(peer.tick())])?;
        }
        while let Some(event) = peer.next_event() {
            if let PeerEvent::Desync(desync) = event {
                return Err(format!("the states of the players differ since tick {}", desync.tick).into());
            }
        }
    }
    let (tick, hash) = (peer.tick(), peer.game().state_hash());
    let verdict = verify::<Versus>(&peer.finish()?.replay, &Limits::default());
    if !verdict.is_match() {
        return Err(format!("the replay does not verify: {verdict}").into());
    }
    println!("tick {tick}, {hash}");
    Ok(())
}
