//! [`Player`]: who controls a seat.

use std::fmt;
use std::rc::Rc;

use lockstep2d::lockstep::Game;

use super::controls::Controls;
use crate::event::Event;

/// A computer player: returns the input for the next tick of a game. It is called once per tick.
pub type Bot<G> = Box<dyn FnMut(&G) -> <G as Game>::Input>;

/// Creates the bot of a seat, with the random seed of the scene.
type MakeBot<G> = Rc<dyn Fn(u64, usize) -> Bot<G>>;

/// Who controls a seat.
pub enum Player<G: Game> {
    /// A person at the keyboard.
    Keys(Controls<G::Input>),
    /// A bot, created from the random seed of the scene and the number of its seat.
    Bot(MakeBot<G>),
    /// Nobody: the seat's input is [`Game::absent`].
    Absent,
}

impl<G: Game> Clone for Player<G> {
    fn clone(&self) -> Self {
        match self {
            Player::Keys(controls) => Player::Keys(controls.clone()),
            Player::Bot(bot) => Player::Bot(Rc::clone(bot)),
            Player::Absent => Player::Absent,
        }
    }
}

impl<G: Game> fmt::Debug for Player<G> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Player::Keys(_) => "Keys",
            Player::Bot(_) => "Bot",
            Player::Absent => "Absent",
        })
    }
}

/// A player in a match.
pub(super) enum Seated<G: Game> {
    Keys(Controls<G::Input>),
    Bot(Bot<G>),
    Absent,
}

impl<G: Game> Seated<G> {
    pub(super) fn new(player: &Player<G>, seed: u64, seat: usize) -> Self {
        match player {
            Player::Keys(controls) => Seated::Keys(controls.clone()),
            Player::Bot(bot) => Seated::Bot(bot(seed, seat)),
            Player::Absent => Seated::Absent,
        }
    }

    /// The input for the next tick.
    pub(super) fn input(&mut self, game: &G) -> G::Input {
        match self {
            Seated::Keys(controls) => controls.take(),
            Seated::Bot(bot) => bot(game),
            Seated::Absent => G::absent(),
        }
    }

    /// Whether a person presses a key.
    pub(super) fn presses(&self) -> bool {
        matches!(self, Seated::Keys(controls) if controls.is_pressed())
    }

    /// Handles a key. Returns `true` if it is one of this player.
    pub(super) fn handle(&mut self, event: &Event) -> bool {
        match self {
            Seated::Keys(controls) => controls.handle(event),
            _ => false,
        }
    }
}
