use core::fmt;

use super::bytes::{Decoded, Malformed, Reader};

/// Largest length of an address in bytes.
pub const ADDRESS_BYTES_MAX: usize = 32;

/// An address of a transport, such as an IP address with a port. Addresses are compared as bytes, so the transport must
/// always encode an address in the same form. An IPv4 address and its mapped form in IPv6 are different addresses.
///
/// ```
/// use lockstep2d::session::{ADDRESS_BYTES_MAX, Address};
/// // A custom transport over a chat service, which identifies players by numbers.
/// let player = 76_561_197_960_287_930_u64;
/// let address = Address::new(&player.to_le_bytes()).expect("eight bytes");
/// assert_eq!(address.bytes(), player.to_le_bytes());
/// assert_eq!(Address::new(&[0; ADDRESS_BYTES_MAX + 1]), None);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Address {
    length: u8,
    bytes: [u8; ADDRESS_BYTES_MAX],
}

impl Address {
    /// The address with these bytes; `None` if there are more than [`ADDRESS_BYTES_MAX`].
    #[must_use]
    pub fn new(bytes: &[u8]) -> Option<Self> {
        let length = u8::try_from(bytes.len()).ok()?;
        let mut address = Address { length, bytes: [0; ADDRESS_BYTES_MAX] };
        address.bytes.get_mut(..bytes.len())?.copy_from_slice(bytes);
        Some(address)
    }

    /// An address that reaches no peer.
    #[must_use]
    pub const fn nowhere() -> Self {
        Address { length: 0, bytes: [0; ADDRESS_BYTES_MAX] }
    }

    /// The bytes of the address.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.length)).unwrap_or_default()
    }

    pub(super) fn write(&self, bytes: &mut alloc::vec::Vec<u8>) {
        bytes.push(self.length);
        bytes.extend_from_slice(self.bytes());
    }

    pub(super) fn read(reader: &mut Reader) -> Decoded<Self> {
        let length = usize::from(reader.u8()?);
        Address::new(reader.take(length)?).ok_or(Malformed)
    }
}

impl fmt::Debug for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.bytes().iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
