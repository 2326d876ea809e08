//! `versus` over WebRTC, for web pages and native programs. Arrow keys.
//!
//! A page without a room in its address opens a match in a new room. Pages with `#ROOM` join it. Natively:
//! `bevy_lockstep2d_web [ROOM [SERVER]]`. Pages and programs need a signalling server of matchbox. `cargo run --example
//! bot` starts such a server and an opponent.

#[cfg_attr(target_arch = "wasm32", path = "page.rs")]
#[cfg_attr(not(target_arch = "wasm32"), path = "native.rs")]
mod platform;

use bevy::{app::RunFixedMainLoop, prelude::*};
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d_examples::app;
use bevy_lockstep2d_examples::versus::{Versus, press};
use lockstep2d::lockstep::Game;
use lockstep2d::peer::{PeerEvent, PeerIdentity, PeerOptions};
use lockstep2d::session::Status;
use lockstep2d_matchbox::Matchbox;

struct Arguments {
    /// `ws://HOST:PORT`.
    server: String,
    /// The room of a match that another player has opened.
    room: Option<String>,
    /// Identity of this player. A player that returns with the same identity gets its seat back.
    me: PeerIdentity,
    /// Room that is created if `room` is `None`.
    new_room: String,
}

#[derive(Resource)]
struct Room(String);

/// A room that has no other members yet.
#[derive(Resource)]
struct Empty(Option<Matchbox>, PeerIdentity);

/// Joins the match once another member is in the room.
fn join(mut commands: Commands, mut empty: ResMut<Empty>) -> Result {
    let me = empty.1;
    if let Some(mut matchbox) = empty.0.take() {
        matchbox.update();
        if let Some(&contact) = matchbox.others().first() {
            commands.insert_resource(Lockstep::<Versus>::join(
                &(),
                PeerOptions::rollback(),
                me,
                matchbox,
                contact,
            )?);
            commands.remove_resource::<Empty>();
        } else {
            empty.0 = Some(matchbox);
        }
    }
    Ok(())
}

fn tell(lockstep: Option<Res<Lockstep<Versus>>>, room: Res<Room>, mut windows: Query<&mut Window>) {
    let name = &room.0;
    let peer = lockstep.as_ref().and_then(|lockstep| lockstep.peer());
    let text = match peer.and_then(|peer| Some((peer.status()?, peer))) {
        None => format!("{name}: connecting"),
        Some((Status::Waiting, _)) => format!("{name}: waiting for another player"),
        Some((Status::Finished { .. } | Status::Closed, peer)) if peer.tick() == peer.confirmed() => {
            format!("{name}: the end, tick {}, {}", peer.tick(), peer.game().state_hash())
        }
        Some((status, peer)) => {
            let guessed = peer.tick().saturating_sub(peer.confirmed());
            format!("{name}: {status:?}, tick {}, {guessed} ticks guessed", peer.tick())
        }
    };
    platform::show(&text, &mut windows);
}

/// Puts the room into the address of the page, so that a reloaded page returns to it. Fails on a desync.
fn enter(mut events: MessageReader<MatchEvent>, room: Res<Room>) -> Result {
    for MatchEvent(event) in events.read() {
        if let PeerEvent::Desync(desync) = event {
            return Err(format!("the states of the players differ since tick {}", desync.tick).into());
        }
        platform::enter(&room.0);
    }
    Ok(())
}

fn main() -> Result {
    let Arguments { server, room, me, new_room } = platform::arguments();
    let name = room.clone().unwrap_or(new_room);
    let matchbox = Matchbox::connect(&format!("{server}/versus-{name}"));
    let mut app = app::<Versus>("versus", 18.0, Vec2::ZERO);
    if room.is_some() {
        app.insert_resource(Empty(Some(matchbox), me));
    } else {
        app.insert_resource(Lockstep::<Versus>::host(&(), PeerOptions::rollback(), me, matchbox)?);
    }
    app.insert_resource(Room(name))
        .add_systems(PreUpdate, join.run_if(resource_exists::<Empty>))
        .add_systems(RunFixedMainLoop, press.in_set(LockstepSystems::Inputs))
        .add_systems(Update, (tell, enter))
        .run();
    Ok(())
}
