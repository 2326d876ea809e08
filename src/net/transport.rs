//! [`Transport`]: sends and receives packets. Implementations are [`Udp`] and, for tests, [`Network`](super::Network).

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use std::io;
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};

/// Maximum length of a packet in bytes. Only games with long inputs come near: GGRS sends all unacknowledged inputs in
/// one message.
pub const PACKET_BYTES_MAX: usize = 16 << 10;
/// Maximum length of packets composed by this crate, in bytes: most networks pass it without fragmentation.
pub(super) const PACKET_BYTES_AIM: usize = 1200;

/// Carries packets between peers. Packets may be lost, duplicated, delayed and reordered, and may come from anybody.
pub trait Transport<A> {
    /// Sends a packet of at most [`PACKET_BYTES_MAX`] bytes, or drops it.
    fn send(&mut self, packet: &[u8], to: &A);

    /// The next received packet and its sender. Does not block.
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
    /// Errors of the operating system.
    pub fn bind(address: impl ToSocketAddrs) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        socket.set_nonblocking(true)?;
        Ok(Udp { socket, buffer: vec![0; PACKET_BYTES_MAX] })
    }

    /// The local address of the socket.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn local_address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }
}

impl Transport<SocketAddr> for Udp {
    fn send(&mut self, packet: &[u8], to: &SocketAddr) {
        // A packet that cannot be sent counts as lost, and lost packets are retransmitted.
        let _ = self.socket.send_to(packet, to);
    }

    fn receive(&mut self) -> Option<(SocketAddr, Vec<u8>)> {
        loop {
            match self.socket.recv_from(&mut self.buffer) {
                Ok((length, from)) => return Some((from, self.buffer.get(..length)?.to_vec())),
                // An earlier packet was not delivered. More received packets may be waiting.
                Err(error) if error.kind() == io::ErrorKind::ConnectionReset => {}
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(_) => return None,
            }
        }
    }
}
