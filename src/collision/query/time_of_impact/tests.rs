//! Compares times of impact with the separations at many moments of the tick.

use super::*;
use crate::collision::shape::support::samples;
use crate::math::Rng;
use alloc::vec::Vec;

const ORIGIN: Vec2<Fx> = Vec2::ZERO;

fn at(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

fn turn(radians: Fx) -> i64 {
    crate::math::fx_div(radians, TAU).unwrap().to_bits()
}

fn rectangle(half_width: Fx, half_height: Fx) -> SupportShape {
    let (x, y) = (half_width, half_height);
    SupportShape::from_points([at(-x, -y), at(x, -y), at(x, y), at(-x, y)], Fx::ZERO)
}

fn separation(a: &SupportShape, sweep_a: &Sweep, b: &SupportShape, sweep_b: &Sweep, fraction: Fx) -> Fx {
    let pose = |support: &SupportShape, sweep: &Sweep| {
        let (moved, rotation) = sweep.at(fraction);
        support.rotated(rotation).moved(to_grid(sweep.start - sweep_a.start + moved))
    };
    distance(&pose(a, sweep_a), &pose(b, sweep_b)).distance
}

fn fractions(count: i64) -> impl Iterator<Item = Fx> {
    (0..=count).map(move |i| Fx::from_num(i) / count)
}

fn random_sweep(rng: &mut Rng) -> Sweep {
    let start = samples::vector(rng, fx!(2.5));
    let size = if rng.chance(1, 3) { fx!(0.1) } else { fx!(8) };
    let end = start + samples::vector(rng, size);
    let spin = if rng.chance(1, 3) { fx!(8) } else { fx!(0.8) };
    Sweep { start, end, turn: turn(rng.range(-spin, spin)) }
}

#[test]
fn no_contact_is_passed_and_none_is_invented() {
    let mut rng = Rng::new(1);
    let (mut hits, mut separated, mut failed, mut started) = (0, 0, 0, 0);
    for _ in 0..15_000 {
        let (a, b) = (samples::support(&mut rng), samples::support(&mut rng));
        let (sweep_a, sweep_b) = (random_sweep(&mut rng), random_sweep(&mut rng));
        let target = rng.range(fx!(-0.01), fx!(0.02));
        if separation(&a, &sweep_a, &b, &sweep_b, Fx::ZERO) <= target + TOLERANCE {
            started += 1;
            continue;
        }
        let free = match time_of_impact(&a, &sweep_a, &b, &sweep_b, target) {
            TimeOfImpact::Separated => Fx::ONE,
            TimeOfImpact::Hit { fraction } => {
                hits += 1;
                let found = separation(&a, &sweep_a, &b, &sweep_b, fraction);
                assert!(
                    found <= target + TOLERANCE + fx!(0.000001),
                    "{found} {target} {a:?} {sweep_a:?} {b:?} {sweep_b:?}"
                );
                fraction
            }
            TimeOfImpact::Failed { fraction } => {
                failed += 1;
                fraction
            }
            TimeOfImpact::Overlapped => panic!("{a:?} {sweep_a:?} {b:?} {sweep_b:?}"),
        };
        separated += u32::from(free == Fx::ONE);
        for sample in fractions(200) {
            let found = separation(&a, &sweep_a, &b, &sweep_b, fx_mul(sample, free));
            assert!(
                found > target - fx!(0.000001),
                "{found} {target} at {sample} of {free}: {a:?} {sweep_a:?} {b:?} {sweep_b:?}"
            );
        }
    }
    assert!(
        hits > 1_500 && separated > 6_000 && failed < 5,
        "hits {hits}, separated {separated}, failed {failed}, in contact at the start {started}"
    );
}

/// B overlaps A by at most three quarters of B's inner radius.
#[test]
fn contact_is_left_or_deepened_but_not_passed() {
    let mut rng = Rng::new(2);
    let (mut hits, mut free_to_go, mut overlapped, mut failed) = (0, 0, 0, 0);
    for _ in 0..20_000 {
        let (a, b) = (samples::support(&mut rng), samples::support(&mut rng));
        let (sweep_a, sweep_b) = (random_sweep(&mut rng), random_sweep(&mut rng));
        let start = distance(&a, &b.moved(to_grid(sweep_b.start - sweep_a.start)));
        let shift = start.normal.widen().scale(rng.range(fx!(-0.02), fx!(0.005)) - start.distance);
        let sweep_b = Sweep { start: sweep_b.start + shift, end: sweep_b.end + shift, ..sweep_b };
        let first = separation(&a, &sweep_a, &b, &sweep_b, Fx::ZERO);
        if first > fx!(0.005) {
            continue;
        }
        let free = match time_of_impact(&a, &sweep_a, &b, &sweep_b, fx!(0.005)) {
            TimeOfImpact::Separated => Fx::ONE,
            TimeOfImpact::Hit { fraction } => {
                hits += 1;
                assert!(
                    separation(&a, &sweep_a, &b, &sweep_b, fraction) < first,
                    "{a:?} {sweep_a:?} {b:?} {sweep_b:?}"
                );
                fraction
            }
            TimeOfImpact::Failed { fraction } => {
                failed += 1;
                fraction
            }
            TimeOfImpact::Overlapped => {
                overlapped += 1;
                continue;
            }
        };
        free_to_go += u32::from(free == Fx::ONE);
        let limit = fx_mul(b.inner_radius().max(Fx::DELTA), fx!(-0.75)).min(Fx::ZERO);
        for sample in fractions(100) {
            let found = separation(&a, &sweep_a, &b, &sweep_b, fx_mul(sample, free));
            let has_inside = b.inner_radius() > Fx::ZERO;
            assert!(
                !has_inside || found > limit - fx!(0.000001),
                "{found} {limit} {a:?} {sweep_a:?} {b:?} {sweep_b:?}"
            );
        }
    }
    assert!(
        hits > 5_000 && free_to_go > 5_000 && failed < 25,
        "hits {hits}, free {free_to_go}, overlapped {overlapped}, failed {failed}"
    );
}

#[test]
fn a_bullet_and_a_thin_rod_do_not_pass_a_wall() {
    let wall = rectangle(fx!(0.005), fx!(5));
    let fixed = Sweep::fixed(at(fx!(3), fx!(0)));
    let bullet = rectangle(fx!(0.025), fx!(0.025));
    let flight = Sweep { start: ORIGIN, end: at(fx!(6.7), fx!(0.3)), turn: turn(fx!(2)) };
    let hit = time_of_impact(&wall, &fixed, &bullet, &flight, fx!(0.005));
    assert!(
        matches!(hit, TimeOfImpact::Hit { fraction } if fraction > fx!(0.43) && fraction < fx!(0.45)),
        "{hit:?}"
    );
    let rod = rectangle(fx!(1), fx!(0.01));
    let pin = SupportShape::disc(ORIGIN, fx!(0.01));
    let spin = Sweep { turn: turn(fx!(0.83)), ..Sweep::fixed(ORIGIN) };
    let pinned = Sweep::fixed(at(fx!(0.9), fx!(0.4)));
    let hit = time_of_impact(&pin, &pinned, &rod, &spin, Fx::ZERO);
    // Seen from the centre of the rod, the pin is at 0.418 rad and 0.985 m away. The pin's radius and half the
    // thickness of the rod are 0.02 m together, so they take up 0.02 / 0.985 rad.
    assert!(
        matches!(hit, TimeOfImpact::Hit { fraction } if (fraction - fx!(0.479)).abs() < fx!(0.001)),
        "{hit:?}"
    );
}

/// The floor is nearly as long as the world, and sloped so that its normal is rounded.
#[test]
fn what_rests_or_slides_or_rolls_on_a_floor_is_free() {
    let far = at(fx!(1000000000), fx!(333333333.25));
    let floor = SupportShape::from_points([-far, far], Fx::ZERO);
    let slope = far.normalized().unwrap().widen();
    let rotation = Rot::from_angle(Angle::of(slope));
    let still = Sweep::fixed(ORIGIN);
    for sunk in [fx!(-0.004), fx!(0), fx!(0.004), fx!(0.01)] {
        for speed in [fx!(0), fx!(0.1), fx!(6.7)] {
            let start = at(fx!(1234), fx!(0.25) - sunk);
            let along = |start: Vec2<Fx>, turn: i64| {
                let moved = rotation.apply_wide(start);
                Sweep { start: moved, end: moved + slope.scale(speed), turn }
            };
            let shape = rectangle(fx!(0.5), fx!(0.25)).rotated(rotation);
            let slide = time_of_impact(&floor, &still, &shape, &along(start, 0), fx!(0.005));
            assert_eq!(slide, TimeOfImpact::Separated, "{sunk} {speed}");
            let wobble = along(start, turn(fx!(0.01)));
            let slide = time_of_impact(&floor, &still, &shape, &wobble, fx!(0.005));
            assert_eq!(slide, TimeOfImpact::Separated, "{sunk} {speed}");
            let ball = SupportShape::disc(ORIGIN, fx!(0.25));
            let roll = time_of_impact(&floor, &still, &ball, &along(start, turn(fx!(27))), fx!(0.005));
            assert_eq!(roll, TimeOfImpact::Separated, "{sunk} {speed}");
            let next =
                SupportShape::from_points([at(fx!(1236), Fx::ZERO), at(fx!(1240), Fx::ZERO)], Fx::ZERO);
            let next = next.rotated(rotation);
            let seam = time_of_impact(&next, &still, &shape, &along(start, 0), fx!(-0.05));
            assert_eq!(seam, TimeOfImpact::Separated, "{sunk} {speed}");
            let down = along(start, 0);
            let down = Sweep { end: down.end - slope.perp().scale(fx!(3)), ..down };
            let into = time_of_impact(&floor, &still, &shape, &down, fx!(0.005));
            let TimeOfImpact::Hit { fraction } = into else { panic!("{into:?} {sunk} {speed}") };
            let depth = separation(&floor, &still, &shape, &down, fraction);
            assert!(depth > fx!(-0.1875) && depth < fx!(0.00505), "{depth} {sunk} {speed}");
        }
    }
}

#[test]
fn the_far_end_of_the_world_and_wild_spins_end_safely() {
    let corners: Vec<_> =
        [Fx::MIN, fx!(0), Fx::MAX].into_iter().flat_map(|x| [at(x, Fx::MAX), at(x, Fx::MIN)]).collect();
    let rod = rectangle(fx!(1), fx!(0.01));
    let line = SupportShape::from_points([corners[1], corners[4]], fx!(1));
    for &start in &corners {
        for &end in &corners {
            for turn in [i64::MIN, -1, 0, i64::MAX] {
                let (still, wild) = (Sweep::fixed(start), Sweep { start, end, turn });
                for target in [fx!(-1), fx!(1)] {
                    for support in [&rod, &line] {
                        time_of_impact(support, &wild, &rod, &still, target);
                        time_of_impact(support, &still, &rod, &wild, target);
                        time_of_impact(support, &wild, &line, &wild, target);
                    }
                }
            }
        }
    }
}
