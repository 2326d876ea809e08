//! [`Timeline`]: a replay in which one can go to any tick, forwards and backwards.
//!
//! A deterministic game cannot be run backwards, but it can be run again from a state that was kept. Two kinds are kept:
//!
//! - *Keyframes*, one every [`interval`](Timeline::interval) ticks, as the canonical bytes of the game's save. When they
//!   have used up their budget, the interval doubles and every second one goes, so that those that stay are evenly
//!   spread. Whatever has been played once is therefore less than an interval of simulation away, for good.
//! - A *trail* of saves just behind where one steps backwards, so that the ticks between two keyframes are simulated
//!   once and not once for every step.
//!
//! A keyframe is kept as bytes although a save in memory may share most of itself with others: bytes can be counted,
//! whatever a game's saves are made of, and they go into a file as they are.

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
use super::playback::{Playback, Step};
use super::verdict::Verdict;
use crate::codec;
use crate::lockstep::Game;
use crate::world::World;

/// How much a [`Timeline`] keeps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimelineOptions {
    /// Ticks from one keyframe to the next, at least 1. It is rounded down to whole blocks of the replay, if it is longer
    /// than one, since the replay has checkpoints there that a keyframe is compared with.
    pub interval: u32,
    /// Bytes that all keyframes may take together, at most [`KEYFRAMES_BYTES_MAX`]. The trail may take about a quarter as
    /// much again. The keyframe of tick 0 is kept in any case.
    pub bytes: usize,
}

impl Default for TimelineOptions {
    /// Five seconds at 60 Hz, and 64 MiB.
    fn default() -> Self {
        TimelineOptions { interval: 300, bytes: 64 << 20 }
    }
}

/// Why a [`Timeline`] cannot go somewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SeekError {
    /// The replay ends before.
    NoSuchTick {
        /// Where to go.
        tick: u64,
        /// How many ticks there are.
        ticks: u64,
    },
    /// The replay cannot be played as far: its inputs are not this game's, cost too much, or lead elsewhere.
    Replay(Verdict),
    /// A keyframe is none of this replay. It comes from a file of keyframes, or saving and loading this game loses
    /// something.
    Keyframe {
        /// After how many ticks it is said to be.
        tick: u64,
        /// What is wrong with it.
        why: String,
    },
    /// After going back, the game has taken another course than the first time: saving and loading it loses something.
    Forgetful {
        /// The tick of the first checkpoint that is not the same any more.
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
                "played again after going back, tick {tick} is another one: saving and loading this game loses something"
            ),
        }
    }
}

impl core::error::Error for SeekError {}

/// A replay in which one can go to any tick. *Tick t* is the state after *t* ticks.
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
/// // Nine hundred ticks forward, and the last of them again from the keyframe of tick 600.
/// assert_eq!(timeline.simulated(), 900 + 299);
/// timeline.step_back().expect("there is another");
/// assert_eq!(timeline.simulated(), 900 + 299);
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
pub struct Timeline<'a, G: Game> {
    file: &'a [u8],
    playback: Playback<'a, G>,
    keyframes: Keyframes<'a>,
    trail: Trail<'a, G::Save>,
    played: u64,
    simulated: u64,
    /// The first tick that cannot be reached, and why.
    failed: Option<(u64, Verdict)>,
}

impl<'a, G: Game> Timeline<'a, G> {
    /// Scans the whole file and starts the game; nothing is played.
    ///
    /// # Errors
    /// The [`Verdict`] when there is nothing to play: the file is malformed, too large, of another game, or its setup
    /// starts another state.
    pub fn open(file: &'a [u8], options: &TimelineOptions, limits: &Limits) -> Result<Self, Verdict> {
        let playback = Playback::<G>::open(file, limits)?;
        let place = playback.place().clone();
        let block_ticks = u64::from(place.inputs.reader().header().checkpoint_interval).max(1);
        let interval = u64::from(options.interval).max(1);
        let interval = if interval > block_ticks { interval - interval % block_ticks } else { interval };
        let start = Keyframe { place, save: codec::encode(&playback.game().save()) };
        let keyframes = Keyframes::new(start, interval, options.bytes.min(KEYFRAMES_BYTES_MAX));
        let (trail, failed) = (Trail::default(), None);
        Ok(Timeline { file, playback, keyframes, trail, played: 0, simulated: 0, failed })
    }

    /// The game as of now.
    #[must_use]
    pub fn game(&self) -> &G {
        self.playback.game()
    }

    /// The physics world of the game as of now, if it has one, to look at.
    pub fn world(&mut self) -> Option<&World> {
        self.playback.world()
    }

    /// Where it is.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.playback.tick()
    }

    /// How many ticks the replay has, as far as it is whole.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.playback.ticks()
    }

    /// Up to which tick the replay has been played without a gap, with all its checkpoints the same.
    #[must_use]
    pub fn played(&self) -> u64 {
        self.played
    }

    /// How many ticks have been simulated altogether, repeated ones among them: what going about has cost.
    #[must_use]
    pub fn simulated(&self) -> u64 {
        self.simulated
    }

    /// Ticks from one keyframe to the next. It grows when they have used up their budget.
    #[must_use]
    pub fn interval(&self) -> u64 {
        self.keyframes.interval()
    }

    /// The ticks of the keyframes, in ascending order, 0 among them.
    pub fn keyframes(&self) -> impl Iterator<Item = u64> {
        self.keyframes.iter().map(|frame| frame.place.tick)
    }

    /// Goes to a tick. Where the replay has been played already, that costs less than an [`interval`](Self::interval) of
    /// simulation; where it has not, it is played.
    ///
    /// Every checkpoint on the way is compared.
    ///
    /// # Errors
    /// [`SeekError`]. If the replay cannot be played as far, the game is where that was found; one can still go to every
    /// tick before. Where there is no such tick or no such keyframe, it is where it was.
    pub fn seek(&mut self, tick: u64) -> Result<(), SeekError> {
        if tick > self.ticks() {
            return Err(SeekError::NoSuchTick { tick, ticks: self.ticks() });
        }
        self.check_reachable(tick)?;
        // Who goes back a little is going to go back more.
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

    /// Goes one tick further. That is always simulated, so that what a tick leaves behind beside the state, such as its
    /// contact points, is there to be seen.
    ///
    /// # Errors
    /// As [`Timeline::seek`]. At the end it stays where it is and says [`Step::Ended`].
    pub fn step(&mut self) -> Result<Step, SeekError> {
        if self.tick() == self.ticks() {
            return Ok(Step::Ended);
        }
        self.check_reachable(self.tick() + 1)?;
        self.play_tick().map(|()| Step::Ticked)
    }

    /// Goes one tick back. The first time in an interval that may cost an interval of simulation, and then, in memory
    /// enough, nothing.
    ///
    /// # Errors
    /// As [`Timeline::seek`]. At the start it stays where it is and says [`Step::Ended`].
    pub fn step_back(&mut self) -> Result<Step, SeekError> {
        match self.tick().checked_sub(1) {
            Some(before) => self.seek(before).map(|()| Step::Ticked),
            None => Ok(Step::Ended),
        }
    }

    /// Plays what has not been played, which leaves keyframes everywhere, and comes back.
    ///
    /// # Errors
    /// As [`Timeline::seek`].
    pub fn play_all(&mut self) -> Result<(), SeekError> {
        let here = self.tick();
        self.seek(self.played)?;
        // Not by `seek`, which would pass over what a file's keyframes spare.
        while self.tick() < self.ticks() {
            self.play_tick()?;
        }
        self.seek(here)
    }

    /// The keyframes as the bytes of a file, for [`Timeline::use_keyframes`] another time. It has those for which the
    /// replay has a checkpoint: all, unless the interval is shorter than the replay's blocks.
    #[must_use]
    pub fn keyframes_to_bytes(&self) -> Vec<u8> {
        bytes::encode::<G>(self.file, &self.keyframes)
    }

    /// Puts keyframes from a file, of [`Timeline::keyframes_to_bytes`], in the place of those that there are.
    ///
    /// The interval becomes a multiple of the file's. A keyframe is decoded when it is needed, and has to have the state
    /// of the replay's own checkpoint. That is no verdict on the replay: nothing shows that its inputs lead there. What
    /// has been played is [`Timeline::played`].
    ///
    /// # Errors
    /// [`KeyframesError`] for any other bytes, or those of another replay. The keyframes are then as they were.
    pub fn use_keyframes(&mut self, bytes: &[u8]) -> Result<(), KeyframesError> {
        let body = bytes::decode::<G>(self.file, bytes)?;
        let interval = body.interval.saturating_mul(self.interval().div_ceil(body.interval));
        let start = self.keyframes.first().clone();
        let found = bytes::place(&start.place, self.ticks(), body)?;
        let mut keyframes = Keyframes::new(start, interval, self.keyframes.bytes_max());
        for frame in found {
            keyframes.insert(frame);
        }
        self.keyframes = keyframes;
        Ok(())
    }

    fn check_reachable(&self, tick: u64) -> Result<(), SeekError> {
        match &self.failed {
            Some((unreachable, verdict)) if tick >= *unreachable => Err(SeekError::Replay(verdict.clone())),
            _ => Ok(()),
        }
    }

    /// Goes to the last tick up to `tick` that costs no simulation.
    fn go_to_latest_before(&mut self, tick: u64) -> Result<(), SeekError> {
        let frame = self.keyframes.latest(tick);
        let kept = self.trail.latest(tick);
        let from = kept.map_or(0, |(place, _)| place.tick).max(frame.place.tick);
        if (from..=tick).contains(&self.tick()) {
            return Ok(());
        }
        match kept.filter(|(place, _)| place.tick == from) {
            Some((place, save)) => {
                self.playback.go(save, place.clone());
                Ok(())
            }
            None => self.go_to_keyframe(tick),
        }
    }

    fn go_to_keyframe(&mut self, tick: u64) -> Result<(), SeekError> {
        let Keyframe { place, save } = self.keyframes.latest(tick);
        let tick = place.tick;
        let save: G::Save = codec::decode(save)
            .map_err(|error| SeekError::Keyframe { tick, why: alloc::format!("{error}") })?;
        let (back, here) = (self.game().save(), self.playback.place().clone());
        self.playback.go(&save, place.clone());
        if self.playback.agrees() {
            return Ok(());
        }
        self.playback.go(&back, here);
        Err(SeekError::Keyframe { tick, why: "its state is not that of the replay's checkpoint".into() })
    }

    /// Keeps where it is, for steps backwards.
    fn leave_trail(&mut self) {
        let length = (self.keyframes.bytes_max() / 4) / self.keyframes.latest(self.tick()).bytes();
        let length = u64::try_from(length).unwrap_or(u64::MAX).max(2);
        let spacing = self.interval().div_ceil(length);
        if self.tick().is_multiple_of(spacing) {
            self.trail.keep(self.playback.place().clone(), self.playback.game().save(), length);
        }
    }

    fn play_tick(&mut self) -> Result<(), SeekError> {
        let before = self.tick();
        let result = self.playback.step();
        let now = self.tick();
        self.simulated += now - before;
        if let Err(verdict) = result {
            if now <= self.played && matches!(verdict, Verdict::Diverged { .. }) {
                return Err(SeekError::Forgetful { tick: now });
            }
            self.failed = Some((before + 1, verdict.clone()));
            return Err(SeekError::Replay(verdict));
        }
        if before <= self.played {
            self.played = self.played.max(now);
        }
        if self.keyframes.is_due(now) {
            let save = codec::encode(&self.game().save());
            self.keyframes.insert(Keyframe { place: self.playback.place().clone(), save });
        }
        Ok(())
    }
}
