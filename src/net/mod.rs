//! Multiplayer for any [`Game`](crate::lockstep::Game): every peer plays the same game, and only inputs are sent.
//!
//! [GGRS](https://docs.rs/ggrs) exchanges the inputs, predicts late ones, and requests rollbacks. This module adds the
//! missing parts:
//!
//! - [`Driver`] executes the requests of any GGRS session, and keeps the recent states and the replay. It is all you
//!   need with your own session and sockets.
//! - [`Peer`] is a complete participant. It compares [`HandshakeParameters`] in the handshake, admits late joiners,
//!   makes all peers agree on the tick at which a player left, compares states, and adapts the tick rate. It creates
//!   its own GGRS sessions.
//! - [`Transport`] carries packets: [`Udp`], a simulated [`Network`] in memory for tests, or your own.
//!
//! This module never reads a clock: the time is passed to [`Peer::update`]. GGRS reads the clock for its timeouts.
//!
//! `docs/MULTIPLAYER.md` explains the course of a match and what to do after a divergence.
//!
//! ```no_run
//! # use lockstep2d::lockstep::Game;
//! # use lockstep2d::net::{NetError, NetGame, NetOptions, Peer, Udp};
//! # fn read_pad<G: NetGame>() -> G::Input { G::Input::default() }
//! # fn draw<G: NetGame>(_: &G) {}
//! # fn play<MyGame: NetGame>(setup: &MyGame::Setup) -> Result<(), Box<dyn std::error::Error>> {
//! let mut peer = Peer::<MyGame, _, _>::host(setup, NetOptions::rollback(), Udp::bind("0.0.0.0:7000")?)?;
//! # let start = std::time::Instant::now();
//! loop {
//!     peer.update(start.elapsed())?;
//!     while peer.is_due() && peer.advance(read_pad::<MyGame>())? {}
//!     draw(peer.game());
//!     std::thread::sleep(std::time::Duration::from_millis(1));
//! }
//! # }
//! ```

mod driver;
mod error;
mod handshake;
mod liveness;
mod message_validator;
mod options;
mod packet;
mod peer;
mod session;
mod simulated_network;
mod transport;
mod wire;

pub use driver::{Divergence, Driver};
pub use error::DriverError;
pub use handshake::{HandshakeDifference, HandshakeMismatch, HandshakeParameters};
pub use options::{INPUT_DELAY_MAX, Mode, NetOptions};
pub use peer::{Event, NetError, Peer};
pub use simulated_network::{LinkConditions, Network, Port};
pub use transport::{PACKET_BYTES_MAX, Transport, Udp};
pub use wire::{Address, ChecksumReport, GgrsConfig, NetGame, Wire};
