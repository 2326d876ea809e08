//! Little-endian integers in a buffer that is reused: records of a fixed size, written and read in order.

use alloc::vec::Vec;

/// An integer of a fixed number of bytes.
pub(super) trait Integer: Copy {
    type Bytes: AsRef<[u8]>;
    fn to_bytes(self) -> Self::Bytes;
    /// Of as many bytes.
    fn of_slice(bytes: &[u8]) -> Self;
}

macro_rules! integers {
    ($($integer:ty)*) => {
        $(impl Integer for $integer {
            type Bytes = [u8; size_of::<$integer>()];
            #[inline(always)]
            fn to_bytes(self) -> Self::Bytes {
                self.to_le_bytes()
            }
            #[inline(always)]
            fn of_slice(bytes: &[u8]) -> Self {
                <$integer>::from_le_bytes(bytes.try_into().expect("as many bytes"))
            }
        })*
    };
}

integers!(u8 u16 u32 u64 i32 i64);

/// The lower 32 bits.
#[expect(clippy::cast_possible_truncation, reason = "the upper half is looked at or kept by the caller")]
#[inline(always)]
pub(super) fn low_half(integer: i64) -> i32 {
    integer as i32
}

/// A record of `N` bytes that is being written.
pub(super) struct Record<'a, const N: usize> {
    bytes: &'a mut [u8; N],
    len: usize,
}

impl<'a, const N: usize> Record<'a, N> {
    pub(super) fn new(bytes: &'a mut [u8; N]) -> Self {
        Record { bytes, len: 0 }
    }

    #[inline(always)]
    pub(super) fn put<I: Integer>(&mut self, integer: I) {
        let bytes = integer.to_bytes();
        let bytes = bytes.as_ref();
        self.bytes[self.len..self.len + bytes.len()].copy_from_slice(bytes);
        self.len += bytes.len();
    }

    /// What has been put.
    pub(super) fn written(&self) -> &[u8] {
        &self.bytes[..self.len]
    }

    /// Takes back what has been put after so many bytes.
    #[inline(always)]
    pub(super) fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }
}

/// Replaces what is in a buffer by a record for each of so many things. With their number known before, that takes less
/// than a [`Writer`].
#[inline(always)]
pub(super) fn put_records<T, const N: usize>(
    bytes: &mut Vec<u8>,
    count: usize,
    things: impl IntoIterator<Item = T>,
    mut put: impl FnMut(T, &mut Record<'_, N>),
) {
    bytes.resize(count * N, 0);
    for (thing, bytes) in things.into_iter().zip(bytes.chunks_exact_mut(N)) {
        put(thing, &mut Record::new(bytes.try_into().expect("as many bytes")));
    }
}

/// Writes records one after the other into a buffer, however many there will be. What was there is overwritten and not
/// cleared before, so that a buffer that is written again and again is only as much work as what is written.
pub(super) struct Writer<'a> {
    bytes: &'a mut Vec<u8>,
    len: usize,
}

impl<'a> Writer<'a> {
    /// Expects so many bytes.
    pub(super) fn new(bytes: &'a mut Vec<u8>, size: usize) -> Self {
        bytes.reserve(size.saturating_sub(bytes.len()));
        Writer { bytes, len: 0 }
    }

    /// The next record: as many bytes of it are kept as are put.
    #[inline(always)]
    pub(super) fn record<const N: usize>(&mut self, write: impl FnOnce(&mut Record<'_, N>)) {
        if self.bytes.len() < self.len + N {
            self.grow(N);
        }
        let bytes = self.bytes[self.len..].first_chunk_mut().expect("room for every record");
        let mut record = Record::new(bytes);
        write(&mut record);
        self.len += record.len;
    }

    #[cold]
    fn grow(&mut self, record: usize) {
        self.bytes.resize(self.len + record + self.len / 4 + 1024, 0);
    }
}

impl Drop for Writer<'_> {
    fn drop(&mut self) {
        self.bytes.truncate(self.len);
    }
}

/// What is left to be read. Behind the end, which nobody comes to with a buffer of our own, there are zeros.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl<'a> Reader<'a> {
    /// The next record.
    #[inline(always)]
    pub(super) fn record<const N: usize>(&mut self) -> Fields<'a, N> {
        let Some((bytes, rest)) = self.0.split_first_chunk() else {
            debug_assert!(false, "read past the end");
            return Fields { bytes: &[0; N], len: 0 };
        };
        self.0 = rest;
        Fields { bytes, len: 0 }
    }

    /// The next bytes for themselves.
    pub(super) fn part(&mut self, length: usize) -> Reader<'a> {
        let (part, rest) = self.0.split_at(length.min(self.0.len()));
        self.0 = rest;
        Reader(part)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// A record of `N` bytes that is being read.
pub(super) struct Fields<'a, const N: usize> {
    bytes: &'a [u8; N],
    len: usize,
}

impl<const N: usize> Fields<'_, N> {
    #[inline(always)]
    pub(super) fn take<I: Integer>(&mut self) -> I {
        let start = self.len;
        self.len += size_of::<I>();
        I::of_slice(&self.bytes[start..self.len])
    }
}
