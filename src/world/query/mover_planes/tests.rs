use super::*;
use crate::math::{Rng, Rot};

fn plane(normal: Vec2<Unit>, separation: Fx) -> MoverPlane {
    MoverPlane {
        shape: ShapeId::from_parts(0, 0),
        body: BodyId::from_parts(0, 0),
        body_position: Vec2::ZERO,
        body_angle: Angle::ZERO,
        velocity: Vec2::ZERO,
        normal,
        separation,
        point: Vec2::ZERO,
        push_limit: Fx::MAX,
        push: Fx::ZERO,
    }
}

/// Oracle: tries the target, its projections on the planes, and the intersections of all pairs of planes. Returns the
/// nearest one that is at most `slack` behind any plane.
fn nearest(target: Vec2<Fx>, planes: &[MoverPlane], slack: Fx) -> Option<Vec2<Fx>> {
    let height = |plane: &MoverPlane, x: Vec2<Fx>| plane.separation + plane.normal.widen().dot(x);
    let mut candidates = alloc::vec![target];
    for p in planes {
        candidates.push(target - p.normal.widen().scale(height(p, target)));
        for q in planes {
            let (n, m) = (p.normal.widen(), q.normal.widen());
            let meet = crate::math::Mat2::new(n.x, n.y, m.x, m.y);
            if meet.determinant().abs() > fx!(0.00001) {
                let inverse = meet.inverse().expect("not parallel");
                candidates.push(inverse.apply(Vec2::new(-p.separation, -q.separation)));
            }
        }
    }
    let outside = |x: &Vec2<Fx>| planes.iter().all(|plane| height(plane, *x) >= -slack);
    candidates.into_iter().filter(outside).min_by_key(|x| x.distance(target))
}

/// `count` random normals, each `apart` to `apart + 25` degrees from the one before.
fn fan(rng: &mut Rng, count: u32, apart: i64) -> Vec<Vec2<Unit>> {
    let mut turn = rng.angle();
    let mut normals = Vec::new();
    for _ in 0..count {
        normals.push(Rot::from_angle(turn).apply(Vec2::X));
        turn += Angle::from_degrees(Fx::from_num(apart) + rng.range(fx!(0), fx!(25)));
    }
    normals
}

#[test]
fn the_solved_translation_is_the_nearest_one_outside() {
    let mut rng = Rng::new(1);
    let mut worst = Fx::ZERO;
    for _ in 0..5000 {
        let count = 1 + rng.below(5);
        let mut planes: Vec<_> =
            fan(&mut rng, count, 1).iter().map(|&n| plane(n, rng.range(fx!(-0.1), fx!(0.5)))).collect();
        let target = Vec2::new(rng.range(fx!(-1), fx!(1)), rng.range(fx!(-1), fx!(1)));
        let found = solve_planes(target, &mut planes);
        let least = planes.iter().map(|plane| plane.height(found)).min().expect("planes");
        assert!(least > fx!(-0.0000001), "{least} {target:?} {planes:?}");
        // The slack is small: a point behind one of two nearly parallel planes may be nearer to the target by many
        // times the slack.
        let expected = nearest(target, &planes, fx!(0.00000001)).expect("the planes leave room");
        worst = worst.max(found.distance(target) - expected.distance(target));
        assert!(worst < fx!(0.000001), "{found:?} {expected:?} {target:?} {planes:?}");
    }
}

#[test]
fn planes_that_push_in_turn_get_there_too() {
    let mut rng = Rng::new(2);
    for _ in 0..5000 {
        let mut planes: Vec<_> =
            fan(&mut rng, 2, 25).iter().map(|&n| plane(n, rng.range(fx!(-0.1), fx!(0.5)))).collect();
        let target = Vec2::new(rng.range(fx!(-1), fx!(1)), rng.range(fx!(-1), fx!(1)));
        let exact = solve_planes(target, &mut planes);
        planes.iter_mut().for_each(|plane| plane.push_limit = fx!(100));
        let found = solve_planes(target, &mut planes);
        assert!(found.distance(exact) < fx!(0.00002), "{found:?} {exact:?} {target:?} {planes:?}");
    }
}

#[test]
fn a_clipped_velocity_is_the_nearest_that_is_free() {
    let mut rng = Rng::new(3);
    for _ in 0..5000 {
        let mut normals = fan(&mut rng, 3, 5);
        let velocity = Vec2::new(rng.range(fx!(-9), fx!(9)), rng.range(fx!(-9), fx!(9)));
        let found = clipped(velocity, normals.iter().copied());
        let still: Vec<_> = normals.iter().map(|&n| plane(n, Fx::ZERO)).collect();
        let expected = nearest(velocity, &still, fx!(0.000001)).expect("zero is free");
        let further = found.distance(velocity) - expected.distance(velocity);
        assert!(further.abs() < fx!(0.00001), "{found:?} {expected:?} {still:?}");
        assert!(still.iter().all(|plane| plane.height(found) > fx!(-0.000001)), "{found:?} {still:?}");
        normals.reverse();
        assert_eq!(clipped(velocity, normals.iter().copied()), found);
    }
}

#[test]
fn soft_planes_give_way() {
    let mut planes = [plane(Vec2::Y, Fx::ZERO)];
    planes[0].push_limit = fx!(0.25);
    assert_eq!(solve_planes(Vec2::new(fx!(1), fx!(-1)), &mut planes), Vec2::new(fx!(1), fx!(-0.75)));
    assert_eq!(planes[0].push, fx!(0.25));
    let velocity = Vec2::new(fx!(1), fx!(-1));
    assert_eq!(clip_velocity(velocity, &planes), velocity);
}

#[test]
fn extreme_planes_do_not_panic() {
    let extremes = [Fx::MIN, Fx::MAX, Fx::ZERO, -Fx::DELTA];
    for a in extremes {
        for b in extremes {
            for limit in extremes {
                let mut planes = [plane(Vec2::X, a), plane(-Vec2::X, b), plane(Vec2::Y, a)];
                planes[1].push_limit = limit;
                let _ = solve_planes(Vec2::new(b, a), &mut planes);
                let _ = clip_velocity(Vec2::new(b, a), &planes);
            }
        }
    }
}
