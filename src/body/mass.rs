//! Mass, centre of mass and radius of gyration from shapes and densities.
//!
//! Bodies store the radius of gyration `k = sqrt(I / m)` instead of the moment of inertia. The angular velocity `w`
//! then becomes a speed `u = k w` in m/s, and the same mass `m` applies to both motions. The parallel axis theorem sums
//! the parts of a body:
//!
//! ```text
//! m     = sum m_i
//! m c   = sum m_i c_i
//! m k^2 = sum m_i (k_i^2 + |c_i - c|^2)
//! ```
//!
//! Sums are 128-bit integers, and each quotient is rounded once.

mod figure;

use serde::{Deserialize, Serialize};

use figure::Figure;

use super::error::WorldError;
use super::geometry::Geometry;
use super::polygon::Polygon;
use super::shape::{REACH_MAX, ShapeDef};
use crate::fx;
use crate::math::{Fx, PI, Reciprocal, Unit, Vec2, div_round, fx_mul, saturate_wide};

/// Range of masses in kg.
const MASS: core::ops::RangeInclusive<Fx> = fx!(0.00001)..=fx!(1073741824);
/// Range of radii of gyration in metres.
const GYRATION: core::ops::RangeInclusive<Fx> = fx!(0.002)..=fx!(512);

/// Source of a dynamic body's mass.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// use lockstep2d::body::MassSource;
/// // A roly-poly: its centre of mass is below its middle.
/// let mass = MassSource::Given { mass: fx!(2), centre: Vec2::new(fx!(0), fx!(-0.3)), gyration: fx!(0.2) };
/// let id = world.spawn(&BodyDef::dynamic().mass(mass), &[ShapeDef::new(Geometry::circle(fx!(0.5))?)])?;
/// assert_eq!(world.body(id).map(|body| body.mass()), Some(fx!(2)));
/// # let _ = square;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum MassSource {
    /// Computed from the area and density of the shapes. If no shape has both an area and a density, the body has no
    /// mass: gravity, forces, contacts and joints do not change its velocity, and it pushes other bodies as a kinematic
    /// body does.
    #[default]
    Shapes,
    /// Given explicitly. The shapes do not contribute.
    Given {
        /// Mass in kg, 1e-5 to 2^30.
        mass: Fx,
        /// Centre of mass in the body's frame, in metres, within ±128.
        centre: Vec2<Fx>,
        /// Radius of gyration about the centre of mass in metres, 0.002 to 512.
        gyration: Fx,
    },
}

/// Mass, centre of mass and radius of gyration of a body.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, world::World};
/// # let mut world = World::default();
/// use lockstep2d::body::MassProperties;
/// // A person of 80 kg, whose centre of mass and radius of gyration follow from the shapes.
/// let shapes = [ShapeDef::new(Polygon::rectangle(fx!(0.25), fx!(0.9))?)];
/// let person = MassProperties::of_shapes(&shapes)?.with_mass(fx!(80));
/// let id = world.spawn(&BodyDef::dynamic().mass(person.into()), &shapes)?;
/// // m (w^2 + h^2) / 12
/// let inertia = fx!(80) * (fx!(0.5) * fx!(0.5) + fx!(1.8) * fx!(1.8)) / 12;
/// assert!((world.body(id).expect("it was added").inertia() - inertia).abs() < fx!(0.001));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MassProperties {
    /// Mass in kg, 0 for a body without mass.
    pub(crate) mass: Fx,
    pub(crate) centre: Vec2<Fx>,
    /// Radius of gyration in metres. Positive but arbitrary if the mass is 0.
    pub(crate) gyration: Fx,
    /// `1 / gyration`, or 0 if the rotation is locked.
    pub(crate) inverse_gyration: Reciprocal,
}

impl MassProperties {
    /// Computes the properties of a dynamic body from the areas and densities of its shapes.
    ///
    /// # Errors
    /// [`WorldError::MassOutOfRange`] if the mass is not 1e-5 to 2^30 kg, for example 0 because the shapes are lines;
    /// [`WorldError::GyrationOutOfRange`] if the radius of gyration is not 0.002 to 512 m; the error of the first shape
    /// that a dynamic body cannot have.
    pub fn of_shapes(shapes: &[ShapeDef]) -> Result<Self, WorldError> {
        shapes.iter().try_for_each(|shape| shape.validate(REACH_MAX))?;
        Self::from_parts(shapes.iter().map(Part::of_shape))
    }

    /// Mass in kg.
    #[must_use]
    pub const fn mass(&self) -> Fx {
        self.mass
    }

    /// Centre of mass in the body's frame, in metres.
    #[must_use]
    pub const fn centre_of_mass(&self) -> Vec2<Fx> {
        self.centre
    }

    /// Radius of gyration about the centre of mass in metres, `sqrt(inertia / mass)`.
    #[must_use]
    pub const fn radius_of_gyration(&self) -> Fx {
        self.gyration
    }

    /// Moment of inertia about the centre of mass in kg m², saturated.
    #[must_use]
    pub const fn inertia(&self) -> Fx {
        fx_mul(fx_mul(self.mass, self.gyration), self.gyration)
    }

    /// Returns the properties with another mass but the same centre and radius of gyration.
    #[must_use]
    pub const fn with_mass(self, mass: Fx) -> Self {
        MassProperties { mass, ..self }
    }

    /// Properties of a body without mass: forces do not change its velocity. The radius of gyration is arbitrary: 4 m
    /// allows 100 rad/s at a speed limit of 400 m/s, and keeps the ratio of the longest lever arm to this radius below
    /// 91.
    pub(crate) fn immovable() -> Self {
        Self::new(Fx::ZERO, Vec2::ZERO, fx!(4))
    }

    pub(crate) fn dynamic<'a>(
        source: MassSource,
        shapes: impl Iterator<Item = &'a ShapeDef> + Clone,
    ) -> Result<Self, WorldError> {
        let properties = match source {
            MassSource::Given { mass, centre, gyration } => {
                for value in [centre.x, centre.y] {
                    if !(-super::REACH_MAX..=super::REACH_MAX).contains(&value) {
                        return Err(WorldError::OffsetOutOfRange { value, max: super::REACH_MAX });
                    }
                }
                check_gyration(gyration)?;
                Self::new(mass, centre, gyration)
            }
            MassSource::Shapes => {
                let parts = shapes.map(Part::of_shape);
                if parts.clone().all(|part| part.mass == 0) {
                    return Ok(Self::immovable());
                }
                Self::from_parts(parts)?
            }
        };
        if !MASS.contains(&properties.mass) {
            return Err(WorldError::MassOutOfRange { value: properties.mass });
        }
        Ok(properties)
    }

    pub(crate) fn without_rotation(self) -> Self {
        MassProperties { inverse_gyration: Reciprocal::ZERO, ..self }
    }

    fn new(mass: Fx, centre: Vec2<Fx>, gyration: Fx) -> Self {
        MassProperties { mass, centre, gyration, inverse_gyration: Reciprocal::of(gyration) }
    }

    fn from_parts(parts: impl Iterator<Item = Part> + Clone) -> Result<Self, WorldError> {
        let mass: i128 = parts.clone().map(|part| i128::from(part.mass.to_bits())).sum();
        let total = Fx::from_bits(saturate_wide(mass));
        if !MASS.contains(&total) {
            return Err(WorldError::MassOutOfRange { value: total });
        }
        let weighted = |coordinate: fn(&Part) -> Fx| {
            let sum: i128 = parts
                .clone()
                .map(|part| i128::from(part.mass.to_bits()) * i128::from(coordinate(&part).to_bits()))
                .sum();
            Fx::from_bits(saturate_wide(div_round(sum, mass)))
        };
        let centre = Vec2::new(weighted(|part| part.centre.x), weighted(|part| part.centre.y));
        // Squares of lengths have 44 fraction bits. The total mass has at most 63 bits, and so has, for each part, the
        // sum of k² and the squared distance from the centre.
        let moment: i128 = parts
            .map(|part| {
                let arm = part.centre - centre;
                let (x, y) = (i128::from(arm.x.to_bits()), i128::from(arm.y.to_bits()));
                i128::from(part.mass.to_bits()) * (part.gyration_squared + ((x * x + y * y) >> 20))
            })
            .sum();
        let gyration_squared = div_round(moment, mass).unsigned_abs();
        let bits = (gyration_squared << 20).isqrt();
        let gyration = Fx::from_bits(i64::try_from(bits).unwrap_or(i64::MAX));
        check_gyration(gyration)?;
        Ok(Self::new(total, centre, gyration))
    }
}

impl From<MassProperties> for MassSource {
    fn from(properties: MassProperties) -> Self {
        let MassProperties { mass, centre, gyration, .. } = properties;
        MassSource::Given { mass, centre, gyration }
    }
}

/// Area of a shape in m². 0 for lines.
pub(crate) fn area_of(shape: &ShapeDef) -> Fx {
    Part::of_shape(&ShapeDef { density: Fx::ONE, ..*shape }).mass
}

fn check_gyration(gyration: Fx) -> Result<(), WorldError> {
    let inside = GYRATION.contains(&gyration);
    if inside { Ok(()) } else { Err(WorldError::GyrationOutOfRange { value: gyration }) }
}

struct Part {
    mass: Fx,
    /// Centre of mass in the body's frame.
    centre: Vec2<Fx>,
    /// Square of the radius of gyration about `centre`, in m², with 44 fraction bits.
    gyration_squared: i128,
}

impl Part {
    fn of_shape(shape: &ShapeDef) -> Part {
        match &shape.geometry {
            Geometry::Circle { radius } => {
                let area = fx_mul(PI, fx_mul(*radius, *radius));
                let r = i128::from(radius.to_bits());
                // k^2 = r^2 / 2
                let part =
                    Part { mass: fx_mul(area, shape.density), centre: shape.offset, gyration_squared: 0 };
                Part { gyration_squared: (r * r) >> 21, ..part }
            }
            Geometry::Segment { .. } | Geometry::Link { .. } => {
                Part { mass: Fx::ZERO, centre: shape.offset, gyration_squared: 0 }
            }
            Geometry::Polygon(polygon) => Part::of_polygon(polygon, shape),
            Geometry::Capsule { a, b, radius } => Part::of_capsule(*a, *b, *radius, shape),
        }
    }

    /// The capsule consists of a rectangle of `l` by `2 r` and two half discs. The centre of mass of each half disc is
    /// `4 r / (3 pi)` beyond an end of the rectangle:
    ///
    /// ```text
    /// A     = 2 r l + pi r^2
    /// k^2 A = 2 r l (l^2 + 4 r^2) / 12 + pi r^2 (r^2 / 2 + l^2 / 4 + 4 r l / (3 pi))
    /// ```
    fn of_capsule(a: Vec2<Fx>, b: Vec2<Fx>, radius: Fx, shape: &ShapeDef) -> Part {
        let (r, l) = (radius, a.distance(b));
        let (rr, rl, ll) = (fx_mul(r, r), fx_mul(r, l), fx_mul(l, l));
        let (rectangle, disc) = (rl * 2, fx_mul(PI, rr));
        let area = rectangle + disc;
        let of_rectangle = (ll + rr * 4) / 12;
        let of_disc = rr / 2 + ll / 4 + fx_mul(rl, fx!(0.424413181578));
        // Areas and squares of lengths have 32 fraction bits each, the quotient 44.
        let product = |weight: Fx, square: Fx| i128::from(weight.to_bits()) * i128::from(square.to_bits());
        let moment = product(rectangle, of_rectangle) + product(disc, of_disc);
        let gyration_squared = div_round(moment << 12, area.to_bits().max(1).into());
        let centre = shape.offset + a.lerp(b, Unit::lit("0.5"));
        Part { mass: fx_mul(area, shape.density), centre, gyration_squared }
    }

    fn of_polygon(polygon: &Polygon, shape: &ShapeDef) -> Part {
        let vertices = polygon.vertices();
        let figure = Figure::of_polygon(vertices).rounded(vertices, polygon.radius());
        let (x, y) = figure.centre();
        let centre = Vec2::new(Fx::from_bits(saturate_wide(x)), Fx::from_bits(saturate_wide(y)));
        let area = Fx::from_bits(saturate_wide(figure.area()));
        Part {
            mass: fx_mul(area, shape.density),
            centre: shape.offset + centre,
            gyration_squared: figure.gyration_squared(),
        }
    }
}

#[cfg(test)]
mod tests;
