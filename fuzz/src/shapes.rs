//! Shapes: mostly 0.1 to 2 m, sometimes at the limits, sometimes beyond them.

use lockstep2d::body::{Filter, Geometry, Material, Mixing, Polygon, ShapeDef};
use lockstep2d::codec;
use lockstep2d::math::{Fx, Length, Vec2};

use crate::source::Source;

/// A shape, valid or not.
pub fn shape(source: &mut Source<'_>) -> ShapeDef {
    let mut def = ShapeDef::new(geometry(source));
    if source.one_in(3) {
        def.offset = source.mostly_vec(-800, 800);
    }
    if source.one_in(4) {
        def.density = source.mostly(10, 5000);
    }
    if source.one_in(4) {
        def.material = material(source);
    }
    if source.one_in(8) {
        def.filter = Filter {
            category: source.pick(&[1, 2, 3, 0, u64::MAX]),
            mask: source.pick(&[u64::MAX, 1, 2, 0]),
            group: source.pick(&[0, 1, -1, i32::MIN, i32::MAX]),
        };
    }
    def
}

fn material(source: &mut Source<'_>) -> Material {
    let rules = [Mixing::Average, Mixing::GeometricMean, Mixing::Minimum, Mixing::Product, Mixing::Maximum];
    Material {
        friction: source.mostly(0, 16_000),
        friction_mixing: source.pick(&rules),
        restitution: source.mostly(0, 1000),
        restitution_mixing: source.pick(&rules),
    }
}

fn geometry(source: &mut Source<'_>) -> Geometry {
    match source.below(12) {
        0..=2 => Geometry::Circle { radius: source.mostly(50, 1000) },
        3..=5 => {
            let half = (source.thousandths(50, 1000), source.thousandths(50, 1000));
            rounded(source, Polygon::rectangle(half.0, half.1).ok())
        }
        6 => {
            let polygon = Polygon::regular(3 + source.below(6) as u32, source.mostly(50, 1000));
            rounded(source, polygon.ok())
        }
        7 | 8 => {
            let points: Vec<_> = (0..3 + source.below(8)).map(|_| source.mostly_vec(-1000, 1000)).collect();
            rounded(source, Polygon::hull(&points).ok())
        }
        9 => Geometry::Segment { a: source.mostly_vec(-3000, 0), b: source.mostly_vec(0, 3000) },
        10 => extreme(source),
        _ => stored_polygon(source).map_or(fallback(), Geometry::Polygon),
    }
}

fn fallback() -> Geometry {
    Geometry::Circle { radius: lockstep2d::fx!(0.5) }
}

fn rounded(source: &mut Source<'_>, polygon: Option<Polygon>) -> Geometry {
    let radius = if source.one_in(4) { source.mostly(0, 500) } else { Fx::ZERO };
    polygon.and_then(|polygon| polygon.rounded(radius).ok()).map_or(fallback(), Geometry::Polygon)
}

/// The largest, the smallest and the thinnest.
fn extreme(source: &mut Source<'_>) -> Geometry {
    let size = |source: &mut Source<'_>| source.pick(&[2, 3, 120_000, 119_999, 100_000, 17_000, 1, 64_000]);
    let length = |thousandths: i64| lockstep2d::math::ratio(thousandths, 1000);
    match source.below(4) {
        0 => Geometry::Circle { radius: length(size(source)) },
        1 => {
            let (x, y) = (length(size(source)), length(size(source)));
            rounded(source, Polygon::rectangle(x, y).ok())
        }
        2 => {
            let far = source.pick(&[1, 1_000_000, 1_000_000_000]);
            let end = |source: &mut Source<'_>| source.thousandths(-1000, 1000).saturating_mul_int(far);
            let a = Vec2::new(end(source), end(source));
            Geometry::Segment { a, b: Vec2::new(end(source), end(source)) }
        }
        _ => {
            let tip = Vec2::new(length(size(source)), Fx::from_bits(i64::from(source.byte()) << 10));
            let base = Vec2::new(-length(size(source)), Fx::ZERO);
            let points = [base, Vec2::new(length(size(source)), -Fx::DELTA * 1024), tip];
            rounded(source, Polygon::new(&points).ok())
        }
    }
}

/// A polygon as a file stores it: any vertices at all that the decoder accepts.
fn stored_polygon(source: &mut Source<'_>) -> Option<Polygon> {
    let grid = source.pick(&[1i32 << 22, 1 << 12, 1 << 28, 1]);
    let count = 3 + source.below(6);
    let coordinate =
        |source: &mut Source<'_>| Length::from_bits((source.below(9) as i32 - 4).saturating_mul(grid));
    let vertices: Vec<_> = (0..count).map(|_| Vec2::new(coordinate(source), coordinate(source))).collect();
    let radius = if source.one_in(3) { coordinate(source) } else { Length::ZERO };
    codec::decode(&codec::encode(&(vertices, radius))).ok()
}
