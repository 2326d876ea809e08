use crate::body::{Geometry, GeometryError};
use crate::collision::PosedShape;
use crate::math::{Angle, Fx, Rot, Vec2};

/// A shape for a query: a geometry with a position and a rotation.
///
/// ```
/// use lockstep2d::{body::Polygon, fx, math::{Angle, Vec2}, world::Probe};
/// let crate_ = Probe::new(Polygon::square(fx!(0.5))?, Vec2::new(fx!(3), fx!(1)))?.turned(Angle::EIGHTH);
/// assert_eq!(crate_.at(Vec2::ZERO).position(), Vec2::ZERO);
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    position: Vec2<Fx>,
    geometry: Geometry,
    rotation: Rot,
}

impl Probe {
    /// A geometry with the origin of its coordinates at a position in the world, in metres.
    ///
    /// # Errors
    /// [`GeometryError`] if the size of the geometry is out of range.
    pub fn new(geometry: impl Into<Geometry>, position: impl Into<Vec2<Fx>>) -> Result<Self, GeometryError> {
        let position = position.into();
        let geometry = geometry.into();
        geometry.validate()?;
        Ok(Probe { position, geometry, rotation: Rot::IDENTITY })
    }

    /// The geometry must be valid.
    pub(super) const fn of(geometry: Geometry, position: Vec2<Fx>) -> Self {
        Probe { position, geometry, rotation: Rot::IDENTITY }
    }

    pub(super) const fn posed_at(geometry: Geometry, position: Vec2<Fx>, rotation: Rot) -> Self {
        Probe { position, geometry, rotation }
    }

    /// Sets the rotation about the geometry's origin.
    #[must_use]
    pub fn turned(mut self, angle: Angle) -> Self {
        self.rotation = Rot::from_angle(angle);
        self
    }

    /// Sets the position in the world, in metres.
    #[must_use]
    pub fn at(mut self, position: impl Into<Vec2<Fx>>) -> Self {
        let position = position.into();
        self.position = position;
        self
    }

    /// Position of the geometry's origin in the world, in metres.
    #[must_use]
    pub const fn position(&self) -> Vec2<Fx> {
        self.position
    }

    pub(super) fn posed(&self) -> PosedShape {
        PosedShape::of_geometry(&self.geometry, self.position, self.rotation)
    }
}
