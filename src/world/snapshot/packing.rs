//! Records of little-endian integers in reused buffers, written and read in order.

use alloc::vec::Vec;

pub(super) trait Integer: Copy {
    type Bytes: AsRef<[u8]>;
    fn to_bytes(self) -> Self::Bytes;
    /// Reads an integer from its little-endian bytes, whose number must be the size of the integer.
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

integers!(u8 u16 u32 u64 i16 i32 i64);

#[expect(clippy::cast_possible_truncation, reason = "the caller checks or keeps the high half")]
#[inline(always)]
pub(super) fn low_half(integer: i64) -> i32 {
    integer as i32
}

/// A record of up to `N` bytes that is being written. Its first `len` bytes are already written.
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

    pub(super) fn written(&self) -> &[u8] {
        &self.bytes[..self.len]
    }

    #[inline(always)]
    pub(super) fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }
}

/// Replaces the content of `bytes` by `count` records of `N` bytes, one for each of `things`. Faster than a [`Writer`],
/// because the size is known.
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

/// Replaces the content of a buffer by records whose total size is not known in advance. Overwrites the old content
/// without clearing it first, so that the cost depends only on the bytes written.
pub(super) struct Writer<'a> {
    bytes: &'a mut Vec<u8>,
    len: usize,
}

impl<'a> Writer<'a> {
    /// Starts at the beginning of the buffer. Reserves memory for `size` bytes in total.
    pub(super) fn new(bytes: &'a mut Vec<u8>, size: usize) -> Self {
        bytes.reserve(size.saturating_sub(bytes.len()));
        Writer { bytes, len: 0 }
    }

    /// Appends a record of at most `N` bytes, which `write` fills.
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

/// The unread rest of a buffer. Reading a record past the end is a bug: debug builds panic, others read zeros.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl<'a> Reader<'a> {
    #[inline(always)]
    pub(super) fn record<const N: usize>(&mut self) -> Fields<'a, N> {
        let Some((bytes, rest)) = self.0.split_first_chunk() else {
            debug_assert!(false, "read past the end");
            return Fields { bytes: &[0; N], len: 0 };
        };
        self.0 = rest;
        Fields { bytes, len: 0 }
    }

    pub(super) fn part(&mut self, length: usize) -> Reader<'a> {
        let (part, rest) = self.0.split_at(length.min(self.0.len()));
        self.0 = rest;
        Reader(part)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// A record of `N` bytes that is being read. Its first `len` bytes are already read.
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
