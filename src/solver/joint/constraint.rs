//! Joints as the solver sees them: a list of constraints, each with its ends and its share of the rows and points.

use alloc::vec::Vec;

use super::super::body::{SolverBody, turn_of};
use super::super::body_list::BodyList;
use super::super::colour::{Colouring, Node};
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

/// All joints, for one tick, in the order in which they are solved.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointSet {
    /// For each body of the tick, whether it is in `bodies`.
    has_joint: Vec<bool>,
    bodies: Vec<JointedBody>,
    /// For each body of the tick.
    turned: Vec<Turned>,
    joints: Vec<JointConstraint>,
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

#[derive(Clone, Debug)]
struct JointConstraint {
    joint: JointId,
    rows: Share,
    points: Share,
    ends: Ends,
}

/// A part of a list.
#[derive(Clone, Copy, Debug)]
struct Share {
    start: u32,
    end: u32,
}

impl Share {
    #[inline]
    fn of<T>(self, list: &mut [T]) -> &mut [T] {
        &mut list[self.start as usize..self.end as usize]
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
        self.clear();
        nodes.clear();
        self.has_joint.clear();
        for &slot in slots {
            let (a, b) = joints.at(slot).def.bodies();
            for body in [a.index(), b.index()] {
                let index = list.own_index_of(body);
                self.has_joint.resize(list.len(), false);
                if !core::mem::replace(&mut self.has_joint[index as usize], true) {
                    let body = bodies.at(body);
                    let inverse_gyration = body.mass.inverse_gyration;
                    self.bodies.push(JointedBody { index, angle: body.angle(), inverse_gyration });
                }
            }
            nodes.push(list.node(slot.into(), bodies, a.index(), b.index()));
        }
        self.turned.resize(list.len(), Turned::default());
        for &index in colouring.order(nodes, list.len()) {
            let id = joints.handle_at(slots[index as usize]);
            let joint = joints.at(id.index());
            let (a, b) = joint.def.bodies();
            let ends = [a, b].map(|body| (list.index_of(body.index()), bodies.at(body.index())));
            self.push(id, joint, ends[0], ends[1], tuning);
        }
    }

    fn clear(&mut self) {
        self.bodies.clear();
        self.turned.clear();
        self.joints.clear();
        self.rows.clear();
        self.points.clear();
    }

    fn push(&mut self, id: JointId, joint: &Joint, a: (u32, &Body), b: (u32, &Body), tuning: &Tuning) {
        let starts = (count(&self.rows), count(&self.points));
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
        let rows = Share { start: starts.0, end: count(&self.rows) };
        let points = Share { start: starts.1, end: count(&self.points) };
        self.joints.push(JointConstraint { joint: id, rows, points, ends: Ends::prepare(joint, a, b) });
    }

    /// Arms, gains and gaps at the present pose.
    pub(crate) fn refresh(&mut self, bodies: &[SolverBody], tuning: &Tuning) {
        for body in &self.bodies {
            let turns = turn_of(bodies[body.index as usize].turn, body.inverse_gyration);
            let rotation = Rot::from_angle(body.angle + Angle::from_turns(Fx::from_bits(turns)));
            self.turned[body.index as usize] = Turned { rotation, turns };
        }
        for joint in &self.joints {
            let place = joint.ends.place(bodies, &self.turned);
            for point in joint.points.of(&mut self.points) {
                point.refresh(&place, tuning);
            }
            let mut last = None;
            for row in joint.rows.of(&mut self.rows) {
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
        for joint in &self.joints {
            let turn = |body: u32, inverse_gyration: Reciprocal| -> Unit {
                let step: Step = h.times(bodies[body as usize].spin);
                inverse_gyration.times(step)
            };
            let ends = &joint.ends;
            let turns =
                (turn(ends.body_a, ends.inverse_gyration_a), turn(ends.body_b, ends.inverse_gyration_b));
            for point in joint.points.of(&mut self.points) {
                point.aim(turns, tuning);
            }
        }
    }

    pub(crate) fn warm_start(&mut self, bodies: &mut [SolverBody], faults: &mut Faults) {
        for joint in &self.joints {
            let (a, b) = SolverBody::pair(bodies, joint.ends.body_a, joint.ends.body_b);
            for row in joint.rows.of(&mut self.rows) {
                row.warm_start(a, b, faults);
            }
            for point in joint.points.of(&mut self.points) {
                point.warm_start(a, b, faults);
            }
        }
    }

    pub(crate) fn solve(
        &mut self,
        pass: Pass,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        for joint in &self.joints {
            let (a, b) = SolverBody::pair(bodies, joint.ends.body_a, joint.ends.body_b);
            for row in joint.rows.of(&mut self.rows) {
                row.solve(pass, tuning, a, b, faults);
            }
            for point in joint.points.of(&mut self.points) {
                point.solve(pass, tuning, a, b, faults);
            }
        }
    }

    /// Keeps impulses and turns for the next tick.
    pub(crate) fn store(&mut self, joints: &mut Arena<Joint, JointId>) {
        for constraint in &self.joints {
            let joint = joints.at_mut(constraint.joint.index());
            joint.turns = constraint.ends.turns(&self.turned);
            joint.impulses = JointImpulses::default();
            for row in constraint.rows.of(&mut self.rows) {
                joint.impulses.0[usize::from(row.slot)] = row.lambda;
            }
            for point in constraint.points.of(&mut self.points) {
                joint.impulses.set_point(point.slot, point.lambda);
            }
        }
    }

    /// The force and the torque about B's anchor that a joint has last exerted on B: `P / h`, from the velocities that
    /// its impulses give to one of the bodies at rest.
    pub(super) fn reaction(joint: &Joint, a: &Body, b: &Body, tuning: &Tuning) -> (Vec2<Fx>, Fx) {
        let mut set = JointSet { turned: alloc::vec![Turned::default(); 2], ..JointSet::default() };
        for (index, body) in [(0, a), (1, b)] {
            let inverse_gyration = body.mass.inverse_gyration;
            set.bodies.push(JointedBody { index, angle: body.angle(), inverse_gyration });
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

fn count<T>(list: &[T]) -> u32 {
    u32::try_from(list.len()).expect("parts of joints are counted in 32 bits")
}
