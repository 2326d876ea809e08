//! [`Limits`]: bounds of memory and traffic.

use core::time::Duration;

/// Limits of a relay. Waiting frames take at most `connections` times `queue_bytes` bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of connections.
    pub connections: usize,
    /// Largest number of rooms.
    pub rooms: usize,
    /// Largest number of members of a room.
    pub members: usize,
    /// Largest datagram in bytes. A larger one closes the connection.
    pub datagram_bytes: usize,
    /// Bytes that may wait for a member. Beyond them, the oldest datagrams are dropped.
    pub queue_bytes: usize,
    /// Bytes per second from a member, with bursts of one second. Further datagrams are dropped, and eight times as
    /// many bytes close the connection.
    pub bytes_per_second: u32,
    /// Datagrams per second from a member, with bursts of one second. Further ones are dropped, and eight times as many
    /// close the connection.
    pub datagrams_per_second: u32,
    /// Silence after which a member, pinged three times meanwhile, is disconnected.
    pub idle: Duration,
    /// Origins of web pages that may connect; empty for all. Clients without an origin, such as native ones, are
    /// admitted.
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
