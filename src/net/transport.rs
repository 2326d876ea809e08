//! [`Transport`]: packets out and in. [`Udp`] is one, [`Network`](super::Network) another for tests.

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use std::io;
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};

/// Longest packet, in bytes. Only a game with long inputs comes near: GGRS sends all those that were not acknowledged in
/// one message.
pub const PACKET_BYTES_MAX: usize = 16 << 10;
/// What passes through most networks in one piece: packets of our own making are no longer.
pub(super) const PACKET_BYTES_AIM: usize = 1200;

/// Carries packets between peers: it may lose, double, delay and reorder them, and anybody may send some.
pub trait Transport<A> {
    /// Sends a packet of at most [`PACKET_BYTES_MAX`] bytes, or does not.
    fn send(&mut self, packet: &[u8], to: &A);

    /// The next packet that has come, and from where. Does not wait.
    fn receive(&mut self) -> Option<(A, Vec<u8>)>;
}

/// A UDP socket.
pub struct Udp {
    socket: UdpSocket,
    buffer: Vec<u8>,
}

impl fmt::Debug for Udp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.socket.fmt(f)
    }
}

impl Udp {
    /// Opens a socket; port 0 lets the system choose one.
    ///
    /// # Errors
    /// Whatever the system has against it.
    pub fn bind(address: impl ToSocketAddrs) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        socket.set_nonblocking(true)?;
        Ok(Udp { socket, buffer: vec![0; PACKET_BYTES_MAX] })
    }

    /// Where it is bound.
    ///
    /// # Errors
    /// Whatever the system says.
    pub fn local_address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }
}

impl Transport<SocketAddr> for Udp {
    fn send(&mut self, packet: &[u8], to: &SocketAddr) {
        // A packet that is not sent is a lost packet, and those are sent again.
        let _ = self.socket.send_to(packet, to);
    }

    fn receive(&mut self) -> Option<(SocketAddr, Vec<u8>)> {
        loop {
            match self.socket.recv_from(&mut self.buffer) {
                Ok((length, from)) => return Some((from, self.buffer.get(..length)?.to_vec())),
                // An earlier packet did not arrive: not the end of what is there.
                Err(error) if error.kind() == io::ErrorKind::ConnectionReset => {}
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(_) => return None,
            }
        }
    }
}
