//! The protocol of a match between peers, without sockets, clocks or threads. The caller passes the time and the
//! received packets, and sends the returned packets.
//!
//! Peers exchange inputs and short status records (rows). A peer that joins receives a state of the game. The
//! [`Session`]s of all peers agree on which peer plays which seat in which ticks, which inputs are final, and at which
//! tick the match ends.
//!
//! - [`Session`]: takes packets and local inputs, returns packets, [`Request`]s to the game, and [`Event`]s.
//! - [`Endpoint`]: a session with addresses. It opens or joins a match and sends states to peers that join.
//! - [`View`]: the seats, players and voters of a match. Views change by agreement of a majority.
//! - [`Config`]: the parameters of a match and of a peer. With a [`Config::guess`] of 0, the peer plays in lockstep.
//!
//! `docs/PROTOCOL.md` has the rules, the packets byte by byte, and the invariants that simulations check.

mod address;
mod agreement;
mod bytes;
mod config;
mod congestion;
mod contacts;
mod endpoint;
mod endpoint_receive;
mod event;
mod guests;
mod id;
mod input_log;
mod join_packet;
mod lifecycle;
mod link;
mod pace;
mod packet;
mod peers;
mod phase;
mod play;
mod progress;
mod proposal;
mod receive;
mod request;
mod routes;
mod row;
mod runs;
mod siphash;
mod start_state;
mod state;
#[cfg(test)]
mod tests;
mod transfer;
mod transmit;
mod view;
mod wire_row;

pub use address::{ADDRESS_BYTES_MAX, Address};
#[doc(hidden)]
pub use config::Fault;
pub use config::{Config, ConfigError, DELAY_MAX, GUESS_MAX, INPUT_BYTES_MAX, Timing};
pub use endpoint::{Endpoint, Identity, JoinEvent, STATE_BYTES_MAX};
pub use event::{Event, Status};
pub use guests::GUESTS_MAX;
pub use id::{Key, NEVER, PeerId, Tick};
pub use join_packet::{OFFER_BYTES_MAX, RefusalReason};
pub use link::Link;
pub use packet::PACKET_BYTES_MAX;
pub use play::Statistics;
pub use request::{InputSize, InputStatus, Request, TickInputs};
pub use state::{Role, Session};
pub use view::{SEATS_MAX, SPANS_MAX, Span, View, Voter};
