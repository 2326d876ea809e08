//! Posed shapes: rotated to world axes once per tick.

use core::ops::Deref;

use super::support::SupportShape;
use crate::body::{Body, Geometry, POLYGON_VERTICES_MAX, Polygon, ShapeDef};
use crate::collision::shape::link::Link;
use crate::math::{Aabb, Fx, Length, Rot, Unit, Vec2, narrow, widen};

/// Largest distance in metres from the centre of a box to a corner, plus the rounding radius, for which the SIMD path
/// accepts the box.
const BOX_REACH_MAX: Length = Length::lit("3");

#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct PosedShape {
    pub(crate) centre: Vec2<Fx>,
    pub(crate) bounds: Aabb,
    pub(crate) outline: Outline,
}

/// Outline relative to the shape's centre, in world axes.
#[derive(Clone, Debug)]
pub(crate) enum Outline {
    Circle { radius: Length },
    Segment { a: Vec2<Fx>, b: Vec2<Fx> },
    Polygon(Hull),
    Link(Link),
}

impl Outline {
    /// Radius in metres by which the point or polygon is widened. 0 for a segment or link.
    pub(crate) fn radius(&self) -> Fx {
        match self {
            Outline::Circle { radius } => widen(*radius),
            Outline::Polygon(hull) => widen(hull.radius),
            Outline::Segment { .. } | Outline::Link(_) => Fx::ZERO,
        }
    }
}

/// First two vertices and normals of a box. The other two are their opposites.
pub(crate) type BoxFaces<'a> = (&'a [Vec2<Length>; 2], &'a [Vec2<Unit>; 2]);

/// [`BoxFaces`] by value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faces {
    pub(in crate::collision) vertices: [Vec2<Length>; 2],
    pub(in crate::collision) normals: [Vec2<Unit>; 2],
}

impl Faces {
    fn of(vertices: &[Vec2<Length>], normals: &[Vec2<Unit>]) -> Option<Self> {
        Some(Faces { vertices: *vertices.first_chunk()?, normals: *normals.first_chunk()? })
    }

    #[inline(always)]
    pub(in crate::collision) fn rotated(&self, rotation: Rot) -> Self {
        let Faces { vertices: [v0, v1], normals: [n0, n1] } = *self;
        Faces {
            vertices: [rotation.apply(v0), rotation.apply(v1)],
            normals: [rotation.apply(n0), rotation.apply(n1)],
        }
    }

    #[inline(always)]
    fn bounds(&self, radius: Length) -> Aabb {
        let [a, b] = self.vertices;
        let most = |a: Length, b: Length| a.saturating_abs().max(b.saturating_abs());
        let upper = Vec2::new(most(a.x, b.x), most(a.y, b.y)).widen();
        Aabb::new(-upper, upper).expanded(radius.into())
    }
}

/// A convex outline in 32-bit coordinates. A segment or capsule is a two-sided polygon, and a circle a single point.
#[derive(Clone, Debug)]
pub(crate) struct Hull {
    count: usize,
    vertices: [Vec2<Length>; POLYGON_VERTICES_MAX],
    normals: [Vec2<Unit>; POLYGON_VERTICES_MAX],
    pub(crate) radius: Length,
    /// Direction of a capsule in its own frame.
    direction: Vec2<Unit>,
    /// Whether the outline is four-sided and point-symmetric about the centre.
    is_box: bool,
    /// Whether the outline is a box with nearly right angles, small enough for the SIMD path.
    is_small_box: bool,
}

impl Hull {
    #[inline]
    pub(crate) fn vertices(&self) -> &[Vec2<Length>] {
        &self.vertices[..self.count]
    }

    /// `normals()[i]` belongs to the edge from vertex `i` to the next vertex.
    #[inline]
    pub(crate) fn normals(&self) -> &[Vec2<Unit>] {
        &self.normals[..self.count]
    }

    #[inline]
    pub(crate) fn vertex(&self, i: usize) -> Vec2<Length> {
        self.vertices[i % POLYGON_VERTICES_MAX]
    }

    #[inline]
    pub(crate) fn normal(&self, i: usize) -> Vec2<Unit> {
        self.normals[i % POLYGON_VERTICES_MAX]
    }

    #[inline]
    pub(crate) fn is_line(&self) -> bool {
        self.count == 2
    }

    #[inline]
    pub(crate) fn as_box(&self) -> Option<BoxFaces<'_>> {
        if !self.is_box {
            return None;
        }
        self.vertices.first_chunk().zip(self.normals.first_chunk())
    }

    #[inline]
    pub(crate) fn is_small_box(&self) -> bool {
        self.is_small_box
    }

    /// The next vertex, counter-clockwise.
    #[inline]
    pub(crate) fn next(&self, i: usize) -> usize {
        if i + 1 == self.count { 0 } else { i + 1 }
    }

    #[inline]
    pub(crate) fn previous(&self, i: usize) -> usize {
        if i == 0 { self.count.saturating_sub(1) } else { i - 1 }
    }

    /// A circle, as a hull of one point.
    pub(crate) fn point(radius: Length) -> Self {
        Hull { count: 1, radius, ..Self::empty() }
    }

    pub(crate) fn faces(&self) -> usize {
        if self.count < 2 { 0 } else { self.count }
    }

    /// Mean of the vertices, relative to the shape's centre.
    pub(crate) fn middle(&self) -> Vec2<Fx> {
        let sum = self.vertices().iter().fold(Vec2::ZERO, |sum, vertex| sum + vertex.widen());
        let count = i64::try_from(self.count).expect("at most 8 vertices");
        Vec2::new(sum.x / count, sum.y / count)
    }

    /// A segment: one edge in each direction, with opposite normals.
    pub(crate) fn segment(a: Vec2<Length>, b: Vec2<Length>, direction: Vec2<Unit>) -> Self {
        let mut hull = Hull { count: 2, ..Self::empty() };
        hull.place_ends(a, b, direction);
        hull
    }

    fn capsule(a: Vec2<Fx>, b: Vec2<Fx>, radius: Length, rotation: Rot) -> Self {
        let direction = (b - a).normalized().unwrap_or(Vec2::X);
        let mut hull = Hull { count: 2, radius, direction, ..Self::empty() };
        hull.turn_capsule(a, b, rotation);
        hull
    }

    /// Rotates a capsule, whose ends `a` and `b` are given in its own frame.
    fn turn_capsule(&mut self, a: Vec2<Fx>, b: Vec2<Fx>, rotation: Rot) {
        let [a, b] = [a, b].map(|end| rotation.apply(end.narrow()));
        self.place_ends(a, b, rotation.apply(self.direction));
    }

    fn place_ends(&mut self, a: Vec2<Length>, b: Vec2<Length>, direction: Vec2<Unit>) {
        [self.vertices[0], self.vertices[1]] = [a, b];
        [self.normals[0], self.normals[1]] = [-direction.perp(), direction.perp()];
    }

    pub(crate) fn rotated(polygon: &Polygon, rotation: Rot) -> Self {
        let is_box = match (polygon.vertices(), polygon.normals()) {
            (&[v0, v1, v2, v3], &[n0, n1, n2, n3]) => (v2, v3, n2, n3) == (-v0, -v1, -n0, -n1),
            _ => false,
        };
        let count = polygon.vertices().len();
        let mut hull = Hull { count, radius: polygon.radius(), is_box, ..Self::empty() };
        hull.rotate(polygon, rotation);
        hull.is_small_box = is_box && hull.fits_lanes();
        hull
    }

    /// Whether a box is small enough for the SIMD path, with nearly right angles.
    fn fits_lanes(&self) -> bool {
        let reach = |vertex: &Vec2<Length>| vertex.length().saturating_add(self.radius);
        let cosine: Unit = self.normals[0].dot(self.normals[1]);
        self.vertices().iter().all(|vertex| reach(vertex) <= BOX_REACH_MAX)
            && cosine.saturating_abs() < Unit::lit("0.1")
    }

    #[inline(always)]
    fn rotate(&mut self, polygon: &Polygon, rotation: Rot) {
        if let (true, Some(faces)) = (self.is_box, Faces::of(polygon.vertices(), polygon.normals())) {
            self.set_faces(&faces.rotated(rotation));
            return;
        }
        let local = polygon.vertices().iter().zip(polygon.normals());
        let posed = self.vertices.iter_mut().zip(&mut self.normals);
        for ((vertex, normal), (local_vertex, local_normal)) in posed.zip(local) {
            *vertex = rotation.apply(*local_vertex);
            *normal = rotation.apply(*local_normal);
        }
    }

    #[inline(always)]
    fn set_faces(&mut self, Faces { vertices: [v0, v1], normals: [n0, n1] }: &Faces) {
        let (vertices, normals) = (&mut self.vertices, &mut self.normals);
        // Negates the rounded vectors, so that opposite vertices and normals stay exact opposites.
        [vertices[0], vertices[1], vertices[2], vertices[3]] = [*v0, *v1, -*v0, -*v1];
        [normals[0], normals[1], normals[2], normals[3]] = [*n0, *n1, -*n0, -*n1];
    }

    const fn empty() -> Self {
        Hull {
            count: 0,
            vertices: [Vec2::ZERO; POLYGON_VERTICES_MAX],
            normals: [Vec2::ZERO; POLYGON_VERTICES_MAX],
            radius: Length::ZERO,
            direction: Vec2::ZERO,
            is_box: false,
            is_small_box: false,
        }
    }

    fn bounds(&self) -> Aabb {
        if let (true, Some(faces)) = (self.is_box, Faces::of(&self.vertices, &self.normals)) {
            return faces.bounds(self.radius);
        }
        let first = self.vertices[0];
        let (lower, upper) = self.vertices()[1..]
            .iter()
            .fold((first, first), |(lower, upper), &vertex| (lower.min(vertex), upper.max(vertex)));
        Aabb::new(lower.widen(), upper.widen()).expanded(self.radius.into())
    }
}

impl PosedShape {
    /// Poses a shape of a body. `rotation` is the rotation of the body, which callers compute once for all of its
    /// shapes.
    pub(crate) fn new(shape: &ShapeDef, body: &Body, rotation: Rot) -> Self {
        Self::of_geometry(&shape.geometry, centre_of(shape, body, || rotation), rotation)
    }

    /// Poses the shape again after its body has moved. Evaluates `rotation` only if the shape depends on it.
    #[inline(always)]
    pub(crate) fn renew(&mut self, shape: &ShapeDef, body: &Body, rotation: &impl Deref<Target = Rot>) {
        let centre = centre_of(shape, body, || **rotation);
        match (&mut self.outline, &shape.geometry) {
            (Outline::Polygon(hull), Geometry::Polygon(polygon)) => {
                hull.rotate(polygon, **rotation);
                self.bounds = hull.bounds().translated(centre);
                self.centre = centre;
            }
            (Outline::Polygon(hull), Geometry::Capsule { a, b, radius: _ }) => {
                hull.turn_capsule(*a, *b, **rotation);
                self.bounds = hull.bounds().translated(centre);
                self.centre = centre;
            }
            (Outline::Circle { .. }, Geometry::Circle { .. }) => {
                self.shift(centre - self.centre);
            }
            (_, geometry) => *self = Self::of_geometry(geometry, centre, **rotation),
        }
    }

    #[inline(always)]
    pub(crate) fn turn_box(&mut self, faces: &Faces, centre: Vec2<Fx>) {
        if let Outline::Polygon(hull) = &mut self.outline {
            hull.set_faces(faces);
            self.bounds = faces.bounds(hull.radius).translated(centre);
            self.centre = centre;
        }
    }

    /// Translates the shape. The result equals posing it again after a translation of its body.
    pub(crate) fn shift(&mut self, by: Vec2<Fx>) {
        self.centre += by;
        self.bounds = self.bounds.translated(by);
    }

    /// Radius in metres of a disc inside a geometry. 0 for a segment or link.
    pub(crate) fn inner_radius(geometry: &Geometry) -> Fx {
        SupportShape::of(&Self::of_geometry(geometry, Vec2::ZERO, Rot::IDENTITY), Vec2::ZERO).inner_radius()
    }

    #[inline]
    pub(crate) fn as_small_box(&self) -> Option<Faces> {
        match &self.outline {
            Outline::Polygon(hull) if hull.is_small_box => Faces::of(&hull.vertices, &hull.normals),
            _ => None,
        }
    }

    /// Faces of a small box in its own frame, if the centre of the box is its body's centre of mass. The faces and the
    /// body's pose suffice to pose this box. `None` for any other shape.
    pub(crate) fn as_centred_box(&self, shape: &ShapeDef, body: &Body) -> Option<Faces> {
        let Geometry::Polygon(polygon) = &shape.geometry else { return None };
        self.as_small_box()?;
        let is_centred = arm_of(shape, body) == Vec2::ZERO;
        Faces::of(polygon.vertices(), polygon.normals()).filter(|_| is_centred)
    }

    /// Whether the shape is solid from a place: false on the open side of a one-sided link.
    pub(crate) fn is_solid_from(&self, place: Vec2<Fx>) -> bool {
        match &self.outline {
            Outline::Link(link) => link.is_solid_from(place - self.centre),
            _ => true,
        }
    }

    /// Whether a ray from a place can meet the shape: false behind a one-sided link.
    pub(crate) fn is_facing(&self, place: Vec2<Fx>) -> bool {
        match &self.outline {
            Outline::Link(link) => link.is_facing(place - self.centre),
            _ => true,
        }
    }

    /// Whether the shape stops another, whose middle is at one place at the start of a cast and at another place at the
    /// hit. A shape behind a neighbour of a one-sided link may pass through the neighbour before it meets the link.
    pub(crate) fn stops(&self, start: Vec2<Fx>, at_hit: Vec2<Fx>) -> bool {
        self.is_solid_from(start) || self.is_facing(start) && self.is_solid_from(at_hit)
    }

    /// Whether the shape may stop another in a cast that starts with the other's middle at a place.
    pub(crate) fn may_stop(&self, start: Vec2<Fx>) -> bool {
        self.is_solid_from(start) || self.is_facing(start)
    }

    pub(crate) fn of_geometry(geometry: &Geometry, centre: Vec2<Fx>, rotation: Rot) -> Self {
        let (outline, bounds) = match geometry {
            Geometry::Circle { radius } => {
                let bounds = Aabb::new(Vec2::ZERO, Vec2::ZERO).expanded(*radius);
                (Outline::Circle { radius: narrow(*radius) }, bounds)
            }
            Geometry::Segment { a, b } => {
                let (a, b) = (rotation.apply_wide(*a), rotation.apply_wide(*b));
                (Outline::Segment { a, b }, Aabb::new(a.min(b), a.max(b)))
            }
            Geometry::Link { a, b, before, after, sides } => {
                let posed = |point: Vec2<Fx>| rotation.apply_wide(point);
                let link =
                    Link::new([*a, *b].map(posed), [*before, *after].map(|end| end.map(posed)), *sides);
                (Outline::Link(link), Aabb::new(link.a.min(link.b), link.a.max(link.b)))
            }
            Geometry::Polygon(polygon) => {
                let hull = Hull::rotated(polygon, rotation);
                let bounds = hull.bounds();
                (Outline::Polygon(hull), bounds)
            }
            Geometry::Capsule { a, b, radius } => {
                let hull = Hull::capsule(*a, *b, narrow(*radius), rotation);
                let bounds = hull.bounds();
                (Outline::Polygon(hull), bounds)
            }
        };
        PosedShape { centre, bounds: bounds.translated(centre), outline }
    }
}

fn centre_of(shape: &ShapeDef, body: &Body, rotation: impl FnOnce() -> Rot) -> Vec2<Fx> {
    let arm = arm_of(shape, body);
    let turned = if arm == Vec2::ZERO { arm } else { rotation().apply_wide(arm) };
    body.centre_of_mass() + turned
}

/// Vector from the body's centre of mass to the shape's centre, in the body's frame.
pub(crate) fn arm_of(shape: &ShapeDef, body: &Body) -> Vec2<Fx> {
    shape.offset - body.local_centre_of_mass()
}
