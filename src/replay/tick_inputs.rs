use super::limits::Limits;
use super::reader::{InputBlock, Part, ReadError, Reader};
use super::runs::{Run, Runs};

/// Reads the inputs of a replay tick by tick.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording, TickInputs};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// // Marks the ticks with input, for the seek bar of a viewer.
/// let mut inputs = TickInputs::open(&file, &Limits::default())?;
/// let mut is_busy = vec![];
/// while let Some(run) = inputs.next_tick()? {
///     is_busy.push(run.encoded.iter().any(|&byte| byte != 0));
/// }
/// assert_eq!((is_busy.len(), is_busy.contains(&true)), (90, false));
/// # Ok::<(), lockstep2d::replay::ReadError>(())
/// ```
#[derive(Clone, Debug)]
pub struct TickInputs<'a> {
    reader: Reader<'a>,
    block: Option<InputBlock<'a>>,
    block_left: u32,
    runs: Runs<'a>,
    /// The current run, with the number of its remaining ticks.
    run: Option<Run<'a>>,
}

impl<'a> TickInputs<'a> {
    /// Opens a replay at its first tick.
    ///
    /// # Errors
    /// As [`Reader::open`].
    pub fn open(file: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        let reader = Reader::open(file, limits)?;
        Ok(TickInputs { reader, block: None, block_left: 0, runs: Runs::new(&[], 0), run: None })
    }

    /// Advances by one tick. Returns the run of this tick, or `None` at the end of the complete blocks. [`Run::ticks`]
    /// is the number of remaining ticks of the run, including this one.
    ///
    /// # Errors
    /// [`ReadError`] if the next block is malformed or exceeds a limit.
    pub fn next_tick(&mut self) -> Result<Option<Run<'a>>, ReadError> {
        loop {
            if let Some(run) = self.run.as_mut().filter(|run| run.ticks > 0) {
                let found = *run;
                run.ticks -= 1;
                self.block_left -= 1;
                return Ok(Some(found));
            }
            self.run = self.runs.next_run()?;
            if self.run.is_none() {
                let Some(Part::Inputs(block)) = self.reader.next_part()? else {
                    return Ok(None);
                };
                (self.runs, self.block_left) = (block.runs(), block.ticks);
                self.block = Some(block);
            }
        }
    }

    /// The block that ends with the tick that was just read, with the checkpoint after that tick. `None` if that tick
    /// is not the last of its block.
    #[must_use]
    pub fn finished_block(&self) -> Option<&InputBlock<'a>> {
        self.block.as_ref().filter(|_| self.block_left == 0)
    }

    pub(super) fn reader(&self) -> &Reader<'a> {
        &self.reader
    }
}
