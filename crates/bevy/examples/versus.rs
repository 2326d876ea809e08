//! Two players push each other off a platform, with rollback. Arrow keys.
//!
//! `versus` plays against a bot over a simulated bad line; `versus host 0.0.0.0:7000` and `versus join ADDRESS` play
//! over UDP.

use std::net::ToSocketAddrs;

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d_examples::versus::{Versus, bot_pad, press};
use bevy_lockstep2d_examples::{Line, LineEnd, app};
use lockstep2d::peer::{Peer, PeerIdentity, PeerOptions, Udp, socket_address};
use lockstep2d::session::Address;

/// The bot is an ordinary peer without Bevy.
#[derive(Resource)]
struct Bot(Peer<Versus, LineEnd>);

fn play_bot(mut bot: ResMut<Bot>, line: Res<Line>, time: Res<Time<Real>>) -> Result {
    line.set_time(time.elapsed());
    bot.0.update(time.elapsed())?;
    while bot.0.is_due() {
        let pad = bot_pad(bot.0.tick());
        bot.0.advance(&[pad])?;
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
            let host = address.to_socket_addrs()?.next().ok_or("no such address")?;
            Lockstep::join(&(), options, me, Udp::bind("0.0.0.0:0")?, socket_address(host))?
        }
        _ => {
            let (line, contact) = (Line::default(), Address::new(&[0]).ok_or("a byte is an address")?);
            let bot = Peer::join(&(), options, PeerIdentity::random(), line.end(1), contact)?;
            app.insert_resource(Bot(bot)).insert_resource(line.clone()).add_systems(PreUpdate, play_bot);
            Lockstep::host(&(), options, me, line.end(0))?
        }
    };
    app.insert_resource(lockstep)
        .add_systems(bevy::app::RunFixedMainLoop, press.in_set(LockstepSystems::Inputs))
        .run();
    Ok(())
}
