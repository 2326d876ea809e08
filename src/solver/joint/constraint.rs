//! Joints as the solver sees them: hinges in batches, and a list of all others, each with its ends and its share of the
//! rows and points.

use alloc::vec::Vec;

use super::super::body::SolverBody;
use super::super::body_list::{BodyList, GROUND};
use super::super::colour::{Colouring, Group, Node};
use super::super::contact::Pass;
use super::super::limits::Faults;
use super::super::settings::Tuning;
use super::basis::{Basis, Definitions, Known};
use super::def::JointKind;
use super::hinge::{AngleParts, End, Expired, HingeSet, Poses, Task, Turning, node};
use super::list::JointList;
use super::place::{Ends, Turned};
use super::rotations::Rotations;
use super::state::{Joint, JointImpulses};
use crate::body::{Arena, Body, BodyId, JointId};
use crate::lanes::{Machine, Quad};
use crate::math::{Fx, Unit, Vec2, fx_mul, mul, widen};

/// All joints, for one tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointSet {
    basis: Basis,
    /// The slots of bodies with joints that nothing moves.
    anchors: Vec<u32>,
    /// For each body of the tick, where it is in `bodies`, from 1; 0 if it has no joint.
    places: Vec<u32>,
    /// What joints have to know of their bodies while they are arranged.
    bodies: Vec<End>,
    /// How each of `bodies` turns, from tick to tick: what is read in every sub-step lies by itself.
    turning: Vec<Turning>,
    /// For each body of the tick.
    turned: Vec<Turned>,
    quads: Vec<Quad>,
    /// For each joint in the order of the state, what it is solved as.
    entries: Vec<Entry>,
    hinges: HingeSet,
    /// The slots of the joints that are no hinges.
    others: Vec<u32>,
    /// Indices of these, in the order in which they are solved.
    order: Vec<u32>,
    /// In the order of the state, which is read once and from front to back: joints are large.
    drafts: JointList,
    /// In the order in which they are solved.
    list: JointList,
}

#[derive(Clone, Copy, Debug)]
enum Entry {
    /// The index of its input.
    Hinge(u32),
    /// The index of its slot.
    Other(u32),
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
        let JointSet {
            basis: _,
            anchors,
            places,
            bodies,
            turning,
            turned,
            quads,
            entries,
            hinges,
            others,
            order,
            drafts,
            list,
        } = self;
        anchors.clear();
        places.clear();
        bodies.clear();
        turning.clear();
        turned.clear();
        quads.clear();
        entries.clear();
        hinges.clear();
        others.clear();
        order.clear();
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
        let definitions =
            Definitions { joints: joints.revision(), bodies: bodies.revision(), tuning: *tuning };
        match self.basis.renew(definitions, joints.returns(), slots, list.slots()) {
            Known::All => self.resume(bodies, list),
            Known::Arrangement => {
                self.hinges.reload(joints);
                self.resume(bodies, list);
            }
            Known::Nothing => {
                self.clear();
                self.arrange((joints, slots), (bodies, list), tuning, nodes);
                self.sort(nodes, colouring);
            }
        }
        self.prepare_others(joints, (bodies, list), tuning);
    }

    /// Hinges as the last tick has left them, with the bodies where they are now.
    fn resume(&mut self, bodies: &Arena<Body, BodyId>, list: &mut BodyList) {
        for &slot in &self.anchors {
            list.own_index_of(slot, bodies.at(slot));
        }
        for body in &mut self.turning {
            body.angle = list.poses()[body.index as usize].angle;
        }
        self.hinges.resume(list.poses());
    }

    /// Lists the joints and their bodies.
    fn arrange(
        &mut self,
        (joints, slots): (&Arena<Joint, JointId>, &[u32]),
        (bodies, list): (&Arena<Body, BodyId>, &mut BodyList),
        tuning: &Tuning,
        nodes: &mut Vec<Node>,
    ) {
        nodes.clear();
        for &slot in slots {
            let joint = joints.at(slot);
            let (a, b) = joint.def.bodies();
            let places = [a, b].map(|id| self.place_of(id.index(), bodies, list, tuning.rate));
            places.into_iter().for_each(|place| self.bodies[place].joints += 1);
            let [end_a, end_b] = places.map(|place| &self.bodies[place]);
            nodes.push(node(slot, end_a, end_b));
            let entry = match hinge_parts(&joint.def.kind) {
                Some(parts) => {
                    Entry::Hinge(self.hinges.push_input(slot, joint, (end_a, end_b), &parts, tuning))
                }
                None => {
                    self.others.push(slot);
                    Entry::Other(count(&self.others) - 1)
                }
            };
            self.entries.push(entry);
        }
        self.turned.resize(list.len(), Turned::default());
        self.quads.resize(list.len(), Quad::default());
    }

    /// Where a body is in `bodies`: a compact copy of what joints need of it.
    fn place_of(&mut self, slot: u32, bodies: &Arena<Body, BodyId>, list: &mut BodyList, rate: u32) -> usize {
        if list.index_of(slot) == GROUND {
            self.anchors.push(slot);
        }
        let index = list.own_index_of(slot, bodies.at(slot));
        if self.places.len() < list.len() {
            self.places.resize(list.len(), 0);
        }
        let place = &mut self.places[index as usize];
        if *place == 0 {
            let end = End::new(index, bodies.at(slot), rate);
            self.turning.push(end.turning);
            self.bodies.push(end);
            *place = count(&self.bodies);
        }
        *place as usize - 1
    }

    /// Sorts them into colours.
    fn sort(&mut self, nodes: &[Node], colouring: &mut Colouring) {
        let JointSet { entries, hinges, order, places, bodies, .. } = self;
        let is_alone = |index: u32| bodies[places[index as usize] as usize - 1].joints == 1;
        colouring.order(nodes, self.turned.len());
        for group in colouring.groups() {
            let (Group::Serial(indices) | Group::Coloured(indices)) = group;
            order.extend(indices.iter().filter_map(|&index| match entries[index as usize] {
                Entry::Hinge(_) => None,
                Entry::Other(other) => Some(other),
            }));
            let input_of = |index: u32| match entries[index as usize] {
                Entry::Hinge(input) => Some(input),
                Entry::Other(_) => None,
            };
            hinges.push(&group, input_of, is_alone);
        }
    }

    /// Lists the joints that are no hinges, with their rows and points.
    fn prepare_others(
        &mut self,
        joints: &Arena<Joint, JointId>,
        (bodies, indices): (&Arena<Body, BodyId>, &BodyList),
        tuning: &Tuning,
    ) {
        let JointSet { others, order, drafts, list, .. } = self;
        drafts.clear();
        list.clear();
        for &slot in others.iter() {
            let joint = joints.at(slot);
            let end = |id: BodyId| (indices.index_of(id.index()), bodies.at(id.index()));
            let (a, b) = joint.def.bodies();
            drafts.push(slot, joint, end(a), end(b), tuning);
        }
        for &index in order.iter() {
            list.copy(drafts, index);
        }
    }

    /// Whether the body at an index of the tick has a joint.
    pub(crate) fn holds(&self, index: u32) -> bool {
        self.places.get(index as usize).is_some_and(|&place| place != 0)
    }

    /// Arms, gains and gaps at the present pose; those of hinges when the next task comes to them.
    pub(crate) fn refresh(&mut self, machine: Machine, bodies: &[SolverBody], tuning: &Tuning) {
        let mut any_turned = false;
        let JointSet { turning, turned, quads, .. } = self;
        machine.run(Rotations { turning, bodies, turned, quads, any: &mut any_turned });
        self.hinges.expire(if any_turned { Expired::Everything } else { Expired::Gaps });
        for (joint, (_, rows, points)) in self.list.walk_joints() {
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
        let JointSet { turning, quads, hinges, places, .. } = self;
        let mut aim = |body: &Turning, (half, sixth): (Unit, Unit)| {
            let turn = body.ahead_of(bodies[body.index as usize].spin).clamp(-TURN_MAX, TURN_MAX);
            let (across, squared): (Unit, Unit) = (mul(half, turn), mul(turn, turn));
            let along: Unit = mul(sixth, squared);
            let Quad(numbers) = &mut quads[body.index as usize];
            [numbers[2], numbers[3]] = [across.to_bits(), along.to_bits()];
        };
        let [joint, mount] = [tuning.joint, tuning.mount].map(|softness| {
            let stretch = softness.stretch();
            (stretch / 2, stretch / 6)
        });
        turning.iter().for_each(|body| aim(body, joint));
        for index in hinges.mounted() {
            aim(&turning[places[index as usize] as usize - 1], mount);
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
            (Poses { quads: &self.quads, turned: &self.turned }, machine),
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
            (Poses { quads: &self.quads, turned: &self.turned }, machine),
            tuning,
            SolverBody::cells(bodies),
            faults,
        );
    }

    /// Keeps impulses and turns for the next tick.
    pub(crate) fn store(&mut self, joints: &mut Arena<Joint, JointId>) {
        self.hinges.store(joints, &self.turned);
        for (constraint, (_, rows, points)) in self.list.walk_joints() {
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
        // Place 0 is the ground's.
        let ends = [End::new(1, a, tuning.rate), End::new(2, b, tuning.rate)];
        self.turning.extend(ends.map(|end| end.turning));
        self.turned.resize(self.turned.len().max(3), Turned::default());
        self.quads.resize(self.quads.len().max(3), Quad::default());
        match hinge_parts(&joint.def.kind) {
            Some(parts) => {
                self.hinges.push_input(0, joint, (&ends[0], &ends[1]), &parts, tuning);
                self.hinges.push(&Group::Serial(&[0]), Some, |_| false);
            }
            None => self.list.push(0, joint, (1, a), (2, b), tuning),
        }
        let machine = Machine::default();
        let mut bodies = [SolverBody::default(); 3];
        self.refresh(machine, &bodies, tuning);
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
