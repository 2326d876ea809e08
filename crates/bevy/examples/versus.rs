//! Two players push each other off a platform, with rollback. Arrow keys.
//!
//! `versus` plays against a bot over a simulated network with delay and packet loss; `versus host 0.0.0.0:7000` and
//! `versus join ADDRESS` play over UDP.

use std::net::{SocketAddr, ToSocketAddrs};
use std::time::Duration;

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d_examples::app;
use bevy_lockstep2d_examples::versus::{Versus, bot_pad, press};
use lockstep2d::peer::{LinkConditions, Network, Peer, PeerIdentity, PeerOptions, Port, Udp, socket_address};

/// A bot: an ordinary peer without Bevy.
#[derive(Resource)]
struct Bot {
    peer: Peer<Versus, Port>,
    network: Network,
}

fn play_bot(mut bot: ResMut<Bot>, time: Res<Time<Real>>) -> Result {
    bot.network.set_time(time.elapsed());
    bot.peer.update(time.elapsed())?;
    while bot.peer.is_due() {
        let pad = bot_pad(bot.peer.tick());
        bot.peer.advance(&[pad])?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (options, me) = (PeerOptions::rollback(), PeerIdentity::random());
    let mut app = app::<Versus>("versus", 18.0, Vec2::ZERO);
    let lockstep: Lockstep<Versus> = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["host", address] => Lockstep::host(&(), options, me, Udp::bind(address)?)?,
        ["join", address] => {
            // The host of this example listens on IPv4 only.
            let mut found = address.to_socket_addrs()?;
            let host = found.find(SocketAddr::is_ipv4).ok_or("no such IPv4 address")?;
            Lockstep::join(&(), options, me, Udp::bind("0.0.0.0:0")?, socket_address(host))?
        }
        _ => {
            let bad = LinkConditions { loss: 10, ..LinkConditions::latency(Duration::from_millis(100)) };
            let network = Network::new(bad, 1);
            let (host, guest) = (network.port(1), network.port(2));
            let peer = Peer::join(&(), options, PeerIdentity::random(), guest, host.address())?;
            app.insert_resource(Bot { peer, network }).add_systems(PreUpdate, play_bot);
            Lockstep::host(&(), options, me, host)?
        }
    };
    app.insert_resource(lockstep)
        .add_systems(bevy::app::RunFixedMainLoop, press.in_set(LockstepSystems::Inputs))
        .run();
    Ok(())
}
