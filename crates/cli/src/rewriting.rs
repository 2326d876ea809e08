//! [`Copy`]: plays the beginning of a replay and records it as a new replay, for `fork` and `trim`.

use std::path::Path;

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{
    Limits, Reader, RecordError, Recorder, Step, Verdict, VerifiedReplay, play_within, verify,
};

use crate::error::CommandError;

pub(crate) struct Copy<G: Game> {
    game: G,
    recorder: Recorder<G>,
    /// Work units of the setup and of the ticks so far.
    work: u64,
}

pub(crate) enum CopyError {
    /// The replay cannot be played as far as requested. `ticks` is the tick of the last checkpoint that agrees with the
    /// replay, or 0 if none does. An error of [`Copy::step`] always has 0.
    Replay { ticks: u64, verdict: Verdict },
    /// The setup or the inputs of the replay cannot be recorded.
    Record(RecordError),
}

impl<G: Game> Copy<G> {
    /// Plays the first `ticks` ticks of a replay and records them again. If the replay has fewer ticks, it is copied to
    /// its end.
    pub(crate) fn new(file: &[u8], ticks: u64, limits: &Limits) -> Result<Self, CopyError> {
        let unplayable = |verdict| CopyError::Replay { ticks: 0, verdict };
        let mut replay = VerifiedReplay::<G>::open(file, limits).map_err(unplayable)?;
        let reader = Reader::open(file, limits).map_err(|error| unplayable(error.into()))?;
        let header = reader.header();
        let setup = codec::decode(header.setup).map_err(|_| CopyError::Record(RecordError::Setup))?;
        let (mut recorder, _) =
            Recorder::<G>::start(&setup, header.checkpoint_interval).map_err(CopyError::Record)?;
        let mut agreed = 0;
        while recorder.ticks() < ticks {
            match replay.step() {
                Ok(Step::Ticked) => {}
                Ok(Step::Ended) => break,
                Err(verdict) => return Err(CopyError::Replay { ticks: agreed, verdict }),
            }
            recorder.record(replay.inputs()).map_err(CopyError::Record)?;
            if recorder.is_checkpoint_due() {
                recorder.checkpoint(replay.game().state_hash());
                agreed = recorder.ticks();
            }
        }
        Ok(Copy { work: replay.work(), game: replay.into_game(), recorder })
    }

    pub(crate) fn ticks(&self) -> u64 {
        self.recorder.ticks()
    }

    pub(crate) fn players(&self) -> u32 {
        self.game.players()
    }

    pub(crate) fn step(&mut self, inputs: &[G::Input], limits: &Limits) -> Result<(), CopyError> {
        let inputs = self.recorder.record(inputs).map_err(CopyError::Record)?;
        play_within(&mut self.game, inputs, limits, &mut self.work, G::step)
            .map_err(|verdict| CopyError::Replay { ticks: 0, verdict })?;
        if self.recorder.is_checkpoint_due() {
            self.recorder.checkpoint(self.game.state_hash());
        }
        Ok(())
    }

    /// Completes and verifies the replay. Returns its bytes and final hash. `output` is the path for error messages.
    pub(crate) fn finish(self, output: &Path, limits: &Limits) -> Result<(Vec<u8>, StateHash), CommandError> {
        let bytes = self.recorder.finish(&self.game)?;
        match verify::<G>(&bytes, limits) {
            Verdict::Match { hash, .. } => Ok((bytes, hash)),
            verdict => Err(CommandError::Replay { path: output.to_path_buf(), verdict }),
        }
    }
}

impl CopyError {
    pub(crate) fn of_file(self, path: &Path) -> CommandError {
        match self {
            CopyError::Replay { verdict, .. } => CommandError::Replay { path: path.to_path_buf(), verdict },
            CopyError::Record(error) => CommandError::Record(error),
        }
    }
}
