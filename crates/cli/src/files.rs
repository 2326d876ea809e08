//! Reading files of untrusted size, and printing untrusted names.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use lockstep2d::codec;
use lockstep2d::lockstep::Game;

/// Extension, without the dot, of the files in a folder that count as replays.
pub(crate) const EXTENSION: &str = "replay";

/// Reads at most `bytes_max + 1` bytes of a file. If that many bytes are returned, the file is larger than `bytes_max`.
pub(crate) fn read(path: &Path, bytes_max: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let expected = file.metadata()?.len();
    read_from(file, expected, bytes_max)
}

/// Reads at most `bytes_max + 1` bytes of a stream. `expected` is an estimate of its length in bytes, by which memory
/// is reserved.
pub(crate) fn read_from(stream: impl Read, expected: u64, bytes_max: u64) -> io::Result<Vec<u8>> {
    let end = bytes_max.saturating_add(1);
    // The buffer has one byte more than expected. Without free space, the last read, which finds the end of the file,
    // would double the capacity.
    let expected = expected.min(bytes_max).saturating_add(1);
    let mut bytes = Vec::new();
    if usize::try_from(expected).map_or(true, |expected| bytes.try_reserve_exact(expected).is_err()) {
        return Err(io::ErrorKind::OutOfMemory.into());
    }
    stream.take(end).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Whether bytes are the encoding of a save of the game `G`, as the command `seek` writes it.
pub(crate) fn is_save<G: Game>(bytes: &[u8]) -> bool {
    codec::decode::<G::Save>(bytes).is_ok_and(|save| codec::encode(&save) == bytes)
}

/// A path on one line: see [`OneLine`].
pub(crate) struct Shown<'a>(pub(crate) &'a Path);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        OneLine(&self.0.display().to_string()).fmt(f)
    }
}

/// Untrusted text on one line, with [misleading](is_misleading) characters escaped.
pub(crate) struct OneLine<'a>(pub(crate) &'a str);

impl fmt::Display for OneLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            if is_misleading(character) {
                write!(f, "{}", character.escape_default())?;
            } else {
                write!(f, "{character}")?;
            }
        }
        Ok(())
    }
}

/// Whether a character is a control character, a line or paragraph separator, a soft hyphen, a zero-width or
/// bidirectional control, an interlinear annotation mark, or a tag.
pub(crate) fn is_misleading(character: char) -> bool {
    matches!(
        character,
        '\0'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}'
            | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e007f}'
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_break_in_a_name_is_shown_escaped() {
        let name = Path::new("a\n9 of 9 files match\u{1b}[2J ü.replay");
        assert_eq!(Shown(name).to_string(), "a\\n9 of 9 files match\\u{1b}[2J ü.replay");
        assert_eq!(OneLine("a\u{202e}hctam\u{2028}b").to_string(), "a\\u{202e}hctam\\u{2028}b");
    }

    #[test]
    fn a_stream_is_read_no_further_than_its_limit() {
        for (length, expected) in [(0, 0), (99, 99), (100, 100), (101, 101), (5000, 101)] {
            for guess in [0, 10, length, u64::MAX] {
                let bytes = read_from(io::repeat(7).take(length), guess, 100).unwrap();
                assert_eq!(
                    bytes.len(),
                    expected,
                    "read a source of {length} bytes, of which {guess} were announced"
                );
            }
        }
    }
}
