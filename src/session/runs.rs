//! Compression of the inputs of consecutive ticks: each input is XORed with the input before it, and the result is
//! run-length encoded.
//!
//! A run starts with a LEB128 number: the length of the run in bytes times two, plus one for a run of zeros. In a run
//! of other bytes, the bytes follow the number. The decoder knows the total number of bytes.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use super::bytes::{Decoded, Malformed, Reader, Write};

/// Minimum number of zeros for a separate run between other bytes.
const ZEROS_MIN: usize = 3;

/// Appends the encoding of inputs of `size` bytes each.
pub(super) fn encode(inputs: &[u8], size: usize, bytes: &mut Vec<u8>) {
    let differences = |at: usize| {
        let before = at.checked_sub(size).and_then(|at| inputs.get(at)).copied().unwrap_or(0);
        inputs.get(at).copied().unwrap_or(0) ^ before
    };
    let zeros_from = |at: usize| (at..inputs.len()).take_while(|&at| differences(at) == 0).count();
    let mut at = 0;
    while at < inputs.len() {
        let zeros = zeros_from(at);
        if zeros > 0 {
            bytes.put_count(2 * zeros + 1);
            at += zeros;
            continue;
        }
        let start = at;
        while at < inputs.len() {
            let zeros = zeros_from(at);
            if zeros >= ZEROS_MIN || zeros > 0 && at + zeros == inputs.len() {
                break;
            }
            at += zeros.max(1);
        }
        bytes.put_count(2 * (at - start));
        bytes.extend((start..at).map(differences));
    }
}

/// Appends `count` decoded bytes of inputs of `size` bytes each.
pub(super) fn decode(reader: &mut Reader, count: usize, size: usize, inputs: &mut Vec<u8>) -> Decoded<()> {
    let start = inputs.len();
    let end = start + count;
    while inputs.len() < end {
        let run = reader.count(2 * (end - inputs.len()) + 1)?;
        let length = run / 2;
        if length == 0 || length > end - inputs.len() {
            return Err(Malformed);
        }
        if run % 2 == 1 {
            inputs.resize(inputs.len() + length, 0);
        } else {
            inputs.extend_from_slice(reader.take(length)?);
        }
    }
    for at in start + size..end {
        let before = inputs.get(at - size).copied().unwrap_or(0);
        if let Some(byte) = inputs.get_mut(at) {
            *byte ^= before;
        }
    }
    Ok(())
}
