//! A WebSocket relay for matches of lockstep2d.
//!
//! Browsers cannot open UDP sockets, and some networks allow only HTTP. The relay forwards datagrams between the
//! members of a room without reading their contents. `README.md` has the protocol.
//!
//! - [`Server`] is the relay. The binary `lockstep2d-relay` runs it.
//! - [`Relay`] is a member of a room: a [`Transport`](lockstep2d::peer::Transport) for native peers.

mod client;
mod frame;
#[cfg(feature = "server")]
mod server;
mod silence;

pub use client::{Relay, RelayError};
pub use frame::ADDRESS_BYTES;
#[cfg(feature = "server")]
pub use server::{Limits, Server};
