//! [`Netplay`]: a match at one computer.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::RecordError;
use lockstep2d::world::World;
use lockstep2d_render::{Camera, DrawList};
use lockstep2d_shove::{Bot, Pad, Save, Setup, Shove};

use super::decorate::{decorate, headline};
use super::keys::{Keys, Side};
use crate::event::Event;
use crate::recording::{Recording, RecordingError};
use crate::source::{Source, SourceError};

/// Controller of a seat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chair {
    /// A person with these keys.
    Person(Side),
    /// A bot.
    Bot,
    /// No player.
    Empty,
}

/// Match of people at one keyboard and bots.
///
/// As in a live sandbox, every tick is recorded and any tick can be sought. Recorded ticks are played again until a
/// person presses one of the players' keys: the match then continues live from there, and the later recorded ticks
/// are dropped.
pub struct Netplay {
    recording: Recording<Shove>,
    players: Vec<Player>,
}

enum Player {
    Person(Keys),
    Bot(Bot),
    Nobody,
}

impl Netplay {
    /// Starts a match of `chairs.len()` seats, 2 to 4.
    ///
    /// # Errors
    /// [`RecordError`] if the number of seats is out of range or the setup is invalid in another way.
    pub fn new(setup: Setup, chairs: &[Chair]) -> Result<Self, RecordError> {
        let setup = Setup { seats: u8::try_from(chairs.len()).unwrap_or(u8::MAX), ..setup };
        let recording = Recording::start(&setup, Save::rollback_bytes)?;
        let player = |(seat, chair): (u8, &Chair)| match chair {
            Chair::Person(side) => Player::Person(Keys::new(*side)),
            Chair::Bot => Player::Bot(Bot::new(setup.seed, seat)),
            Chair::Empty => Player::Nobody,
        };
        Ok(Netplay { recording, players: (0..).zip(chairs).map(player).collect() })
    }

    /// Starts a match of two people at one keyboard, the first on its left side, and this number of bots, at most 2.
    ///
    /// # Errors
    /// As [`Netplay::new`].
    pub fn for_two(seed: u64, bots: usize) -> Result<Self, RecordError> {
        let mut chairs = vec![Chair::Person(Side::Left), Chair::Person(Side::Right)];
        chairs.resize(2 + bots.min(2), Chair::Bot);
        Self::new(Setup { seed, ..Setup::default() }, &chairs)
    }

    /// Returns the match at the current tick.
    #[must_use]
    pub fn game(&self) -> &Shove {
        self.recording.game()
    }

    fn step(&mut self) -> Result<(), RecordingError> {
        if !self.recording.is_at_end() && !self.somebody_presses() {
            return self.recording.replay_tick();
        }
        let game = self.recording.game();
        let pads: Vec<_> = self.players.iter_mut().map(|player| player.pad(game)).collect();
        self.recording.play(&pads)
    }

    fn somebody_presses(&self) -> bool {
        self.players.iter().any(|player| match player {
            Player::Person(keys) => keys.pad() != Pad::default(),
            _ => false,
        })
    }
}

impl Player {
    fn pad(&mut self, game: &Shove) -> Pad {
        match self {
            Player::Person(keys) => keys.pad(),
            Player::Bot(bot) => bot.pad(game),
            Player::Nobody => Pad::ABSENT,
        }
    }
}

impl Source for Netplay {
    fn name(&self) -> &str {
        "shove"
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

    /// Always `None`: the world runs on after the last round.
    fn ticks(&self) -> Option<u64> {
        None
    }

    fn recorded(&self) -> u64 {
        self.recording.ticks()
    }

    fn tick_rate(&self) -> u32 {
        self.recording.game().tick_rate()
    }

    /// Seeking forwards plays; seeking backwards keeps the recording.
    fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
        if tick < self.tick() {
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
        // All players get the event, so that none misses the release of a key.
        let taken = self.players.iter_mut().map(|player| match player {
            Player::Person(keys) => keys.handle(event),
            _ => false,
        });
        taken.fold(false, |any, taken| any | taken)
    }

    fn decorate(&mut self, list: &mut DrawList, camera: &Camera) {
        decorate(self.recording.game(), list, camera);
    }

    fn save_replay(&mut self) -> Option<Result<Vec<u8>, SourceError>> {
        Some(self.recording.to_replay().map_err(SourceError::of))
    }

    fn status(&self) -> String {
        let course = if self.recording.is_at_end() { "live" } else { "recorded" };
        format!("{course} · {}", headline(self.recording.game()))
    }
}
