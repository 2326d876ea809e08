//! Time of impact: when two moving, rotating shapes first come within a distance of each other.
//!
//! Conservative advancement (B. Mirtich, "Impulse-based Dynamic Simulation of Rigid Body Systems", 1996) along the axis
//! `n` of the current separation. In the fraction `h` of the tick, a vertex at `r` from its body's centre moves along
//! `n` by
//!
//! ```text
//! n . (p(h) - p(0)) >= (n . d + theta n . perp(r)) h - theta^2 |r| h^2 / 2
//! ```
//!
//! where `d` is the displacement and `theta` the rotation of the body in the whole tick. The separation along any axis
//! is a lower bound of the true separation, so the shapes have no contact as long as these parabolas keep the
//! separation along `n` above the target. The linear term lets a body that slides, rolls or spins beside a surface
//! advance freely. Root finding on separating axes (E. Catto, "Continuous Collision", GDC 2013) takes as few steps, but
//! proves nothing about the time between two steps.
//!
//! Separation is signed: after contact it is the negative depth.

use super::distance::{Distance, distance};
use crate::collision::narrow_phase::segment::clip;
use crate::collision::shape::support::{Grid, SupportShape, along, from_grid, to_fx, to_grid};
use crate::fx;
use crate::math::{Angle, Fx, Rot, TAU, Unit, Vec2, fx_mul, round_shift_wide, saturate_wide};

/// Largest distance in metres from the target at which a contact counts as found.
pub(crate) const TOLERANCE: Fx = fx!(0.00005);

/// Largest number of steps before the search fails. Faces that stay near the target while they rotate by a large part
/// of a turn would need more steps.
const STEPS_MAX: u32 = 48;

/// Largest number of steps of queries, which have policies other than [`StartPolicy::Protect`]. Queries are rare, so
/// they may take more steps.
const QUERY_STEPS_MAX: u32 = 512;

/// Largest rotation in radians. With this limit and [`REACH_MAX`], `theta^2 |r|` fits its type.
const TURN_MAX: Fx = fx!(1024);
/// Largest distance in metres of a rotating shape's points from the centre of its body.
const REACH_MAX: Fx = fx!(1024);

#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweep {
    /// World position of the centre of mass at the start of the tick.
    pub(crate) start: Vec2<Fx>,
    /// World position of the centre of mass at the end of the tick.
    pub(crate) end: Vec2<Fx>,
    /// Rotation in units of 2^-32 turn, counter-clockwise. May exceed a turn.
    pub(crate) turn: i64,
}

impl Sweep {
    pub(crate) fn fixed(at: Vec2<Fx>) -> Self {
        Sweep { start: at, end: at, turn: 0 }
    }

    /// Displacement and rotation from the start to a fraction of the tick.
    pub(crate) fn at(&self, fraction: Fx) -> (Vec2<Fx>, Rot) {
        let rotation = Rot::from_angle(Angle::from_turns(Fx::from_bits(self.turned(fraction))));
        ((self.end - self.start).scale(fraction), rotation)
    }

    /// Rotation from the start to a fraction of the tick, in units of 2^-32 turn.
    pub(crate) fn turned(&self, fraction: Fx) -> i64 {
        let turned = i128::from(self.turn) * i128::from(fraction.to_bits());
        saturate_wide(round_shift_wide(turned, Fx::FRAC_NBITS))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TimeOfImpact {
    /// The shapes do not come within the target.
    Separated,
    /// The shapes first come within the target after this fraction of the tick.
    Hit { fraction: Fx },
    /// The shapes overlap at the start, too deeply for a reliable direction of separation. With
    /// [`StartPolicy::Report`], any overlap is too deep. With [`StartPolicy::Protect`], the limit is three quarters of
    /// the inner radius of B, or of A if B has none. If neither has an inner radius, the limit is 0.
    Overlapped,
    /// The search gave up, because it took too many steps, because it made no progress, or because a shape rotates too
    /// far. Before this fraction of the tick, the shapes do not come within the target.
    Failed { fraction: Fx },
}

/// Treatment of shapes that start within the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StartPolicy {
    /// Continuous collision: the shapes may overlap more deeply, but not pass through each other.
    Protect,
    /// The shapes may slide, roll and separate, but come closer by at most twice [`TOLERANCE`].
    Resist,
    /// The result is [`TimeOfImpact::Hit`] at fraction 0, or [`TimeOfImpact::Overlapped`].
    Report,
}

/// Time at which the surfaces of two shapes first come within `target` metres. A negative target is a depth. The
/// support shapes are posed as at the start, each relative to its own body's centre of mass.
///
/// With a target of 0 or more, a body that slides over the seam of two flush floors stops there. With a negative
/// target, such as minus a quarter of B's inner radius, the body passes the seam, and the solver resolves the overlap.
///
/// Shapes that start within the target get another target, which is half-way between the initial separation (0 if the
/// separation is positive) and a depth of three quarters of the inner radius of B, or of A if B has no inner radius.
/// The centre of B then does not pass the surface of A.
pub(crate) fn time_of_impact(
    a: &SupportShape,
    sweep_a: &Sweep,
    b: &SupportShape,
    sweep_b: &Sweep,
    target: Fx,
) -> TimeOfImpact {
    first_impact((a, sweep_a), (b, sweep_b), target, StartPolicy::Protect)
}

/// [`time_of_impact`] with a choice of policy.
pub(crate) fn first_impact(
    (a, sweep_a): (&SupportShape, &Sweep),
    (b, sweep_b): (&SupportShape, &Sweep),
    target: Fx,
    policy: StartPolicy,
) -> TimeOfImpact {
    match swept_pair(a, sweep_a, b, sweep_b, target) {
        Ok((a, b)) => advance(&a, &b, target, policy),
        Err(Unswept::Apart) => TimeOfImpact::Separated,
        Err(Unswept::TooFast) => TimeOfImpact::Failed { fraction: Fx::ZERO },
    }
}

/// Normal from A to B at a fraction of the tick. `None` if a shape rotates too far, or if the shapes stay more than 1 m
/// apart.
pub(crate) fn normal_at(
    (a, sweep_a): (&SupportShape, &Sweep),
    (b, sweep_b): (&SupportShape, &Sweep),
    fraction: Fx,
) -> Option<Vec2<Unit>> {
    let (a, b) = swept_pair(a, sweep_a, b, sweep_b, Fx::ONE).ok()?;
    Some(distance(&a.at(fraction).support, &b.at(fraction).support).normal)
}

const OVERLAP_STEPS_MAX: u32 = 256;

/// Fraction of the tick after which two shapes first overlap. At this time, the depth is at most 0.05 mm. `None` if the
/// shapes do not overlap, a shape rotates too far or the search takes too many steps. Two segments have a depth only if
/// they cross, so they count as overlapping within 0.05 mm of each other.
pub(crate) fn first_overlap(
    a: &SupportShape,
    sweep_a: &Sweep,
    b: &SupportShape,
    sweep_b: &Sweep,
) -> Option<Fx> {
    let is_line = |shape: &SupportShape| shape.radius == 0 && shape.points().len() < 3;
    let (target, overlap) =
        if is_line(a) && is_line(b) { (Fx::ZERO, TOLERANCE) } else { (-TOLERANCE, Fx::ZERO) };
    let (a, b) = swept_pair(a, sweep_a, b, sweep_b, target).ok()?;
    let mut fraction = Fx::ZERO;
    for _ in 0..OVERLAP_STEPS_MAX {
        let (posed_a, posed_b) = (a.at(fraction), b.at(fraction));
        let Distance { distance, normal, .. } = distance(&posed_a.support, &posed_b.support);
        if distance <= overlap {
            return Some(fraction);
        }
        let left = Fx::ONE - fraction;
        let offset = radii(&a.support, &b.support).saturating_add(target);
        let free = free_part(&a.tracks(&posed_a, normal, -1), &b.tracks(&posed_b, normal, 1), offset, left);
        if free == left || free == Fx::ZERO {
            return None;
        }
        fraction += free;
    }
    None
}

enum Unswept {
    /// The shapes do not come near each other.
    Apart,
    /// A shape rotates too far.
    TooFast,
}

/// The two shapes with their motion, relative to B's centre at the start.
fn swept_pair(
    a: &SupportShape,
    sweep_a: &Sweep,
    b: &SupportShape,
    sweep_b: &Sweep,
    target: Fx,
) -> Result<(SweptShape, SweptShape), Unswept> {
    let between = sweep_b.start - sweep_a.start;
    let moved = (sweep_b.end - sweep_b.start).length().saturating_add((sweep_a.end - sweep_a.start).length());
    let range = moved.saturating_add(radii(a, b)).saturating_add(target);
    // The part of a shape that may meet the other, and its reach.
    let part = |shape, sweep, to_other, reach: Fx| {
        let part = near(shape, sweep, to_other, range.saturating_add(reach).saturating_add(Fx::ONE))?;
        Some((part, to_fx(part.reach())))
    };
    let part_a = part(a, sweep_a, between, to_fx(b.reach()));
    let (support_a, reach_a) = part_a.ok_or(Unswept::Apart)?;
    let (support_b, reach_b) = part(b, sweep_b, -between, reach_a).ok_or(Unswept::Apart)?;
    if between.is_longer_than(range.saturating_add(reach_a).saturating_add(reach_b)) {
        return Err(Unswept::Apart);
    }
    let swept_a = SweptShape::new(support_a, reach_a, sweep_a, -between);
    swept_a.zip(SweptShape::new(support_b, reach_b, sweep_b, Vec2::ZERO)).ok_or(Unswept::TooFast)
}

fn advance(a: &SweptShape, b: &SweptShape, mut target: Fx, policy: StartPolicy) -> TimeOfImpact {
    let mut fraction = Fx::ZERO;
    let steps_max = if policy == StartPolicy::Protect { STEPS_MAX } else { QUERY_STEPS_MAX };
    for step in 0..steps_max {
        let (posed_a, posed_b) = (a.at(fraction), b.at(fraction));
        let Distance { distance, normal, .. } = distance(&posed_a.support, &posed_b.support);
        let close = target.saturating_add(TOLERANCE);
        if distance <= close {
            if step > 0 {
                return TimeOfImpact::Hit { fraction };
            }
            let deeper = match policy {
                StartPolicy::Protect => target_of_contact(&a.support, &b.support, distance),
                StartPolicy::Resist => Some(distance.saturating_sub(TOLERANCE * 2)),
                StartPolicy::Report if distance < Fx::ZERO => None,
                StartPolicy::Report => return TimeOfImpact::Hit { fraction },
            };
            match deeper {
                Some(deeper) => target = target.min(deeper),
                None => return TimeOfImpact::Overlapped,
            }
            if distance <= target + TOLERANCE {
                return TimeOfImpact::Overlapped;
            }
        }
        let left = Fx::ONE - fraction;
        let offset = radii(&a.support, &b.support).saturating_add(target);
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

fn radii(a: &SupportShape, b: &SupportShape) -> Fx {
    to_fx(a.radius + b.radius)
}

/// Target for shapes that start in contact. `None` if they overlap too deeply.
fn target_of_contact(a: &SupportShape, b: &SupportShape, separation: Fx) -> Option<Fx> {
    let inner = Some(b.inner_radius()).filter(|&inner| inner > 0).unwrap_or_else(|| a.inner_radius());
    let deepest = fx_mul(inner, fx!(-0.75));
    let start = separation.min(Fx::ZERO);
    (start > deepest).then(|| (start + deepest) / 2)
}

/// If a shape is a segment and does not rotate, clips it to the square with half side `window` about `other`, which is
/// the centre of the other shape. The other shape cannot meet the rest of the segment, and products of its far ends
/// with a unit normal would have too large errors. `None` if no part of the segment is left. Returns other shapes
/// unchanged.
fn near(shape: &SupportShape, sweep: &Sweep, other: Vec2<Fx>, window: Fx) -> Option<SupportShape> {
    match *shape.points() {
        [p, q] if sweep.turn == 0 => {
            let (p, q) = clip(from_grid(p), from_grid(q), other, window)?;
            Some(SupportShape::from_points([p + other, q + other], to_fx(shape.radius)))
        }
        _ => Some(*shape),
    }
}

struct SweptShape {
    support: SupportShape,
    sweep: Sweep,
    /// Centre of the shape's body at the start, relative to the centre of B's body.
    centre: Vec2<Fx>,
    displacement: Vec2<Fx>,
    /// Rotation in radians. 0 for a disc that rotates about its centre.
    theta: Fx,
    /// `theta^2 |r| / 2` of the furthest vertex.
    curvature: Fx,
}

/// A shape at a moment of the tick, relative to B's centre at the start.
struct Posed {
    support: SupportShape,
    centre: Vec2<Grid>,
}

impl SweptShape {
    /// `reach` is the distance of the furthest point from the body's centre. `None` if the shape rotates too far.
    fn new(support: SupportShape, reach: Fx, sweep: &Sweep, centre: Vec2<Fx>) -> Option<Self> {
        let turn = i128::from(sweep.turn) * i128::from(TAU.to_bits());
        let theta = Fx::from_bits(saturate_wide(round_shift_wide(turn, Fx::FRAC_NBITS)));
        let theta = if reach == 0 { Fx::ZERO } else { theta };
        if theta != 0 && (theta.saturating_abs() > TURN_MAX || reach > REACH_MAX) {
            return None;
        }
        let curvature = fx_mul(fx_mul(theta, theta), reach) / 2 + Fx::DELTA * 4;
        let curvature = if theta == 0 { Fx::ZERO } else { curvature };
        Some(SweptShape {
            support,
            sweep: *sweep,
            centre,
            displacement: sweep.end - sweep.start,
            theta,
            curvature,
        })
    }

    fn at(&self, fraction: Fx) -> Posed {
        let (displacement, rotation) = self.sweep.at(fraction);
        let centre = to_grid(self.centre + displacement);
        let support = if self.theta == 0 { self.support } else { self.support.rotated(rotation) };
        Posed { support: support.moved(centre), centre }
    }

    /// Positions of the vertices along the axis `normal` and their speeds per tick, both times `sign`. If the shape
    /// does not rotate, the vertex nearest to the other shape is enough.
    fn tracks(&self, posed: &Posed, normal: Vec2<Unit>, sign: i64) -> Tracks {
        let wide = normal.widen();
        let speed = wide.dot(self.displacement);
        let mut tracks = Tracks { count: 0, vertices: [(Fx::ZERO, Fx::ZERO); 8], curvature: self.curvature };
        for &point in posed.support.points() {
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

/// Vertices `(x, v)` along an axis. After the fraction `h` of the tick, a vertex is at `x + v h - curvature h^2` or
/// beyond.
struct Tracks {
    count: usize,
    vertices: [(Fx, Fx); 8],
    curvature: Fx,
}

/// Largest fraction, up to `left`, until which no vertex of B comes nearer than `offset` to a vertex of A. The tracks
/// of A are negated, so that distances are sums.
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

/// Largest fraction `t` up to `end` such that `gap + speed h - curvature h^2 >= 0` for `0 <= h <= t`, rounded down.
fn positive_part(gap: Fx, speed: Fx, curvature: Fx, end: Fx) -> Fx {
    if gap <= 0 {
        return Fx::ZERO;
    }
    let at_end = gap.saturating_add(fx_mul(speed.saturating_sub(fx_mul(curvature, end)), end));
    // The function is concave, so it is positive between any two points where it is positive. The four units cover
    // rounding errors.
    if at_end > Fx::DELTA * 4 {
        return end;
    }
    let bits = |x: Fx| i128::from(x.to_bits());
    let discriminant = bits(speed) * bits(speed) + 4 * bits(curvature) * bits(gap);
    let denominator = discriminant.max(0).isqrt() + 1 - bits(speed);
    Fx::from_bits(saturate_wide((bits(gap) << (Fx::FRAC_NBITS + 1)) / denominator)).min(end)
}

#[cfg(test)]
mod tests;
