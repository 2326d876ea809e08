//! Which shapes collide.

use serde::{Deserialize, Serialize};

/// Collision filter: two shapes of a shared non-zero group collide if it is positive and never if it is
/// negative; otherwise each one's mask must name one of the other's categories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Filter {
    /// The categories this shape belongs to, one bit each.
    pub category: u64,
    /// The categories this shape collides with.
    pub mask: u64,
    /// Overrides categories among shapes of the same non-zero group.
    pub group: i32,
}

impl Default for Filter {
    /// Category 1, collides with everything, no group.
    fn default() -> Self {
        Filter { category: 1, mask: u64::MAX, group: 0 }
    }
}

impl Filter {
    /// Whether two shapes may collide. Symmetric.
    #[must_use]
    pub const fn accepts(&self, other: &Filter) -> bool {
        if self.group == other.group && self.group != 0 {
            return self.group > 0;
        }
        self.mask & other.category != 0 && other.mask & self.category != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_override_masks() {
        let player = Filter { category: 2, mask: 1, group: 0 };
        let wall = Filter::default();
        assert!(player.accepts(&wall) && wall.accepts(&player));
        assert!(!player.accepts(&player), "players pass through each other");
        let team = Filter { group: 7, ..player };
        assert!(team.accepts(&team));
        let ghost = Filter { group: -7, ..wall };
        assert!(!ghost.accepts(&ghost) && ghost.accepts(&wall));
    }
}
