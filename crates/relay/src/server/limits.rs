//! [`Limits`]: bounds of memory and traffic.

use core::time::Duration;

/// Limits of a relay. Waiting datagrams take at most `connections` times `queue_bytes` bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of connections.
    pub connections: usize,
    /// Largest number of rooms.
    pub rooms: usize,
    /// Largest number of members of a room.
    pub members: usize,
    /// Largest datagram in bytes. A larger datagram closes the connection.
    pub datagram_bytes: usize,
    /// Maximum memory in bytes of the datagrams queued for a member, including 80 bytes of overhead for each. If they
    /// exceed this limit, the oldest are dropped.
    pub queue_bytes: usize,
    /// Maximum mean number of bytes per second from a member. A burst may have as many bytes as this rate allows in a
    /// second. Datagrams above the rate are dropped. The connection is closed at eight times the rate; this check also
    /// counts fragments and pings.
    pub bytes_per_second: u32,
    /// Maximum mean number of datagrams per second from a member. A burst may have as many datagrams as this rate
    /// allows in a second. Datagrams above the rate are dropped. At eight times the rate, the connection is closed.
    pub datagrams_per_second: u32,
    /// A member that sends nothing for this time is disconnected. In the meantime, it is pinged three times.
    pub idle: Duration,
    /// Origins of web pages that may connect. If empty, all pages may connect. Clients without an origin, such as
    /// native programs, may always connect.
    pub origins: Vec<String>,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            connections: 4096,
            rooms: 1024,
            members: 64,
            datagram_bytes: 4096,
            queue_bytes: 512 * 1024,
            bytes_per_second: 2_000_000,
            datagrams_per_second: 4000,
            idle: Duration::from_secs(30),
            origins: Vec::new(),
        }
    }
}
