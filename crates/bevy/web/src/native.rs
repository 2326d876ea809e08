//! The native program: reads its arguments, and shows the state of the match in the title of its window.

use bevy::prelude::*;
use lockstep2d::peer::PeerIdentity;

use crate::Arguments;

pub fn arguments() -> Arguments {
    let mut arguments = std::env::args().skip(1);
    let me = PeerIdentity::random();
    let room = arguments.next();
    let server = arguments.next().unwrap_or_else(|| "ws://127.0.0.1:3536".into());
    Arguments { server, room, me, new_room: format!("{:x}", me.id.0) }
}

pub fn show(text: &str, windows: &mut Query<&mut Window>) {
    for mut window in windows {
        if window.title != text {
            window.title = text.into();
        }
    }
}

/// Does nothing: a program gets the room as an argument, not from an address.
pub const fn enter(_room: &str) {}
