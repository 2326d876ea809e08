//! [`Live`]: a world that the user can act in while it runs.

mod act;
mod hand;
mod pick;
mod spawn;

pub use act::{Act, Aim, Form, Held, Playground};

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSave, SandboxSetup};
use lockstep2d::replay::{Limits, RecordError};
use lockstep2d::world::{Command, World};
use lockstep2d_scenes::Scene;

use crate::recording::{Recording, RecordingError};
use crate::source::{Source, SourceError};
use hand::Hand;

/// A sandbox in which the user acts, and its recording.
///
/// Every tick is recorded, so the user can go to any tick since the start. Playing on from an earlier tick shows the
/// recorded ticks again, until an [`Act`] issues commands. The later recorded ticks are then dropped. If the work of
/// the replay exceeds the limit of a verifier, the status shows a lower bound for the verifier's argument `--max-work`.
///
/// ```
/// use lockstep2d_scenes::Scene;
/// use lockstep2d_viewer::{Source, live::{Act, Live, Playground}};
///
/// let scene = Scene::find("box_stack").expect("a scene");
/// let mut live = Live::scene(scene, 0)?;
/// live.seek(30)?;
/// live.act(Act::Gravity(lockstep2d::math::Vec2::ZERO));
/// live.seek(60)?;
/// live.seek(10)?;
/// assert_eq!((live.tick(), live.recorded()), (10, 60));
/// let file = live.save_replay().expect("it records")?;
/// assert!(lockstep2d::replay::verify::<lockstep2d::lockstep::Sandbox>(&file, &Default::default()).is_match());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Live {
    name: String,
    scene: Option<&'static Scene>,
    recording: Recording<Sandbox>,
    hand: Hand,
    acts: Vec<Act>,
    /// Message for the status if commands were dropped in the last played tick.
    note: Option<&'static str>,
}

impl Live {
    /// Starts a scene. In every live tick, the commands of its script run before those of the user.
    ///
    /// # Errors
    /// [`RecordError`] if a replay cannot hold the scene.
    pub fn scene(scene: &'static Scene, seed: u64) -> Result<Self, RecordError> {
        let live = Self::new(scene.name, &scene.setup(seed))?;
        Ok(Live { scene: Some(scene), ..live })
    }

    /// Starts a world from any setup.
    ///
    /// # Errors
    /// [`RecordError`] if the setup is invalid or a replay cannot hold it.
    pub fn new(name: impl Into<String>, setup: &SandboxSetup) -> Result<Self, RecordError> {
        let recording = Recording::start(setup, |_, save: &SandboxSave| save.world.rollback_bytes())?;
        Ok(Live {
            name: name.into(),
            scene: None,
            recording,
            hand: Hand::new(0),
            acts: Vec::new(),
            note: None,
        })
    }

    pub(crate) fn limited(self, limits: &Limits) -> Self {
        Live { recording: self.recording.limited(limits.clone()), ..self }
    }

    /// Returns the sandbox at the current tick.
    #[must_use]
    pub fn game(&self) -> &Sandbox {
        self.recording.game()
    }

    /// Plays the recorded tick if there is one and the acts issue no commands. Otherwise plays a live tick.
    fn step(&mut self) -> Result<(), RecordingError> {
        let world = self.recording.game().world();
        let goes_on = self.recording.is_at_end();
        let mut done = Vec::new();
        if goes_on {
            self.hand.follow(world, &mut done);
        }
        for act in self.acts.drain(..) {
            self.hand.act(act, world, &mut done);
        }
        if !goes_on && done.is_empty() {
            return self.recording.replay_tick();
        }
        self.hand.pull(world, &mut done);
        self.play(done)
    }

    fn play(&mut self, done: Vec<Command>) -> Result<(), RecordingError> {
        let script = self.scene.map(|scene| scene.commands(self.recording.tick(), self.recording.game()));
        let script = script.unwrap_or_default();
        let all = [[script.clone(), done].concat()];
        self.note = None;
        match self.recording.play(&all) {
            // The commands do not fit in a replay. The user's commands are dropped.
            Err(RecordingError::TooMuch | RecordingError::Record(_)) if all[0].len() > script.len() => {
                self.hand.forget();
                self.note = Some("too many commands in one tick: they were dropped");
                if self.recording.is_at_end() {
                    self.recording.play(&[script])
                } else {
                    self.recording.replay_tick()
                }
            }
            result => result,
        }
    }
}

impl Playground for Live {
    fn act(&mut self, act: Act) {
        // If several drag targets follow each other, only the last counts.
        if let (Act::DragTo(_), Some(Act::DragTo(_))) = (act, self.acts.last()) {
            self.acts.pop();
        }
        self.acts.push(act);
    }

    fn held(&self) -> Option<Held> {
        self.hand.held()
    }

    fn waiting(&self) -> usize {
        self.acts.len()
    }
}

impl Source for Live {
    fn name(&self) -> &str {
        &self.name
    }

    fn world(&mut self) -> &World {
        self.recording.game().world()
    }

    fn hash(&self) -> StateHash {
        self.recording.game().state_hash()
    }

    fn tick(&self) -> u64 {
        self.recording.tick()
    }

    fn ticks(&self) -> Option<u64> {
        None
    }

    fn recorded(&self) -> u64 {
        self.recording.ticks()
    }

    fn tick_rate(&self) -> u32 {
        self.recording.game().tick_rate()
    }

    /// Seeking forwards plays, also beyond the recorded ticks. Seeking backwards drops queued acts and releases the
    /// held body.
    fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
        if tick < self.tick() {
            self.acts.clear();
            self.hand.forget();
            return self.recording.seek(tick).map_err(SourceError::of);
        }
        while self.tick() < tick {
            if self.acts.is_empty() && !self.recording.is_at_end() {
                self.recording.seek(tick.min(self.recorded())).map_err(SourceError::of)?;
            } else {
                self.step().map_err(SourceError::of)?;
            }
        }
        Ok(())
    }

    fn playground(&mut self) -> Option<&mut dyn Playground> {
        Some(self)
    }

    fn save_replay(&mut self) -> Option<Result<Vec<u8>, SourceError>> {
        Some(self.recording.replay_file().map_err(SourceError::of))
    }

    fn status(&self) -> String {
        let refused = self.recording.game().refused();
        let course = if self.recording.is_at_end() { "live" } else { "recorded" };
        let mut status = format!("{course} · {refused} commands refused");
        status.extend(self.note.map(|note| format!(" · {note}")));
        status + &self.recording.limit_hint()
    }
}
