//! Units of a block: a hinge with its row on the angle, a limit or motor of a hinge, or a part of another joint.

use core::ops::Range;

use super::super::super::body_list::GROUND;
use super::super::super::context::{Pass, StepContext};
use super::super::super::limits::{Faults, IMPULSE_MAX};
use super::super::super::row::MassFractions;
use super::super::hinge::{ANGLE_MAX, HingeSet, Poses};
use super::super::list::{BlockedPart, BlockedTask, JointList, ListPart};
use super::EXTRA_BITS;
use super::geometric_stiffness::Leverage;
use super::matrix::ONE;
use super::mobility::Mobility;
use super::scaling::{ScaledRow, Scaling, length, product};
use crate::math::{Speed, Unit as Fraction, Vec2, div_round, saturate_wide};

#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// The number of the hinge among the hinges in blocks.
    Hinge(usize),
    /// The number of the hinge, and the side (0 for the lower limit).
    HingeLimit(usize, usize),
    /// The number of the hinge.
    HingeDrive(usize),
    Part(ListPart),
}

/// Softness of a row in the bias pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowSoftness {
    pub(super) mass_scale: Fraction,
    pub(super) task: BlockedTask,
}

/// One or two rows that are scaled together, and the row on the angle of a hinge.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    source: Source,
    /// Index of the first row.
    pub(super) row: usize,
    /// Bodies from which velocities are read.
    source_bodies: [u32; 2],
    /// Bodies that impulses change, or the ground.
    bodies: [u32; 2],
    mobility: Mobility,
    softness: [Option<RowSoftness>; 3],
    scaling: Scaling,
    angle_scaling: Scaling,
    pub(super) leverage: Leverage,
    is_limited: bool,
    /// Denominator of the unit's row with geometric stiffness, divided by the denominator without it, with 30 fraction
    /// bits.
    stiffened: i64,
}

impl Unit {
    fn new(
        source: Source,
        bodies: [u32; 2],
        fractions: MassFractions,
        softness: [Option<RowSoftness>; 3],
    ) -> Self {
        let mobility = Mobility::new(fractions);
        let source_bodies = bodies;
        let bodies = [0, 1].map(|side: usize| if mobility.roots[side] == 0 { GROUND } else { bodies[side] });
        let (scaling, angle_scaling) = (Scaling::default(), Scaling::default());
        Unit {
            source,
            row: 0,
            source_bodies,
            bodies,
            mobility,
            softness,
            scaling,
            angle_scaling,
            leverage: Leverage::None,
            is_limited: false,
            stiffened: ONE,
        }
    }

    /// The units of a hinge, its limits and its motor. `number` is the number of the hinge among the hinges in blocks.
    pub(super) fn of_hinge(number: usize, hinges: &HingeSet) -> impl Iterator<Item = Self> {
        let hinge = hinges.blocked_hinge(number);
        let row = Some(RowSoftness { mass_scale: hinge.softness.mass_scale, task: BlockedTask::Limit });
        let limits = (0..if hinge.has_limits { 2 } else { 0 }).map(move |side| {
            Unit::new(Source::HingeLimit(number, side), hinge.changed, hinge.fractions, [row, None, None])
        });
        let rigid = Some(RowSoftness { mass_scale: Fraction::ONE, task: BlockedTask::Drive });
        let drive = hinge.has_drive.then(|| {
            Unit::new(Source::HingeDrive(number), hinge.changed, hinge.fractions, [rigid, None, None])
        });
        core::iter::once(Unit::hinge(number, hinges)).chain(limits).chain(drive)
    }

    fn hinge(number: usize, hinges: &HingeSet) -> Self {
        let hinge = hinges.blocked_hinge(number);
        let mass_scale = hinge.softness.mass_scale;
        let point = Some(RowSoftness { mass_scale, task: BlockedTask::Hold });
        let angle = hinge.angle.map(|angle| RowSoftness { mass_scale: angle.mass_scale, task: angle.task });
        Unit::new(Source::Hinge(number), hinge.changed, hinge.fractions, [point, point, angle])
    }

    pub(super) fn part(part: &BlockedPart) -> Self {
        let &BlockedPart { part, bodies, fractions, mass_scale, task, is_limited } = part;
        let row = Some(RowSoftness { mass_scale, task });
        let softness = match part {
            ListPart::Row(_) => [row, None, None],
            ListPart::Point(_) => [row, row, None],
        };
        Unit { is_limited, ..Unit::new(Source::Part(part), bodies, fractions, softness) }
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = RowSoftness> {
        self.softness.into_iter().flatten()
    }

    pub(super) fn range(&self) -> Range<usize> {
        self.row..self.row + self.rows().count()
    }

    /// The entries for the unit's first two rows in a list with a number for each row of the block.
    pub(super) fn impulses(&self, numbers: &[i64]) -> [i64; 2] {
        let mut own = [0; 2];
        self.range().zip(&mut own).for_each(|(row, number)| *number = numbers[row]);
        own
    }

    /// Whether an impulse of one unit changes a velocity that the other measures.
    pub(super) fn touches(&self, other: &Unit) -> bool {
        self.common_sides(other).iter().any(Option::is_some)
    }

    /// Pairs of sides, one of each unit, with a common body.
    pub(super) fn common_sides(&self, other: &Unit) -> [Option<(usize, usize)>; 2] {
        [0, 1].map(|side: usize| {
            let body = self.bodies[side];
            let at = other.bodies.iter().position(|&other| other == body && body != GROUND);
            at.map(|other| (side, other))
        })
    }

    pub(super) fn refresh(&mut self, hinges: &HingeSet, list: &JointList, rows: &mut [ScaledRow]) {
        let Unit { row, mobility, softness, scaling, angle_scaling, leverage, stiffened, .. } = self;
        let none = [Vec2::new(Fraction::ZERO, Fraction::ZERO); 2];
        match self.source {
            Source::Hinge(number) => {
                let hinge = hinges.blocked_hinge(number);
                *leverage = Leverage::AtPoint(hinge.e);
                (*scaling, [rows[*row], rows[*row + 1]]) = Scaling::of_point(hinge.e, mobility);
                if let Some(angle) = hinge.angle {
                    let e = angle.e;
                    let denominator = mobility.turning(e, e);
                    (*angle_scaling, rows[*row + 2]) = Scaling::of_row(none, e, denominator, mobility);
                }
            }
            Source::HingeLimit(number, side) => {
                let e = hinges.blocked_limit(number, side);
                (*scaling, rows[*row]) = Scaling::of_row(none, e, mobility.turning(e, e), mobility);
            }
            Source::HingeDrive(number) => {
                let e = hinges.blocked_drive_ratios(number);
                let denominator = mobility.turning(e, e);
                *stiffened = quotient(denominator, denominator + mobility.lost_turning(e));
                (*scaling, rows[*row]) = Scaling::of_row(none, e, denominator, mobility);
            }
            Source::Part(ListPart::Point(at)) => {
                let ratios = list.point(at).block.ratios().into();
                let mass_scale = softness[0].map_or(Fraction::ONE, |softness| softness.mass_scale);
                (*scaling, [rows[*row], rows[*row + 1]]) = Scaling::of_spring(mass_scale, ratios, mobility);
            }
            Source::Part(ListPart::Row(at)) => {
                let part = list.row(at);
                let (n, e) = part.row.jacobian();
                let denominator = part.denominator() - mobility.lost_turning(e);
                *stiffened = quotient(denominator, part.denominator());
                *leverage = Leverage::AlongAxis(part.reach);
                (*scaling, rows[*row]) = Scaling::of_row(n, e, denominator, mobility);
            }
        }
    }

    /// For each row, the change of its impulse (a speed) if an iteration solved this row alone, starting from an
    /// impulse of 0.
    pub(super) fn wanted(
        &self,
        pass: Pass,
        hinges: &HingeSet,
        list: &JointList,
        poses: Poses<'_>,
        context: &StepContext<'_>,
        faults: &mut Faults,
    ) -> [i64; 3] {
        let bodies = || self.source_bodies.map(|body| context.bodies[body as usize].get());
        match self.source {
            Source::Hinge(number) => {
                hinges.blocked_wanted(number, pass, poses, context, faults).map(i64::from)
            }
            Source::HingeLimit(number, side) => {
                [hinges.blocked_limit_wanted(number, side, pass, context, faults), 0, 0]
            }
            Source::HingeDrive(number) => [hinges.blocked_drive_wanted(number, context, faults), 0, 0],
            Source::Part(ListPart::Row(at)) if self.is_limit() => {
                let [a, b] = bodies();
                [list.row(at).wanted_of_limit(pass, &a, &b, faults), 0, 0]
            }
            Source::Part(ListPart::Row(at)) => {
                let [a, b] = bodies();
                [list.row(at).wanted(pass, &a, &b, faults).unwrap_or(0), 0, 0]
            }
            Source::Part(ListPart::Point(at)) => match list.point(at).softness() {
                Some(softness) if pass == Pass::Bias => {
                    let [a, b] = bodies();
                    let [x, y] = list.point(at).wanted(softness, &a, &b, faults);
                    [x, y, 0]
                }
                _ => [0; 3],
            },
        }
    }

    /// Whether the unit is a spring between two points, whose scale contains its softness.
    pub(super) fn is_point_spring(&self) -> bool {
        matches!(self.source, Source::Part(ListPart::Point(_)))
    }

    /// The numbers that the equations multiply by the impulse scales: `L` of a row, or `p` of a spring between two
    /// points.
    pub(super) fn yielding(&self, [x, y, angle]: [i64; 3]) -> [i64; 3] {
        match (self.source, self.softness[0]) {
            (Source::Part(ListPart::Point(_)), Some(softness)) => {
                let mass_scale = i64::from(softness.mass_scale.to_bits());
                let [x, y] = self.scaling.divide([x, y]).map(|part| product(part, mass_scale));
                [x, y, 0]
            }
            _ => [x, y, angle],
        }
    }

    /// `R^-1 d`.
    pub(super) fn scale(&self, [x, y, angle]: [i64; 3]) -> [i64; 3] {
        let [x, y] = self.scaling.scale([x, y]);
        [x, y, self.angle_scaling.scale([angle, 0])[0]]
    }

    /// `R d`.
    pub(super) fn restore(&self, [x, y, angle]: [i64; 3]) -> [i64; 3] {
        let [x, y] = self.scaling.restore([x, y]);
        [x, y, self.angle_scaling.restore([angle, 0])[0]]
    }

    /// Impulses without the denominators that scale them: `R^-T R^-1 L`.
    pub(super) fn exerted(&self, [x, y, angle]: [i64; 3]) -> [i64; 3] {
        let [x, y] = self.scaling.divide([x, y]);
        [x, y, self.angle_scaling.divide([angle, 0])[0]]
    }

    /// `R R^T p`, the inverse of [`Self::exerted`].
    pub(super) fn scaled_by_denominator(&self, [x, y, angle]: [i64; 3]) -> [i64; 3] {
        let [x, y] = self.scaling.multiply([x, y]);
        [x, y, self.angle_scaling.multiply([angle, 0])[0]]
    }

    /// Sets the factors of geometric stiffness. Returns whether they have changed.
    pub(super) fn set_spins(&mut self, spins: [i64; 2]) -> bool {
        self.mobility.set_spins(spins)
    }

    pub(super) fn is_stiffened(&self) -> bool {
        self.mobility.is_stiffened()
    }

    pub(super) fn spin_root(&self, side: usize) -> i64 {
        self.mobility.spin_roots[side]
    }

    /// Takes the impulses, as speeds, from the joint.
    pub(super) fn take_impulses(&self, hinges: &mut HingeSet, list: &mut JointList) -> [i32; 3] {
        match self.source {
            Source::Hinge(number) => hinges.take_impulses(number),
            Source::HingeLimit(number, side) => [hinges.take_limit_impulse(number, side), 0, 0],
            Source::HingeDrive(number) => [hinges.take_drive_impulse(number), 0, 0],
            Source::Part(ListPart::Row(at)) => {
                [core::mem::take(&mut list.row_mut(at).lambda).to_bits(), 0, 0]
            }
            Source::Part(ListPart::Point(at)) => {
                let Vec2 { x, y } = core::mem::take(&mut list.point_mut(at).lambda);
                [x.to_bits(), y.to_bits(), 0]
            }
        }
    }

    pub(super) fn return_impulses(&self, impulses: [i32; 3], hinges: &mut HingeSet, list: &mut JointList) {
        let [x, y, _] = impulses.map(Speed::from_bits);
        match self.source {
            Source::Hinge(number) => hinges.return_impulses(number, impulses),
            Source::HingeLimit(number, side) => hinges.return_limit_impulse(number, side, impulses[0]),
            Source::HingeDrive(number) => hinges.return_drive_impulse(number, impulses[0]),
            Source::Part(ListPart::Row(at)) => list.row_mut(at).lambda = x,
            Source::Part(ListPart::Point(at)) => list.point_mut(at).lambda = Vec2::new(x, y),
        }
    }

    /// The body on a side and the square root of its mass fraction. `None` if no impulse changes the body.
    pub(super) fn moved(&self, side: usize) -> Option<(u32, i64)> {
        (self.bodies[side] != GROUND).then_some((self.bodies[side], self.mobility.roots[side]))
    }

    pub(super) fn impulse_max(&self, part: usize) -> Speed {
        let is_angle = part == 2 || matches!(self.source, Source::HingeLimit(..) | Source::HingeDrive(_));
        if is_angle { ANGLE_MAX } else { IMPULSE_MAX }
    }

    /// Index of the row of a joint that is not a hinge.
    pub(super) fn list_row(&self) -> Option<usize> {
        if let Source::Part(ListPart::Row(at)) = self.source { Some(at) } else { None }
    }

    pub(super) fn is_spring(&self) -> bool {
        self.softness[0].is_some_and(|softness| softness.task == BlockedTask::Spring)
    }

    pub(super) fn is_limit(&self) -> bool {
        self.softness[0].is_some_and(|softness| softness.task == BlockedTask::Limit)
    }

    pub(super) fn is_drive(&self) -> bool {
        self.softness[0].is_some_and(|softness| softness.task == BlockedTask::Drive)
    }

    pub(super) fn is_bounded(&self) -> bool {
        self.is_limit() || self.is_drive() || self.is_limited
    }

    /// Bounds of an impulse, as speeds with 32 fraction bits.
    fn bounds(&self, hinges: &HingeSet, list: &JointList) -> [i64; 2] {
        let (lower, upper) = match self.source {
            Source::HingeDrive(number) => {
                let max = hinges.blocked_drive_max(number);
                (-max, max)
            }
            Source::Part(ListPart::Row(at)) if !self.is_limit() => list.row(at).bounds(),
            _ => return [0, i64::MAX],
        };
        [lower, upper].map(|bound| product(i64::from(bound.to_bits()) << EXTRA_BITS, self.stiffened))
    }

    /// Clamps the impulse of a row, or shortens the impulse of a point in its direction.
    pub(super) fn within_bounds(&self, impulse: [i64; 2], hinges: &HingeSet, list: &JointList) -> [i64; 2] {
        match self.source {
            Source::Part(ListPart::Point(at)) => {
                let max = i64::from(list.point(at).impulse_max().to_bits()) << EXTRA_BITS;
                let [x, y, _] = self.yielding([impulse[0], impulse[1], 0]);
                let (length, max) = (length([x, y]), i128::from(max));
                if length <= max {
                    return impulse;
                }
                impulse.map(|part| saturate_wide(div_round(i128::from(part) * max, length)))
            }
            _ => {
                let [lower, upper] = self.bounds(hinges, list);
                [impulse[0].clamp(lower, upper), 0]
            }
        }
    }

    /// The magnitude of an impulse divided by the largest impulse of the motor, rounded down.
    pub(super) fn excess(&self, impulse: i64, hinges: &HingeSet, list: &JointList) -> u64 {
        let [_, max] = self.bounds(hinges, list);
        impulse.unsigned_abs() / max.unsigned_abs().max(1)
    }

    pub(super) fn is_open(&self, hinges: &HingeSet, list: &JointList) -> bool {
        match self.source {
            Source::HingeLimit(number, side) => hinges.blocked_limit_is_open(number, side),
            Source::Part(ListPart::Row(at)) => list.row(at).is_open(),
            Source::Hinge(_) | Source::HingeDrive(_) | Source::Part(ListPart::Point(_)) => false,
        }
    }
}

/// A quotient of at most 1, with 30 fraction bits.
fn quotient(part: i64, whole: i64) -> i64 {
    if part >= whole { ONE } else { saturate_wide(div_round(i128::from(part) << 30, whole.into())).max(0) }
}
