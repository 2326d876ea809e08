//! [`Bot`]: somebody to play against, and to test with.

use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2, fx_mul};

use crate::game::Shove;
use crate::pad::Pad;
use crate::setup::Setup;
use crate::view::Player;

/// A player that sees the match and nothing else. The same seed, seat and matches give the same pads.
///
/// It tries to be further inside than its opponent, pushes it outwards from there, and turns back before the edge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bot {
    seat: usize,
    rng: Rng,
    /// How far from the edge it turns back, in metres: how brave it is.
    caution: Fx,
    pad: Pad,
    /// Ticks for which it holds the pad: nobody changes their mind sixty times a second.
    hold: u32,
}

impl Bot {
    /// A bot for a seat.
    #[must_use]
    pub fn new(seed: u64, seat: u8) -> Self {
        let mut rng = Rng::with_stream(seed, seat.into());
        let caution = rng.range(fx!(0.4), fx!(1.2));
        Bot { seat: seat.into(), rng, caution, pad: Pad::default(), hold: 0 }
    }

    /// A bot for each seat of a match, with its seed.
    #[must_use]
    pub fn each(setup: &Setup) -> Vec<Bot> {
        (0..setup.seats).map(|seat| Bot::new(setup.seed, seat)).collect()
    }

    /// What it does in the next tick. To be asked once a tick.
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
        // Where it will be in a third of a second.
        let soon = me.position + me.velocity.scale(fx!(0.3));
        let margin = game.radius().saturating_sub(soon.length());
        if margin < self.caution {
            let back = Pad::towards(-me.position);
            return if margin < Fx::ZERO { back.with(Pad::DASH) } else { back };
        }
        let distance = |other: &Player| other.position.distance(me.position);
        // Of equally near ones the next one round the table, so that not everybody goes for the first.
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
        // How far it is inside of the other, along the push.
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
