//! [`Replay`]: a replay file as a source.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, Step, Timeline, TimelineOptions, Verdict, VerifiedReplay};
use lockstep2d::world::World;
use lockstep2d_render::{Camera, DrawList};

use super::{Source, SourceError};
use crate::play::Presentation;

/// Initial interval between keyframes, in ticks. With a shorter interval, seeking is faster, and the keyframes take
/// more memory.
const INTERVAL: u32 = 60;

/// Number of work units after which a call of [`Source::think`] stops verifying.
const THINK_WORK: u64 = 100_000;

/// Replay of a game, verified in the background while it is shown.
///
/// ```
/// use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, Recording};
/// use lockstep2d_viewer::{Replay, Source};
///
/// let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60)?;
/// for _ in 0..100 {
///     recording.step(&[vec![]])?;
/// }
/// let file = recording.finish()?.leak();
/// let mut replay =
///     Replay::<Sandbox>::open("empty.replay", file, &Limits::default()).map_err(|verdict| verdict.to_string())?;
/// replay.seek(50)?;
/// assert_eq!((replay.tick(), replay.ticks()), (50, Some(100)));
/// while replay.think() {}
/// assert!(replay.status().contains("match"), "{}", replay.status());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Replay<G: Game> {
    name: String,
    timeline: Timeline<'static, G>,
    /// The verifier; `None` once there is a verdict.
    check: Option<Box<VerifiedReplay<'static, G>>>,
    verdict: Option<Verdict>,
    /// Empty world, shown for a game without a world.
    nothing: World,
    presentation: Presentation<G>,
}

impl<G: Game + 'static> Replay<G> {
    /// Opens a replay.
    ///
    /// # Errors
    /// The [`Verdict`] if no tick of the replay can be played.
    pub fn open(name: &str, bytes: &'static [u8], limits: &Limits) -> Result<Self, Verdict> {
        let options = TimelineOptions { interval: INTERVAL, ..TimelineOptions::default() };
        let timeline = Timeline::open(bytes, &options, limits)?;
        let check = Some(Box::new(VerifiedReplay::open(bytes, limits)?));
        Ok(Replay {
            name: name.into(),
            timeline,
            check,
            verdict: None,
            nothing: World::default(),
            presentation: Presentation::default(),
        })
    }

    pub(crate) fn presented(self, presentation: Presentation<G>) -> Self {
        Replay { presentation, ..self }
    }

    /// Returns the game at the current tick.
    #[must_use]
    pub fn game(&self) -> &G {
        self.timeline.game()
    }

    fn go(&mut self, tick: u64) -> Result<(), SourceError> {
        if tick == self.timeline.tick() {
            return Ok(());
        }
        // Seeks to the tick before and simulates the requested tick, so that derived data such as contact points is
        // available.
        let Some(before) = tick.checked_sub(1) else {
            return self.timeline.seek(tick).map_err(SourceError::of);
        };
        self.timeline.seek(before).map_err(SourceError::of)?;
        self.timeline.step().map(drop).map_err(SourceError::of)
    }
}

impl<G: Game + 'static> Source for Replay<G> {
    fn name(&self) -> &str {
        &self.name
    }

    fn world(&mut self) -> &World {
        self.timeline.world().unwrap_or(&self.nothing)
    }

    fn hash(&self) -> StateHash {
        self.timeline.game().state_hash()
    }

    fn tick(&self) -> u64 {
        self.timeline.tick()
    }

    fn ticks(&self) -> Option<u64> {
        Some(self.timeline.ticks())
    }

    fn tick_rate(&self) -> u32 {
        self.timeline.game().tick_rate()
    }

    fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
        self.go(tick.min(self.timeline.ticks()))
    }

    fn decorate(&mut self, list: &mut DrawList, camera: &Camera) {
        self.presentation.draw(self.timeline.game(), list, camera);
    }

    fn state(&self) -> Vec<(String, String)> {
        (self.presentation.state)(self.timeline.game())
    }

    fn status(&self) -> String {
        match (&self.verdict, &self.check) {
            (Some(verdict), _) => verdict.to_string(),
            (None, Some(check)) => format!("verifying: tick {} of {}", check.tick(), check.ticks()),
            (None, None) => String::new(),
        }
    }

    fn verdict(&self) -> Option<&Verdict> {
        self.verdict.as_ref()
    }

    fn think(&mut self) -> bool {
        let Some(check) = &mut self.check else { return false };
        let enough = check.work().saturating_add(THINK_WORK);
        while check.work() < enough {
            if !matches!(check.step(), Ok(Step::Ticked)) {
                self.verdict = self.check.take().map(|check| check.conclude());
                return false;
            }
        }
        true
    }
}
