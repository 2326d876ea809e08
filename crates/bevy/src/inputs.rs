//! [`Inputs`]: the inputs of the local players.

use bevy::prelude::Resource;

use crate::game::LockstepGame;

/// Inputs of the local players for the coming ticks. Write them in [`LockstepSystems::Inputs`](crate::LockstepSystems).
///
/// A frame may play no tick or several. A *held* input is the input of every tick until it changes: directions, buttons
/// that are down. A *once* input replaces the held input for the next played tick alone: a jump, a list of commands. So
/// a press counts once. During a pause, a *once* input waits for the next tick. In a replay, for a spectator and after
/// an error, it is removed in the same frame. When another game begins, it is removed before the systems of
/// [`LockstepSystems::Inputs`](crate::LockstepSystems) run and, if such a system replaces the game, after them.
///
/// ```
/// # use bevy_lockstep2d::Inputs;
/// # use lockstep2d::{lockstep::Sandbox, math::Vec2, fx, world::Command};
/// let mut inputs = Inputs::<Sandbox>::default();
/// inputs.once(0).push(Command::SetGravity { gravity: Vec2::new(fx!(0), fx!(-5)) });
/// ```
#[derive(Resource)]
pub struct Inputs<G: LockstepGame> {
    seats: Vec<Seat<G::Input>>,
    /// Number of the game that receives the inputs: see `Lockstep::number`.
    game: Option<u64>,
}

struct Seat<I> {
    held: I,
    once: Option<I>,
}

impl<I: Default> Default for Seat<I> {
    fn default() -> Self {
        Seat { held: I::default(), once: None }
    }
}

impl<G: LockstepGame> Default for Inputs<G> {
    fn default() -> Self {
        Inputs { seats: Vec::new(), game: None }
    }
}

/// Largest number of players, as in a replay.
const SEATS_MAX: u32 = 64;

impl<G: LockstepGame> Inputs<G> {
    /// The held input of a local player. Local players are counted from 0: in a match, they are your own seats in
    /// ascending order. Players above 63 share an input that is never used.
    pub fn held(&mut self, player: u32) -> &mut G::Input {
        &mut self.seat(player).held
    }

    /// The input of a local player for the next tick only. It begins as a copy of the held input.
    pub fn once(&mut self, player: u32) -> &mut G::Input {
        let Seat { held, once } = self.seat(player);
        once.get_or_insert_with(|| held.clone())
    }

    /// The input of a local player for the next tick only, if [`Inputs::once`] has created it.
    pub(crate) fn pending(&mut self, player: u32) -> Option<&mut G::Input> {
        self.seats.get_mut(player as usize)?.once.as_mut()
    }

    /// Removes all inputs.
    pub fn clear(&mut self) {
        self.seats.clear();
    }

    fn seat(&mut self, player: u32) -> &mut Seat<G::Input> {
        let index = player.min(SEATS_MAX) as usize;
        if self.seats.len() <= index {
            self.seats.resize_with(index + 1, Seat::default);
        }
        &mut self.seats[index]
    }

    pub(crate) fn next(&self, players: usize) -> Vec<G::Input> {
        let of = |player: usize| match self.seats.get(player) {
            Some(Seat { once: Some(once), .. }) => once.clone(),
            Some(Seat { held, .. }) => held.clone(),
            None => G::Input::default(),
        };
        (0..players).map(of).collect()
    }

    /// Sets the game that receives the inputs. Removes `once` inputs that a former game has not used.
    pub(crate) fn begin_game(&mut self, number: u64) {
        if self.game.replace(number).is_some_and(|former| former != number) {
            self.used();
        }
    }

    /// Removes the `once` inputs, because a tick has used them or no tick can use them.
    pub(crate) fn used(&mut self) {
        for seat in &mut self.seats {
            seat.once = None;
        }
    }
}
