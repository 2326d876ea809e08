//! Targets whose input is a file or packets.
//!
//! The first byte of an input selects whether the other bytes are the file itself or describe changes of an original
//! file, and whether the checksums of the resulting file are repaired. (The target `session` has another format.)

pub mod replay;
pub mod report;
pub mod session;
pub mod snapshot;

use crate::forge::mutate;
use crate::source::Source;

struct Attempt<'a> {
    file: Vec<u8>,
    /// The original file, if `file` was made by changing it.
    original: Option<&'a [u8]>,
}

/// Makes a file from an input, whose changes refer to one of `originals`. `repair` corrects all checksums of a file.
fn attempt<'a>(bytes: &[u8], originals: &'a [Vec<u8>], repair: impl Fn(&mut Vec<u8>)) -> Attempt<'a> {
    let Some((&mode, rest)) = bytes.split_first() else {
        return Attempt { file: Vec::new(), original: None };
    };
    let mut source = Source::new(rest);
    let (mut file, original) = if mode & 2 == 0 {
        (rest.to_vec(), None)
    } else {
        let original = &originals[usize::from(mode >> 2) % originals.len()];
        let mut file = original.clone();
        for _ in 0..=source.below(3) {
            change(&mut source, &mut file, originals);
        }
        (file, Some(original.as_slice()))
    };
    if mode & 1 == 1 {
        repair(&mut file);
    }
    Attempt { file, original }
}

/// Changes a few bytes, or copies a piece of an original into the file.
fn change(source: &mut Source<'_>, file: &mut Vec<u8>, originals: &[Vec<u8>]) {
    if !source.one_in(8) {
        return mutate(source, file);
    }
    let other = &originals[source.below(originals.len())];
    let from = source.below(other.len());
    let piece = &other[from..(from + source.below(200)).min(other.len())];
    let at = source.below(file.len());
    let end = if source.one_in(2) { at } else { (at + piece.len()).min(file.len()) };
    file.splice(at..end, piece.iter().copied());
}
