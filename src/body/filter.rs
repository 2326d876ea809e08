//! Collision filters.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

/// Collision filter. Two shapes in the same non-zero group may collide if the group is positive, and do not collide if
/// it is negative. For other pairs, each shape's mask must include a category of the other shape.
///
/// A large set of shapes that do not collide with each other, such as bullets, costs the broad phase less if all shapes
/// have the same group from -1 to -32 768. The cost is equally low if all shapes have group 0 and the same single
/// category, and their masks exclude this category.
///
/// ```
/// # use lockstep2d::body::Filter;
/// let bullet = Filter { category: 2, mask: !2, group: 0 };
/// assert!(bullet.accepts(&Filter::default()) && !bullet.accepts(&bullet));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Filter {
    /// Categories of this shape, one bit each.
    pub category: u64,
    /// Categories that this shape may collide with, one bit each.
    pub mask: u64,
    /// Overrides categories and masks among shapes of the same non-zero group.
    pub group: i32,
}

impl Default for Filter {
    /// Category 1, collides with all categories, no group.
    fn default() -> Self {
        Filter { category: 1, mask: u64::MAX, group: 0 }
    }
}

impl Filter {
    /// Whether two shapes may collide. The result is the same if the shapes are exchanged.
    #[must_use]
    pub const fn accepts(&self, other: &Filter) -> bool {
        if self.group == other.group && self.group != 0 {
            return self.group > 0;
        }
        self.mask & other.category != 0 && other.mask & self.category != 0
    }

    pub(crate) fn collision_class(&self) -> CollisionClass {
        let Filter { category, mask, group } = *self;
        let class = match group {
            ..0 => i64::from(group),
            // Two shapes with this single category do not collide, because the mask of each excludes it.
            0 if category.is_power_of_two() && mask & category == 0 => i64::from(1 + category.ilog2()),
            _ => 0,
        };
        CollisionClass(i16::try_from(class).unwrap_or(0))
    }
}

/// Shapes of one class do not collide with each other, unless the class is [`CollisionClass::NONE`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CollisionClass(i16);

impl CollisionClass {
    /// Class of a shape that may collide with shapes of every class, and of a set with shapes of several classes.
    pub(crate) const NONE: Self = CollisionClass(0);

    /// Class of the union of two sets of shapes.
    pub(crate) fn common(self, other: Self) -> Self {
        if self == other { self } else { CollisionClass::NONE }
    }
}
