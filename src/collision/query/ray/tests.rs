//! The first test compares rays with sphere tracing.

use super::*;
use crate::collision::query::distance::distance;
use crate::collision::shape::support::{samples, to_fx};
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
                // Sphere tracing stops 2e-7 m before the surface. At a grazing angle, this distance is much longer
                // along the ray, so the error is measured along the surface normal.
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
            assert!(cast_ray(&shape, origin, through - origin).is_some(), "{shape:?} {origin:?} {through:?}");
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
    let wall = SupportShape::from_points([Vec2::new(fx!(1), fx!(-1)), Vec2::new(fx!(1), fx!(1))], Fx::ZERO);
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
/// A rounding error may put the hit point slightly outside of the shape. A ray from there in the same direction must
/// hit the shape again.
#[test]
fn a_ray_that_continues_from_a_hit_does_not_pass_through() {
    let mut rng = Rng::new(6);
    let (mut rays, mut passed) = (0, 0);
    for _ in 0..60_000 {
        let scale = if rng.chance(1, 2) { fx!(1) } else { rng.range(fx!(0.1), fx!(75)) };
        let shape = samples::support(&mut rng);
        let points = samples::world_points(&shape).into_iter().map(|point| point.scale(scale));
        let shape = SupportShape::from_points(points, fx_mul(to_fx(shape.radius), scale));
        let origin = samples::vector(&mut rng, fx!(4)).scale(scale);
        let translation = (samples::vector(&mut rng, fx!(1)).scale(scale) - origin).scale(fx!(2));
        let Some(hit) = cast_ray(&shape, origin, translation) else { continue };
        let steep = -translation.normalized().unwrap().widen().dot(hit.normal.widen());
        if steep < fx!(0.01) || to_fx(shape.radius) < fx!(0.001) {
            continue;
        }
        rays += 1;
        passed += u32::from(cast_ray(&shape, hit.point, translation).is_none());
    }
    assert!(rays > 10_000 && passed == 0, "{passed} of {rays} rays pass through");
}
