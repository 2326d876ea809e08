#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use super::bytes::{Cursor, put_varint};
use super::flaw::Flaw;
use super::reader::ReadError;

/// Consecutive ticks with the same inputs.
///
/// ```
/// # use lockstep2d::{codec, lockstep::{Game, Sandbox, SandboxSetup}};
/// use lockstep2d::replay::{Limits, Part, Reader, Recording, Run, Runs};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..45).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// let mut reader = Reader::open(&file, &Limits::default())?;
/// let Some(Part::Inputs(block)) = reader.next_part()? else { panic!("a block") };
/// // If no button is pressed in a block, all its ticks are one run of a few bytes.
/// let mut runs: Runs = block.runs();
/// let run: Run = runs.next_run()?.expect("a block is not empty");
/// assert_eq!(run.ticks, 45);
/// assert_eq!(codec::decode::<<Sandbox as Game>::Input>(run.encoded), Ok(vec![]));
/// assert!(runs.next_run()?.is_none());
/// # Ok::<(), lockstep2d::replay::ReadError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run<'a> {
    /// Number of ticks, at least one.
    pub ticks: u32,
    /// Canonical bytes of the inputs for one tick, in player order.
    pub encoded: &'a [u8],
    /// Offset of the run in the file.
    pub offset: u64,
}

impl Run<'_> {
    pub(super) fn write(ticks: u32, encoded: &[u8], bytes: &mut Vec<u8>) {
        put_varint(ticks, bytes);
        put_varint(u32::try_from(encoded.len()).expect("a length that was checked"), bytes);
        bytes.extend_from_slice(encoded);
    }
}

/// Reads the runs of a block in their canonical encoding.
#[derive(Clone, Debug)]
pub struct Runs<'a> {
    cursor: Cursor<'a>,
    previous: Option<&'a [u8]>,
}

impl<'a> Runs<'a> {
    pub(super) fn new(bytes: &'a [u8], offset: u64) -> Self {
        Runs { cursor: Cursor::new(bytes, offset), previous: None }
    }

    /// The next run, or `None` at the end of the block.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] for bytes that no recorder writes. A [`Reader`](super::Reader) has already refused such
    /// bytes.
    pub fn next_run(&mut self) -> Result<Option<Run<'a>>, ReadError> {
        if self.cursor.is_empty() {
            return Ok(None);
        }
        let offset = self.cursor.offset();
        let malformed = |flaw| ReadError::Malformed { offset, flaw };
        let ticks = self.cursor.varint()?;
        if ticks == 0 {
            return Err(malformed(Flaw::EmptyRun));
        }
        let length = self.cursor.varint()?;
        let encoded = usize::try_from(length).ok().and_then(|length| self.cursor.take(length));
        let encoded = encoded.ok_or(malformed(Flaw::BlockCut))?;
        if self.previous == Some(encoded) {
            return Err(malformed(Flaw::SplitRun));
        }
        self.previous = Some(encoded);
        Ok(Some(Run { ticks, encoded, offset }))
    }
}
