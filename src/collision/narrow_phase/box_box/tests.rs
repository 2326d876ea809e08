//! Tests of the SIMD path.

use super::*;
use crate::body::{Body, BodyDef, MassProperties, Polygon, ShapeDef};
use crate::collision::{CachedAxis, SatCounters, collide_near};
use crate::fx;
use crate::math::{Angle, Rng, Rot, narrow};
use crate::simd::Backend;
use alloc::format;
use alloc::vec::Vec;

/// A box within the size limit of the SIMD path, and its half extents.
fn random_box(rng: &mut Rng) -> (Polygon, Vec2<Fx>) {
    // Multiples of 1/1024 m, so that opposite corners are exact opposites.
    let size_max = [1850, 1850, 500, 250][rng.below(4) as usize];
    let mut size = || i64::from(50 + rng.below(size_max - 50));
    let (width, height) = (size(), size());
    let (width, height) = if rng.below(8) == 0 { (2750, 50) } else { (width, height) };
    let slant = if rng.below(4) == 0 { height / 20 } else { 0 };
    let corner = |x: i64, y: i64| Vec2::new(fx!(1) * x / 1024, fx!(1) * y / 1024);
    let (top, bottom) = (corner(width + slant, height), corner(width - slant, -height));
    let Vec2 { x: width, y: height } = top;
    let polygon = Polygon::hull(&[top, -bottom, -top, bottom]).expect("convex");
    let radius = if rng.below(3) == 0 { rng.range(fx!(0), fx!(0.2)) } else { fx!(0) };
    (polygon.rounded(radius).expect("valid"), Vec2::new(width + radius, height + radius))
}

/// Two boxes that touch or nearly touch. Most of them are nearly at right angles to each other, as in piles.
fn random_pair(rng: &mut Rng) -> (PosedShape, PosedShape) {
    let ((a, reach_a), (b, reach_b)) = (random_box(rng), random_box(rng));
    let turned = match rng.below(4) {
        0 => rng.angle(),
        1 => Angle::from_degrees(rng.range(fx!(-0.5), fx!(0.5))),
        2 => Angle::from_degrees(fx!(90) * i64::from(rng.below(4))),
        _ => Angle::ZERO,
    };
    let reach_b = Vec2::new(reach_b.x.max(reach_a.x), reach_b.y);
    let aside = match rng.below(4) {
        0 => fx!(0),
        1 => reach_a.x + rng.range(fx!(-0.001), fx!(0.001)),
        _ => rng.range(-(reach_a.x + reach_b.x), reach_a.x + reach_b.x),
    };
    let gap = match rng.below(4) {
        0 => fx!(0),
        1 => rng.range(-reach_b.y, fx!(0.2)),
        _ => rng.range(fx!(-0.002), fx!(0.03)),
    };
    let away = reach_a.y + reach_b.y + gap;
    let place = Vec2::new(rng.range(fx!(-900), fx!(900)), rng.range(fx!(-900), fx!(900)));
    let common = if rng.below(4) == 0 { Angle::ZERO } else { rng.angle() };
    let way = Rot::from_angle(common).apply_wide(Vec2::new(aside, away));
    let posed = |polygon: Polygon, place, angle| {
        PosedShape::of_geometry(&polygon.into(), place, Rot::from_angle(angle))
    };
    let (first, second) = (posed(a, place, common), posed(b, place + way, common + turned));
    if rng.below(2) == 0 { (first, second) } else { (second, first) }
}

#[test]
fn lanes_find_what_is_found_one_by_one() {
    let machines =
        || Backend::available().filter_map(Machine::new).filter(|machine| machine.vectors().is_some());
    if machines().next().is_none() {
        return;
    }
    let mut rng = Rng::new(5);
    let (mut pairs_seen, mut points, mut left) = (0, [0; 3], 0);
    let mut batch = BoxPairs::default();
    for _ in 0..20_000 {
        let pairs: Vec<_> = (0..=rng.below(10)).map(|_| random_pair(&mut rng)).collect();
        let widest = if rng.below(16) == 0 { fx!(2) } else { fx!(0.2) };
        let margins: Vec<_> = pairs.iter().map(|_| narrow(rng.range(fx!(0.005), widest))).collect();
        let expected = pairs.iter().zip(&margins).map(|((a, b), &margin)| {
            collide_near(a, b, margin, &mut CachedAxis::default(), &mut SatCounters::default())
        });
        let expected: Vec<_> = expected.collect();
        let slots_of = |place: usize| (63 - 3 * u32::try_from(place).unwrap(), u32::try_from(place).unwrap());
        let mut boxes = SmallBoxes::default();
        boxes.resize(64);
        for (place, (a, b)) in pairs.iter().enumerate() {
            assert!(a.as_small_box().is_some() && b.as_small_box().is_some(), "{a:?} {b:?}");
            let (slot_a, slot_b) = slots_of(place);
            boxes.place(slot_a, a, None);
            boxes.place(slot_b, b, None);
        }
        for machine in machines() {
            let backend = machine.backend();
            batch.clear();
            let mut indices = 0..;
            let places = pairs.iter().zip(&margins).enumerate().map(|(place, ((a, b), &margin))| {
                let radii = [a, b].map(|shape| narrow(shape.outline.radius()));
                let is_added = batch.push(slots_of(place), b.centre - a.centre, radii, margin);
                if is_added { indices.next() } else { None }
            });
            let places: Vec<_> = places.collect();
            batch.collide(machine, &boxes);
            for (i, ((place, (a, _)), expected)) in places.iter().zip(&pairs).zip(&expected).enumerate() {
                let mut manifolds = Vec::new();
                if !place.is_some_and(|place| batch.append_to(&mut manifolds, place, a.centre)) {
                    assert!(manifolds.is_empty());
                    left += 1;
                    continue;
                }
                let [found] = manifolds[..] else { panic!("expected one manifold, got {manifolds:?}") };
                // Manifolds without points may differ in their other fields.
                let same = found == *expected || found.points().is_empty() && expected.points().is_empty();
                assert!(same, "{backend:?}: expected {expected:?}, got {found:?}: {:?}", pairs[i]);
                points[found.points().len()] += 1;
            }
            pairs_seen += pairs.len();
        }
    }
    assert!(
        points.iter().all(|&count| count > pairs_seen / 20),
        "each point count should be frequent: {points:?} of {pairs_seen}"
    );
    assert!(
        left > 0 && left < pairs_seen / 10,
        "under a tenth of {pairs_seen} pairs should be left to the scalar path, not {left}"
    );
}

fn body_at_rest() -> Body {
    Body::new(&BodyDef::dynamic(), MassProperties::immovable())
}

#[test]
fn a_box_that_is_turned_is_posed_as_if_anew() {
    let mut rng = Rng::new(8);
    let mut boxes = SmallBoxes::default();
    boxes.resize(1);
    for _ in 0..200 {
        let polygon = random_box(&mut rng).0;
        let (shape, body) = (ShapeDef::new(polygon), body_at_rest());
        let mut posed = PosedShape::of_geometry(&shape.geometry, Vec2::ZERO, Rot::IDENTITY);
        boxes.place(0, &posed, posed.as_centred_box(&shape, &body));
        for _ in 0..20 {
            let rotation = Rot::from_angle(rng.angle());
            let centre = Vec2::new(rng.range(fx!(-900), fx!(900)), rng.range(fx!(-900), fx!(900)));
            let faces = boxes
                .split([usize::MAX].into_iter())
                .next()
                .and_then(|mut all| all.turn(0, &&rotation))
                .expect("a centred box");
            posed.turn_box(&faces, centre);
            let anew = PosedShape::of_geometry(&shape.geometry, centre, rotation);
            assert_eq!(format!("{posed:?}"), format!("{anew:?}"));
            let mut fresh = SmallBoxes::default();
            fresh.resize(1);
            fresh.place(0, &anew, None);
            assert_eq!(format!("{:?}", boxes.turned), format!("{:?}", fresh.turned));
        }
    }
    let shape = ShapeDef::new(Polygon::square(fx!(1)).expect("valid")).offset((fx!(1), fx!(0)));
    let posed = PosedShape::of_geometry(&shape.geometry, Vec2::ZERO, Rot::IDENTITY);
    boxes.place(0, &posed, posed.as_centred_box(&shape, &body_at_rest()));
    let turned =
        boxes.split([usize::MAX].into_iter()).next().and_then(|mut all| all.turn(0, &&Rot::IDENTITY));
    assert!(turned.is_none());
}
