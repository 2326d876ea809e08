use alloc::vec::Vec;

use crate::session::Address;

/// Carries packets between peers. Packets may be lost, duplicated, delayed and reordered, and come from anybody.
///
/// ```
/// use lockstep2d::{peer::Transport, session::Address};
/// use std::collections::VecDeque;
///
/// /// A custom transport, which returns every sent packet to its sender.
/// struct Echo(VecDeque<(Address, Vec<u8>)>);
///
/// impl Transport for Echo {
///     fn send(&mut self, packet: &[u8], to: &Address) {
///         self.0.push_back((to.clone(), packet.to_vec()));
///     }
///
///     fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
///         self.0.pop_front()
///     }
/// }
/// ```
pub trait Transport {
    /// Sends a packet of at most [`PACKET_BYTES_MAX`](crate::session::PACKET_BYTES_MAX) bytes, or drops it. Inside of
    /// `Sealed`, packets are 32 bytes longer.
    fn send(&mut self, packet: &[u8], to: &Address);

    /// The next received packet and its sender. Does not block.
    fn receive(&mut self) -> Option<(Address, Vec<u8>)>;
}

#[cfg(feature = "std")]
pub use udp::{Udp, socket_address};

#[cfg(feature = "std")]
mod udp;
