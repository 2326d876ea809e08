//! Read access to a match.

use lockstep2d::body::{Body, BodyId};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::World;

use crate::arena;
use crate::game::Shove;
use crate::rules::Phase;
use crate::setup::Setup;

/// Current state of a player.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Player {
    /// Whether the seat is taken.
    pub present: bool,
    /// Body of the player, until it falls.
    pub body: Option<BodyId>,
    /// Position in metres, or zero without a body.
    pub position: Vec2<Fx>,
    /// Velocity in m/s, or zero without a body.
    pub velocity: Vec2<Fx>,
    /// Ticks until the player can dash again.
    pub recharge: u32,
    /// One point for each player that fell in [`Phase::Fight`] while this player was standing.
    pub score: u32,
    /// Number of rounds won.
    pub won: u32,
}

impl Player {
    /// Whether the player stands on the platform.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        self.body.is_some()
    }
}

impl Shove {
    /// Parameters of the match.
    #[must_use]
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The world. [`Role::of`](crate::Role::of) gives the roles of its bodies.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// Number of seats.
    #[must_use]
    pub fn seats(&self) -> usize {
        self.setup.seats.into()
    }

    /// Player on a seat, counted from 0. `None` if there is no such seat.
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

    /// Players of all seats, in order.
    pub fn players_in_order(&self) -> impl Iterator<Item = Player> {
        (0..self.seats()).filter_map(|seat| self.player(seat))
    }

    /// Current radius of the platform, in metres.
    #[must_use]
    pub fn radius(&self) -> Fx {
        arena::radius(self.rules.rings)
    }

    /// Number of the round, counted from 1. It is 0 before the first round that counts.
    #[must_use]
    pub const fn round(&self) -> u8 {
        self.rules.round
    }

    /// Whether the round does not count, because it began with fewer than two players.
    #[must_use]
    pub fn is_practice(&self) -> bool {
        self.rules.is_practice()
    }

    /// Current phase.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.rules.phase
    }

    /// Ticks until the phase ends by time.
    #[must_use]
    pub const fn ticks_left(&self) -> u16 {
        self.rules.ticks_left
    }
}
