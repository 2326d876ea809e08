//! [`Limits`]: bounds of memory and traffic.

use core::time::Duration;

/// Limits of a relay. The frames that wait for members contain at most `connections` times `queue_bytes` bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of connections at the same time.
    pub connections: usize,
    /// Largest number of rooms at the same time.
    pub rooms: usize,
    /// Largest number of members of a room.
    pub members: usize,
    /// Largest datagram in bytes. A larger one closes the connection.
    pub datagram_bytes: usize,
    /// Largest number of bytes that wait for one member. When there are more, the oldest datagrams are dropped.
    pub queue_bytes: usize,
    /// Largest number of bytes per second from one member, with bursts of one second. Datagrams above this rate are
    /// dropped; a member that sends eight times as much is disconnected.
    pub bytes_per_second: u32,
    /// Largest number of datagrams per second from one member, with bursts of one second. Datagrams above this rate are
    /// dropped; a member that sends eight times as many is disconnected.
    pub datagrams_per_second: u32,
    /// Time without any frame after which a member is disconnected. The member is pinged three times within this time.
    pub idle: Duration,
    /// Origins of web pages that may connect. Empty: all. Clients that send no origin, as native ones do, are admitted.
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
