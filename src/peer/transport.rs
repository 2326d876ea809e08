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
mod udp {
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

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn an_address_has_one_form() {
            let plain: SocketAddr = "10.1.2.3:7000".parse().unwrap();
            let mapped: SocketAddr = "[::ffff:10.1.2.3]:7000".parse().unwrap();
            assert_eq!(socket_address(plain), socket_address(mapped));
            for address in ["10.1.2.3:7000", "[2001:db8::1]:9", "[fe80::1%3]:9", "[fe80::1]:9"] {
                let address: SocketAddr = address.parse().unwrap();
                assert_eq!(to_socket(&socket_address(address)), Some(address));
            }
            assert_eq!(to_socket(&Address::new(&[1, 2, 3]).unwrap()), None);
        }

        #[test]
        fn sockets_of_both_families_reach_each_other() {
            let mut v4 = Udp::bind("127.0.0.1:0").unwrap();
            let Ok(mut v6) = Udp::bind("[::]:0") else { return };
            let port = v6.local_address().unwrap().port();
            let to = socket_address(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
            v4.send(&[1, 2, 3], &to);
            let mut received = None;
            for _ in 0..1000 {
                received = v6.receive();
                if received.is_some() {
                    break;
                }
                std::thread::sleep(core::time::Duration::from_millis(1));
            }
            let own = socket_address(v4.local_address().unwrap());
            assert_eq!(received, Some((own, vec![1, 2, 3])));
        }
    }
}
