use alloc::vec::Vec;

use super::recorder::{RecordError, Recorder};
use crate::lockstep::Game;

/// A game that is recorded while it runs.
///
/// ```
/// use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, Recording, verify};
/// let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), CHECKPOINT_INTERVAL)?;
/// let mut file = vec![];
/// for _ in 0..200 {
///     recording.step(&[vec![]])?;
///     // If the game crashes, the file is a replay up to the last full second.
///     file.extend(recording.take_bytes());
/// }
/// file.extend(recording.finish()?);
/// assert!(verify::<Sandbox>(&file, &Limits::default()).is_match());
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
pub struct Recording<G: Game> {
    game: G,
    recorder: Recorder<G>,
}

impl<G: Game> Recording<G> {
    /// Starts a game, with a checkpoint every `checkpoint_interval` ticks.
    ///
    /// # Errors
    /// [`RecordError`] if the setup cannot start a game, or a replay cannot represent the game.
    pub fn start(setup: &G::Setup, checkpoint_interval: u32) -> Result<Self, RecordError> {
        let (recorder, game) = Recorder::start(setup, checkpoint_interval)?;
        Ok(Recording { game, recorder })
    }

    /// The game at the current tick.
    #[must_use]
    pub fn game(&self) -> &G {
        &self.game
    }

    /// Number of ticks played.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.recorder.ticks()
    }

    /// Records one tick and plays it. The game gets the inputs as they will be decoded when the replay is verified.
    ///
    /// # Errors
    /// [`RecordError`] if the inputs cannot be recorded. The tick is not played.
    pub fn step(&mut self, inputs: &[G::Input]) -> Result<(), RecordError> {
        let inputs = self.recorder.record(inputs)?;
        self.game.step(inputs);
        if self.recorder.is_checkpoint_due() {
            self.recorder.checkpoint(self.game.state_hash());
        }
        Ok(())
    }

    /// Takes the finished bytes, to be appended to the file.
    #[must_use]
    pub fn take_bytes(&mut self) -> Vec<u8> {
        self.recorder.take_bytes()
    }

    /// Ends the replay, and returns the bytes that have not been taken.
    ///
    /// # Errors
    /// [`RecordError::Claims`] if the game's claims cannot be recorded.
    pub fn finish(self) -> Result<Vec<u8>, RecordError> {
        self.recorder.finish(&self.game)
    }
}
