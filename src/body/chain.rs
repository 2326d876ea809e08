//! Chains of links, for ground and walls.

#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use super::error::GeometryError;
use super::filter::Filter;
use super::geometry::{Geometry, Sides};
use super::material::Material;
use super::shape::{SHAPES_PER_BODY_MAX, ShapeDef};
use crate::math::{Fx, Vec2};

/// A polyline of [`Geometry::Link`] shapes. Each link stores the far ends of its neighbours, which prevents ghost
/// collisions where two links meet.
///
/// ```
/// use lockstep2d::{body::{BodyDef, Chain}, fx, math::Vec2, world::World};
/// let points = [(fx!(-50), fx!(2)), (fx!(-10), fx!(0)), (fx!(10), fx!(0)), (fx!(50), fx!(3))];
/// let ground = Chain::new(&points.map(|(x, y)| Vec2::new(x, y))).links()?;
/// let mut world = World::default();
/// world.spawn(&BodyDef::fixed(), &ground)?;
/// assert_eq!(ground.len(), 3);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chain<'a> {
    points: &'a [Vec2<Fx>],
    materials: &'a [Material],
    closed: bool,
    sides: Sides,
    filter: Filter,
}

impl<'a> Chain<'a> {
    /// Creates an open two-sided chain through points in the body's frame, in metres.
    #[must_use]
    pub fn new(points: &'a [Vec2<Fx>]) -> Self {
        Chain { points, materials: &[], closed: false, sides: Sides::Both, filter: Filter::default() }
    }

    /// Connects the last point with the first.
    #[must_use]
    pub fn closed(mut self) -> Self {
        self.closed = true;
        self
    }

    /// Makes the chain solid only from its right side, looking from its first point towards its last. A
    /// counter-clockwise loop is then solid from outside, and ground whose points run from right to left is solid from
    /// above. A shape passes through if the mean of its vertices is on the left side.
    #[must_use]
    pub fn one_sided(mut self) -> Self {
        self.sides = Sides::Right;
        self
    }

    /// Sets the materials: one for all links, or one per link.
    #[must_use]
    pub fn materials(mut self, materials: &'a [Material]) -> Self {
        self.materials = materials;
        self
    }

    /// Sets the filter of all links.
    #[must_use]
    pub fn filter(mut self, filter: Filter) -> Self {
        self.filter = filter;
        self
    }

    /// Returns the links, as shapes of a body.
    ///
    /// # Errors
    /// [`GeometryError::ChainLength`] if there are fewer than 2 points (3 for a closed chain) or more than 4096 links;
    /// [`GeometryError::MaterialCount`] if the number of materials is not 0, 1 or the number of links;
    /// [`GeometryError::SizeOutOfRange`] if neighbouring points are closer than 2 mm, or a coordinate is not within
    /// ±2^30 m.
    pub fn links(&self) -> Result<Vec<ShapeDef>, GeometryError> {
        let points = self.points;
        let count = if self.closed { points.len() } else { points.len().saturating_sub(1) };
        if count < if self.closed { 3 } else { 1 } || count > SHAPES_PER_BODY_MAX as usize {
            return Err(GeometryError::ChainLength { points: points.len() as u64 });
        }
        if self.materials.len() > 1 && self.materials.len() != count {
            return Err(GeometryError::MaterialCount {
                links: count as u64,
                materials: self.materials.len() as u64,
            });
        }
        (0..count).map(|index| self.link(index)).collect()
    }

    fn link(&self, index: usize) -> Result<ShapeDef, GeometryError> {
        let points = self.points;
        let count = points.len();
        let at = |index: usize| {
            let within = index.checked_rem(count).filter(|_| self.closed || index < count)?;
            points.get(within).copied()
        };
        let before = match index.checked_sub(1) {
            Some(before) => at(before),
            None => at(count - 1).filter(|_| self.closed),
        };
        let (Some(a), Some(b)) = (at(index), at(index + 1)) else {
            return Err(GeometryError::ChainLength { points: count as u64 });
        };
        let geometry = Geometry::Link { a, b, before, after: at(index + 2), sides: self.sides };
        geometry.validate()?;
        let default = Material::default();
        let material = self.materials.get(index).or(self.materials.first()).unwrap_or(&default);
        Ok(ShapeDef { material: *material, filter: self.filter, ..ShapeDef::new(geometry) })
    }
}
