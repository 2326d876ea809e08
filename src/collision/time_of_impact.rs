//! When two moving, turning shapes first come within a distance of each other.
//!
//! Conservative advancement (B. Mirtich, "Impulse-based Dynamic Simulation of Rigid Body Systems", 1996), along the
//! axis of the present separation: with the axis `n` fixed, a vertex at `r` from its body's centre moves by
//!
//! ```text
//! n . (p(h) - p(0)) >= (n . d + theta n . perp(r)) h - theta^2 |r| h^2 / 2
//! ```
//!
//! in the part `h` of the tick, for a displacement `d` and a turn by `theta`. The separation along any axis is a
//! lower bound of the true one, so as long as these parabolas stay above the target nothing has been passed. The
//! linear term makes a body that slides, rolls or spins beside a surface free to go on, where the usual bound on
//! the speed of its points would stop it again and again; root finding on separating axes (E. Catto, "Continuous
//! Collision", GDC 2013) takes as few steps but proves nothing between them.
//!
//! Separation is signed: past contact it is minus the depth, which changes no faster than the shapes move.

use super::core::{
    Core, Grid, along, cross, direction, edges, from_grid, height, scaled_along, to_fx, to_grid,
};
use super::distance::{Distance, distance};
use super::segment::clip;
use crate::fx;
use crate::math::{Angle, Fx, Rot, TAU, Unit, Vec2, fx_mul, round_shift_wide, saturate_wide};

/// How close in metres to the target a contact is found.
pub(crate) const TOLERANCE: Fx = fx!(0.00005);

/// Steps before the search gives up. Of random set-ups none takes more than 20.
const STEPS_MAX: u32 = 48;

/// The largest turn in radians of a shape that is not a disc about its body's centre, and the largest reach in metres
/// of one that turns. With these `theta^2 |r|` fits.
const TURN_MAX: Fx = fx!(1024);
const REACH_MAX: Fx = fx!(1024);

/// The movement of a body in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweep {
    /// Its centre of mass at the start, in the world.
    pub(crate) start: Vec2<Fx>,
    /// And at the end.
    pub(crate) end: Vec2<Fx>,
    /// How far it turns, in units of 2^-32 turn, counter-clockwise. May be more than a turn.
    pub(crate) turn: i64,
}

impl Sweep {
    /// A body that does not move.
    pub(crate) fn fixed(at: Vec2<Fx>) -> Self {
        Sweep { start: at, end: at, turn: 0 }
    }

    /// Its movement after a fraction of the tick: the displacement of the centre and the rotation since the start.
    pub(crate) fn at(&self, fraction: Fx) -> (Vec2<Fx>, Rot) {
        let turned = round_shift_wide(i128::from(self.turn) * i128::from(fraction.to_bits()), Fx::FRAC_NBITS);
        let rotation = Rot::from_angle(Angle::from_turns(Fx::from_bits(saturate_wide(turned))));
        ((self.end - self.start).scale(fraction), rotation)
    }
}

/// How two movements end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TimeOfImpact {
    /// They never come within the target.
    Separated,
    /// They come within the target after this fraction of the tick, and not before.
    Hit { fraction: Fx },
    /// They start so deep in each other that no side is the right one.
    Overlapped,
    /// The search gave up: they do not come within the target before this fraction of the tick.
    Failed { fraction: Fx },
}

/// When the surfaces of two shapes first come within `target` metres; a negative target is a depth. The shapes are
/// given as they are posed at the start, each about its own body's centre of mass.
///
/// Shapes that start within the target, in contact, may go on to slide, roll or separate, and to sink deeper, but not
/// through: their target is half-way from where they are to three quarters of the inner radius of B (of A if B has
/// none), so that the centre of B does not pass the surface of A. Deeper than that is [`TimeOfImpact::Overlapped`].
pub(crate) fn time_of_impact(a: (&Core, &Sweep), b: (&Core, &Sweep), target: Fx) -> TimeOfImpact {
    let between = b.1.start - a.1.start;
    let moved = (b.1.end - b.1.start).length().saturating_add((a.1.end - a.1.start).length());
    let reach =
        moved.saturating_add(to_fx(b.0.reach())).saturating_add(radii(a.0, b.0)).saturating_add(target);
    let Some(core_a) = near(a, between, reach.saturating_add(Fx::ONE)) else {
        return TimeOfImpact::Separated;
    };
    let gap = between.length().saturating_sub(to_fx(core_a.reach()));
    if gap > reach {
        return TimeOfImpact::Separated;
    }
    let (Some(a), Some(b)) = (Mover::new(core_a, a.1, -between), Mover::new(*b.0, b.1, Vec2::ZERO)) else {
        return TimeOfImpact::Failed { fraction: Fx::ZERO };
    };
    advance(&a, &b, target)
}

fn advance(a: &Mover, b: &Mover, mut target: Fx) -> TimeOfImpact {
    let mut fraction = Fx::ZERO;
    for step in 0..STEPS_MAX {
        let (posed_a, posed_b) = (a.at(fraction), b.at(fraction));
        let Distance { distance, normal, .. } = distance(&posed_a.core, &posed_b.core);
        let close = target.saturating_add(TOLERANCE);
        if distance <= close {
            if step > 0 {
                return TimeOfImpact::Hit { fraction };
            }
            match target_of_contact(&a.core, &b.core, distance) {
                Some(deeper) => target = target.min(deeper),
                None => return TimeOfImpact::Overlapped,
            }
            if distance <= target + TOLERANCE {
                return TimeOfImpact::Overlapped;
            }
        }
        let left = Fx::ONE - fraction;
        let offset = radii(&a.core, &b.core).saturating_add(target);
        let free = free_part(&a.tracks(&posed_a, normal, -1), &b.tracks(&posed_b, normal, 1), offset, left);
        if free == left {
            return TimeOfImpact::Separated;
        }
        if free == Fx::ZERO {
            break;
        }
        fraction += free;
    }
    TimeOfImpact::Failed { fraction }
}

fn radii(a: &Core, b: &Core) -> Fx {
    to_fx(a.radius + b.radius)
}

/// The target of shapes that start in contact: see [`time_of_impact`]. `None` if they are too deep already.
fn target_of_contact(a: &Core, b: &Core, separation: Fx) -> Option<Fx> {
    let inner = Some(inner_radius(b)).filter(|&inner| inner > 0).unwrap_or_else(|| inner_radius(a));
    let deepest = fx_mul(inner, fx!(-0.75));
    let start = separation.min(Fx::ZERO);
    (start > deepest).then(|| (start + deepest) / 2)
}

/// The radius of a disc inside the shape, in metres.
pub(crate) fn inner_radius(core: &Core) -> Fx {
    let points = core.points();
    let count = i64::try_from(points.len()).unwrap_or(1);
    let sum = points.iter().fold(Vec2::ZERO, |sum, &point| sum + point);
    let centre = Vec2::new(sum.x / count, sum.y / count);
    let inside = |(p, q): (Vec2<Grid>, Vec2<Grid>)| {
        let edge = q - p;
        Some(height(cross(edge, centre - p), scaled_along(direction(edge)?, edge)))
    };
    let inside = edges(points).filter_map(inside).min().unwrap_or(Grid::ZERO);
    to_fx(core.radius + inside.max(Grid::ZERO))
}

/// A long segment is cut to what B, at `b`, may meet: a normal has not enough bits for its far ends.
fn near((a, sweep): (&Core, &Sweep), b: Vec2<Fx>, window: Fx) -> Option<Core> {
    match *a.points() {
        [p, q] if sweep.turn == 0 => {
            let (p, q) = clip(from_grid(p) - b, from_grid(q) - b, window)?;
            Some(Core::from_points([p + b, q + b], to_fx(a.radius)))
        }
        _ => Some(*a),
    }
}

/// A shape that moves.
struct Mover {
    core: Core,
    sweep: Sweep,
    /// Its body's centre at the start, from that of B.
    centre: Vec2<Fx>,
    displacement: Vec2<Fx>,
    /// In radians; 0 for a disc that turns about its centre.
    theta: Fx,
    /// `theta^2 |r| / 2` of the furthest vertex.
    curvature: Fx,
}

/// The core at some time, about B's centre at the start.
struct Posed {
    core: Core,
    centre: Vec2<Grid>,
}

impl Mover {
    /// `None` if it turns too far.
    fn new(core: Core, sweep: &Sweep, centre: Vec2<Fx>) -> Option<Self> {
        let reach = to_fx(core.reach());
        let turn = i128::from(sweep.turn) * i128::from(TAU.to_bits());
        let theta = Fx::from_bits(saturate_wide(round_shift_wide(turn, Fx::FRAC_NBITS)));
        let theta = if reach == 0 { Fx::ZERO } else { theta };
        if theta != 0 && (theta.saturating_abs() > TURN_MAX || reach > REACH_MAX) {
            return None;
        }
        let curvature = fx_mul(fx_mul(theta, theta), reach) / 2 + Fx::DELTA * 4;
        let curvature = if theta == 0 { Fx::ZERO } else { curvature };
        Some(Mover { core, sweep: *sweep, centre, displacement: sweep.end - sweep.start, theta, curvature })
    }

    fn at(&self, fraction: Fx) -> Posed {
        let (displacement, rotation) = self.sweep.at(fraction);
        let centre = to_grid(self.centre + displacement);
        let core = if self.theta == 0 { self.core } else { self.core.rotated(rotation) };
        Posed { core: core.moved(centre), centre }
    }

    /// Where the vertices are along an axis and how fast they move, by `sign` -1 towards the other end of it. Vertices
    /// that move alike are told by the first of them.
    fn tracks(&self, posed: &Posed, normal: Vec2<Unit>, sign: i64) -> Tracks {
        let wide = normal.widen();
        let speed = wide.dot(self.displacement);
        let mut tracks = Tracks { count: 0, vertices: [(Fx::ZERO, Fx::ZERO); 8], curvature: self.curvature };
        for &point in posed.core.points() {
            let spin = fx_mul(self.theta, from_grid(point - posed.centre).cross(wide));
            let (x, v) = (to_fx(along(normal, point)), speed.saturating_add(spin));
            let track = (x.saturating_mul_int(sign), v.saturating_mul_int(sign));
            if self.theta == 0 && tracks.count == 1 {
                tracks.vertices[0] = tracks.vertices[0].min(track);
            } else {
                tracks.vertices[tracks.count] = track;
                tracks.count += 1;
            }
        }
        tracks
    }
}

/// The vertices of a shape along an axis: each at `x + v h`, less at most `curvature h^2`.
struct Tracks {
    count: usize,
    vertices: [(Fx, Fx); 8],
    curvature: Fx,
}

/// The part of the tick, at most `left`, in which no vertex of B comes nearer than `offset` to one of A. The axis
/// points to B; A is seen from its other end, so that distances are sums.
fn free_part(a: &Tracks, b: &Tracks, offset: Fx, left: Fx) -> Fx {
    let curvature = a.curvature.saturating_add(b.curvature);
    let mut free = left;
    for &(x_a, v_a) in &a.vertices[..a.count] {
        for &(x_b, v_b) in &b.vertices[..b.count] {
            let gap = x_a.saturating_add(x_b).saturating_sub(offset);
            free = positive_part(gap, v_a.saturating_add(v_b), curvature, free);
        }
    }
    free
}

/// The part of 0 to `end` in which `gap + speed h - curvature h^2` is not negative, rounded down.
fn positive_part(gap: Fx, speed: Fx, curvature: Fx, end: Fx) -> Fx {
    if gap <= 0 {
        return Fx::ZERO;
    }
    let at_end = gap.saturating_add(fx_mul(speed.saturating_sub(fx_mul(curvature, end)), end));
    // Concave, so it is positive between two ends where it is. A few units cover the rounding.
    if at_end > Fx::DELTA * 4 {
        return end;
    }
    let bits = |x: Fx| i128::from(x.to_bits());
    let discriminant = bits(speed) * bits(speed) + 4 * bits(curvature) * bits(gap);
    let denominator = discriminant.max(0).isqrt() + 1 - bits(speed);
    Fx::from_bits(saturate_wide((bits(gap) << (Fx::FRAC_NBITS + 1)) / denominator)).min(end)
}

#[cfg(test)]
mod tests {
    //! Against the separation at many moments of the tick.

    use super::super::core::samples;
    use super::*;
    use crate::math::Rng;
    use alloc::vec::Vec;

    const ORIGIN: Vec2<Fx> = Vec2::ZERO;

    fn at(x: Fx, y: Fx) -> Vec2<Fx> {
        Vec2::new(x, y)
    }

    fn turn(radians: Fx) -> i64 {
        crate::math::fx_div(radians, TAU).unwrap().to_bits()
    }

    fn rectangle(half_width: Fx, half_height: Fx) -> Core {
        let (x, y) = (half_width, half_height);
        Core::from_points([at(-x, -y), at(x, -y), at(x, y), at(-x, y)], Fx::ZERO)
    }

    fn separation(a: (&Core, &Sweep), b: (&Core, &Sweep), fraction: Fx) -> Fx {
        let pose = |(core, sweep): (&Core, &Sweep)| {
            let (moved, rotation) = sweep.at(fraction);
            core.rotated(rotation).moved(to_grid(sweep.start - a.1.start + moved))
        };
        distance(&pose(a), &pose(b)).distance
    }

    fn fractions(count: i64) -> impl Iterator<Item = Fx> {
        (0..=count).map(move |i| Fx::from_num(i) / count)
    }

    fn random_sweep(rng: &mut Rng) -> Sweep {
        let start = samples::vector(rng, fx!(4));
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
            let (a, b) = (samples::core(&mut rng), samples::core(&mut rng));
            let (sweep_a, sweep_b) = (random_sweep(&mut rng), random_sweep(&mut rng));
            let target = rng.range(fx!(-0.01), fx!(0.02));
            let (a, b) = ((&a, &sweep_a), (&b, &sweep_b));
            if separation(a, b, Fx::ZERO) <= target + TOLERANCE {
                started += 1;
                continue;
            }
            let free = match time_of_impact(a, b, target) {
                TimeOfImpact::Separated => Fx::ONE,
                TimeOfImpact::Hit { fraction } => {
                    hits += 1;
                    let found = separation(a, b, fraction);
                    assert!(found <= target + TOLERANCE + fx!(0.000001), "{found} {target} {a:?} {b:?}");
                    fraction
                }
                TimeOfImpact::Failed { fraction } => {
                    failed += 1;
                    fraction
                }
                TimeOfImpact::Overlapped => panic!("{a:?} {b:?}"),
            };
            separated += u32::from(free == Fx::ONE);
            for sample in fractions(200) {
                let found = separation(a, b, fx_mul(sample, free));
                assert!(
                    found > target - fx!(0.000001),
                    "{found} {target} at {sample} of {free}: {a:?} {b:?}"
                );
            }
        }
        assert!(hits > 2_000 && separated > 6_000 && failed == 0, "{hits} {separated} {failed} {started}");
    }

    /// From contact: what comes back as free never lets the centre of B pass.
    #[test]
    fn contact_is_left_or_deepened_but_not_passed() {
        let mut rng = Rng::new(2);
        let (mut hits, mut free_to_go, mut overlapped, mut failed) = (0, 0, 0, 0);
        for _ in 0..60_000 {
            let (a, b) = (samples::core(&mut rng), samples::core(&mut rng));
            let (sweep_a, sweep_b) = (random_sweep(&mut rng), random_sweep(&mut rng));
            let start = distance(&a, &b.moved(to_grid(sweep_b.start - sweep_a.start)));
            // Moved so that it starts about the contact.
            let shift = start.normal.widen().scale(rng.range(fx!(-0.02), fx!(0.005)) - start.distance);
            let sweep_b = Sweep { start: sweep_b.start + shift, end: sweep_b.end + shift, ..sweep_b };
            let (a, b) = ((&a, &sweep_a), (&b, &sweep_b));
            let first = separation(a, b, Fx::ZERO);
            if first > fx!(0.005) {
                continue;
            }
            let free = match time_of_impact(a, b, fx!(0.005)) {
                TimeOfImpact::Separated => Fx::ONE,
                TimeOfImpact::Hit { fraction } => {
                    hits += 1;
                    assert!(separation(a, b, fraction) < first, "{a:?} {b:?}");
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
            let limit = fx_mul(inner_radius(b.0).max(Fx::DELTA), fx!(-0.75)).min(Fx::ZERO);
            for sample in fractions(100) {
                let found = separation(a, b, fx_mul(sample, free));
                let has_inside = inner_radius(b.0) > Fx::ZERO;
                assert!(!has_inside || found > limit - fx!(0.000001), "{found} {limit} {a:?} {b:?}");
            }
        }
        assert!(
            hits > 5_000 && free_to_go > 5_000 && failed < 20,
            "{hits} {free_to_go} {overlapped} {failed}"
        );
    }

    #[test]
    fn a_bullet_and_a_thin_rod_do_not_pass_a_wall() {
        let wall = rectangle(fx!(0.005), fx!(5));
        let fixed = Sweep::fixed(at(fx!(3), fx!(0)));
        let bullet = rectangle(fx!(0.025), fx!(0.025));
        let flight = Sweep { start: ORIGIN, end: at(fx!(6.7), fx!(0.3)), turn: turn(fx!(2)) };
        let hit = time_of_impact((&wall, &fixed), (&bullet, &flight), fx!(0.005));
        assert!(
            matches!(hit, TimeOfImpact::Hit { fraction } if fraction > fx!(0.43) && fraction < fx!(0.45)),
            "{hit:?}"
        );
        let rod = rectangle(fx!(1), fx!(0.01));
        let pin = Core::disc(ORIGIN, fx!(0.01));
        let spin = Sweep { turn: turn(fx!(0.83)), ..Sweep::fixed(ORIGIN) };
        let pinned = Sweep::fixed(at(fx!(0.9), fx!(0.4)));
        let hit = time_of_impact((&pin, &pinned), (&rod, &spin), Fx::ZERO);
        // The pin is at 0.418 rad; the two surfaces are 0.02 / 0.985 rad wide.
        assert!(
            matches!(hit, TimeOfImpact::Hit { fraction } if (fraction - fx!(0.479)).abs() < fx!(0.001)),
            "{hit:?}"
        );
    }

    /// On a floor as long as the world, sloped so that its normal is rounded.
    #[test]
    fn what_rests_or_slides_or_rolls_on_a_floor_is_free() {
        let far = at(fx!(1000000000), fx!(333333333.25));
        let floor = Core::from_points([-far, far], Fx::ZERO);
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
                let slide = time_of_impact((&floor, &still), (&shape, &along(start, 0)), fx!(0.005));
                assert_eq!(slide, TimeOfImpact::Separated, "{sunk} {speed}");
                let wobble = along(start, turn(fx!(0.01)));
                let slide = time_of_impact((&floor, &still), (&shape, &wobble), fx!(0.005));
                assert_eq!(slide, TimeOfImpact::Separated, "{sunk} {speed}");
                let ball = Core::disc(ORIGIN, fx!(0.25));
                let roll =
                    time_of_impact((&floor, &still), (&ball, &along(start, turn(fx!(27)))), fx!(0.005));
                assert_eq!(roll, TimeOfImpact::Separated, "{sunk} {speed}");
                let down = along(start, 0);
                let down = Sweep { end: down.end - slope.perp().scale(fx!(3)), ..down };
                let into = time_of_impact((&floor, &still), (&shape, &down), fx!(0.005));
                let TimeOfImpact::Hit { fraction } = into else { panic!("{into:?} {sunk} {speed}") };
                let depth = separation((&floor, &still), (&shape, &down), fraction);
                assert!(depth > fx!(-0.1875) && depth < fx!(0.00505), "{depth} {sunk} {speed}");
            }
        }
    }

    #[test]
    fn the_far_end_of_the_world_and_wild_spins_end_safely() {
        let corners: Vec<_> =
            [Fx::MIN, fx!(0), Fx::MAX].into_iter().flat_map(|x| [at(x, Fx::MAX), at(x, Fx::MIN)]).collect();
        let rod = rectangle(fx!(1), fx!(0.01));
        let line = Core::from_points([corners[1], corners[4]], fx!(1));
        for &start in &corners {
            for &end in &corners {
                for turn in [i64::MIN, -1, 0, i64::MAX] {
                    let (still, wild) = (Sweep::fixed(start), Sweep { start, end, turn });
                    for target in [fx!(-1), fx!(1)] {
                        for core in [&rod, &line] {
                            time_of_impact((core, &wild), (&rod, &still), target);
                            time_of_impact((core, &still), (&rod, &wild), target);
                            time_of_impact((core, &wild), (&line, &wild), target);
                        }
                    }
                }
            }
        }
    }
}
