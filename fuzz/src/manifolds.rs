//! Compares the contact and the distance of two shapes with exact values. These come from a search over all face
//! normals and all pairs of a vertex and an edge, in arithmetic on big integers.

use lockstep2d::body::{BodyDef, Geometry, MassSource, Polygon, ShapeDef};
use lockstep2d::math::{Angle, Fx, Rot, Step, Vec2};
use lockstep2d::world::{Config, World};
use num_bigint::BigInt;
use num_traits::{Signed, Zero};

use crate::maths::exact::{Exact, integer};
use crate::source::Source;

/// A point in units of 2^-32 m.
type Point = [BigInt; 2];

/// Maximum error of a separation, in micrometres: 500 because a face of B is chosen only if its separation exceeds that
/// of the best face of A by more than 500, 500 because outlines up to 500 apart count as touching, and 1 for rounding.
const CONTACT_ERROR: i64 = 1_001;
/// Maximum error of a distance, in micrometres. The actual errors are 20 nm from the algorithm and 240 nm from rounding
/// a rotated vertex.
const DISTANCE_ERROR: i64 = 1;

/// All points within `radius` of the convex hull of `points`, which are counter-clockwise.
struct Solid {
    points: Vec<Point>,
    radius: BigInt,
}

/// The relation of two shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Seen {
    /// The shapes are not valid.
    Refused,
    /// The shapes have no contact. Two segments never have one, even if they cross.
    Apart,
    /// Close enough for a contact, but not touching.
    Near,
    /// The contact is touching.
    Overlapping,
}

/// Puts two shapes into a world and checks their distance and contact.
///
/// # Panics
/// When the distance or the contact differs from the exact value by more than the documented error.
pub fn run(bytes: &[u8]) -> Seen {
    let mut source = Source::new(bytes);
    let config = Config { gravity: Vec2::ZERO, sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    let scale = source.pick(&[1, 1, 1, 10, 50]);
    let (def_a, def_b) = (geometry(&mut source, scale), geometry(&mut source, scale));
    let (Some(def_a), Some(def_b)) = (def_a, def_b) else { return Seen::Refused };
    let far = source.pick(&[Fx::ZERO, Fx::from(1_000_000_000)]);
    let at_a = Vec2::new(far, -far);
    let reach = 700 * scale;
    let between = match source.below(6) {
        0 => Vec2::ZERO,
        1 => Vec2::new(source.thousandths(-reach, reach), Fx::ZERO),
        _ => Vec2::new(source.thousandths(-reach, reach), source.thousandths(-reach, reach)),
    };
    let at_b = at_a + between;
    let (angle_a, angle_b) = (source.angle(), source.angle());
    let a = BodyDef::fixed().position(at_a).angle(angle_a);
    // Segments have no mass, and a body without mass has no contacts with fixed bodies.
    let mass = MassSource::Given { mass: Fx::ONE, centre: Vec2::ZERO, gyration: Fx::ONE };
    let b = BodyDef::dynamic().position(at_b).angle(angle_b).mass(mass);
    let shapes = [(a, def_a), (b, def_b)].map(|(body, geometry)| {
        let body = world.spawn(&body, &[ShapeDef::new(geometry)]).ok()?;
        Some(world.body(body)?.shapes()[0])
    });
    let [Some(shape_a), Some(shape_b)] = shapes else { return Seen::Refused };
    let (solid_a, solid_b) = (Solid::of(&def_a, at_a, angle_a), Solid::of(&def_b, at_b, angle_b));
    let exact = separation(&solid_a, &solid_b);
    let radii = integer(&solid_a.radius + &solid_b.radius);
    let what = || format!("{def_a:?} at {at_a:?} {angle_a:?}, {def_b:?} at {at_b:?} {angle_b:?}");

    let distance = world.distance(shape_a, shape_b).expect("both are there");
    let found = integer(distance.distance.to_bits()) + &radii;
    assert!(is_within(&exact, &found, DISTANCE_ERROR), "distance {}: {}", distance.distance, what());

    // Two segments never have a contact.
    let is_segment = |geometry: &Geometry| matches!(geometry, Geometry::Segment { .. });
    if is_segment(&def_a) && is_segment(&def_b) {
        return Seen::Apart;
    }
    world.step();
    let contact = world.contacts().next();
    let Some(contact) = contact else {
        let near = integer(config.touching_distance().to_bits()) + &radii - micrometres(CONTACT_ERROR);
        assert!(exact > signed_square(&near), "no contact: {}", what());
        return Seen::Apart;
    };
    let manifold = contact.manifold;
    let least = manifold.points().iter().map(|point| point.separation).min().expect("a contact has points");
    let found = integer(Fx::from(least).to_bits()) + &radii;
    // A separation below the range of `Step` is reported as `Step::MIN`.
    let saturated = least == Step::MIN;
    let right = match saturated {
        true => exact <= signed_square(&(found + micrometres(CONTACT_ERROR))),
        false => is_within(&exact, &found, CONTACT_ERROR),
    };
    assert!(right, "separation {least}: {}", what());
    let length = manifold.normal.widen().length();
    assert!((length - Fx::ONE).abs() < Fx::from_bits(16), "a normal of length {length}: {}", what());
    for point in manifold.points().iter().filter(|_| !saturated) {
        let place = manifold.origin + point.anchor.widen();
        let place = [BigInt::from(place.x.to_bits()), BigInt::from(place.y.to_bits())];
        // Half the separation: a contact point has this distance from each surface.
        let half = BigInt::from(Fx::from(point.separation).to_bits().abs() / 2);
        for solid in [&solid_a, &solid_b] {
            let allowed = integer(&solid.radius + &half) + micrometres(CONTACT_ERROR);
            let off = solid.square_distance(&place);
            assert!(
                off <= &allowed * &allowed,
                "a contact point is not half-way between the surfaces: {}",
                what()
            );
        }
    }
    if contact.touching { Seen::Overlapping } else { Seen::Near }
}

fn micrometres(count: i64) -> Exact {
    Exact::new(BigInt::from(count) << 32, BigInt::from(1_000_000))
}

/// A geometry other than a link. Its coordinates and radii are at most 0.5 m times `scale`. `None` if it is invalid.
fn geometry(source: &mut Source<'_>, scale: i64) -> Option<Geometry> {
    let size = |source: &mut Source<'_>| source.thousandths(2, 500 * scale);
    let point = |source: &mut Source<'_>| {
        Vec2::new(
            source.thousandths(-500 * scale, 500 * scale),
            source.thousandths(-500 * scale, 500 * scale),
        )
    };
    match source.below(8) {
        0 => Geometry::circle(size(source)).ok(),
        1 => {
            let (a, b, radius) = (point(source), point(source), source.thousandths(2, 300 * scale));
            Some(Geometry::Capsule { a, b, radius })
        }
        2 => Some(Geometry::Segment { a: point(source), b: point(source) }),
        3 => Polygon::regular(3 + source.below(6) as u32, size(source)).ok().map(Geometry::Polygon),
        4 => {
            let (width, height) = (size(source), size(source));
            let rounded = source.thousandths(0, 100 * scale);
            Polygon::rectangle(width, height).and_then(|it| it.rounded(rounded)).ok().map(Geometry::Polygon)
        }
        5 => Polygon::square(size(source)).ok().map(Geometry::Polygon),
        _ => {
            let points: Vec<_> = (0..3 + source.below(6)).map(|_| point(source)).collect();
            Polygon::hull(&points).ok().map(Geometry::Polygon)
        }
    }
}

impl Solid {
    fn of(geometry: &Geometry, at: Vec2<Fx>, angle: Angle) -> Self {
        let rotation = Rot::from_angle(angle);
        let place = |v: Vec2<Fx>| [v.x + at.x, v.y + at.y].map(|value| BigInt::from(value.to_bits()));
        let (points, radius) = match geometry {
            Geometry::Circle { radius } => (vec![place(Vec2::ZERO)], *radius),
            Geometry::Capsule { a, b, radius } => {
                (vec![place(turned(*a, angle)), place(turned(*b, angle))], *radius)
            }
            Geometry::Segment { a, b } | Geometry::Link { a, b, .. } => {
                (vec![place(rotation.apply_wide(*a)), place(rotation.apply_wide(*b))], Fx::ZERO)
            }
            Geometry::Polygon(polygon) => {
                let vertices = polygon.vertices().iter();
                (vertices.map(|v| place(rotation.apply(*v).widen())).collect(), Fx::from(polygon.radius()))
            }
        };
        Solid { points, radius: radius.to_bits().into() }
    }

    /// The edges. Two points have two edges, one in each direction, and a single point has none.
    fn edges(&self) -> impl Iterator<Item = (&Point, &Point)> {
        let count = self.points.len();
        (0..count)
            .filter(move |_| count > 1)
            .map(move |at| (&self.points[at], &self.points[(at + 1) % count]))
    }

    /// Squared distance of a point from the convex hull of `self.points`. It is 0 for a point inside the hull.
    fn square_distance(&self, point: &Point) -> Exact {
        if self.points.len() > 2 && self.edges().all(|(a, b)| !cross(a, b, point).is_negative()) {
            return Exact::zero();
        }
        let to_first = || integer(square(&self.points[0], point));
        self.edges().map(|(a, b)| square_from_edge(a, b, point)).min().unwrap_or_else(to_first)
    }
}

fn turned(v: Vec2<Fx>, angle: Angle) -> Vec2<Fx> {
    Rot::from_angle(angle).apply_wide(v)
}

fn cross(a: &Point, b: &Point, c: &Point) -> BigInt {
    (&b[0] - &a[0]) * (&c[1] - &a[1]) - (&b[1] - &a[1]) * (&c[0] - &a[0])
}

fn dot(a: &Point, b: &Point, c: &Point) -> BigInt {
    (&b[0] - &a[0]) * (&c[0] - &a[0]) + (&b[1] - &a[1]) * (&c[1] - &a[1])
}

fn square(a: &Point, b: &Point) -> BigInt {
    dot(a, b, b)
}

fn square_from_edge(a: &Point, b: &Point, point: &Point) -> Exact {
    let (along, whole) = (dot(a, b, point), square(a, b));
    if !along.is_positive() {
        integer(square(a, point))
    } else if along >= whole {
        integer(square(b, point))
    } else {
        let across = cross(a, b, point);
        Exact::new(&across * &across, whole)
    }
}

/// `x |x|`, monotonic in `x`.
fn signed_square(x: &Exact) -> Exact {
    x * x.abs()
}

/// Signed square of the distance between the two convex hulls. If the hulls overlap, the distance is the negative
/// penetration depth.
fn separation(a: &Solid, b: &Solid) -> Exact {
    let of_axes = |a: &Solid, b: &Solid| {
        let face = |(start, end): (&Point, &Point)| {
            // The right side of an edge is outside.
            let nearest = b.points.iter().map(|point| -cross(start, end, point)).min()?;
            Some(Exact::new(&nearest * nearest.abs(), square(start, end)))
        };
        a.edges().filter_map(face).max()
    };
    let deepest = of_axes(a, b).into_iter().chain(of_axes(b, a)).max();
    let apart =
        [(a, b), (b, a)].into_iter().flat_map(|(a, b)| a.points.iter().map(|point| b.square_distance(point)));
    let apart = apart.min().unwrap_or_else(Exact::zero);
    match deepest {
        // `apart` is wrong for crossing segments: it is the distance of an end point and so positive. But `deepest` is
        // negative then. `deepest` is wrong for collinear segments that are apart: it is zero. But `apart` is positive
        // then.
        Some(deepest) if !deepest.is_positive() && (deepest.is_negative() || apart.is_zero()) => deepest,
        _ => apart,
    }
}

/// Whether `exact` is the signed square of a length within `error` micrometres of `found`.
fn is_within(exact: &Exact, found: &Exact, error: i64) -> bool {
    let error = micrometres(error);
    (signed_square(&(found - &error))..=signed_square(&(found + &error))).contains(exact)
}
