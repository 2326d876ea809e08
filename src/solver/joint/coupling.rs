//! Couplings of gears, racks and pulleys. A coupling computes one row ([`Row::coupled`]) and the position along it.

use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::row::{Lever, Row, angular_scale};
use super::def::{JointDef, JointKind};
use super::pose::{BodyRotation, Ends, JointPose};
use super::row::{Measure, NO_REACH};
use super::state::{Joint, radians};
use super::{Gear, Pulley, Rack};
use crate::body::Body;
use crate::fx;
use crate::math::{Angle, Fx, Length, Reciprocal, Rot, Unit, Vec2, fx_div, fx_mul, narrow, widen};

/// Smallest distance in metres between the anchors of a gear for which the gear has a pitch point. The angles of nearer
/// wheels are coupled, but their angular momentum is not conserved.
const DISTANCE_MIN: Fx = fx!(0.001);

/// Largest length of the direction of a row, so that its components fit [`Unit`].
const LONGEST: Fx = fx!(1.98);

#[derive(Clone, Copy, Debug)]
pub(super) enum Coupling {
    Gear {
        gear: Gear,
        frames: [Angle; 2],
        /// `|N| / k` of each wheel: the magnitude of its number of teeth over its radius of gyration.
        inverse: [Reciprocal; 2],
    },
    Rack {
        rack: Rack,
        /// The x axis of the joint's frame on B, in the frame of B.
        axis: Vec2<Unit>,
    },
    Pulley {
        pulley: Pulley,
        /// Vectors from the wheels to the centres of mass at the start of the tick.
        centres: [Vec2<Fx>; 2],
    },
}

impl Coupling {
    pub(super) fn prepare(joint: &Joint, bodies: [&Body; 2]) -> Option<Self> {
        let JointDef { frame_a, frame_b, kind, .. } = &*joint.def;
        Some(match *kind {
            JointKind::Gear(gear) => {
                let inverse = [(bodies[0], gear.teeth_a), (bodies[1], gear.teeth_b)].map(|(body, teeth)| {
                    let gyration = body.radius_of_gyration() / i64::from(teeth).abs();
                    if body.turns() { Reciprocal::of(gyration) } else { Reciprocal::ZERO }
                });
                Coupling::Gear { gear, frames: [frame_a.angle, frame_b.angle], inverse }
            }
            JointKind::Rack(rack) => {
                let Rot { cos, sin } = Rot::from_angle(frame_b.angle);
                Coupling::Rack { rack, axis: Vec2::new(cos, sin) }
            }
            JointKind::Pulley(pulley) => {
                let ends = [(frame_a, bodies[0], pulley.wheel_a), (frame_b, bodies[1], pulley.wheel_b)];
                let centres = ends.map(|(frame, body, wheel)| frame.centre_and_arm(body).0 - wheel);
                Coupling::Pulley { pulley, centres }
            }
            _ => return None,
        })
    }

    pub(super) fn measure(
        &self,
        ends: &Ends,
        pose: &JointPose,
        bodies: &[Cell<SolverBody>],
        body_rotations: &[BodyRotation],
    ) -> Measure {
        let rotations = ends.bodies().map(|body| &body_rotations[body]);
        match self {
            Coupling::Gear { gear, frames, inverse } => {
                let angles = [0, 1].map(|side: usize| rotations[side].angle + frames[side]);
                gear_measure(gear, angles, *inverse, pose)
            }
            Coupling::Rack { rack, axis } => {
                let along = rotations[1].rotation.apply(*axis);
                let rolled = fx_mul(rack.radius, radians(ends.turns(body_rotations)));
                rack_measure(rack.radius, along, rolled, pose)
            }
            Coupling::Pulley { pulley, centres } => {
                let levers = [pose.lever_a, pose.lever_b];
                let shifts = ends.bodies().map(|body| bodies[body].get().shift.widen());
                let ropes = [0, 1].map(|side: usize| centres[side] + shifts[side] + levers[side].arm.widen());
                pulley_measure(pulley.ratio, ropes, pose)
            }
        }
    }
}

impl JointDef {
    /// The definition, changed so that a gear, rack or pulley has no position error at the poses of its bodies.
    pub(crate) fn fitted(mut self, a: &Body, b: &Body) -> Self {
        match self.kind {
            JointKind::Gear(gear) => {
                let angles = [a.angle() + self.frame_a.angle, b.angle() + self.frame_b.angle];
                let apart = teeth_apart(&gear, angles, self.gap(a, b)).to_turns();
                self.frame_a.angle -= Angle::from_turns(apart / i64::from(gear.teeth_a));
            }
            JointKind::Rack(rack) => {
                let off = self.rack_position(&rack, a, b, Joint::new(self).turns(a.angle(), b.angle()));
                let along = Rot::from_angle(self.frame_b.angle).apply_wide(Vec2::new(Fx::ONE, Fx::ZERO));
                self.frame_b.anchor -= along.scale(off);
            }
            JointKind::Pulley(ref mut pulley) => {
                let anchors = [(&self.frame_a, a), (&self.frame_b, b)];
                let [on_a, on_b] = anchors.map(|(frame, body)| body.transform().apply(frame.anchor));
                pulley.length = pulley.taut_length(on_a, on_b);
            }
            _ => {}
        }
        self
    }

    fn gap(&self, a: &Body, b: &Body) -> Vec2<Fx> {
        b.transform().apply(self.frame_b.anchor) - a.transform().apply(self.frame_a.anchor)
    }

    /// The position of a rack in metres; 0 if the joint has no position error.
    fn rack_position(&self, rack: &Rack, a: &Body, b: &Body, turns: i64) -> Fx {
        let along = Rot::from_angle(b.angle() + self.frame_b.angle);
        let along = Vec2::new(along.cos, along.sin).widen();
        self.gap(a, b).dot(along).saturating_add(fx_mul(rack.radius, radians(turns)))
    }
}

impl Joint {
    /// The torque on B, given the negated torque on A (`opposite`). The torque on B equals `opposite`, except in a gear
    /// without a pitch point.
    pub(super) fn torque_on_b(&self, opposite: Fx, gap: Vec2<Fx>) -> Fx {
        match self.def.kind {
            JointKind::Gear(gear) if pitch_per_tooth(&gear, gap).is_none() => {
                opposite.saturating_mul_int((-gear.teeth_b).into()).saturating_div_int(gear.teeth_a.into())
            }
            _ => opposite,
        }
    }

    /// The position error of a gear, rack or pulley in metres, along the pitch line or the rope. The error of a gear
    /// without a pitch point is in radians, with 2 pi per tooth. `None` for other kinds.
    pub(crate) fn coupling_error(&self, a: &Body, b: &Body) -> Option<Fx> {
        let def = &*self.def;
        Some(match &def.kind {
            JointKind::Gear(gear) => {
                let angles = [a.angle() + def.frame_a.angle, b.angle() + def.frame_b.angle];
                let gap = def.gap(a, b);
                let apart = teeth_apart(gear, angles, gap).to_radians().saturating_abs();
                fx_mul(apart, pitch_per_tooth(gear, gap).unwrap_or(Fx::ONE))
            }
            JointKind::Rack(rack) => {
                def.rack_position(rack, a, b, self.turns(a.angle(), b.angle())).saturating_abs()
            }
            JointKind::Pulley(pulley) => {
                let on_a = a.transform().apply(def.frame_a.anchor);
                let on_b = b.transform().apply(def.frame_b.anchor);
                pulley.taut_length(on_a, on_b).saturating_sub(pulley.length).max(Fx::ZERO)
            }
            _ => return None,
        })
    }

    /// Whether [`Self::coupling_error`] is in radians.
    pub(crate) fn is_coupling_error_angle(&self, a: &Body, b: &Body) -> bool {
        let is_angle = |gear: &Gear| pitch_per_tooth(gear, self.def.gap(a, b)).is_none();
        matches!(&self.def.kind, JointKind::Gear(gear) if is_angle(gear))
    }
}

/// The error of the mesh, up to whole teeth, as an angle: a full turn of this angle is one tooth.
fn teeth_apart(gear: &Gear, [a, b]: [Angle; 2], gap: Vec2<Fx>) -> Angle {
    let line = Angle::of(gap).to_bits();
    let teeth =
        |teeth: i32, angle: Angle| angle.to_bits().wrapping_sub(line).wrapping_mul(teeth.cast_unsigned());
    Angle::from_bits(teeth(gear.teeth_a, a).wrapping_add(teeth(gear.teeth_b, b)))
}

/// Metres along the pitch line per unit of `NA a + NB b` (see `gear.rs`), if the wheels have a pitch point.
fn pitch_per_tooth(gear: &Gear, gap: Vec2<Fx>) -> Option<Fx> {
    let teeth = i64::from(gear.teeth_a + gear.teeth_b);
    let distance = gap.length();
    (teeth != 0 && distance >= DISTANCE_MIN).then(|| distance / teeth.abs())
}

/// The row of a gear and the position along the row: `s` metres per unit of `NA a + NB b` (see `gear.rs`). The
/// direction of the row has the length `(NA + NB) s / distance`. `s` is the smaller of the scales of the pitch line and
/// of a row on an angle, because with a larger `s` the row would hardly move the wheels.
fn gear_measure(gear: &Gear, angles: [Angle; 2], inverse: [Reciprocal; 2], pose: &JointPose) -> Measure {
    let Gear { teeth_a, teeth_b } = *gear;
    let turning = widen(angular_scale(inverse, pose.fractions));
    let pitch = pitch_per_tooth(gear, pose.gap);
    let scale: Length = narrow(match pitch {
        Some(pitch) if turning == 0 || pitch < turning => pitch,
        _ => turning,
    });
    let scale = widen(scale);
    let linear = pitch.map_or(Fx::ZERO, |pitch| {
        let share = fx_div(scale, pitch).unwrap_or(Fx::ZERO).min(Fx::ONE);
        if teeth_a + teeth_b < 0 { -share } else { share }
    });
    let tangent = pose.gap.normalized().unwrap_or(Vec2::X).perp();
    let n: Vec2<Unit> = tangent.widen().scale(linear).narrow();
    let across = |lever: Lever| lever.arm.widen().cross(n.widen());
    let of_teeth = |teeth: i32| scale.saturating_mul_int(teeth.into());
    let arms = [
        across(pose.lever_a).saturating_add(of_teeth(teeth_a)),
        across(pose.lever_b).saturating_sub(of_teeth(teeth_b)),
    ];
    let apart = teeth_apart(gear, angles, pose.gap).to_radians();
    measured([n, n], arms, pose, -fx_mul(scale, apart), Fx::ONE)
}

/// The row of a rack and the position along it. `rolled` is the radius times the angle of the rack relative to the
/// wheel.
fn rack_measure(radius: Fx, along: Vec2<Unit>, rolled: Fx, pose: &JointPose) -> Measure {
    let direction = along.widen();
    let across = |arm: Vec2<Fx>| arm.cross(direction);
    let (arm_a, arm_b) = (pose.lever_a.arm.widen(), pose.lever_b.arm.widen());
    // The bodies may be so far apart that the arm saturates.
    let arms = [across(arm_a), across(arm_b - pose.gap)].map(|arm| arm.saturating_add(radius));
    let position = pose.gap.dot(direction).saturating_add(rolled);
    measured([along, along], arms, pose, position, Fx::ONE)
}

/// The row of a pulley and the position along it. `ropes` lead from the wheels to the anchors. The direction on B is
/// `ratio` times as long as the direction on A. One factor scales both, so that their lengths are between a quarter of
/// [`LONGEST`] and [`LONGEST`].
fn pulley_measure(ratio: Fx, ropes: [Vec2<Fx>; 2], pose: &JointPose) -> Measure {
    let [(to_a, length_a), (to_b, length_b)] = ropes
        // If an anchor is at its wheel, its rope counts as hanging down.
        .map(|rope| rope.normalized_with_length().unwrap_or((-Vec2::Y, Fx::ZERO)));
    let over_ratio = |most: Fx| fx_div(most, ratio).unwrap_or(Fx::ONE);
    let scale =
        if ratio < Fx::ONE { LONGEST.min(over_ratio(Fx::ONE)) } else { over_ratio(LONGEST).min(Fx::ONE) };
    let n_a: Vec2<Unit> = -to_a.widen().scale(scale).narrow();
    let n_b: Vec2<Unit> = to_b.widen().scale(fx_mul(scale, ratio)).narrow();
    let arms = [pose.lever_a.arm.widen().cross(n_a.widen()), pose.lever_b.arm.widen().cross(n_b.widen())];
    let position = length_a.saturating_add(fx_mul(ratio, length_b));
    measured([n_a, n_b], arms, pose, position, scale)
}

fn measured(n: [Vec2<Unit>; 2], arms: [Fx; 2], pose: &JointPose, position: Fx, scale: Fx) -> Measure {
    let inverse = [pose.lever_a.inverse_gyration, pose.lever_b.inverse_gyration];
    let (row, denominator) = Row::coupled(n, arms.map(narrow), inverse, pose.fractions);
    Measure { row, denominator, position, scale, reach: NO_REACH }
}
