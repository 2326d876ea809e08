//! Ray cast against a shape: `o + t d` for the smallest `t` from 0 to 1.
//!
//! The outline of a core with a radius `r` consists of its edges, moved outwards by `r`, and of circles about its
//! vertices. For an edge vector `e` from `p`, a ray crosses the moved line where `e x (o + t d - p) = -r |e|`. The ray
//! enters a circle about `p` half a chord before the ray's nearest point to `p`. Products are exact. `|e|` and `|d|`
//! have a relative error of 1.5e-9, but they only affect lengths up to the radius. Rays and segments may therefore be
//! as long as the world.

use super::distance::overlap;
use crate::collision::shape::support::{
    Fraction, Grid, SupportShape, along, cross, direction, dot, edges, from_grid, height,
};
use crate::collision::shape::support::{scaled_along, to_grid};
use crate::math::{Fx, Unit, Vec2};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RayHit {
    /// Fraction of the translation, 0 to 1, rounded down to 2^-32. For a ray of 2^30 m that is 0.25 m.
    pub(crate) fraction: Fx,
    /// The fraction with more bits, to order two hits.
    pub(crate) order: Fraction,
    /// Hit point relative to the origin of the support shape, within 1 µm of the surface.
    pub(crate) point: Vec2<Fx>,
    /// Outward surface normal. Zero if the ray starts inside the shape or on its border.
    pub(crate) normal: Vec2<Unit>,
}

/// First hit of a ray. A segment is hit from both sides, and at its end by a ray that runs along the segment.
pub(crate) fn cast_ray(shape: &SupportShape, origin: Vec2<Fx>, translation: Vec2<Fx>) -> Option<RayHit> {
    if contains_point(shape, origin) {
        let (fraction, order) = (Fx::ZERO, Fraction::ZERO);
        return Some(RayHit { fraction, order, point: origin, normal: Vec2::ZERO });
    }
    // Both ends are rounded to the grid, so that a ray from the end of another ray starts exactly there.
    let end = to_grid(origin + translation);
    let origin = to_grid(origin);
    let translation = end - origin;
    let (fraction, normal) = entry(shape.points(), shape.radius, origin, translation)?;
    let point = from_grid(origin + fraction.of(translation));
    Some(RayHit { fraction: fraction.to_fx(), order: fraction, point, normal })
}

/// Whether a point is in a shape, borders included.
pub(crate) fn contains_point(shape: &SupportShape, point: Vec2<Fx>) -> bool {
    overlap(shape, &SupportShape::point(point))
}

/// Fraction and normal at which a ray from outside comes within `radius` of the hull of `points`.
pub(in crate::collision) fn entry(
    points: &[Vec2<Grid>],
    radius: Grid,
    o: Vec2<Grid>,
    d: Vec2<Grid>,
) -> Option<(Fraction, Vec2<Unit>)> {
    let forward = direction(d)?;
    // A face that is hit is the entry, because the shape is convex.
    if let Some(found) = edges(points).find_map(|(p, q)| enter_face(p, q, radius, o, d)) {
        return Some(found);
    }
    // Without a radius there are no circles, but a ray may hit a point, or a segment's end along the segment.
    if radius == 0 && points.len() > 2 {
        return None;
    }
    let fraction = points.iter().filter_map(|&p| enter_circle(p, radius, o, d, forward)).min()?;
    let hit = o + fraction.of(d);
    let from = points.iter().min_by_key(|&&p| dot(hit - p, hit - p)).map(|&p| hit - p)?;
    let normal = if radius == 0 { None } else { direction(from) };
    Some((fraction, normal.unwrap_or(-forward)))
}

/// Entry of a ray through the face from `p` to `q`, moved outwards by `radius`.
fn enter_face(
    p: Vec2<Grid>,
    q: Vec2<Grid>,
    radius: Grid,
    o: Vec2<Grid>,
    d: Vec2<Grid>,
) -> Option<(Fraction, Vec2<Unit>)> {
    let e = q - p;
    let inwards = cross(e, d);
    if inwards <= 0 {
        return None;
    }
    let tangent = direction(e)?;
    let way = -cross(e, o - p) - times_length(radius, e, tangent);
    if way < 0 || way > inwards {
        return None;
    }
    let fraction = Fraction::ratio(way, inwards);
    let on_face = if radius == 0 {
        // Exact, so that no ray slips through a corner.
        (0..=inwards).contains(&cross(o - p, d))
    } else {
        (0..=dot(e, e)).contains(&dot(e, o + fraction.of(d) - p))
    };
    on_face.then_some((fraction, -tangent.perp()))
}

/// Entry of a ray into the circle about `p`. `forward` is the ray's direction.
fn enter_circle(
    p: Vec2<Grid>,
    radius: Grid,
    o: Vec2<Grid>,
    d: Vec2<Grid>,
    forward: Vec2<Unit>,
) -> Option<Fraction> {
    let from_centre = o - p;
    let (before, beside) = (-dot(from_centre, d), cross(from_centre, d).abs());
    if before < 0 || beside > times_length(radius, d, forward) {
        return None;
    }
    let (r, h) = (radius.to_bits(), height(beside, scaled_along(forward, d)).to_bits());
    let half_chord = (i128::from(r - h) * i128::from(r + h)).max(0).isqrt();
    let way = before - ((half_chord * (scaled_along(forward, d) >> 8)) >> (Unit::FRAC_NBITS - 8));
    let whole = dot(d, d);
    // Negative if the ray starts inside by a rounding error.
    (way <= whole).then(|| Fraction::ratio(way.max(0), whole))
}

/// `radius |v|` in units of 2^-56 m². The shift keeps the product within 128 bits.
fn times_length(radius: Grid, v: Vec2<Grid>, direction: Vec2<Unit>) -> i128 {
    ((scaled_along(direction, v) >> 8) * i128::from(radius.to_bits())) >> (Unit::FRAC_NBITS - 8)
}

/// Approach in metres to a surface with this outward normal.
pub(in crate::collision) fn approach(normal: Vec2<Unit>, translation: Vec2<Grid>) -> Grid {
    -along(normal, translation)
}

#[cfg(test)]
mod tests {
    //! The first test compares rays with sphere tracing.

    use super::*;
    use crate::collision::query::distance::distance;
    use crate::collision::shape::support::samples;
    use crate::fx;
    use crate::math::{Rng, fx_div, fx_mul};

    /// Distance along a ray to the surface: see [`samples::march`].
    fn trace(shape: &SupportShape, origin: Vec2<Fx>, translation: Vec2<Fx>) -> Result<Option<Fx>, ()> {
        let length = translation.length();
        samples::march(length, |way| {
            let at = origin + translation.scale(fx_div(way, length).unwrap());
            distance(shape, &SupportShape::point(at)).distance
        })
    }

    #[test]
    fn rays_hit_what_sphere_tracing_hits() {
        let mut rng = Rng::new(1);
        let (mut hits, mut misses, mut grazing, mut inside) = (0, 0, 0, 0);
        for _ in 0..30_000 {
            let shape = samples::support(&mut rng);
            let origin = samples::vector(&mut rng, fx!(4));
            let aim = samples::vector(&mut rng, fx!(1.2));
            let translation = (aim - origin).scale(rng.range(fx!(0.5), fx!(3)));
            let found = cast_ray(&shape, origin, translation);
            if contains_point(&shape, origin) {
                inside += 1;
                let hit = found.expect("starts inside");
                assert_eq!((hit.fraction, hit.point, hit.normal), (Fx::ZERO, origin, Vec2::ZERO));
                continue;
            }
            match (trace(&shape, origin, translation), found) {
                (Ok(None), None) => misses += 1,
                (Ok(Some(way)), Some(hit)) => {
                    hits += 1;
                    // The search stops 2e-7 m before the surface, which is a longer way at a grazing angle. The error is
                    // therefore measured across the surface.
                    let found = fx_mul(hit.fraction, translation.length());
                    let steep = -translation.normalized().unwrap().widen().dot(hit.normal.widen());
                    assert!(steep >= 0, "{hit:?} {shape:?}");
                    let error = fx_mul((found - way).abs(), steep);
                    assert!(error < fx!(0.000001), "{found} {way} {steep} {shape:?} {origin:?}");
                    let surface = distance(&shape, &SupportShape::point(hit.point));
                    assert!(surface.distance.abs() < fx!(0.0000001), "{surface:?} {hit:?} {shape:?}");
                }
                (Err(()), _) => grazing += 1,
                (traced, found) => panic!("{traced:?} {found:?} {shape:?} {origin:?} {translation:?}"),
            }
        }
        assert!(
            hits > 8_000 && misses > 5_000 && inside > 200 && grazing < 1_500,
            "{hits} {misses} {inside} {grazing}"
        );
    }

    /// Rays aim through corners and along edges.
    #[test]
    fn no_ray_slips_into_a_shape() {
        let mut rng = Rng::new(3);
        let mut rays = 0;
        for _ in 0..20_000 {
            let shape = samples::support(&mut rng);
            let points = samples::world_points(&shape);
            let (first, last) = (points[0], points[points.len() - 1]);
            for (through, onwards) in
                [(first, last - first), (last, first - last), (last, samples::vector(&mut rng, fx!(1)))]
            {
                let origin = through - onwards.scale(rng.range(fx!(0.5), fx!(3)));
                if contains_point(&shape, origin) {
                    continue;
                }
                rays += 1;
                assert!(
                    cast_ray(&shape, origin, through - origin).is_some(),
                    "{shape:?} {origin:?} {through:?}"
                );
            }
        }
        assert!(rays > 20_000, "expected over 20000 rays, got {rays}");
    }

    #[test]
    fn a_ray_across_the_world_is_as_exact_as_a_short_one() {
        let mut rng = Rng::new(2);
        let mut hits = 0;
        for _ in 0..10_000 {
            let shape = samples::support(&mut rng);
            let far = samples::vector(&mut rng, fx!(1073741823));
            let aim = samples::vector(&mut rng, fx!(0.5));
            let Some(hit) = cast_ray(&shape, far, aim - far + (aim - far)) else { continue };
            hits += 1;
            let surface = distance(&shape, &SupportShape::point(hit.point));
            assert!(surface.distance.abs() < fx!(0.0000001), "{surface:?} {hit:?} {shape:?}");
        }
        assert!(hits > 5_000, "expected over 5000 hits, got {hits}");
    }

    #[test]
    fn large_shapes_are_hit_within_a_micrometre() {
        let mut rng = Rng::new(4);
        let mut hits = 0;
        for _ in 0..20_000 {
            let shape = samples::large(&mut rng);
            let origin = samples::vector(&mut rng, fx!(300));
            let translation = samples::vector(&mut rng, fx!(100)) - origin;
            let Some(hit) = cast_ray(&shape, origin, translation) else { continue };
            hits += 1;
            let surface = distance(&shape, &SupportShape::point(hit.point)).distance;
            assert!(hit.fraction == 0 || surface.abs() < fx!(0.0000003), "{surface:?} {hit:?} {shape:?}");
        }
        assert!(hits > 5_000, "expected over 5000 hits, got {hits}");
    }

    #[test]
    fn nothing_overflows_at_the_edge_of_the_world() {
        for p in samples::extremes() {
            for q in samples::extremes() {
                for radius in [fx!(0), fx!(110), Fx::MAX] {
                    let shape = SupportShape::from_points([p, q], radius);
                    for origin in samples::extremes() {
                        for translation in samples::extremes() {
                            cast_ray(&shape, origin, translation);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn segments_are_hit_from_both_sides_and_at_their_ends() {
        let wall =
            SupportShape::from_points([Vec2::new(fx!(1), fx!(-1)), Vec2::new(fx!(1), fx!(1))], Fx::ZERO);
        let hit = |x, y, dx, dy| {
            let hit = cast_ray(&wall, Vec2::new(x, y), Vec2::new(dx, dy))?;
            Some((hit.fraction, hit.normal))
        };
        assert_eq!(hit(fx!(0), fx!(0), fx!(2), fx!(0)), Some((fx!(0.5), -Vec2::X)));
        assert_eq!(hit(fx!(2), fx!(0), fx!(-4), fx!(0)), Some((fx!(0.25), Vec2::X)));
        assert_eq!(hit(fx!(0), fx!(1), fx!(2), fx!(0)), Some((fx!(0.5), -Vec2::X)));
        assert_eq!(hit(fx!(0), fx!(1) + Fx::DELTA * 16, fx!(2), fx!(0)), None);
        assert_eq!(hit(fx!(1), fx!(3), fx!(0), fx!(-4)), Some((fx!(0.5), Vec2::Y)));
        assert_eq!(hit(fx!(0), fx!(0), fx!(0), fx!(0)), None);
        assert_eq!(hit(fx!(0), fx!(0), fx!(0.5), fx!(0)), None);
    }
}
