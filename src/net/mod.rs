//! Multiplayer.
mod driver;
mod gate;
mod options;
mod packet;
mod peer;
mod session;
mod terms;
mod transport;
mod weather;
mod wire;

pub use driver::{Divergence, Driver, DriverError};
pub use options::{INPUT_DELAY_MAX, Mode, Options};
pub use peer::{Event, NetError, Peer};
pub use terms::{Terms, TermsDifference, TermsMismatch};
pub use transport::{PACKET_BYTES_MAX, Transport, Udp};
pub use weather::{Network, Port, Weather};
pub use wire::{Address, Echo, GgrsConfig, NetGame, Wire};
