//! Datagrams over UDP sockets.

#[cfg(test)]
mod tests;

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use core::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, SocketAddrV6};
use std::io;
use std::net::{ToSocketAddrs, UdpSocket};

use super::Transport;
use crate::session::Address;

/// Largest datagram of UDP. If the buffer were shorter, a longer datagram would give an error on Windows, and
/// `receive` could not tell it from a failure of the socket.
const DATAGRAM_MAX: usize = 1 << 16;

/// A UDP socket.
///
/// ```
/// use lockstep2d::peer::{Transport, Udp, socket_address};
/// // Two sockets of one machine.
/// let (mut host, mut guest) = (Udp::bind("127.0.0.1:0")?, Udp::bind("127.0.0.1:0")?);
/// let address = socket_address(host.local_address()?);
/// guest.send(b"hello", &address);
/// let received = (0..1000).find_map(|_| {
///     std::thread::sleep(std::time::Duration::from_millis(1));
///     host.receive()
/// });
/// assert_eq!(received, Some((socket_address(guest.local_address()?), b"hello".to_vec())));
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Udp {
    socket: UdpSocket,
    buffer: Vec<u8>,
    is_v6: bool,
}

impl fmt::Debug for Udp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.socket.fmt(f)
    }
}

/// The [`Address`] of a socket. IPv4 addresses mapped to IPv6 become IPv4 addresses. Link-local addresses keep
/// their scope, the number of a network interface of this machine.
#[must_use]
pub fn socket_address(address: SocketAddr) -> Address {
    let port = address.port().to_le_bytes();
    let bytes = match (address.ip().to_canonical(), address) {
        (IpAddr::V4(ip), _) => [&ip.octets()[..], &port].concat(),
        (IpAddr::V6(ip), SocketAddr::V6(scoped)) if ip.is_unicast_link_local() => {
            [&ip.octets()[..], &scoped.scope_id().to_le_bytes(), &port].concat()
        }
        (IpAddr::V6(ip), _) => [&ip.octets()[..], &port].concat(),
    };
    Address::new(&bytes).unwrap_or_else(Address::nowhere)
}

fn to_socket(address: &Address) -> Option<SocketAddr> {
    let (ip, port) = address.bytes().split_last_chunk::<2>()?;
    let port = u16::from_le_bytes(*port);
    if let Ok(ip) = <[u8; 4]>::try_from(ip) {
        return Some((Ipv4Addr::from(ip), port).into());
    }
    let (ip, scope) = ip.split_first_chunk::<16>()?;
    let scope = if scope.is_empty() { 0 } else { u32::from_le_bytes(scope.try_into().ok()?) };
    Some(SocketAddrV6::new(Ipv6Addr::from(*ip), port, 0, scope).into())
}

impl Udp {
    /// Opens a socket. Port 0 lets the system choose one.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn bind(address: impl ToSocketAddrs) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        socket.set_nonblocking(true)?;
        let is_v6 = socket.local_addr()?.is_ipv6();
        Ok(Udp { socket, buffer: vec![0; DATAGRAM_MAX], is_v6 })
    }

    /// The local address of the socket.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn local_address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }
}

impl Transport for Udp {
    fn send(&mut self, packet: &[u8], to: &Address) {
        let Some(mut to) = to_socket(to) else { return };
        // An IPv6 socket reaches IPv4 addresses in their mapped form.
        if let (true, IpAddr::V4(ip)) = (self.is_v6, to.ip()) {
            to.set_ip(IpAddr::V6(ip.to_ipv6_mapped()));
        }
        let _ = self.socket.send_to(packet, to);
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        loop {
            match self.socket.recv_from(&mut self.buffer) {
                Ok((length, from)) => {
                    return Some((socket_address(from), self.buffer.get(..length)?.to_vec()));
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return None,
                // The errors `ConnectionReset` and `ConnectionRefused` report, at the next call, that an earlier
                // packet could not be delivered to its receiver.
                Err(error)
                    if matches!(
                        error.kind(),
                        io::ErrorKind::ConnectionReset
                            | io::ErrorKind::ConnectionRefused
                            | io::ErrorKind::Interrupted
                    ) => {}
                Err(_) => return None,
            }
        }
    }
}
