//! Frames between client and server.

use serde::{Deserialize, Serialize};

/// Length of the address of a member in bytes.
pub const ADDRESS_BYTES: usize = 8;

/// Length in bytes of the secret that a client sends first.
pub(crate) const SECRET_BYTES: usize = 16;

/// Address of a member of a room.
pub(crate) type Member = [u8; ADDRESS_BYTES];

/// Encodes a frame: an address and a datagram. In a frame to the relay, the address is that of the receiver. In a frame
/// from the relay, it is that of the sender.
pub(crate) fn frame(member: Member, datagram: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(ADDRESS_BYTES + datagram.len());
    bytes.extend_from_slice(&member);
    bytes.extend_from_slice(datagram);
    bytes
}

pub(crate) fn unframe(bytes: &[u8]) -> Option<(Member, &[u8])> {
    bytes.split_first_chunk::<ADDRESS_BYTES>().map(|(member, datagram)| (*member, datagram))
}

/// Contents of the text frame with the members of the room. It is sent at the beginning and after every change.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Members {
    /// Address of the member that receives this frame.
    pub(crate) you: String,
    /// Addresses of the other members, in order of arrival.
    pub(crate) others: Vec<String>,
}

/// An address as hexadecimal digits.
#[cfg(feature = "server")]
pub(crate) fn to_text(member: Member) -> String {
    format!("{:016x}", u64::from_be_bytes(member))
}

pub(crate) fn of_text(text: &str) -> Option<Member> {
    if text.len() != 2 * ADDRESS_BYTES {
        return None;
    }
    u64::from_str_radix(text, 16).ok().map(u64::to_be_bytes)
}

#[cfg(all(test, feature = "server"))]
mod tests {
    use super::*;

    #[test]
    fn addresses_survive_as_text() {
        let member = [0, 1, 2, 3, 4, 5, 6, 255];
        assert_eq!(to_text(member), "00010203040506ff");
        assert_eq!(of_text("00010203040506ff"), Some(member));
        assert_eq!(of_text("00010203040506f"), None);
        assert_eq!(of_text("zz010203040506ff"), None);
    }

    #[test]
    fn a_frame_is_an_address_and_a_datagram() {
        let member = [7; ADDRESS_BYTES];
        assert_eq!(unframe(&frame(member, b"hello")), Some((member, &b"hello"[..])));
        assert_eq!(unframe(&[1, 2, 3]), None);
    }
}
