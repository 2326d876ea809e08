//! Convex polygons, optionally rounded.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::error::GeometryError;
use super::geometry::check_size;
use crate::math::{Angle, Fx, Length, Rot, Unit, Vec2};

/// Largest number of vertices of a polygon.
pub const POLYGON_VERTICES_MAX: usize = 8;

/// Largest extent in metres of a circle, capsule or polygon from its centre on each axis, radius included. Each point
/// is then within 156 m of the centre. If two shapes of this extent are at most 15 m apart, a vertex of one is at most
/// 3 * 156 m + 15 m from the centre of the other. This distance fits [`Length`].
pub const SHAPE_EXTENT_MAX: Fx = crate::fx!(110);

/// Minimum length of an edge in metres. A shorter edge has no reliable direction in units of [`Length`].
const EDGE_MIN: Fx = crate::fx!(0.0005);

/// A convex polygon, counter-clockwise, relative to its shape's centre. A radius moves its edges outwards and rounds
/// its corners.
///
/// ```
/// use lockstep2d::{body::Polygon, fx, math::Vec2};
/// let crate_ = Polygon::rectangle(fx!(0.5), fx!(0.25))?;
/// let kite = Polygon::hull(&[
///     Vec2::new(fx!(0), fx!(1)),
///     Vec2::new(fx!(-0.5), fx!(0)),
///     Vec2::new(fx!(0), fx!(-0.5)),
///     Vec2::new(fx!(0.5), fx!(0)),
/// ])?;
/// assert_eq!((crate_.vertices().len(), kite.vertices().len()), (4, 4));
/// # Ok::<(), lockstep2d::body::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "Repr", try_from = "Repr")]
pub struct Polygon {
    count: u8,
    vertices: [Vec2<Length>; POLYGON_VERTICES_MAX],
    /// `normals[i]` belongs to the edge from vertex `i` to the next vertex.
    normals: [Vec2<Unit>; POLYGON_VERTICES_MAX],
    radius: Length,
}

/// Serialized form. Normals are recomputed, so that no file can contain wrong normals.
#[derive(Serialize, Deserialize)]
struct Repr {
    vertices: Vec<Vec2<Length>>,
    radius: Length,
}

impl From<Polygon> for Repr {
    fn from(polygon: Polygon) -> Self {
        Repr { vertices: polygon.vertices().to_vec(), radius: polygon.radius }
    }
}

impl TryFrom<Repr> for Polygon {
    type Error = GeometryError;
    fn try_from(repr: Repr) -> Result<Self, GeometryError> {
        Polygon::from_vertices(&repr.vertices)?.rounded(repr.radius.into())
    }
}

impl Polygon {
    /// Creates a polygon from its vertices in counter-clockwise order, in metres from the shape's centre.
    ///
    /// Avoid corners with an angle within about 0.0001 rad of 0 or of half a turn: collision detection may classify
    /// a point beside one of the two edges as beside the other edge.
    ///
    /// # Errors
    /// If there are not 3 to 8 vertices, or vertices are out of range, closer than 0.5 mm, clockwise, collinear or not
    /// convex.
    pub fn new(vertices: &[Vec2<Fx>]) -> Result<Self, GeometryError> {
        for &vertex in vertices {
            check_vertex(vertex)?;
        }
        let narrow: Vec<Vec2<Length>> = vertices.iter().map(|vertex| vertex.narrow()).collect();
        Self::from_vertices(&narrow)
    }

    /// Creates the convex hull of points.
    ///
    /// # Errors
    /// If a point is out of range, or the hull has no area, more than 8 vertices or an edge shorter than 0.5 mm.
    pub fn hull(points: &[Vec2<Fx>]) -> Result<Self, GeometryError> {
        for &point in points {
            check_vertex(point)?;
        }
        let mut sorted: Vec<Vec2<Length>> = points.iter().map(|point| point.narrow()).collect();
        sorted.sort_unstable_by_key(|point| (point.x, point.y));
        sorted.dedup();
        Self::from_vertices(&monotone_chain(&sorted))
    }

    /// Creates a rectangle about the shape's centre from its half extents, in metres.
    ///
    /// # Errors
    /// If a half extent is not within 0.25 mm to 110 m.
    pub fn rectangle(half_width: Fx, half_height: Fx) -> Result<Self, GeometryError> {
        let (x, y) = (half_width, half_height);
        check_half("half width of a rectangle", x)?;
        check_half("half height of a rectangle", y)?;
        let corner = |x, y| Vec2::new(x, y);
        Self::new(&[corner(-x, -y), corner(x, -y), corner(x, y), corner(-x, y)])
    }

    /// Creates a square about the shape's centre from its half extent, in metres.
    ///
    /// # Errors
    /// If the half extent is not within 0.25 mm to 110 m.
    pub fn square(half_extent: Fx) -> Result<Self, GeometryError> {
        check_half("half extent of a square", half_extent)?;
        Self::rectangle(half_extent, half_extent)
    }

    /// Creates a regular polygon with its first vertex to the right of the centre, from its circumradius in metres.
    ///
    /// # Errors
    /// If there are not 3 to 8 vertices, the radius is not within ±110 m, or an edge is shorter than 0.5 mm.
    pub fn regular(vertex_count: u32, radius: Fx) -> Result<Self, GeometryError> {
        if !(3..=8).contains(&vertex_count) {
            return Err(GeometryError::VertexCount { count: u64::from(vertex_count) });
        }
        let points: Vec<_> = (0..u64::from(vertex_count))
            .map(|i| {
                let turn = (i << 32) / u64::from(vertex_count);
                let angle = Angle::from_bits(u32::try_from(turn).expect("less than a turn"));
                Rot::from_angle(angle).apply_wide(Vec2::new(radius, Fx::ZERO))
            })
            .collect();
        Self::new(&points).map_err(|error| match error {
            GeometryError::SizeOutOfRange { min, max, .. } => {
                GeometryError::SizeOutOfRange { what: "radius of a regular polygon", value: radius, min, max }
            }
            other => other,
        })
    }

    /// Returns the polygon rotated about the shape's centre.
    ///
    /// # Errors
    /// If the outline leaves the range, or is not valid after its coordinates have been rounded to [`Length`].
    pub fn rotated(&self, angle: Angle) -> Result<Self, GeometryError> {
        let rotation = Rot::from_angle(angle);
        self.mapped(|vertex| rotation.apply_wide(vertex))
    }

    /// Returns the polygon translated relative to the shape's centre, in metres.
    ///
    /// # Errors
    /// If the outline leaves the range, or is not valid after its coordinates have been rounded to [`Length`].
    pub fn translated(&self, by: Vec2<Fx>) -> Result<Self, GeometryError> {
        self.mapped(|vertex| vertex + by)
    }

    fn mapped(&self, map: impl Fn(Vec2<Fx>) -> Vec2<Fx>) -> Result<Self, GeometryError> {
        let points: Vec<_> = self.vertices().iter().map(|vertex| map(vertex.widen())).collect();
        Self::new(&points)?.rounded(self.radius.into())
    }

    /// Returns the polygon with the rounding radius `radius` in metres, which replaces an earlier one. The edges move
    /// outwards by the radius, and the corners become arcs.
    ///
    /// # Errors
    /// If the radius is negative, or the outline leaves the range of ±110 m.
    pub fn rounded(mut self, radius: Fx) -> Result<Self, GeometryError> {
        let reach = self.vertices().iter().fold(Fx::ZERO, |reach, vertex| {
            let vertex = vertex.widen();
            reach.max(vertex.x.saturating_abs()).max(vertex.y.saturating_abs())
        });
        check_size("rounding radius of a polygon", radius, Fx::ZERO, SHAPE_EXTENT_MAX - reach)?;
        self.radius = crate::math::narrow(radius);
        Ok(self)
    }

    /// Vertices, counter-clockwise.
    #[must_use]
    pub fn vertices(&self) -> &[Vec2<Length>] {
        &self.vertices[..usize::from(self.count)]
    }

    /// Outward normals. `normals()[i]` belongs to the edge from vertex `i` to the next vertex.
    #[must_use]
    pub fn normals(&self) -> &[Vec2<Unit>] {
        &self.normals[..usize::from(self.count)]
    }

    /// Rounding radius in metres.
    #[must_use]
    pub const fn radius(&self) -> Length {
        self.radius
    }

    fn from_vertices(points: &[Vec2<Length>]) -> Result<Self, GeometryError> {
        let count = points.len();
        if !(3..=POLYGON_VERTICES_MAX).contains(&count) {
            return Err(GeometryError::VertexCount { count: count as u64 });
        }
        let mut vertices = [Vec2::ZERO; POLYGON_VERTICES_MAX];
        let mut normals = [Vec2::ZERO; POLYGON_VERTICES_MAX];
        points.iter().try_for_each(|point| check_vertex(point.widen()))?;
        for (i, &point) in points.iter().enumerate() {
            let next = points[(i + 1) % count];
            let edge = next - point;
            if edge.widen().length() < EDGE_MIN {
                return Err(GeometryError::ShortEdge { vertex: i as u64 });
            }
            // All other vertices are tested, not only the next one, to reject stars that wind around twice. The ends of
            // the edge are recognised by index, so that another vertex at the position of an end is rejected, too.
            let strictly_left = |(j, &other): (usize, &Vec2<Length>)| {
                j == i || j == (i + 1) % count || wide_cross(edge, other - point) > 0
            };
            if !points.iter().enumerate().all(strictly_left) {
                let not_convex = GeometryError::NotConvex { vertex: i as u64 };
                return Err(if is_clockwise(points) { GeometryError::Clockwise } else { not_convex });
            }
            vertices[i] = point;
            normals[i] = -edge.perp().normalized().ok_or(GeometryError::ShortEdge { vertex: i as u64 })?;
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most 8, checked above")]
        Ok(Polygon { count: count as u8, vertices, normals, radius: Length::ZERO })
    }
}

fn check_vertex(vertex: Vec2<Fx>) -> Result<(), GeometryError> {
    [vertex.x, vertex.y].into_iter().try_for_each(|value| {
        check_size("coordinate of a vertex", value, -SHAPE_EXTENT_MAX, SHAPE_EXTENT_MAX)
    })
}

fn check_half(what: &'static str, value: Fx) -> Result<(), GeometryError> {
    if value > Fx::ZERO && value <= SHAPE_EXTENT_MAX {
        return Ok(());
    }
    Err(GeometryError::SizeOutOfRange { what, value, min: EDGE_MIN / 2, max: SHAPE_EXTENT_MAX })
}

fn is_clockwise(points: &[Vec2<Length>]) -> bool {
    let count = points.len();
    (0..count).all(|i| {
        let (point, next) = (points[i], (i + 1) % count);
        let right = |j| j == i || j == next || wide_cross(points[next] - point, points[j] - point) < 0;
        (0..count).all(right)
    })
}

fn wide_cross(a: Vec2<Length>, b: Vec2<Length>) -> i128 {
    i128::from(a.x.to_bits()) * i128::from(b.y.to_bits())
        - i128::from(a.y.to_bits()) * i128::from(b.x.to_bits())
}

/// Andrew's monotone chain: the hull of sorted, distinct points, counter-clockwise from the leftmost.
fn monotone_chain(sorted: &[Vec2<Length>]) -> Vec<Vec2<Length>> {
    let mut hull = half_hull(sorted.iter());
    let upper = half_hull(sorted.iter().rev());
    hull.pop();
    hull.extend(upper);
    hull.pop();
    hull
}

fn half_hull<'a>(points: impl Iterator<Item = &'a Vec2<Length>>) -> Vec<Vec2<Length>> {
    let mut chain: Vec<Vec2<Length>> = Vec::new();
    for &point in points {
        while let [.., a, b] = chain[..] {
            if wide_cross(b - a, point - a) > 0 {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

#[cfg(test)]
mod tests;
