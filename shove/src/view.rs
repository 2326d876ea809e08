//! What can be seen of a match: everything that a bot, a window or a score table asks for.

use lockstep2d::body::{Body, BodyId};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::World;

use crate::arena;
use crate::game::Shove;
use crate::rules::Phase;
use crate::setup::Setup;

/// How a player stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Player {
    /// Whether somebody sits on the seat.
    pub present: bool,
    /// The body, while it stands on the platform.
    pub body: Option<BodyId>,
    /// Where it is, in metres; zero without a body.
    pub position: Vec2<Fx>,
    /// How fast it is, in m/s; zero without a body.
    pub velocity: Vec2<Fx>,
    /// Ticks until it can dash.
    pub recharge: u32,
    /// Points: one for each player whom it has outlived.
    pub score: u32,
    /// Rounds won.
    pub won: u32,
}

impl Player {
    /// Whether it stands on the platform.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        self.body.is_some()
    }
}

impl Shove {
    /// What the match started from.
    #[must_use]
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The world; [`Role::of`](crate::Role::of) tells what its bodies are.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The number of seats.
    #[must_use]
    pub fn seats(&self) -> usize {
        self.setup.seats.into()
    }

    /// The player on a seat; `None` above the number of seats.
    #[must_use]
    pub fn player(&self, seat: usize) -> Option<Player> {
        let seat = self.rules.seats.get(seat).filter(|_| seat < self.seats())?;
        let body = seat.body.and_then(|id| self.world.body(id));
        Some(Player {
            present: seat.present,
            body: seat.body,
            position: body.map_or(Vec2::ZERO, Body::position),
            velocity: body.map_or(Vec2::ZERO, Body::velocity),
            recharge: seat.recharge.into(),
            score: seat.score,
            won: seat.won,
        })
    }

    /// The players of all seats.
    pub fn players_in_order(&self) -> impl Iterator<Item = Player> {
        (0..self.seats()).filter_map(|seat| self.player(seat))
    }

    /// The radius of what is left of the platform, in metres.
    #[must_use]
    pub fn radius(&self) -> Fx {
        arena::radius(self.rules.rings)
    }

    /// The number of the round, from 1; 0 before the first that counts.
    #[must_use]
    pub const fn round(&self) -> u8 {
        self.rules.round
    }

    /// What is going on.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.rules.phase
    }

    /// Ticks until the phase ends by itself.
    #[must_use]
    pub const fn ticks_left(&self) -> u16 {
        self.rules.ticks_left
    }
}
