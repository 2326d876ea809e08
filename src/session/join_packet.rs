//! Packets for joining, transfer of states, and discovery of addresses.

use alloc::vec::Vec;

use super::address::Address;
use super::bytes::{Decoded, Malformed, Reader, Write};
use super::id::{Key, PeerId, Tick};
use super::packet::{PACKET_BYTES_MAX, checksum};

/// Maximum length in bytes of an offer, the data that must be equal for all peers of a match
/// ([`Identity::offer`](super::Identity::offer)).
pub const OFFER_BYTES_MAX: usize = 512;
/// Bytes of a state per packet.
pub(super) const CHUNK_BYTES: usize = 1152;
/// Maximum number of 64-bit words in the bit mask of received chunks.
pub(super) const MASKS_MAX: usize = 16;
pub(super) const ADDRESS_LIST_MAX: usize = 24;

/// Reason for which a contact (the peer that was asked) refuses a joining peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalReason {
    /// The offers differ: another game, setup or version.
    Offer,
    /// The maximum number of peers already join through this contact, or it already sends packets to the maximum number
    /// of peers.
    Full,
    /// The incarnation is that of the contact or of a voter of the match.
    Taken,
    /// The contact is not in a match yet.
    NotReady,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum JoinPacket {
    /// Asks to join. The cookie is 0 until a challenge has arrived.
    Hello {
        nonce: u64,
        key: Key,
        cookie: u64,
        offer: Vec<u8>,
    },
    /// Answers a hello with a cookie. The joining peer sends its next hello with this cookie, which proves that it
    /// receives packets at its address. The sender of a challenge stores nothing.
    Challenge {
        nonce: u64,
        cookie: u64,
    },
    Refused {
        nonce: u64,
        reason: RefusalReason,
        offer: Vec<u8>,
    },
    /// Announces the start state, which follows in chunks.
    Welcome {
        nonce: u64,
        tick: Tick,
        hash: u64,
        length: u64,
    },
    /// The joining peer has the chunks before `next`, and the later ones whose bit in `masks` is set. The contact may
    /// send up to `window` chunks from `next` on.
    Want {
        hash: u64,
        next: u32,
        window: u32,
        masks: Vec<u64>,
    },
    Chunk {
        hash: u64,
        index: u32,
        bytes: Vec<u8>,
    },
    /// Asks whether packets reach an address.
    Probe {
        token: u64,
    },
    /// Answers a probe with its token.
    Pong {
        token: u64,
    },
    AddressList {
        addresses: Vec<(PeerId, Address)>,
    },
}

/// Offset of the kind in a join packet. A match packet has its flags at this offset.
const KIND_AT: usize = 8;
/// Lowest kind of a join packet. All values of the flags of a match packet are lower.
const KIND_FIRST: u8 = 0x80;

pub(super) fn is_join_packet(bytes: &[u8]) -> bool {
    bytes.get(KIND_AT).is_some_and(|&kind| kind >= KIND_FIRST)
}

impl JoinPacket {
    pub(super) fn encode(&self, match_tag: u64, sender: PeerId) -> Vec<u8> {
        let mut body = Vec::new();
        body.put_u32(sender.0);
        match self {
            JoinPacket::Hello { nonce, key, cookie, offer } => {
                body.push(KIND_FIRST);
                body.put_u64(*nonce);
                body.put_u64(key.0);
                body.put_u64(*cookie);
                put_bytes(&mut body, offer);
            }
            JoinPacket::Challenge { nonce, cookie } => {
                body.push(KIND_FIRST + 1);
                body.put_u64(*nonce);
                body.put_u64(*cookie);
            }
            JoinPacket::Refused { nonce, reason, offer } => {
                body.push(KIND_FIRST + 2);
                body.put_u64(*nonce);
                body.push(match reason {
                    RefusalReason::Offer => 0,
                    RefusalReason::Full => 1,
                    RefusalReason::Taken => 2,
                    RefusalReason::NotReady => 3,
                });
                put_bytes(&mut body, offer);
            }
            JoinPacket::Welcome { nonce, tick, hash, length } => {
                body.push(KIND_FIRST + 3);
                body.put_u64(*nonce);
                body.put_u32(*tick);
                body.put_u64(*hash);
                body.put_var64(*length);
            }
            JoinPacket::Want { hash, next, window, masks } => {
                body.push(KIND_FIRST + 4);
                body.put_u64(*hash);
                body.put_var(*next);
                body.put_var(*window);
                body.put_count(masks.len());
                masks.iter().for_each(|&mask| body.put_u64(mask));
            }
            JoinPacket::Chunk { hash, index, bytes } => {
                body.push(KIND_FIRST + 5);
                body.put_u64(*hash);
                body.put_var(*index);
                body.extend_from_slice(bytes);
            }
            JoinPacket::Probe { token } => {
                body.push(KIND_FIRST + 6);
                body.put_u64(*token);
            }
            JoinPacket::Pong { token } => {
                body.push(KIND_FIRST + 7);
                body.put_u64(*token);
            }
            JoinPacket::AddressList { addresses } => {
                body.push(KIND_FIRST + 8);
                body.put_count(addresses.len());
                for (id, address) in addresses {
                    body.put_u32(id.0);
                    address.write(&mut body);
                }
            }
        }
        let mut bytes = checksum(match_tag, &body).to_vec();
        bytes.extend_from_slice(&body);
        bytes
    }

    pub(super) fn read(body: &[u8]) -> Decoded<(PeerId, JoinPacket)> {
        let reader = &mut Reader::new(body);
        let sender = PeerId(reader.u32()?);
        let packet = match reader.u8()?.checked_sub(KIND_FIRST).ok_or(Malformed)? {
            0 => JoinPacket::Hello {
                nonce: reader.u64()?,
                key: Key(reader.u64()?),
                cookie: reader.u64()?,
                offer: read_bytes(reader)?,
            },
            1 => JoinPacket::Challenge { nonce: reader.u64()?, cookie: reader.u64()? },
            2 => JoinPacket::Refused {
                nonce: reader.u64()?,
                reason: match reader.u8()? {
                    0 => RefusalReason::Offer,
                    1 => RefusalReason::Full,
                    2 => RefusalReason::Taken,
                    3 => RefusalReason::NotReady,
                    _ => return Err(Malformed),
                },
                offer: read_bytes(reader)?,
            },
            3 => JoinPacket::Welcome {
                nonce: reader.u64()?,
                tick: reader.u32()?,
                hash: reader.u64()?,
                length: reader.var64()?,
            },
            4 => {
                let (hash, next, window) = (reader.u64()?, reader.var()?, reader.var()?);
                let count = reader.count(MASKS_MAX)?;
                let masks = (0..count).map(|_| reader.u64()).collect::<Decoded<_>>()?;
                JoinPacket::Want { hash, next, window, masks }
            }
            5 => {
                JoinPacket::Chunk { hash: reader.u64()?, index: reader.var()?, bytes: reader.rest().to_vec() }
            }
            6 => JoinPacket::Probe { token: reader.u64()? },
            7 => JoinPacket::Pong { token: reader.u64()? },
            8 => {
                let count = reader.count(ADDRESS_LIST_MAX)?;
                let address = |reader: &mut Reader| Ok((PeerId(reader.u32()?), Address::read(reader)?));
                JoinPacket::AddressList {
                    addresses: (0..count).map(|_| address(reader)).collect::<Decoded<_>>()?,
                }
            }
            _ => return Err(Malformed),
        };
        if reader.is_empty() { Ok((sender, packet)) } else { Err(Malformed) }
    }
}

fn put_bytes(body: &mut Vec<u8>, bytes: &[u8]) {
    body.put_count(bytes.len());
    body.extend_from_slice(bytes);
}

fn read_bytes(reader: &mut Reader) -> Decoded<Vec<u8>> {
    let length = reader.count(OFFER_BYTES_MAX)?;
    Ok(reader.take(length)?.to_vec())
}

const _: () = assert!(CHUNK_BYTES + 32 <= PACKET_BYTES_MAX && OFFER_BYTES_MAX + 64 <= PACKET_BYTES_MAX);
const _: () = assert!(ADDRESS_LIST_MAX * (5 + super::address::ADDRESS_BYTES_MAX) + 32 <= PACKET_BYTES_MAX);
