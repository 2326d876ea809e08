//! Generates shapes: mostly 0.1 to 2 m long, sometimes with numbers at or beyond the limits.

use lockstep2d::body::{
    Area, Attraction, Chain, EventSwitches, Falloff, Filter, Geometry, Material, Mixing, Polygon, ShapeDef,
    ShapeId, Sides,
};
use lockstep2d::codec;
use lockstep2d::math::{Fx, Length, Vec2};
use lockstep2d::world::World;

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
    role(source, &mut def);
    def
}

/// An area, mostly moderate.
pub fn area(source: &mut Source<'_>) -> Area {
    let mut area = Area::new();
    if source.one_in(3) {
        area.acceleration = source.mostly_vec(-20_000, 20_000);
    }
    if source.one_in(3) {
        let falloff = source.pick(&[Falloff::Constant, Falloff::Inverse, Falloff::InverseSquare]);
        let acceleration = source.mostly(-20_000, 20_000);
        area.attraction = Some(Attraction { acceleration, radius: source.mostly(10, 4000), falloff });
    }
    if source.one_in(3) {
        area.force = source.mostly_vec(-20_000, 20_000);
    }
    if source.one_in(3) {
        area.flow = source.mostly_vec(-10_000, 10_000);
    }
    if source.one_in(2) {
        (area.linear_drag, area.angular_drag) = (source.mostly(0, 5000), source.mostly(0, 5000));
    }
    if source.one_in(2) {
        area.density = source.mostly(0, 3000);
    }
    area
}

/// Turns a few shapes into sensors, areas or one-way shapes, and lets some report hit events.
fn role(source: &mut Source<'_>, def: &mut ShapeDef) {
    match source.below(12) {
        0 | 1 => def.events.hit = true,
        2 => {
            let (contact, hit, sensor) = (source.one_in(2), source.one_in(2), source.one_in(2));
            def.events = EventSwitches { contact, hit, sensor, detect_sensors: source.one_in(2) };
        }
        3 => (def.sensor, def.events.detect_sensors) = (true, source.one_in(2)),
        4 => def.one_way = Some(source.angle()),
        5 => *def = def.area(area(source)),
        _ => {}
    }
}

/// A shape of an ordinary scene: 0.2 to 1.4 m long, with a density of 0.5 to 2.
pub fn ordinary_shape(source: &mut Source<'_>) -> ShapeDef {
    let geometry = match source.below(10) {
        8 | 9 => {
            let half = source.thousandths(50, 400);
            let (a, b) = (Vec2::new(-half, Fx::ZERO), Vec2::new(half, Fx::ZERO));
            let radius = source.thousandths(100, 300);
            return ordinary_surface(source, Geometry::Capsule { a, b, radius });
        }
        0..=2 => {
            let half = (source.thousandths(100, 500), source.thousandths(100, 500));
            Polygon::rectangle(half.0, half.1).ok()
        }
        3 => Polygon::regular(3 + source.below(6) as u32, source.thousandths(150, 500)).ok(),
        4 => {
            let mut point = || Vec2::new(source.thousandths(-500, 500), source.thousandths(-500, 500));
            let points = [point(), point(), point(), point(), point(), point()];
            Polygon::hull(&points).ok().filter(is_plump)
        }
        5 => Polygon::square(source.thousandths(100, 400))
            .and_then(|square| square.rounded(source.thousandths(1, 100)))
            .ok(),
        _ => None,
    };
    let radius = source.thousandths(100, 500);
    ordinary_surface(source, geometry.map_or(Geometry::Circle { radius }, Geometry::Polygon))
}

fn ordinary_surface(source: &mut Source<'_>, geometry: Geometry) -> ShapeDef {
    let mut def = ShapeDef::new(geometry);
    if source.one_in(4) {
        def.density = source.thousandths(500, 2000);
    }
    if source.one_in(3) {
        def.material.friction = source.thousandths(0, 1500);
        def.material.restitution = source.thousandths(0, 600);
    }
    if source.one_in(6) {
        def.material.rolling_resistance = source.thousandths(0, 300);
        def.material.surface_speed = source.thousandths(-3000, 3000);
    }
    if source.one_in(3) {
        role(source, &mut def);
    }
    def
}

/// A chain for the ground, from -8 m to 8 m.
pub fn ordinary_chain(source: &mut Source<'_>) -> Vec<ShapeDef> {
    let stretches = source.pick(&[8, 4, 16, 1, 2]);
    let point = |source: &mut Source<'_>, index: i64| {
        let x = lockstep2d::math::ratio(index * 16, stretches) - lockstep2d::fx!(8);
        Vec2::new(x, source.thousandths(-300, 300))
    };
    let mut points: Vec<_> = (0..=stretches).map(|index| point(source, index)).collect();
    // A one-sided chain whose points go from right to left is solid from above.
    let one_sided = source.one_in(3);
    if one_sided {
        points.reverse();
    }
    let chain = Chain::new(&points);
    let chain = if one_sided { chain.one_sided() } else { chain };
    chain.links().expect("points that are apart")
}

/// A chain of arbitrary points, or no shapes if it is invalid.
pub fn chain(source: &mut Source<'_>) -> Vec<ShapeDef> {
    let points: Vec<_> = (0..2 + source.below(10)).map(|_| source.mostly_vec(-4000, 4000)).collect();
    let materials = [material(source)];
    let mut chain = Chain::new(&points);
    if source.one_in(2) {
        chain = chain.closed();
    }
    if source.one_in(2) {
        chain = chain.one_sided();
    }
    if source.one_in(4) {
        chain = chain.materials(&materials);
    }
    chain.links().unwrap_or_default()
}

fn is_plump(polygon: &Polygon) -> bool {
    let half = half_extents(&ShapeDef::new(*polygon));
    half.x > lockstep2d::fx!(0.1) && half.y > lockstep2d::fx!(0.1)
}

/// Largest distance of a point of the shape from its body's origin, on each axis.
#[must_use]
pub fn half_extents(shape: &ShapeDef) -> Vec2<Fx> {
    let reach = match &shape.geometry {
        Geometry::Circle { radius } => Vec2::new(*radius, *radius),
        Geometry::Segment { a, b } | Geometry::Link { a, b, .. } => a.max(-*a).max(*b).max(-*b),
        Geometry::Capsule { a, b, radius } => a.max(-*a).max(*b).max(-*b) + Vec2::new(*radius, *radius),
        Geometry::Polygon(polygon) => {
            let radius: Fx = polygon.radius().into();
            let reach = |reach: Vec2<Fx>, v: &Vec2<Length>| reach.max(v.widen()).max(-v.widen());
            polygon.vertices().iter().fold(Vec2::ZERO, reach) + Vec2::new(radius, radius)
        }
    };
    reach + shape.offset.max(-shape.offset)
}

fn material(source: &mut Source<'_>) -> Material {
    let rules = [Mixing::Average, Mixing::GeometricMean, Mixing::Minimum, Mixing::Product, Mixing::Maximum];
    Material {
        friction: source.mostly(0, 16_000),
        friction_mixing: source.pick(&rules),
        restitution: source.mostly(0, 1500),
        restitution_mixing: source.pick(&rules),
        restitution_threshold: if source.one_in(2) { Some(source.mostly(0, 2000)) } else { None },
        rolling_resistance: if source.one_in(2) { source.mostly(0, 1000) } else { Fx::ZERO },
        surface_speed: if source.one_in(2) { source.mostly(-400_000, 400_000) } else { Fx::ZERO },
    }
}

/// A geometry, valid or not.
pub fn geometry(source: &mut Source<'_>) -> Geometry {
    match source.below(16) {
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
        11 => stored_polygon(source).map_or(fallback(), Geometry::Polygon),
        12 | 13 => {
            let (a, b) = (source.mostly_vec(-1000, 0), source.mostly_vec(0, 1000));
            Geometry::Capsule { a, b, radius: source.mostly(2, 1000) }
        }
        _ => link(source),
    }
}

/// A link with arbitrary neighbours or none, possibly folded back on itself.
fn link(source: &mut Source<'_>) -> Geometry {
    let (a, b) = (source.mostly_vec(-3000, 0), source.mostly_vec(0, 3000));
    let neighbour = |source: &mut Source<'_>, other: Vec2<Fx>| match source.below(4) {
        0 => None,
        1 => Some(other),
        _ => Some(source.mostly_vec(-4000, 4000)),
    };
    let (before, after) = (neighbour(source, b), neighbour(source, a));
    Geometry::Link { a, b, before, after, sides: source.pick(&[Sides::Both, Sides::Right]) }
}

fn fallback() -> Geometry {
    Geometry::Circle { radius: lockstep2d::fx!(0.5) }
}

fn rounded(source: &mut Source<'_>, polygon: Option<Polygon>) -> Geometry {
    let radius = if source.one_in(4) { source.mostly(0, 500) } else { Fx::ZERO };
    polygon.and_then(|polygon| polygon.rounded(radius).ok()).map_or(fallback(), Geometry::Polygon)
}

/// A very large, very small or very thin geometry.
fn extreme(source: &mut Source<'_>) -> Geometry {
    let size = |source: &mut Source<'_>| source.pick(&[2, 3, 120_000, 119_999, 100_000, 17_000, 1, 64_000]);
    let length = |thousandths: i64| lockstep2d::math::ratio(thousandths, 1000);
    let far_end = |source: &mut Source<'_>| {
        let far = source.pick(&[1, 1_000_000, 1_000_000_000]);
        let coordinate = |source: &mut Source<'_>| source.thousandths(-1000, 1000).saturating_mul_int(far);
        Vec2::new(coordinate(source), coordinate(source))
    };
    match source.below(6) {
        0 => Geometry::Circle { radius: length(size(source)) },
        1 => {
            let (x, y) = (length(size(source)), length(size(source)));
            rounded(source, Polygon::rectangle(x, y).ok())
        }
        2 => {
            let a = far_end(source);
            Geometry::Segment { a, b: far_end(source) }
        }
        3 => {
            let ends = (Some(far_end(source)), far_end(source), far_end(source), Some(far_end(source)));
            let (before, a, b, after) = ends;
            Geometry::Link { a, b, before, after, sides: source.pick(&[Sides::Both, Sides::Right]) }
        }
        4 => {
            let end = |source: &mut Source<'_>| Vec2::new(length(size(source)), -length(size(source)));
            let (a, b) = (end(source), -end(source));
            Geometry::Capsule { a, b, radius: length(size(source)) }
        }
        _ => {
            let tip = Vec2::new(length(size(source)), Fx::from_bits(i64::from(source.byte()) << 10));
            let base = Vec2::new(-length(size(source)), Fx::ZERO);
            let points = [base, Vec2::new(length(size(source)), -Fx::DELTA * 1024), tip];
            rounded(source, Polygon::new(&points).ok())
        }
    }
}

/// A polygon with arbitrary vertices, decoded as from a file. `None` if the decoder refuses it.
fn stored_polygon(source: &mut Source<'_>) -> Option<Polygon> {
    let grid = source.pick(&[1i32 << 22, 1 << 12, 1 << 28, 1]);
    let count = 3 + source.below(6);
    let coordinate =
        |source: &mut Source<'_>| Length::from_bits((source.below(9) as i32 - 4).saturating_mul(grid));
    let vertices: Vec<_> = (0..count).map(|_| Vec2::new(coordinate(source), coordinate(source))).collect();
    let radius = if source.one_in(3) { coordinate(source) } else { Length::ZERO };
    codec::decode(&codec::encode(&(vertices, radius))).ok()
}

/// The current definition of a shape with one property changed, or an entirely new definition.
pub(crate) fn altered(source: &mut Source<'_>, world: &World, id: ShapeId) -> ShapeDef {
    let fresh = shape(source);
    let Some(mut def) = world.shape(id).map(|shape| *shape.def()) else { return fresh };
    match source.below(8) {
        0 => def.geometry = fresh.geometry,
        1 => def.offset = fresh.offset,
        2 => def.density = fresh.density,
        3 => def.material = fresh.material,
        4 => def.filter = fresh.filter,
        5 => def.one_way = def.one_way.is_none().then(|| source.angle()),
        6 => (def.sensor, def.events) = (!def.sensor, fresh.events),
        7 if source.one_in(2) => {
            def.sensor = true;
            def.area = source.one_in(4).then(|| area(source));
        }
        _ => def = fresh,
    }
    def
}
