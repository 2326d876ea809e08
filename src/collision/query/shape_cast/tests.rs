use super::*;
use crate::collision::shape::support::samples;
use crate::math::{Rng, fx_div, fx_mul};

/// Distance that B travels to the skin of A, by sphere tracing. `Err` if sphere tracing cannot decide: see
/// [`samples::march`].
fn stepped(a: &SupportShape, b: &SupportShape, translation: Vec2<Fx>) -> Result<Option<Fx>, ()> {
    let length = translation.length();
    samples::march(length, |way| {
        let moved = b.moved(to_grid(translation.scale(fx_div(way, length).unwrap())));
        distance(a, &moved).distance - SKIN
    })
}

#[test]
fn shapes_stop_where_steps_of_their_distance_end() {
    let mut rng = Rng::new(1);
    let (mut hits, mut misses, mut grazing) = (0, 0, 0);
    for _ in 0..20_000 {
        let (a, b) = (samples::support(&mut rng), samples::placed(&mut rng, fx!(4)));
        if distance(&a, &b).distance <= SKIN + TOLERANCE {
            continue;
        }
        let translation = samples::vector(&mut rng, fx!(8));
        match (stepped(&a, &b, translation), cast_shape(&a, &b, translation)) {
            (Ok(None), None) => misses += 1,
            (Ok(Some(way)), Some(hit)) => {
                hits += 1;
                let found = fx_mul(hit.fraction, translation.length());
                let steep = -translation.normalized().unwrap().widen().dot(hit.normal.widen());
                let error = fx_mul((found - way).abs(), steep);
                assert!(error < fx!(0.000001), "{found} {way} {steep} {a:?} {b:?}");
                let gap = distance(&a, &b.moved(to_grid(hit.travelled))).distance - SKIN;
                assert!(gap.abs() < fx!(0.0000001), "{gap} {hit:?} {a:?} {b:?}");
            }
            (Err(()), _) => grazing += 1,
            (stepped, found) => panic!("{stepped:?} {found:?} {a:?} {b:?} {translation:?}"),
        }
    }
    assert!(hits > 1_500 && misses > 8_000 && grazing < 500, "{hits} {misses} {grazing}");
}

#[test]
fn a_stopped_shape_leaves_and_slides_but_does_not_go_on() {
    let mut rng = Rng::new(2);
    let mut stopped = 0;
    for _ in 0..20_000 {
        let (a, b) = (samples::support(&mut rng), samples::placed(&mut rng, fx!(4)));
        let translation = samples::vector(&mut rng, fx!(8));
        let Some(hit) = cast_shape(&a, &b, translation) else { continue };
        stopped += 1;
        let b = b.moved(to_grid(hit.travelled));
        let normal = hit.normal.widen();
        let into = normal.scale(normal.dot(translation));
        assert_eq!(cast_shape(&a, &b, -translation), None, "{hit:?} {a:?} {b:?}");
        assert_eq!(cast_shape(&a, &b, translation - into), None, "{hit:?} {a:?} {b:?}");
        if into.length() > fx!(0.0001) {
            let again = cast_shape(&a, &b, translation).expect("a second cast should hit the same obstacle");
            assert_eq!(again.fraction, Fx::ZERO, "{hit:?} {a:?} {b:?}");
        }
    }
    assert!(stopped > 2_000, "expected over 2000 hits, got {stopped}");
}

#[test]
fn movement_that_starts_in_contact_never_deepens_it() {
    let mut rng = Rng::new(3);
    let mut free = 0;
    for _ in 0..20_000 {
        let (a, b) = (samples::support(&mut rng), samples::placed(&mut rng, fx!(0.6)));
        let start = distance(&a, &b).distance;
        let translation = samples::vector(&mut rng, fx!(2));
        if start > SKIN || cast_shape(&a, &b, translation).is_some() {
            continue;
        }
        free += 1;
        for i in 1..=16_i64 {
            let moved = b.moved(to_grid(translation.scale(Fx::from_num(i) / 16)));
            let gap = distance(&a, &moved).distance;
            assert!(
                gap >= start - fx!(0.000001),
                "the gap should not shrink from {start} to {gap}: {a:?} {b:?} {translation:?}"
            );
        }
    }
    assert!(free > 2_000, "expected over 2000 movements without a hit, got {free}");
}

#[test]
fn large_shapes_stop_at_the_skin_and_leave_it() {
    let mut rng = Rng::new(5);
    let mut hits = 0;
    for _ in 0..10_000 {
        let start = to_grid(samples::vector(&mut rng, fx!(300)));
        let (a, b) = (samples::large(&mut rng), samples::large(&mut rng).moved(start));
        let translation = samples::vector(&mut rng, fx!(300));
        let Some(hit) = cast_shape(&a, &b, translation).filter(|hit| hit.fraction > 0) else { continue };
        hits += 1;
        let b = b.moved(to_grid(hit.travelled));
        let gap = distance(&a, &b).distance - SKIN;
        assert!(gap.abs() < fx!(0.000001), "{gap} {hit:?} {a:?} {b:?}");
        assert_eq!(cast_shape(&a, &b, -translation), None, "{hit:?} {a:?} {b:?}");
    }
    assert!(hits > 500, "expected over 500 hits, got {hits}");
}

#[test]
fn nothing_overflows_at_the_edge_of_the_world() {
    for p in samples::extremes() {
        for q in samples::extremes() {
            for start in samples::extremes() {
                for translation in samples::extremes() {
                    let ball = SupportShape::disc(start, fx!(110));
                    cast_shape(&SupportShape::from_points([p, q], fx!(110)), &ball, translation);
                    cast_shape(&ball, &SupportShape::from_points([p, q], Fx::MAX), translation);
                    let line = SupportShape::from_points([start, p], Fx::ZERO);
                    cast_shape(&line, &SupportShape::from_points([p, q], fx!(0)), translation);
                }
            }
        }
    }
}

#[test]
fn a_cast_across_the_world_stops_at_the_skin() {
    let mut rng = Rng::new(4);
    let mut hits = 0;
    for _ in 0..5_000 {
        let far = samples::vector(&mut rng, fx!(1073741823));
        let (a, b) = (samples::support(&mut rng), samples::support(&mut rng).moved(to_grid(far)));
        let Some(hit) = cast_shape(&a, &b, -far) else { continue };
        hits += 1;
        let gap = distance(&a, &b.moved(to_grid(hit.travelled))).distance - SKIN;
        assert!(gap.abs() < fx!(0.0000003), "{gap} {hit:?} {a:?} {b:?}");
    }
    assert!(hits > 3_000, "expected over 3000 hits, got {hits}");
}
