//! Joints as the solver sees them: a list of constraints, each with its ends and its share of the rows and points.

use alloc::vec::Vec;

use super::super::body::{SolverBody, turn_of};
use super::super::body_list::BodyList;
use super::super::colour::{Colouring, Node, Size};
use super::super::contact::Pass;
use super::super::limits::Faults;
use super::super::settings::Tuning;
use super::def::JointKind;
use super::parts::Parts;
use super::place::{Ends, Turned};
use super::point::JointPoint;
use super::row::JointRow;
use super::state::{Joint, JointImpulses};
use crate::body::{Arena, Body, BodyId, Handle, JointId};
use crate::math::{Angle, Fx, Reciprocal, Rot, Step, Unit, Vec2, fx_mul, widen};

/// All joints, for one tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointSet {
    /// For each body of the tick, whether it is in `bodies`.
    has_joint: Vec<bool>,
    bodies: Vec<JointedBody>,
    /// For each body of the tick.
    turned: Vec<Turned>,
    /// In the order of the state, which is read once and from front to back: joints are large.
    drafts: JointList,
    /// For each of the drafts, how many rows and points come before its own.
    starts: Vec<(u32, u32)>,
    /// In the order in which they are solved.
    list: JointList,
}

/// Joints one after the other.
#[derive(Clone, Debug, Default)]
struct JointList {
    joints: Vec<JointConstraint>,
    /// For each joint what every pass needs, so that the passes read little memory.
    links: Vec<Link>,
    /// Of all joints in turn: a plain hinge has none.
    rows: Vec<JointRow>,
    points: Vec<JointPoint>,
}

/// A body with joints, whose rotation is needed at every refresh.
#[derive(Clone, Copy, Debug)]
struct JointedBody {
    index: u32,
    angle: Angle,
    inverse_gyration: Reciprocal,
}

#[derive(Clone, Copy, Debug)]
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

/// Goes through joints with their rows and points.
struct Walk<'a> {
    links: core::slice::Iter<'a, Link>,
    rows: &'a mut [JointRow],
    points: &'a mut [JointPoint],
}

impl<'a> Iterator for Walk<'a> {
    type Item = (&'a Link, &'a mut [JointRow], &'a mut [JointPoint]);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let link = self.links.next()?;
        let (rows, rest) = core::mem::take(&mut self.rows).split_at_mut(link.rows.into());
        self.rows = rest;
        let (points, rest) = core::mem::take(&mut self.points).split_at_mut(link.points.into());
        self.points = rest;
        Some((link, rows, points))
    }
}

impl JointList {
    fn clear(&mut self) {
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
        let (rows, points) = (share(&self.rows, rows), share(&self.points, points));
        self.links.push(Link { body_a: a.0, body_b: b.0, rows, points });
        self.joints.push(JointConstraint { joint: id, ends: Ends::prepare(joint, a, b) });
    }

    /// Appends a joint of another list, whose rows and points start there.
    fn copy(&mut self, other: &Self, index: usize, (rows, points): (u32, u32)) {
        let link = other.links[index];
        let (rows, points) = (rows as usize, points as usize);
        self.joints.push(other.joints[index]);
        self.links.push(link);
        self.rows.extend_from_slice(&other.rows[rows..rows + usize::from(link.rows)]);
        self.points.extend_from_slice(&other.points[points..points + usize::from(link.points)]);
    }

    fn walk(&mut self) -> Walk<'_> {
        Walk { links: self.links.iter(), rows: &mut self.rows, points: &mut self.points }
    }
}

impl JointSet {
    /// Makes a constraint of every joint that is one, in the order in which they are solved.
    pub(crate) fn prepare(
        &mut self,
        (joints, slots): (&Arena<Joint, JointId>, &[u32]),
        (bodies, list): (&Arena<Body, BodyId>, &mut BodyList),
        tuning: &Tuning,
        nodes: &mut Vec<Node>,
        colouring: &mut Colouring,
    ) {
        self.bodies.clear();
        self.turned.clear();
        self.starts.clear();
        self.drafts.clear();
        self.list.clear();
        nodes.clear();
        self.has_joint.clear();
        for &slot in slots {
            let joint = joints.at(slot);
            let (a, b) = joint.def.bodies();
            let ends = [a, b].map(|id| (list.own_index_of(id.index()), bodies.at(id.index())));
            self.has_joint.resize(list.len(), false);
            for (index, body) in ends {
                if !core::mem::replace(&mut self.has_joint[index as usize], true) {
                    let inverse_gyration = body.mass.inverse_gyration;
                    self.bodies.push(JointedBody { index, angle: body.angle(), inverse_gyration });
                }
            }
            nodes.push(list.node(slot.into(), bodies, (a.index(), b.index()), Size::Large));
            self.starts.push((count(&self.drafts.rows), count(&self.drafts.points)));
            self.drafts.push(joints.handle_at(slot), joint, ends[0], ends[1], tuning);
        }
        self.turned.resize(list.len(), Turned::default());
        for &index in colouring.order(nodes, list.len()) {
            self.list.copy(&self.drafts, index as usize, self.starts[index as usize]);
        }
    }

    /// Arms, gains and gaps at the present pose.
    pub(crate) fn refresh(&mut self, bodies: &[SolverBody], tuning: &Tuning) {
        for body in &self.bodies {
            let turns = turn_of(bodies[body.index as usize].turn, body.inverse_gyration);
            let rotation = Rot::from_angle(body.angle + Angle::from_turns(Fx::from_bits(turns)));
            self.turned[body.index as usize] = Turned { rotation, turns, ahead: Unit::ZERO };
        }
        let JointList { joints, links, rows, points } = &mut self.list;
        let walk = Walk { links: links.iter(), rows, points };
        for (joint, (_, rows, points)) in joints.iter().zip(walk) {
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
            let step: Step = h.times(bodies[body.index as usize].spin);
            self.turned[body.index as usize].ahead = body.inverse_gyration.times(step);
        }
        for (link, _, points) in self.list.walk() {
            let ahead = |slot: u32| self.turned[slot as usize].ahead;
            let turns = (ahead(link.body_a), ahead(link.body_b));
            for point in points {
                point.aim(turns, tuning);
            }
        }
    }

    pub(crate) fn warm_start(&mut self, bodies: &mut [SolverBody], faults: &mut Faults) {
        for (link, rows, points) in self.list.walk() {
            let (a, b) = SolverBody::pair(bodies, link.body_a, link.body_b);
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
        for (link, rows, points) in self.list.walk() {
            let (a, b) = SolverBody::pair(bodies, link.body_a, link.body_b);
            rows.iter_mut().for_each(|row| row.solve(pass, tuning, a, b, faults));
            points.iter_mut().for_each(|point| point.solve(pass, tuning, a, b, faults));
        }
    }

    /// Keeps impulses and turns for the next tick.
    pub(crate) fn store(&mut self, joints: &mut Arena<Joint, JointId>) {
        let JointList { joints: constraints, links, rows, points } = &mut self.list;
        let walk = Walk { links: links.iter(), rows, points };
        for (constraint, (_, rows, points)) in constraints.iter().zip(walk) {
            let joint = joints.at_mut(constraint.joint.index());
            joint.turns = constraint.ends.turns(&self.turned);
            joint.impulses = JointImpulses::default();
            for row in rows {
                joint.impulses.0[usize::from(row.slot)] = row.lambda;
            }
            for point in points {
                joint.impulses.set_point(point.slot, point.lambda);
            }
        }
    }

    /// The force and the torque about B's anchor that a joint has last exerted on B: `P / h`, from the velocities that
    /// its impulses give to one of the bodies at rest. The set's own constraints are gone afterwards, so that it needs
    /// no other memory.
    pub(crate) fn reaction(
        &mut self,
        joint: &Joint,
        (a, b): (&Body, &Body),
        tuning: &Tuning,
    ) -> (Vec2<Fx>, Fx) {
        self.list.clear();
        self.bodies.clear();
        self.turned.resize(2, Turned::default());
        for (index, body) in [(0, a), (1, b)] {
            let inverse_gyration = body.mass.inverse_gyration;
            self.bodies.push(JointedBody { index, angle: body.angle(), inverse_gyration });
        }
        self.list.push(JointId::from_parts(0, 0), joint, (0, a), (1, b), tuning);
        let mut bodies = [SolverBody::default(); 2];
        self.refresh(&bodies, tuning);
        self.warm_start(&mut bodies, &mut 0);
        let place = self.list.joints[0].ends.place(&bodies, &self.turned);
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

fn count<T>(parts: &[T]) -> u32 {
    u32::try_from(parts.len()).expect("parts are counted in 32 bits")
}

/// How many there are more than there were.
fn share<T>(parts: &[T], before: usize) -> u16 {
    u16::try_from(parts.len() - before).expect("a joint has a handful of parts")
}
