//! Properties of a body that follow from all of its contacts, such as whether these contacts are cold.

#[cfg(test)]
mod tests;

use crate::math::{Unit, Vec2};

/// Largest dot product of the normals of two walls between which an impact may wedge a body: the normals differ by at
/// least 60 degrees. If they differ by less, friction holds a body between the walls only if the friction coefficient
/// is above 1.7.
const WEDGE_DOT_MAX: Unit = Unit::lit("0.5");

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Prospect {
    flags: u32,
    /// Normal of the first contact with a wall, towards this body. A wall is a body that impulses do not move.
    wall: Vec2<Unit>,
}

impl Prospect {
    pub(super) const WARM: u32 = 1;
    pub(super) const IMPACT: u32 = 2;
    pub(super) const BOUNCES: u32 = 4;
    const CONTACT: u32 = 8;
    const WALL: u32 = 16;
    const WEDGE: u32 = 32;

    pub(super) fn add(&mut self, flags: u32) {
        self.flags |= flags | Self::CONTACT;
    }

    pub(super) fn add_wall(&mut self, normal: Vec2<Unit>) {
        let dot: Unit = self.wall.dot(normal);
        if self.flags & Self::WALL == 0 {
            self.flags |= Self::WALL;
            self.wall = normal;
        } else if dot < WEDGE_DOT_MAX {
            self.flags |= Self::WEDGE;
        }
    }

    /// Whether the body has contacts, but no initial guess of their impulses.
    pub(super) fn is_cold(self) -> bool {
        self.flags & Self::CONTACT != 0 && !self.has_guess()
    }

    /// Whether the impulses of the last tick are a useful initial guess: a contact of the body had points, and the body
    /// is not wedged.
    pub(super) fn has_guess(self) -> bool {
        self.flags & Self::WARM != 0 && !self.is_wedged()
    }

    /// Whether an impact may drive the body between two walls.
    pub(super) fn is_wedged(self) -> bool {
        self.flags & Self::IMPACT != 0 && self.flags & Self::WEDGE != 0
    }

    pub(super) fn has_impact(self) -> bool {
        self.flags & Self::IMPACT != 0
    }

    pub(super) fn bounces(self) -> bool {
        self.flags & Self::BOUNCES != 0
    }
}
