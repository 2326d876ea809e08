//! [`Pad`]: what one player contributes to one tick, in a byte.

use lockstep2d::math::{Angle, Fx, Unit, Vec2};
use serde::{Deserialize, Serialize};

/// The buttons that are down, one bit each. What they cannot mean does nothing: bits 5 and 6, and of two opposite
/// directions both.
///
/// ```
/// use lockstep2d::math::Vec2;
/// use lockstep2d_shove::Pad;
/// let pad = Pad::LEFT.with(Pad::DASH);
/// assert_eq!(pad.direction(), Some(-Vec2::X));
/// assert_eq!(pad.with(Pad::RIGHT).direction(), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Pad(pub u8);

impl Pad {
    /// Towards -x.
    pub const LEFT: Pad = Pad(1);
    /// Towards +x.
    pub const RIGHT: Pad = Pad(1 << 1);
    /// Towards +y.
    pub const UP: Pad = Pad(1 << 2);
    /// Towards -y.
    pub const DOWN: Pad = Pad(1 << 3);
    /// A sudden push in the direction that is held.
    pub const DASH: Pad = Pad(1 << 4);
    /// Nobody sits here. No player sends it; bit 7 with any other bit means nothing.
    pub const ABSENT: Pad = Pad(1 << 7);

    /// The eight directions, counter-clockwise from +x.
    const COMPASS: [Pad; 8] = [
        Pad::RIGHT,
        Pad::RIGHT.with(Pad::UP),
        Pad::UP,
        Pad::UP.with(Pad::LEFT),
        Pad::LEFT,
        Pad::LEFT.with(Pad::DOWN),
        Pad::DOWN,
        Pad::DOWN.with(Pad::RIGHT),
    ];

    /// These buttons and those.
    #[must_use]
    pub const fn with(self, other: Pad) -> Pad {
        Pad(self.0 | other.0)
    }

    /// Whether all of these buttons are down.
    #[must_use]
    pub const fn has(self, buttons: Pad) -> bool {
        self.0 & buttons.0 == buttons.0
    }

    /// Whether nobody sits here.
    #[must_use]
    pub const fn is_absent(self) -> bool {
        self.0 == Pad::ABSENT.0
    }

    /// Where it points, as a unit vector; `None` in the middle.
    #[must_use]
    pub fn direction(self) -> Option<Vec2<Unit>> {
        let axis = |plus, minus| Fx::from_num(i32::from(self.has(plus)) - i32::from(self.has(minus)));
        Vec2::new(axis(Pad::RIGHT, Pad::LEFT), axis(Pad::UP, Pad::DOWN)).normalized()
    }

    /// The pad that points nearest to a direction; in the middle for the zero vector.
    #[must_use]
    pub fn towards(direction: Vec2<Fx>) -> Pad {
        if direction == Vec2::ZERO {
            return Pad::default();
        }
        // A sixteenth of a turn further, an eighth begins where the pad changes.
        let sixteenth = Angle::from_bits(1 << 28);
        let eighth = (Angle::of(direction) + sixteenth).to_bits() >> 29;
        Pad::COMPASS[eighth as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_is_pointed_at_by_its_pad() {
        for pad in Pad::COMPASS {
            let direction = pad.direction().expect("a direction");
            assert_eq!(Pad::towards(direction.widen()), pad);
        }
        assert_eq!(Pad::towards(Vec2::ZERO), Pad::default());
    }

    #[test]
    fn absence_is_one_pad_only() {
        let absent = (0..=u8::MAX).filter(|&bits| Pad(bits).is_absent());
        assert_eq!(absent.collect::<Vec<_>>(), [128]);
        assert_eq!(Pad(128 | 2).direction(), Some(Vec2::X));
        assert_eq!(Pad(0b0110_0000).direction(), None);
    }
}
