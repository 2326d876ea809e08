//! [`Pad`]: the input of a player for a tick, in one byte.

use lockstep2d::math::{Angle, Fx, Unit, Vec2};
use serde::{Deserialize, Serialize};

/// Buttons that are held down, one bit each. Bits 5 and 6 are ignored, and opposite directions cancel each other.
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
    /// Direction -x.
    pub const LEFT: Pad = Pad(1);
    /// Direction +x.
    pub const RIGHT: Pad = Pad(1 << 1);
    /// Direction +y.
    pub const UP: Pad = Pad(1 << 2);
    /// Direction -y.
    pub const DOWN: Pad = Pad(1 << 3);
    /// Dash: an impulse in the held direction.
    pub const DASH: Pad = Pad(1 << 4);
    /// The input of an empty seat. If other bits are set, too, bit 7 is ignored.
    pub const ABSENT: Pad = Pad(1 << 7);

    /// Pads of the eight directions, counter-clockwise from +x.
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

    /// Union of two sets of buttons.
    #[must_use]
    pub const fn with(self, other: Pad) -> Pad {
        Pad(self.0 | other.0)
    }

    /// Whether all of these buttons are down.
    #[must_use]
    pub const fn has(self, buttons: Pad) -> bool {
        self.0 & buttons.0 == buttons.0
    }

    /// Whether the seat is empty.
    #[must_use]
    pub const fn is_absent(self) -> bool {
        self.0 == Pad::ABSENT.0
    }

    /// Direction of the pad as a unit vector. `None` if no direction is held or opposite ones cancel each other.
    #[must_use]
    pub fn direction(self) -> Option<Vec2<Unit>> {
        let axis = |plus, minus| Fx::from_num(i32::from(self.has(plus)) - i32::from(self.has(minus)));
        Vec2::new(axis(Pad::RIGHT, Pad::LEFT), axis(Pad::UP, Pad::DOWN)).normalized()
    }

    /// Pad whose direction is closest to a given one. The pad has no direction for the zero vector.
    #[must_use]
    pub fn towards(direction: Vec2<Fx>) -> Pad {
        if direction == Vec2::ZERO {
            return Pad::default();
        }
        // Each pad stands for an eighth of a turn around its direction. After adding a sixteenth, these ranges begin at
        // multiples of an eighth, so that the top three bits are the index of the pad.
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
            let direction = pad.direction().expect("each pad of the compass has a direction");
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
