//! Multiplayer for any [`Game`](crate::lockstep::Game): every peer plays the same game, and only inputs are sent.
//!
//! [GGRS](https://docs.rs/ggrs) exchanges the inputs, guesses those that are late, and says what to play again. This
//! module adds what it lacks:
//!
//! - [`Driver`] does what a GGRS session of any kind asks for, and keeps the recent states and the replay. With your own
//!   session and sockets it is all that you need.
//! - [`Peer`] is a whole participant. It compares [`Terms`] before the first tick, seats players who come later, lets
//!   all agree on when somebody left, compares states, and knows how fast to play. It brings its own GGRS sessions.
//! - [`Transport`] carries packets: [`Udp`], a [`Network`] in memory for tests, or yours.
//!
//! Nothing here reads a clock: the time is passed to [`Peer::update`]. GGRS does read it, for its timeouts.
//!
//! `docs/MULTIPLAYER.md` tells how matches go, and what to do in the face of a divergence.
//!
//! ```no_run
//! # use lockstep2d::lockstep::Game;
//! # use lockstep2d::net::{NetError, NetGame, Options, Peer, Udp};
//! # fn read_pad<G: NetGame>() -> G::Input { G::Input::default() }
//! # fn draw<G: NetGame>(_: &G) {}
//! # fn play<MyGame: NetGame>(setup: &MyGame::Setup) -> Result<(), Box<dyn std::error::Error>> {
//! let mut peer = Peer::<MyGame, _, _>::host(setup, Options::rollback(), Udp::bind("0.0.0.0:7000")?)?;
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
mod gate;
mod options;
mod packet;
mod peer;
mod presence;
mod session;
mod terms;
mod transport;
mod weather;
mod wire;

pub use driver::{Divergence, Driver};
pub use error::DriverError;
pub use options::{INPUT_DELAY_MAX, Mode, Options};
pub use peer::{Event, NetError, Peer};
pub use terms::{Terms, TermsDifference, TermsMismatch};
pub use transport::{PACKET_BYTES_MAX, Transport, Udp};
pub use weather::{Network, Port, Weather};
pub use wire::{Address, Echo, GgrsConfig, NetGame, Wire};
