//! Reading and writing the fields of packets: little-endian numbers and LEB128.

use alloc::vec::Vec;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Malformed;

pub(super) type Decoded<T> = Result<T, Malformed>;

/// Reads fields from a slice. Reading a length allocates nothing, so a forged length cannot exhaust the memory.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Reader { rest: bytes }
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    pub(super) fn take(&mut self, count: usize) -> Decoded<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(Malformed)?;
        self.rest = rest;
        Ok(taken)
    }

    pub(super) fn rest(&mut self) -> &'a [u8] {
        core::mem::take(&mut self.rest)
    }

    fn array<const N: usize>(&mut self) -> Decoded<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk::<N>().ok_or(Malformed)?;
        self.rest = rest;
        Ok(*taken)
    }

    pub(super) fn u8(&mut self) -> Decoded<u8> {
        self.array().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Decoded<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Decoded<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Decoded<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn u128(&mut self) -> Decoded<u128> {
        self.array().map(u128::from_le_bytes)
    }

    /// A LEB128 number of at most 64 bits in its shortest form.
    pub(super) fn var64(&mut self) -> Decoded<u64> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.u8()?;
            let part = u64::from(byte & 0x7f);
            if part << shift >> shift != part || byte == 0 && shift > 0 {
                return Err(Malformed);
            }
            value |= part << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(Malformed)
    }

    pub(super) fn var(&mut self) -> Decoded<u32> {
        u32::try_from(self.var64()?).map_err(|_| Malformed)
    }

    pub(super) fn near(&mut self, base: u32) -> Decoded<u32> {
        let coded = self.var64()?;
        let size = i64::try_from(coded >> 1).map_err(|_| Malformed)?;
        let difference = if coded & 1 == 0 { size } else { -1 - size };
        let value = i64::from(base).checked_add(difference).ok_or(Malformed)?;
        u32::try_from(value).map_err(|_| Malformed)
    }

    pub(super) fn count(&mut self, most: usize) -> Decoded<usize> {
        let count = usize::try_from(self.var()?).map_err(|_| Malformed)?;
        if count <= most { Ok(count) } else { Err(Malformed) }
    }
}

pub(super) trait Write {
    fn put_u16(&mut self, value: u16);
    fn put_u32(&mut self, value: u32);
    fn put_u64(&mut self, value: u64);
    fn put_u128(&mut self, value: u128);
    fn put_var64(&mut self, value: u64);
    fn put_var(&mut self, value: u32) {
        self.put_var64(u64::from(value));
    }
    /// Writes `value - base` as a zigzag LEB128 number: the lowest bit is the sign.
    fn put_near(&mut self, value: u32, base: u32) {
        let above = u64::from(value.saturating_sub(base));
        let below = u64::from(base.saturating_sub(value));
        self.put_var64(if below == 0 { above << 1 } else { (below - 1) << 1 | 1 });
    }
    fn put_count(&mut self, count: usize) {
        self.put_var64(u64::try_from(count).unwrap_or(u64::MAX));
    }
}

impl Write for Vec<u8> {
    fn put_u16(&mut self, value: u16) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn put_u32(&mut self, value: u32) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn put_u64(&mut self, value: u64) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn put_u128(&mut self, value: u128) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn put_var64(&mut self, mut value: u64) {
        while value >= 0x80 {
            let [low, ..] = value.to_le_bytes();
            self.push(low | 0x80);
            value >>= 7;
        }
        let [low, ..] = value.to_le_bytes();
        self.push(low);
    }
}
