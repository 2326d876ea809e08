//! Joints as the solver sees them: a list of constraints, each with its ends and its share of the rows and points.

use alloc::vec::Vec;

use super::super::body::{SolverBody, turns};
use super::super::colour::{Colouring, Node};
use super::super::contact::Pass;
use super::super::limits::Faults;
use super::super::node;
use super::super::settings::Tuning;
use super::def::JointKind;
use super::parts::Parts;
use super::place::{Ends, Turned};
use super::point::JointPoint;
use super::row::JointRow;
use super::state::{Joint, JointImpulses};
use crate::body::{Arena, Body, BodyId, Handle, JointId};
use crate::math::{Angle, Fx, Reciprocal, Rot, Step, Unit, Vec2, fx_mul, widen};

/// All joints, for one tick, in the order in which they are solved.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointSet {
    ids: Vec<JointId>,
    /// For each body slot, whether the body is in `bodies`.
    has_joint: Vec<bool>,
    bodies: Vec<JointedBody>,
    /// For each body slot.
    turned: Vec<Turned>,
    joints: Vec<JointConstraint>,
    /// For each of them what every pass needs, so that the passes read little memory.
    links: Vec<Link>,
    /// Of all joints in turn: a plain hinge has none.
    rows: Vec<JointRow>,
    points: Vec<JointPoint>,
}

/// A body with joints, whose rotation is needed at every refresh.
#[derive(Clone, Copy, Debug)]
struct JointedBody {
    slot: u32,
    angle: Angle,
    inverse_gyration: Reciprocal,
}

#[derive(Clone, Debug)]
struct JointConstraint {
    joint: JointId,
    ends: Ends,
}

/// The bodies of a joint, and how many rows and points are its own.
#[derive(Clone, Copy, Debug)]
struct Link {
    body_a: u32,
    body_b: u32,
    rows: u16,
    points: u16,
}

/// Goes through the rows and points of one joint after the other.
struct Walk<'a> {
    rows: &'a mut [JointRow],
    points: &'a mut [JointPoint],
}

impl<'a> Walk<'a> {
    #[inline]
    fn next(&mut self, link: &Link) -> (&'a mut [JointRow], &'a mut [JointPoint]) {
        let (rows, rest) = core::mem::take(&mut self.rows).split_at_mut(link.rows.into());
        self.rows = rest;
        let (points, rest) = core::mem::take(&mut self.points).split_at_mut(link.points.into());
        self.points = rest;
        (rows, points)
    }
}

impl JointSet {
    /// Makes a constraint of every joint that is one, in the order in which they are solved.
    pub(crate) fn prepare(
        &mut self,
        joints: &Arena<Joint, JointId>,
        bodies: &Arena<Body, BodyId>,
        tuning: &Tuning,
        nodes: &mut Vec<Node>,
        colouring: &mut Colouring,
    ) {
        self.clear();
        if joints.len() == 0 {
            return;
        }
        nodes.clear();
        self.turned.resize(bodies.slot_count(), Turned::default());
        self.has_joint.clear();
        self.has_joint.resize(bodies.slot_count(), false);
        for (id, joint) in joints.iter().filter(|(_, joint)| joint.def.kind != JointKind::Filter) {
            self.ids.push(id);
            let (a, b) = joint.def.bodies();
            for slot in [a.index(), b.index()] {
                if !core::mem::replace(&mut self.has_joint[slot as usize], true) {
                    let body = bodies.at(slot);
                    let inverse_gyration = body.mass.inverse_gyration;
                    self.bodies.push(JointedBody { slot, angle: body.angle(), inverse_gyration });
                }
            }
            nodes.push(node(id.index().into(), bodies, a.index(), b.index()));
        }
        for &index in colouring.order(nodes, bodies.slot_count()) {
            let id = self.ids[index as usize];
            let joint = joints.at(id.index());
            let (a, b) = joint.def.bodies();
            let (a, b) = (a.index(), b.index());
            self.push(id, joint, (a, bodies.at(a)), (b, bodies.at(b)), tuning);
        }
    }

    fn clear(&mut self) {
        self.ids.clear();
        self.bodies.clear();
        self.turned.clear();
        self.joints.clear();
        self.links.clear();
        self.rows.clear();
        self.points.clear();
    }

    fn push(&mut self, id: JointId, joint: &Joint, a: (u32, &Body), b: (u32, &Body), tuning: &Tuning) {
        let (rows, points) = (self.rows.len(), self.points.len());
        let mut parts = Parts {
            rows: &mut self.rows,
            points: &mut self.points,
            impulses: &joint.impulses,
            masses: (a.1.mass(), b.1.mass()),
            rate: tuning.rate,
        };
        match &joint.def.kind {
            JointKind::Revolute(kind) => kind.prepare(&mut parts),
            JointKind::Prismatic(kind) => kind.prepare(&mut parts),
            JointKind::Distance(kind) => kind.prepare(&mut parts),
            JointKind::Weld(kind) => kind.prepare(&mut parts),
            JointKind::Wheel(kind) => kind.prepare(&mut parts),
            JointKind::Motor(kind) => kind.prepare(&mut parts),
            JointKind::Filter => {}
        }
        let (rows, points) = (count(self.rows.len() - rows), count(self.points.len() - points));
        self.links.push(Link { body_a: a.0, body_b: b.0, rows, points });
        self.joints.push(JointConstraint { joint: id, ends: Ends::prepare(joint, a, b) });
    }

    /// Arms, gains and gaps at the present pose.
    pub(crate) fn refresh(&mut self, bodies: &[SolverBody], tuning: &Tuning) {
        for body in &self.bodies {
            let turns = turns(bodies[body.slot as usize].turn, body.inverse_gyration);
            let rotation = Rot::from_angle(body.angle + Angle::from_turns(Fx::from_bits(turns)));
            self.turned[body.slot as usize] = Turned { rotation, turns, ahead: Unit::ZERO };
        }
        let mut walk = Walk { rows: &mut self.rows, points: &mut self.points };
        for (joint, link) in self.joints.iter().zip(&self.links) {
            let (rows, points) = walk.next(link);
            let place = joint.ends.place(bodies, &self.turned);
            for point in points {
                point.refresh(&place, tuning);
            }
            let mut last = None;
            for row in rows {
                let measure = match last {
                    Some((direction, measure)) if direction == row.direction => measure,
                    _ => joint.ends.measure(row.direction, &place, &self.turned),
                };
                row.refresh(&measure, tuning);
                last = Some((row.direction, measure));
            }
        }
    }

    /// Looks ahead along the turns of the coming sub-step, at the velocities that the last one has left.
    pub(crate) fn aim(&mut self, bodies: &[SolverBody], h: Reciprocal, tuning: &Tuning) {
        for body in &self.bodies {
            let step: Step = h.times(bodies[body.slot as usize].spin);
            self.turned[body.slot as usize].ahead = body.inverse_gyration.times(step);
        }
        let mut walk = Walk { rows: &mut self.rows, points: &mut self.points };
        for link in &self.links {
            let ahead = |slot: u32| self.turned[slot as usize].ahead;
            let turns = (ahead(link.body_a), ahead(link.body_b));
            let (_, points) = walk.next(link);
            for point in points {
                point.aim(turns, tuning);
            }
        }
    }

    pub(crate) fn warm_start(&mut self, bodies: &mut [SolverBody], faults: &mut Faults) {
        let mut walk = Walk { rows: &mut self.rows, points: &mut self.points };
        for link in &self.links {
            let (a, b) = SolverBody::pair(bodies, link.body_a, link.body_b);
            let (rows, points) = walk.next(link);
            rows.iter_mut().for_each(|row| row.warm_start(a, b, faults));
            points.iter_mut().for_each(|point| point.warm_start(a, b, faults));
        }
    }

    pub(crate) fn solve(
        &mut self,
        pass: Pass,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        let mut walk = Walk { rows: &mut self.rows, points: &mut self.points };
        for link in &self.links {
            let (a, b) = SolverBody::pair(bodies, link.body_a, link.body_b);
            let (rows, points) = walk.next(link);
            rows.iter_mut().for_each(|row| row.solve(pass, tuning, a, b, faults));
            points.iter_mut().for_each(|point| point.solve(pass, tuning, a, b, faults));
        }
    }

    /// Keeps impulses and turns for the next tick.
    pub(crate) fn store(&mut self, joints: &mut Arena<Joint, JointId>) {
        let mut walk = Walk { rows: &mut self.rows, points: &mut self.points };
        for (constraint, link) in self.joints.iter().zip(&self.links) {
            let joint = joints.at_mut(constraint.joint.index());
            joint.turns = constraint.ends.turns(&self.turned);
            joint.impulses = JointImpulses::default();
            let (rows, points) = walk.next(link);
            for row in rows {
                joint.impulses.0[usize::from(row.slot)] = row.lambda;
            }
            for point in points {
                joint.impulses.set_point(point.slot, point.lambda);
            }
        }
    }

    /// The force and the torque about B's anchor that a joint has last exerted on B: `P / h`, from the velocities that
    /// its impulses give to one of the bodies at rest.
    pub(super) fn reaction(joint: &Joint, a: &Body, b: &Body, tuning: &Tuning) -> (Vec2<Fx>, Fx) {
        let mut set = JointSet { turned: alloc::vec![Turned::default(); 2], ..JointSet::default() };
        for (slot, body) in [(0, a), (1, b)] {
            let inverse_gyration = body.mass.inverse_gyration;
            set.bodies.push(JointedBody { slot, angle: body.angle(), inverse_gyration });
        }
        set.push(JointId::from_parts(0, 0), joint, (0, a), (1, b), tuning);
        let mut bodies = [SolverBody::default(); 2];
        set.refresh(&bodies, tuning);
        set.warm_start(&mut bodies, &mut 0);
        let place = set.joints[0].ends.place(&bodies, &set.turned);
        // The lighter one shows more of it.
        let (body, moved, arm) = if a.is_dynamic() && (!b.is_dynamic() || a.mass() < b.mass()) {
            (a, bodies[0].reversed(), place.lever_a.arm)
        } else {
            (b, bodies[1], place.lever_b.arm)
        };
        let per_second = |speed| fx_mul(widen(speed), body.mass()).saturating_mul_int(tuning.rate.into());
        let force = Vec2::new(per_second(moved.velocity.x), per_second(moved.velocity.y));
        let torque = fx_mul(per_second(moved.spin), body.radius_of_gyration());
        (force, torque.saturating_sub(arm.widen().cross(force)))
    }
}

fn count(parts: usize) -> u16 {
    u16::try_from(parts).expect("a joint has a handful of parts")
}
