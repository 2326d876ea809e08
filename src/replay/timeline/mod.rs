//! [`Timeline`]: a replay that can seek to any tick, forwards and backwards.
//!
//! A seek simulates forwards from the latest saved state up to the tick, or from the current tick if that is nearer.
//! The saved states are:
//!
//! - *Keyframes*, one every [`interval`](Timeline::interval) ticks, as canonical bytes. When they exceed their memory
//!   budget, the interval doubles and every second keyframe is removed.
//! - A *trail* of saves before the current tick, made while stepping backwards. With a trail, the ticks between two
//!   keyframes are simulated once, and not again for each step backwards.

mod bytes;
mod keyframes;
mod trail;

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

pub use bytes::{
    KEYFRAMES_BYTES_MAX, KEYFRAMES_FORMAT_VERSION, KEYFRAMES_MAGIC, KeyframesError, KeyframesFlaw,
};

use self::keyframes::{Keyframe, Keyframes};
use self::trail::Trail;
use super::limits::Limits;
use super::verdict::Verdict;
use super::verified_replay::{Step, VerifiedReplay};
use crate::codec;
use crate::lockstep::Game;
use crate::world::World;

/// Memory settings of a [`Timeline`].
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording, Timeline, TimelineOptions};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 30).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// // A phone: a state every half second, in at most 16 MiB.
/// let options = TimelineOptions { interval: 30, bytes: 16 << 20 };
/// let mut timeline = Timeline::<Sandbox>::open(&file, &options, &Limits::default())?;
/// timeline.play_all().expect("it is valid");
/// assert_eq!(timeline.keyframes().collect::<Vec<_>>(), [0, 30, 60, 90]);
/// # Ok::<(), lockstep2d::replay::Verdict>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimelineOptions {
    /// Ticks between keyframes, at least 1. An interval longer than a block of the replay is rounded down to whole
    /// blocks, so that every keyframe is at a checkpoint and can be compared with it.
    pub interval: u32,
    /// Maximum size of all keyframes together in bytes, at most [`KEYFRAMES_BYTES_MAX`]. The trail may use about a
    /// quarter of this amount in addition.
    pub bytes: usize,
}

impl Default for TimelineOptions {
    /// An interval of five seconds at 60 Hz, and 64 MiB of keyframes.
    fn default() -> Self {
        TimelineOptions { interval: 300, bytes: 64 << 20 }
    }
}

/// Reason why a [`Timeline`] cannot seek to a tick.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording, SeekError, Timeline};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
/// # (0..90).for_each(|_| recording.step(&[vec![]]).expect("one input"));
/// # let file = recording.finish().expect("no claims");
/// let mut timeline = Timeline::<Sandbox>::open(&file, &Default::default(), &Limits::default())?;
/// assert_eq!(timeline.seek(91), Err(SeekError::NoSuchTick { tick: 91, ticks: 90 }));
/// // The timeline stays at its current tick.
/// assert_eq!(timeline.tick(), 0);
/// # Ok::<(), lockstep2d::replay::Verdict>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SeekError {
    /// The replay ends before this tick.
    NoSuchTick {
        /// The requested tick.
        tick: u64,
        /// Number of ticks in the replay.
        ticks: u64,
    },
    /// The replay cannot be played up to that tick: its inputs are not valid for this game, exceed a limit, or lead to
    /// another state.
    Replay(Verdict),
    /// A keyframe cannot be decoded, or its state does not match the checkpoint of the replay. Either the keyframe
    /// comes from a wrong file, or saving and loading this game loses state.
    Keyframe {
        /// Tick of the keyframe.
        tick: u64,
        /// Reason.
        why: String,
    },
    /// A tick that was played before has another state after seeking backwards: saving and loading this game loses
    /// state.
    Forgetful {
        /// Tick of the first checkpoint that no longer matches.
        tick: u64,
    },
}

impl fmt::Display for SeekError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SeekError::NoSuchTick { tick, ticks } => write!(f, "there are {ticks} ticks, and no tick {tick}"),
            SeekError::Replay(verdict) => verdict.fmt(f),
            SeekError::Keyframe { tick, why } => write!(f, "the keyframe of tick {tick}: {why}"),
            SeekError::Forgetful { tick } => write!(
                f,
                "after seeking backwards, tick {tick} has another state: saving and loading this game loses state"
            ),
        }
    }
}

impl core::error::Error for SeekError {}

/// A replay that can seek to any tick. *Tick t* is the state after *t* ticks.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording, Timeline};
///
/// let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60)?;
/// (0..1000).try_for_each(|_| recording.step(&[vec![]]))?;
/// let file = recording.finish()?;
///
/// let mut timeline = Timeline::<Sandbox>::open(&file, &Default::default(), &Limits::default()).expect("a replay");
/// timeline.seek(900).expect("it is as long");
/// timeline.step_back().expect("there is one");
/// assert_eq!(timeline.game().world().tick(), 899);
/// // Nine hundred ticks forward, then 299 ticks again from the keyframe of tick 600.
/// assert_eq!(timeline.simulated(), 900 + 299);
/// timeline.step_back().expect("there is another");
/// assert_eq!(timeline.simulated(), 900 + 299);
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
pub struct Timeline<'a, G: Game> {
    file: &'a [u8],
    replay: VerifiedReplay<'a, G>,
    keyframes: Keyframes<'a>,
    trail: Trail<'a, G::Save>,
    played: u64,
    simulated: u64,
    /// The first tick that cannot be reached, and the reason.
    failed: Option<(u64, Verdict)>,
    /// Set if a failed step has left the game in a state that is not that of the current tick.
    is_wrong: bool,
}

impl<'a, G: Game> Timeline<'a, G> {
    /// Scans the whole file and starts the game.
    ///
    /// # Errors
    /// As [`VerifiedReplay::open`].
    pub fn open(file: &'a [u8], options: &TimelineOptions, limits: &Limits) -> Result<Self, Verdict> {
        let replay = VerifiedReplay::<G>::open(file, limits)?;
        let position = replay.position().clone();
        let block_ticks = u64::from(position.inputs.reader().header().checkpoint_interval).max(1);
        let interval = u64::from(options.interval).max(1);
        let interval = if interval > block_ticks { interval - interval % block_ticks } else { interval };
        let start = Keyframe { position, save: codec::encode(&replay.game().save()) };
        let keyframes = Keyframes::new(start, interval, options.bytes.min(KEYFRAMES_BYTES_MAX));
        let (trail, failed) = (Trail::default(), None);
        Ok(Timeline { file, replay, keyframes, trail, played: 0, simulated: 0, failed, is_wrong: false })
    }

    /// The game at the current tick.
    #[must_use]
    pub fn game(&self) -> &G {
        self.replay.game()
    }

    /// The world of the game, if it has one.
    pub fn world(&mut self) -> Option<&World> {
        self.replay.world()
    }

    /// The current tick.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.replay.tick()
    }

    /// Number of ticks in the complete blocks of the file.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.replay.ticks()
    }

    /// The tick up to which every tick has been simulated, and every checkpoint was equal to the one in the file.
    #[must_use]
    pub fn played(&self) -> u64 {
        self.played
    }

    /// Number of simulated ticks, including repeated ones.
    #[must_use]
    pub fn simulated(&self) -> u64 {
        self.simulated
    }

    /// Number of ticks between keyframes. It grows when the keyframes exceed their memory budget.
    #[must_use]
    pub fn interval(&self) -> u64 {
        self.keyframes.interval()
    }

    /// Ticks of the keyframes, ascending from 0.
    pub fn keyframes(&self) -> impl Iterator<Item = u64> {
        self.keyframes.iter().map(|frame| frame.position.tick)
    }

    /// Seeks to a tick. Going to a tick that was played before usually costs less than one [`interval`](Self::interval)
    /// of simulation. The checkpoints of the simulated ticks are compared with the file.
    ///
    /// # Errors
    /// [`SeekError`]. If playing a tick fails, the timeline stays at the last tick played, and earlier ticks remain
    /// reachable. After any other error, the timeline stays at its current tick.
    pub fn seek(&mut self, tick: u64) -> Result<(), SeekError> {
        if tick > self.ticks() {
            return Err(SeekError::NoSuchTick { tick, ticks: self.ticks() });
        }
        self.check_reachable(tick)?;
        // A short seek backwards is usually followed by more of them, so it leaves a trail for them.
        let goes_back = self.tick().checked_sub(tick).is_some_and(|by| (1..self.interval()).contains(&by));
        self.go_to_latest_before(tick)?;
        while self.tick() < tick {
            if goes_back {
                self.leave_trail();
            }
            self.play_tick()?;
        }
        Ok(())
    }

    /// Advances by one tick. The tick is always simulated, so contacts and other results outside of the state are
    /// available.
    ///
    /// # Errors
    /// As [`Timeline::seek`]. At the end the result is [`Step::Ended`].
    pub fn step(&mut self) -> Result<Step, SeekError> {
        if self.tick() == self.ticks() {
            return Ok(Step::Ended);
        }
        self.check_reachable(self.tick() + 1)?;
        self.play_tick().map(|()| Step::Ticked)
    }

    /// Goes back by one tick. The first step back in an interval may cost an interval of simulation. Further steps back
    /// in this interval cost no simulation, if the memory suffices for the trail.
    ///
    /// # Errors
    /// As [`Timeline::seek`]. At the start the result is [`Step::Ended`].
    pub fn step_back(&mut self) -> Result<Step, SeekError> {
        match self.tick().checked_sub(1) {
            Some(before) => self.seek(before).map(|()| Step::Ticked),
            None => Ok(Step::Ended),
        }
    }

    /// Plays the ticks that have not been played, creates their keyframes, and returns to the current tick.
    ///
    /// # Errors
    /// As [`Timeline::seek`].
    pub fn play_all(&mut self) -> Result<(), SeekError> {
        let here = self.tick();
        self.seek(self.played)?;
        // `seek` would jump to keyframes from a file and skip the ticks before them.
        while self.tick() < self.ticks() {
            self.play_tick()?;
        }
        self.seek(here)
    }

    /// Encodes the keyframes at the ends of blocks as a file for [`Timeline::use_keyframes`].
    #[must_use]
    pub fn keyframes_to_bytes(&self) -> Vec<u8> {
        bytes::encode::<G>(self.file, &self.keyframes)
    }

    /// Replaces the keyframes by those of a file from [`Timeline::keyframes_to_bytes`].
    ///
    /// The interval becomes the smallest multiple of the file's interval that is not below the current interval. The
    /// saves are not checked here: when a seek restores one, the seek fails if the state does not match the replay's
    /// checkpoint. A matching state does not prove that the inputs lead to this state. [`Timeline::played`] is the tick
    /// up to which this has been verified.
    ///
    /// # Errors
    /// [`KeyframesError`] for other bytes, and for keyframes of another replay. The current keyframes are then
    /// unchanged.
    pub fn use_keyframes(&mut self, bytes: &[u8]) -> Result<(), KeyframesError> {
        let body = bytes::decode::<G>(self.file, bytes)?;
        let interval = body.interval.saturating_mul(self.interval().div_ceil(body.interval));
        let start = self.keyframes.first().clone();
        let mut keyframes = Keyframes::new(start, interval, self.keyframes.bytes_max());
        bytes::place(body, self.ticks(), &mut keyframes)?;
        self.keyframes = keyframes;
        Ok(())
    }

    fn check_reachable(&self, tick: u64) -> Result<(), SeekError> {
        match &self.failed {
            Some((unreachable, verdict)) if tick >= *unreachable => Err(SeekError::Replay(verdict.clone())),
            _ => Ok(()),
        }
    }

    /// Restores the latest saved state up to `tick`, unless the current tick lies between that state and `tick`.
    fn go_to_latest_before(&mut self, tick: u64) -> Result<(), SeekError> {
        let frame = self.keyframes.latest(tick);
        let kept = self.trail.latest(tick);
        let from = kept.map_or(0, |(position, _)| position.tick).max(frame.position.tick);
        if !self.is_wrong && (from..=tick).contains(&self.tick()) {
            return Ok(());
        }
        match kept.filter(|(position, _)| position.tick == from) {
            Some((position, save)) => {
                self.replay.go(save, position.clone());
                self.is_wrong = false;
                Ok(())
            }
            None => self.go_to_keyframe(tick),
        }
    }

    fn go_to_keyframe(&mut self, tick: u64) -> Result<(), SeekError> {
        let Keyframe { position, save } = self.keyframes.latest(tick);
        let tick = position.tick;
        let save: G::Save = codec::decode(save)
            .map_err(|error| SeekError::Keyframe { tick, why: alloc::format!("{error}") })?;
        let (back, here) = (self.game().save(), self.replay.position().clone());
        self.replay.go(&save, position.clone());
        if self.replay.agrees() {
            self.is_wrong = false;
            return Ok(());
        }
        self.replay.go(&back, here);
        Err(SeekError::Keyframe { tick, why: "its state does not match the replay's checkpoint".into() })
    }

    /// Saves the current state for steps backwards: in every tick, or less often if the saves of an interval would
    /// exceed a quarter of the memory for keyframes.
    fn leave_trail(&mut self) {
        let length = (self.keyframes.bytes_max() / 4) / self.keyframes.latest(self.tick()).bytes();
        let length = u64::try_from(length).unwrap_or(u64::MAX).max(2);
        let spacing = self.interval().div_ceil(length);
        if self.tick().is_multiple_of(spacing) {
            self.trail.keep(self.replay.position().clone(), self.replay.game().save(), length);
        }
    }

    fn play_tick(&mut self) -> Result<(), SeekError> {
        let before = self.tick();
        let result = self.replay.step();
        let now = self.tick();
        self.simulated += now - before;
        if let Err(verdict) = result {
            if now <= self.played && matches!(verdict, Verdict::Diverged { .. }) {
                self.is_wrong = true;
                return Err(SeekError::Forgetful { tick: now });
            }
            self.failed = Some((before + 1, verdict.clone()));
            if now == before && matches!(verdict, Verdict::LimitExceeded { .. }) {
                // The failed step may have changed the game, so its state before the step is restored. If this fails as
                // well, the next seek tries again.
                self.is_wrong = true;
                let _ = self.seek(before);
            }
            return Err(SeekError::Replay(verdict));
        }
        if before <= self.played {
            self.played = self.played.max(now);
        }
        if self.keyframes.is_due(now) {
            let save = codec::encode(&self.game().save());
            self.keyframes.insert(Keyframe { position: self.replay.position().clone(), save });
        }
        Ok(())
    }
}
