//! [`Rules`]: the state of a match besides the world.

use lockstep2d::body::{BodyId, WorldError};
use lockstep2d::math::Rng;
use lockstep2d::world::World;
use serde::{Deserialize, Serialize};

use crate::SEATS_MAX;
use crate::arena;

/// Length of [`Phase::Ready`] in ticks, in which players cannot move yet.
const READY: u16 = 60;
/// Maximum length of [`Phase::Fight`], in ticks.
const FIGHT: u16 = 1200;
/// Length of [`Phase::Pause`] after a round, in ticks.
const PAUSE: u16 = 75;
/// Ticks from the start of [`Phase::Fight`] until the first ring crumbles.
const FIRST_RING: u16 = 180;
/// Ticks between two rings.
const RING: u16 = 60;

/// Phase of a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// A round is about to begin, and players cannot move.
    Ready,
    /// A round is being played.
    Fight,
    /// A round has ended.
    Pause,
    /// The match has ended, and players cannot move.
    Over,
}

/// A seat, which is taken or empty. Seats beyond those of the match stay empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Seat {
    pub(crate) present: bool,
    /// Body of the player, until it falls.
    pub(crate) body: Option<BodyId>,
    /// Ticks until the player can dash again.
    pub(crate) recharge: u8,
    /// One point for each player that fell in [`Phase::Fight`] while this player was standing.
    pub(crate) score: u32,
    /// Number of rounds won.
    pub(crate) won: u32,
}

/// State of a match besides its world.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Rules {
    pub(crate) seats: [Seat; SEATS_MAX],
    /// Number of the round, counted from 1. It is 0 before the first round that counts.
    pub(crate) round: u8,
    pub(crate) phase: Phase,
    /// Ticks until the phase ends by time.
    pub(crate) ticks_left: u16,
    /// Number of rings that have crumbled.
    pub(crate) rings: u8,
    /// Number of players at the start of the round. With fewer than two players, the round is practice and does not
    /// count.
    starters: u8,
    rng: Rng,
}

impl Rules {
    /// State before the first tick, which begins a round with the players that are present.
    pub(crate) fn new(seed: u64) -> Self {
        Rules {
            seats: [Seat::default(); SEATS_MAX],
            round: 0,
            phase: Phase::Pause,
            ticks_left: 0,
            rings: 0,
            starters: 0,
            rng: Rng::new(seed),
        }
    }

    fn count(&self, which: impl Fn(&Seat) -> bool) -> u8 {
        self.seats.iter().map(|seat| u8::from(which(seat))).sum()
    }

    pub(crate) fn is_practice(&self) -> bool {
        self.starters < 2
    }

    /// Whether players can move.
    pub(crate) fn is_on(&self) -> bool {
        matches!(self.phase, Phase::Fight | Phase::Pause)
    }

    /// Sets whether the player of a seat is present. A player who leaves loses its body. This is not a fall, so nobody
    /// gets a point. A player who joins gets a body in the next round. If the current round is practice, the next round
    /// begins at once.
    pub(crate) fn seat(&mut self, world: &mut World, seat: usize, present: bool) {
        let Some(seat) = self.seats.get_mut(seat) else { return };
        seat.present = present;
        if let Some(body) = seat.body.filter(|_| !present) {
            // This fails only if the body does not exist.
            let _ = world.despawn(body);
            seat.body = None;
        }
    }

    /// Counts down the ticks of the phase. Enters the next phase when the time is up, when the round is decided, or
    /// when a player joins a practice round.
    pub(crate) fn advance(&mut self, world: &mut World, rounds: u8) -> Result<(), WorldError> {
        self.ticks_left = self.ticks_left.saturating_sub(1);
        let (present, standing) = (self.count(|seat| seat.present), self.count(|seat| seat.body.is_some()));
        let is_decided = if self.is_practice() { standing < self.starters } else { standing < 2 };
        let is_due = self.ticks_left == 0;
        match self.phase {
            Phase::Over => Ok(()),
            _ if self.is_practice() && present > self.starters => self.begin_round(world),
            Phase::Pause if is_due && self.round >= rounds && !self.is_practice() => {
                self.phase = Phase::Over;
                Ok(())
            }
            Phase::Pause if is_due => self.begin_round(world),
            Phase::Ready if is_due => {
                (self.phase, self.ticks_left) = (Phase::Fight, FIGHT);
                Ok(())
            }
            Phase::Fight if is_due || is_decided => {
                self.end_round(standing);
                Ok(())
            }
            Phase::Fight => self.crumble(world),
            Phase::Ready | Phase::Pause => Ok(()),
        }
    }

    /// Resets the arena, and places the players that are present.
    fn begin_round(&mut self, world: &mut World) -> Result<(), WorldError> {
        self.starters = self.count(|seat| seat.present);
        self.round = self.round.saturating_add(u8::from(!self.is_practice()));
        (self.phase, self.ticks_left, self.rings) = (Phase::Ready, READY, 0);
        arena::draw_platform(world, arena::radius(0))?;
        arena::lay_crates(world, &mut self.rng)?;
        let first = self.rng.angle();
        let mut places = [0, 1, 2, 3];
        let places = &mut places[..self.starters.into()];
        self.rng.shuffle(places);
        let mut places = places.iter();
        for (index, seat) in (0..).zip(&mut self.seats) {
            if let Some(body) = seat.body.take() {
                let _ = world.despawn(body);
            }
            seat.recharge = 0;
            if seat.present {
                let place = (places.next().copied().unwrap_or(0), self.starters);
                seat.body = Some(arena::place_player(world, index, place, first)?);
            }
        }
        Ok(())
    }

    fn end_round(&mut self, standing: u8) {
        (self.phase, self.ticks_left) = (Phase::Pause, PAUSE);
        if standing == 1 && !self.is_practice() {
            for seat in self.seats.iter_mut().filter(|seat| seat.body.is_some()) {
                seat.won = seat.won.saturating_add(1);
            }
        }
    }

    /// Removes a ring of the platform when due.
    fn crumble(&mut self, world: &mut World) -> Result<(), WorldError> {
        let elapsed = FIGHT.saturating_sub(self.ticks_left);
        let due = elapsed >= FIRST_RING && (elapsed - FIRST_RING).is_multiple_of(RING);
        if due && self.rings < arena::RINGS {
            self.rings += 1;
            arena::draw_platform(world, arena::radius(self.rings))?;
        }
        Ok(())
    }

    /// Clears the bodies in the seats of fallen players. In [`Phase::Fight`], each player still standing gets a point
    /// for each fallen player.
    pub(crate) fn fall(&mut self, fallen: &[u8]) {
        for &seat in fallen {
            if let Some(seat) = self.seats.get_mut(usize::from(seat)) {
                seat.body = None;
            }
        }
        if self.phase == Phase::Fight {
            let points = fallen.iter().fold(0u32, |points, _| points.saturating_add(1));
            for seat in self.seats.iter_mut().filter(|seat| seat.body.is_some()) {
                seat.score = seat.score.saturating_add(points);
            }
        }
    }
}
