//! Joints as the solver sees them: hinges in batches, and a list of all others, each with its ends and its share of the
//! rows and points.

use alloc::vec::Vec;

use super::super::body::SolverBody;
use super::super::body_list::BodyList;
use super::super::colour::{Colouring, Group, Node};
use super::super::contact::Pass;
use super::super::lanes::{Machine, Quad};
use super::super::limits::Faults;
use super::super::settings::Tuning;
use super::def::JointKind;
use super::hinge::{AngleParts, End, HingeSet, Poses, Task, node};
use super::parts::Parts;
use super::place::{Ends, Turned};
use super::point::JointPoint;
use super::row::JointRow;
use super::state::{Joint, JointImpulses};
use crate::body::{Arena, Body, BodyId, JointId};
use crate::math::{Angle, Fx, Rot, Unit, Vec2, fx_mul, mul, widen};

/// All joints, for one tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointSet {
    /// For each body of the tick, where it is in `bodies`, from 1; 0 if it has no joint.
    places: Vec<u32>,
    bodies: Vec<End>,
    /// For each body of the tick.
    turned: Vec<Turned>,
    quads: Vec<Quad>,
    /// For each joint in the order of the state, what it is solved as.
    entries: Vec<Entry>,
    hinges: HingeSet,
    /// In the order of the state, which is read once and from front to back: joints are large.
    drafts: JointList,
    /// In the order in which they are solved.
    list: JointList,
}

#[derive(Clone, Copy, Debug)]
enum Entry {
    /// The index of its input.
    Hinge(u32),
    /// Where it is in the drafts, and how many rows and points come before its own.
    Other { index: u32, starts: (u32, u32) },
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

#[derive(Clone, Copy, Debug)]
struct JointConstraint {
    slot: u32,
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

    fn push(&mut self, slot: u32, joint: &Joint, a: (u32, &Body), b: (u32, &Body), tuning: &Tuning) {
        let (rows, points) = (self.rows.len(), self.points.len());
        let mut parts = Parts {
            rows: &mut self.rows,
            points: &mut self.points,
            impulses: &joint.impulses,
            masses: (a.1.mass(), b.1.mass()),
            rate: tuning.rate,
        };
        match &joint.def.kind {
            JointKind::Prismatic(kind) => kind.prepare(&mut parts),
            JointKind::Distance(kind) => kind.prepare(&mut parts),
            JointKind::Weld(kind) => kind.prepare(&mut parts),
            JointKind::Wheel(kind) => kind.prepare(&mut parts),
            JointKind::Motor(kind) => kind.prepare(&mut parts),
            JointKind::Revolute(_) | JointKind::Filter => {}
        }
        let (rows, points) = (share(&self.rows, rows), share(&self.points, points));
        self.links.push(Link { body_a: a.0, body_b: b.0, rows, points });
        self.joints.push(JointConstraint { slot, ends: Ends::prepare(joint, a, b) });
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

/// The rows on the angle of a hinge; `None` of other joints.
fn hinge_parts(kind: &JointKind) -> Option<AngleParts> {
    match kind {
        JointKind::Revolute(kind) => Some(kind.angle_parts()),
        JointKind::Weld(kind) => kind.angle_parts(),
        _ => None,
    }
}

impl JointSet {
    fn clear(&mut self) {
        let JointSet { places, bodies, turned, quads, entries, hinges, drafts, list } = self;
        places.clear();
        bodies.clear();
        turned.clear();
        quads.clear();
        entries.clear();
        hinges.clear();
        drafts.clear();
        list.clear();
    }

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
        for &slot in slots {
            let joint = joints.at(slot);
            let (a, b) = joint.def.bodies();
            let rate = tuning.rate;
            let places = [a, b].map(|id| self.place_of(id.index(), bodies, list, rate));
            let [end_a, end_b] = places.map(|place| &self.bodies[place]);
            nodes.push(node(slot, end_a, end_b));
            let entry = match hinge_parts(&joint.def.kind) {
                Some(parts) => {
                    Entry::Hinge(self.hinges.push_input(slot, joint, (end_a, end_b), &parts, tuning))
                }
                None => {
                    let ends = [(end_a.index, bodies.at(a.index())), (end_b.index, bodies.at(b.index()))];
                    let starts = (count(&self.drafts.rows), count(&self.drafts.points));
                    self.drafts.push(slot, joint, ends[0], ends[1], tuning);
                    Entry::Other { index: count(&self.drafts.joints) - 1, starts }
                }
            };
            self.entries.push(entry);
        }
        self.turned.resize(list.len(), Turned::default());
        self.quads.resize(list.len(), Quad::default());
        self.sort(nodes, colouring);
    }

    /// Where a body is in `bodies`: a compact copy of what joints need of it.
    fn place_of(&mut self, slot: u32, bodies: &Arena<Body, BodyId>, list: &mut BodyList, rate: u32) -> usize {
        let index = list.own_index_of(slot);
        if self.places.len() < list.len() {
            self.places.resize(list.len(), 0);
        }
        let place = &mut self.places[index as usize];
        if *place == 0 {
            self.bodies.push(End::new(index, bodies.at(slot), rate));
            *place = count(&self.bodies);
        }
        *place as usize - 1
    }

    /// Sorts them into colours.
    fn sort(&mut self, nodes: &[Node], colouring: &mut Colouring) {
        let JointSet { entries, hinges, drafts, list, .. } = self;
        colouring.order(nodes, self.turned.len());
        for group in colouring.groups() {
            let (Group::Serial(indices) | Group::Coloured(indices)) = group;
            for &index in indices {
                if let Entry::Other { index, starts } = entries[index as usize] {
                    list.copy(drafts, index as usize, starts);
                }
            }
            hinges.push(&group, |index| match entries[index as usize] {
                Entry::Hinge(input) => Some(input),
                Entry::Other { .. } => None,
            });
        }
    }

    /// Arms, gains and gaps at the present pose.
    pub(crate) fn refresh(&mut self, bodies: &mut [SolverBody], machine: Machine, tuning: &Tuning) {
        for body in &self.bodies {
            let at = body.index as usize;
            let turns = body.turns_of(bodies[at].turn);
            let rotation = Rot::from_angle(body.angle + Angle::from_turns(Fx::from_bits(turns)));
            self.turned[at] = Turned { rotation, turns };
            self.quads[at] = Quad([rotation.cos.to_bits(), rotation.sin.to_bits(), 0, 0]);
        }
        let poses = Poses { quads: &self.quads, turned: &self.turned };
        self.hinges.refresh(SolverBody::cells(bodies), poses, machine, tuning);
        let JointList { joints, links, rows, points } = &mut self.list;
        let walk = Walk { links: links.iter(), rows, points };
        for (joint, (_, rows, points)) in joints.iter().zip(walk) {
            let place = joint.ends.place(bodies, &self.turned);
            for point in points {
                point.refresh(&place);
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
    pub(crate) fn aim(&mut self, bodies: &[SolverBody], tuning: &Tuning) {
        let (half, sixth) = (tuning.joint_stretch / 2, tuning.joint_stretch / 6);
        for body in &self.bodies {
            let turn = body.ahead_of(bodies[body.index as usize].spin).clamp(-TURN_MAX, TURN_MAX);
            let (across, squared): (Unit, Unit) = (mul(half, turn), mul(turn, turn));
            let along: Unit = mul(sixth, squared);
            let Quad(numbers) = &mut self.quads[body.index as usize];
            [numbers[2], numbers[3]] = [across.to_bits(), along.to_bits()];
        }
    }

    pub(crate) fn warm_start(
        &mut self,
        machine: Machine,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        for (link, rows, points) in self.list.walk() {
            let (a, b) = SolverBody::pair(bodies, link.body_a, link.body_b);
            rows.iter_mut().for_each(|row| row.warm_start(a, b, faults));
            points.iter_mut().for_each(|point| point.warm_start(a, b, faults));
        }
        self.hinges.perform(
            Task::WarmStart,
            (&self.quads, machine),
            tuning,
            SolverBody::cells(bodies),
            faults,
        );
    }

    pub(crate) fn solve(
        &mut self,
        pass: Pass,
        machine: Machine,
        tuning: &Tuning,
        bodies: &mut [SolverBody],
        faults: &mut Faults,
    ) {
        for (link, rows, points) in self.list.walk() {
            let (a, b) = SolverBody::pair(bodies, link.body_a, link.body_b);
            rows.iter_mut().for_each(|row| row.solve(pass, tuning, a, b, faults));
            points.iter_mut().for_each(|point| point.solve(pass, a, b, faults));
        }
        self.hinges.perform(
            Task::Solve(pass),
            (&self.quads, machine),
            tuning,
            SolverBody::cells(bodies),
            faults,
        );
    }

    /// Keeps impulses and turns for the next tick.
    pub(crate) fn store(&mut self, joints: &mut Arena<Joint, JointId>) {
        self.hinges.store(joints, &self.turned);
        let JointList { joints: constraints, links, rows, points } = &mut self.list;
        let walk = Walk { links: links.iter(), rows, points };
        for (constraint, (_, rows, points)) in constraints.iter().zip(walk) {
            let joint = joints.at_mut(constraint.slot);
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
        self.clear();
        self.list.clear();
        // Place 0 is the ground's.
        self.bodies.extend([End::new(1, a, tuning.rate), End::new(2, b, tuning.rate)]);
        self.turned.resize(self.turned.len().max(3), Turned::default());
        self.quads.resize(self.quads.len().max(3), Quad::default());
        match hinge_parts(&joint.def.kind) {
            Some(parts) => {
                self.hinges.push_input(0, joint, (&self.bodies[0], &self.bodies[1]), &parts, tuning);
                self.hinges.push(&Group::Serial(&[0]), Some);
            }
            None => self.list.push(0, joint, (1, a), (2, b), tuning),
        }
        let machine = Machine::default();
        let mut bodies = [SolverBody::default(); 3];
        self.refresh(&mut bodies, machine, tuning);
        self.warm_start(machine, tuning, &mut bodies, &mut 0);
        let place = Ends::prepare(joint, (1, a), (2, b)).place(&[SolverBody::default(); 3], &self.turned);
        // The lighter one shows more of it.
        let (body, moved, arm) = if a.is_dynamic() && (!b.is_dynamic() || a.mass() < b.mass()) {
            (a, bodies[1].reversed(), place.lever_a.arm)
        } else {
            (b, bodies[2], place.lever_b.arm)
        };
        let per_second = |speed| fx_mul(widen(speed), body.mass()).saturating_mul_int(tuning.rate.into());
        let force = Vec2::new(per_second(moved.velocity.x), per_second(moved.velocity.y));
        let torque = fx_mul(per_second(moved.spin), body.radius_of_gyration());
        (force, torque.saturating_sub(arm.widen().cross(force)))
    }
}

/// Beyond a quarter of a radian the third order is no better than the second, and feeds energy to chains that one
/// iteration does not solve.
const TURN_MAX: Unit = Unit::lit("0.25");

fn count<T>(parts: &[T]) -> u32 {
    u32::try_from(parts.len()).expect("parts are counted in 32 bits")
}

/// How many there are more than there were.
fn share<T>(parts: &[T], before: usize) -> u16 {
    u16::try_from(parts.len() - before).expect("a joint has a handful of parts")
}
