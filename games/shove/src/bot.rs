//! [`Bot`]: computer player, as an opponent and for tests.

use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2, fx_mul};

use crate::game::Shove;
use crate::pad::Pad;
use crate::setup::Setup;
use crate::view::Player;

/// Computer player. Its pads depend only on its seed, its seat and the states of the match.
///
/// The bot tries to be closer to the centre than its opponent, and pushes the opponent outwards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bot {
    seat: usize,
    rng: Rng,
    /// Smallest distance from the edge that the bot accepts, in metres. It turns back towards the centre if its
    /// predicted position in 0.3 s is closer to the edge.
    caution: Fx,
    pad: Pad,
    /// Number of further ticks for which the bot keeps its pad.
    hold: u32,
}

impl Bot {
    /// Creates a bot for a seat.
    #[must_use]
    pub fn new(seed: u64, seat: u8) -> Self {
        let mut rng = Rng::with_stream(seed, seat.into());
        let caution = rng.range(fx!(0.4), fx!(1.2));
        Bot { seat: seat.into(), rng, caution, pad: Pad::default(), hold: 0 }
    }

    /// Creates a bot for each seat, with the seed of the match.
    #[must_use]
    pub fn each(setup: &Setup) -> Vec<Bot> {
        (0..setup.seats).map(|seat| Bot::new(setup.seed, seat)).collect()
    }

    /// The pad for the next tick. Must be called once per tick.
    pub fn pad(&mut self, game: &Shove) -> Pad {
        if self.hold > 0 {
            self.hold -= 1;
            return self.pad;
        }
        self.hold = 2 + self.rng.below(6);
        self.pad = match game.player(self.seat) {
            Some(me) if me.is_alive() => self.decide(game, &me),
            _ => Pad::default(),
        };
        self.pad
    }

    fn decide(&mut self, game: &Shove, me: &Player) -> Pad {
        // Predicted position in 0.3 s.
        let soon = me.position + me.velocity.scale(fx!(0.3));
        let margin = game.radius().saturating_sub(soon.length());
        if margin < self.caution {
            let back = Pad::towards(-me.position);
            return if margin < Fx::ZERO { back.with(Pad::DASH) } else { back };
        }
        let distance = |other: &Player| other.position.distance(me.position);
        // If several opponents are equally close, the bot attacks the next seat after its own. Otherwise all bots would
        // attack the first seat.
        let others = (1..game.seats()).filter_map(|next| game.player((self.seat + next) % game.seats()));
        let others = others.filter(Player::is_alive);
        let Some(other) = others.min_by_key(distance) else {
            return Pad::towards(-me.position);
        };
        if self.rng.chance(1, 12) {
            return Pad::towards(self.direction());
        }
        self.attack(me, &other)
    }

    fn attack(&mut self, me: &Player, other: &Player) -> Pad {
        let there = other.position + other.velocity.scale(fx!(0.15));
        let way = there - me.position;
        let distance = way.length();
        let outwards = other.position.normalized().map_or(Vec2::ZERO, Vec2::widen);
        // Radial distance by which the opponent is farther outwards than the bot, in metres.
        let inside = way.dot(outwards);
        if inside > fx_mul(distance, fx!(0.4)) {
            let push = Pad::towards(way);
            let dashes = distance < fx!(3) && self.rng.chance(1, 2);
            return if dashes { push.with(Pad::DASH) } else { push };
        }
        let behind = other.position - outwards.scale(fx!(1.6));
        Pad::towards(behind - me.position)
    }

    fn direction(&mut self) -> Vec2<Fx> {
        let (sin, cos) = self.rng.angle().sin_cos();
        Vec2::new(cos, sin).widen()
    }
}
