//! Versions, errors, memory, bytes, and handles.

use std::cell::RefCell;

use crate::border::{In, Out};
use crate::describe::api;
use crate::status::{Failure, Status, last_text};
use crate::table::{self, Bytes};

/// Version of the flat API, increased by every incompatible change.
pub const API_VERSION: u32 = 1;

thread_local! {
    static SCRATCH: RefCell<Vec<u64>> = const { RefCell::new(Vec::new()) };
}

api! {
    /// Version of the API in the library. It has to equal `LS2D_API_VERSION` of the header.
    fn ls2d_api_version() -> u32 { API_VERSION }

    /// Version of the engine's arithmetic: programs with different versions compute different states.
    fn ls2d_semantics() -> u32 { lockstep2d::SEMANTICS }

    /// Copies the text of the last failure or verdict on this thread, as UTF-8 without a final zero. If the buffer is
    /// too short, the text is cut. `length` is the length of the whole text in bytes. A call that returns `LS2D_NONE`
    /// has not failed, and leaves the text unchanged.
    fn ls2d_last_error(buffer: Out<'_, u8>, capacity: usize, length: Out<'_, usize>) {
        let (mut buffer, mut length) = (buffer, length);
        let text = last_text();
        let cut = text.as_bytes().get(..capacity).unwrap_or(text.as_bytes());
        buffer.set_all(capacity, &mut length, cut)?;
        length.set(text.len())
    }

    /// Frees an object of any kind. Every later use of its handle is an error.
    fn ls2d_free(handle: u32) { table::free(handle) }

    /// Number of objects that have not been freed. Use it to find leaks.
    fn ls2d_object_count() -> usize { table::count() }

    /// Number of bytes of a bytes object.
    fn ls2d_bytes_size(bytes: u32, size: Out<'_, usize>) {
        let mut size = size;
        table::with(bytes, |Bytes(bytes)| size.set(bytes.len()))
    }

    /// Copies the bytes of a bytes object.
    fn ls2d_bytes_copy(bytes: u32, buffer: Out<'_, u8>, capacity: usize) {
        let mut buffer = buffer;
        let mut size = 0;
        table::with(bytes, |Bytes(bytes)| buffer.set_all(capacity, &mut Out::of(&mut size), bytes))
    }

    /// Makes a bytes object with a copy of some bytes.
    fn ls2d_bytes_new(data: In<'_, u8>, size: usize, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        bytes.set(table::add(Bytes(data.slice(size)?.to_vec()))?)
    }

    /// A buffer for callers that cannot allocate memory themselves, such as JavaScript. Returns the address of `size`
    /// bytes with an alignment of 8, or 0 if there is not enough memory. Each thread has one such buffer. A call with a
    /// larger size may move the buffer, but keeps its contents.
    fn ls2d_scratch(size: usize) -> usize {
        SCRATCH.with_borrow_mut(|scratch| {
            let words = size.div_ceil(size_of::<u64>()).max(1);
            let missing = words.saturating_sub(scratch.len());
            if scratch.try_reserve(missing).is_err() {
                return 0;
            }
            scratch.resize(words.max(scratch.len()), 0);
            scratch.as_mut_ptr().expose_provenance()
        })
    }
}

pub(super) fn copied(text: &str, given: usize) -> Failure {
    Failure::new(Status::Value, format!("{text}, and not {given}"))
}
