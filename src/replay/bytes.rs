//! Encoding of the format's numbers: little-endian with a fixed length, or LEB128.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use super::flaw::Flaw;
use super::reader::ReadError;

#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    rest: &'a [u8],
    offset: u64,
}

impl<'a> Cursor<'a> {
    /// Creates a cursor over `bytes`, the part of the file that begins at `offset`.
    pub(super) fn new(bytes: &'a [u8], offset: u64) -> Self {
        Cursor { rest: bytes, offset }
    }

    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        self.offset += count as u64;
        Some(taken)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        self.offset += N as u64;
        Some(*taken)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn u128(&mut self) -> Option<u128> {
        self.array().map(u128::from_le_bytes)
    }

    pub(super) fn i64(&mut self) -> Option<i64> {
        self.array().map(i64::from_le_bytes)
    }

    /// Reads a LEB128 number. Requires the shortest form, so that each log has only one encoding.
    pub(super) fn varint(&mut self) -> Result<u32, ReadError> {
        let start = self.offset;
        let mut value: u64 = 0;
        for shift in [0, 7, 14, 21, 28] {
            let [byte] = self.array().ok_or(ReadError::Malformed { offset: start, flaw: Flaw::BlockCut })?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                let is_shortest = byte != 0 || shift == 0;
                return match u32::try_from(value) {
                    Ok(value) if is_shortest => Ok(value),
                    _ => Err(ReadError::Malformed { offset: start, flaw: Flaw::Number }),
                };
            }
        }
        Err(ReadError::Malformed { offset: start, flaw: Flaw::Number })
    }
}

pub(super) fn put_varint(mut value: u32, bytes: &mut Vec<u8>) {
    loop {
        let [low, ..] = (value & 0x7f).to_le_bytes();
        value >>= 7;
        if value == 0 {
            bytes.push(low);
            return;
        }
        bytes.push(low | 0x80);
    }
}
