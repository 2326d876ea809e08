//! [`Player`]: the control of a seat.

use std::fmt;
use std::rc::Rc;

use lockstep2d::lockstep::Game;

use super::controls::Controls;
use crate::event::{Event, Key};

/// A computer player: a function that returns the input for the next tick. It is called only for new ticks, and not
/// when a recorded tick is played again.
pub type Bot<G> = Box<dyn FnMut(&G) -> <G as Game>::Input>;

/// Creates a bot. The arguments are the scene's random seed and the seat number.
type MakeBot<G> = Rc<dyn Fn(u64, usize) -> Bot<G>>;

/// Control of a seat: keys, a bot or no player. Tests pass players to a [`LocalMatch`](crate::LocalMatch).
///
/// ```
/// use std::rc::Rc;
/// use lockstep2d::{lockstep::{Sandbox, SandboxSetup}, math::Vec2, world::Command};
/// use lockstep2d_viewer::{Bot, Controls, LocalMatch, Player, Source};
///
/// // The sandbox has one seat: a bot that turns gravity off in the first tick.
/// fn bot(_seed: u64, _seat: usize) -> Bot<Sandbox> {
///     Box::new(|game| match game.world().tick() {
///         0 => vec![Command::SetGravity { gravity: Vec2::ZERO }],
///         _ => vec![],
///     })
/// }
/// let bot = Player::<Sandbox>::Bot(Rc::new(bot));
/// let mut play = LocalMatch::new("weightless", &SandboxSetup::default(), &[bot], 0)?;
/// play.seek(10)?;
/// assert_eq!(play.world().config().gravity, Vec2::ZERO);
/// // A person without keys and an absent player: both give no input.
/// for player in [Player::Keys(Controls::new()), Player::Absent] {
///     LocalMatch::<Sandbox>::new("still", &SandboxSetup::default(), &[player], 0)?.seek(10)?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub enum Player<G: Game> {
    /// A person at the keyboard.
    Keys(Controls<G::Input>),
    /// A bot, created from the scene's random seed and the seat number.
    Bot(MakeBot<G>),
    /// No player: the seat's input is [`Game::absent`].
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

    pub(super) fn input(&mut self, game: &G) -> G::Input {
        match self {
            Seated::Keys(controls) => controls.take(),
            Seated::Bot(bot) => bot(game),
            Seated::Absent => G::absent(),
        }
    }

    pub(super) fn presses(&self) -> bool {
        matches!(self, Seated::Keys(controls) if controls.is_pressed())
    }

    pub(super) fn forget_taps(&mut self) {
        if let Seated::Keys(controls) = self {
            controls.forget_taps();
        }
    }

    pub(super) fn keys(&self) -> impl Iterator<Item = Key> {
        let controls = match self {
            Seated::Keys(controls) => Some(controls),
            _ => None,
        };
        controls.into_iter().flat_map(Controls::keys)
    }

    pub(super) fn handle(&mut self, event: &Event) -> bool {
        match self {
            Seated::Keys(controls) => controls.handle(event),
            _ => false,
        }
    }
}
