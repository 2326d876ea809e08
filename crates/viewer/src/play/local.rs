//! [`LocalMatch`]: a game that is played on one computer.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Limits, RecordError};
use lockstep2d::world::World;
use lockstep2d_render::{Camera, DrawList};

use super::player::{Player, Seated};
use super::presentation::Presentation;
use crate::event::{Event, Key};
use crate::recording::{Recording, RecordingError};
use crate::source::{Source, SourceError};

/// A game played at one keyboard, by people and bots.
///
/// Every tick is recorded, and the user can go to any recorded tick. From there, the recorded ticks are played again
/// until a person presses a player's key. The game then continues with new inputs, and the later recorded ticks are
/// dropped.
pub struct LocalMatch<G: Game> {
    name: String,
    recording: Recording<G>,
    players: Vec<Seated<G>>,
    presentation: Presentation<G>,
    /// Empty world, shown for a game without a world.
    nothing: World,
}

/// Number of bytes that a save does not share with other saves. It includes a kilobyte for the state of the game's own
/// rules.
fn bytes_of<G: Game>(game: &G, _: &G::Save) -> usize {
    1024 + game.world().map_or(0, |world| world.save().rollback_bytes())
}

impl<G: Game + 'static> LocalMatch<G> {
    /// Starts a game. The players take its seats in order. If there are fewer players than seats, the remaining seats
    /// have no player ([`Player::Absent`]). If there are more, the surplus players are ignored. Bots are created from
    /// `seed`.
    ///
    /// # Errors
    /// [`RecordError`] if the game refuses the setup or a replay cannot hold it.
    pub fn new(
        name: impl Into<String>,
        setup: &G::Setup,
        players: &[Player<G>],
        seed: u64,
    ) -> Result<Self, RecordError> {
        let recording = Recording::<G>::start(setup, bytes_of)?;
        let seats = usize::try_from(recording.game().players()).unwrap_or(usize::MAX);
        let seated = players.iter().chain(std::iter::repeat(&Player::Absent)).take(seats).enumerate();
        let players = seated.map(|(seat, player)| Seated::new(player, seed, seat)).collect();
        let (presentation, nothing) = (Presentation::default(), World::default());
        Ok(LocalMatch { name: name.into(), recording, players, presentation, nothing })
    }

    pub(crate) fn presented(self, presentation: Presentation<G>) -> Self {
        LocalMatch { presentation, ..self }
    }

    pub(crate) fn limited(self, limits: &Limits) -> Self {
        LocalMatch { recording: self.recording.limited(limits.clone()), ..self }
    }

    /// Returns the game at the current tick.
    #[must_use]
    pub fn game(&self) -> &G {
        self.recording.game()
    }

    fn step(&mut self) -> Result<(), RecordingError> {
        if !self.recording.is_at_end() && !self.somebody_presses() {
            return self.recording.replay_tick();
        }
        let game = self.recording.game();
        let inputs: Vec<_> = self.players.iter_mut().map(|player| player.input(game)).collect();
        self.recording.play(&inputs)
    }

    fn somebody_presses(&self) -> bool {
        self.players.iter().any(Seated::presses)
    }
}

impl<G: Game + 'static> Source for LocalMatch<G> {
    fn name(&self) -> &str {
        &self.name
    }

    fn world(&mut self) -> &World {
        self.recording.game().world().unwrap_or(&self.nothing)
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

    /// Seeking forwards plays the ticks up to `tick`, also beyond the last recorded tick. Seeking backwards keeps the
    /// recording, and forgets the keys that went down since the last tick and are up again.
    fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
        if tick < self.tick() {
            self.players.iter_mut().for_each(Seated::forget_taps);
            return self.recording.seek(tick).map_err(SourceError::of);
        }
        while self.tick() < tick {
            if self.recording.is_at_end() || self.somebody_presses() {
                self.step().map_err(SourceError::of)?;
            } else {
                self.recording.seek(tick.min(self.recorded())).map_err(SourceError::of)?;
            }
        }
        Ok(())
    }

    fn handle(&mut self, event: &Event) -> bool {
        // Every player handles the event, so that none misses the release of a key.
        let taken = self.players.iter_mut().map(|player| player.handle(event));
        taken.fold(false, |any, taken| any | taken)
    }

    fn keys(&self) -> Vec<Key> {
        self.players.iter().flat_map(Seated::keys).collect()
    }

    fn decorate(&mut self, list: &mut DrawList, camera: &Camera) {
        self.presentation.draw(self.recording.game(), list, camera);
    }

    fn state(&self) -> Vec<(String, String)> {
        (self.presentation.state)(self.recording.game())
    }

    fn save_replay(&mut self) -> Option<Result<Vec<u8>, SourceError>> {
        Some(self.recording.replay_file().map_err(SourceError::of))
    }

    fn status(&self) -> String {
        let course = if self.recording.is_at_end() { "live" } else { "recorded" };
        let own = (self.presentation.status)(self.recording.game());
        let status = if own.is_empty() { course.to_owned() } else { format!("{course} · {own}") };
        status + &self.recording.limit_hint()
    }
}
