//! All joints of a tick: hinges in batches, and a list of all other joints.

mod reaction;

use alloc::vec::Vec;

use super::super::body_list::{BodyList, GROUND};
use super::super::colour::Colouring;
use super::super::context::StepContext;
use super::super::settings::Tuning;
use super::block::{Blocks, Candidate};
use super::cache_key::{CacheKey, Definitions, Validity};
use super::def::{JointFrame, JointKind};
use super::hinge::{AngleParts, HingeBody, HingeSet, HingeShare, Turning, node};
use super::list::{BlockedPart, JointList};
use super::pose::BodyRotation;
use super::share::{BodyRotations, JointSplit, OwnJoints};
use super::state::Joint;
use crate::body::{Arena, Body, BodyId, JointId};
use crate::simd::{Machine, Quad};
use crate::threads::TeamLock;

#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct JointSet {
    cache_key: CacheKey,
    anchors: Vec<Anchor>,
    /// For each body of the tick, its index in `bodies` plus 1; 0 if the body has no joint.
    places: Vec<u32>,
    bodies: Vec<HingeBody>,
    /// Rotation coefficients of `bodies`, stored separately because every sub-step reads them.
    turning: Vec<Turning>,
    body_rotations: Vec<BodyRotation>,
    quads: Vec<Quad>,
    /// One entry for each joint, in the order of the state.
    entries: Vec<Entry>,
    hinges: HingeSet,
    parts: Vec<HingeShare>,
    /// The bodies of anchored hinges (see [`HingeShare`]).
    anchored: Vec<u32>,
    /// Slots of joints that are not hinges, in the order of solving, and whether they are in a block.
    others: Vec<(u32, bool)>,
    list: JointList,
    /// One candidate for each joint, in the order of the state.
    candidates: Vec<Candidate>,
    /// Whether each joint is in a block, in the order of the state. Empty if there are no blocks.
    is_blocked: Vec<bool>,
    blocks: Blocks,
    /// Rows and points in blocks, sorted by the slots of their joints.
    blocked_parts: Vec<(u32, BlockedPart)>,
}

pub(in crate::solver) struct JointSource<'a> {
    pub(in crate::solver) joints: &'a Arena<Joint, JointId>,
    pub(in crate::solver) slots: &'a [u32],
    pub(in crate::solver) bodies: &'a Arena<Body, BodyId>,
    pub(in crate::solver) tuning: &'a Tuning,
}

/// A body with joints that is not among the active bodies, or a far anchor ([`JointFrame::is_far`]).
#[derive(Clone, Copy, Debug)]
struct Anchor {
    slot: u32,
    far: Option<JointFrame>,
}

#[derive(Clone, Copy, Debug)]
enum Entry {
    /// Index of the input of a hinge.
    Hinge(u32),
    /// Slot of a joint that is not a hinge.
    Other(u32),
}

/// The rows on the angle of a hinge; `None` for other joints.
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
            cache_key: _,
            anchors,
            places,
            bodies,
            turning,
            body_rotations,
            quads,
            entries,
            hinges,
            parts,
            anchored,
            others,
            list,
            candidates,
            is_blocked,
            blocks,
            blocked_parts,
        } = self;
        anchors.clear();
        places.clear();
        bodies.clear();
        turning.clear();
        body_rotations.clear();
        quads.clear();
        entries.clear();
        hinges.clear();
        parts.iter_mut().for_each(HingeShare::clear);
        anchored.clear();
        others.clear();
        list.clear();
        candidates.clear();
        is_blocked.clear();
        blocks.clear();
        blocked_parts.clear();
    }

    /// Makes the constraints of all joints, for `parts` threads, and chooses the joints that are solved in blocks.
    pub(in crate::solver) fn prepare(
        &mut self,
        source: &JointSource<'_>,
        list: &mut BodyList,
        colouring: &mut Colouring,
        parts: usize,
        machine: Machine,
    ) {
        let &JointSource { joints, slots, bodies, tuning } = source;
        let (revisions, tuning) = ([joints.revision(), bodies.revision()], *tuning);
        let definitions = Definitions { revisions, tuning, parts, machine };
        let validity = self.cache_key.renew(definitions, joints.returns(), slots, list.slots());
        if validity == Validity::Nothing || !self.blocks.is_arranged() {
            self.parts.resize_with(parts, HingeShare::default);
            self.clear();
            self.parts.iter_mut().for_each(|part| part.fit(machine));
            self.arrange(source, list, colouring);
            self.sort(colouring);
        } else {
            if validity == Validity::Arrangement {
                self.hinges.reload(joints);
                self.parts.iter_mut().for_each(|part| part.reload(joints));
            }
            self.resume(bodies, list);
        }
        self.prepare_others(source, list);
    }

    fn resume(&mut self, bodies: &Arena<Body, BodyId>, list: &mut BodyList) {
        for &Anchor { slot, far } in &self.anchors {
            match far {
                Some(frame) => list.add_far_anchor(slot, frame.far_pose(bodies.at(slot))),
                None => list.own_index_of(slot, bodies.at(slot)),
            };
        }
        for body in &mut self.turning {
            body.angle = list.poses()[body.index as usize].angle;
        }
        self.hinges.resume(list.poses());
        self.parts.iter_mut().for_each(|part| part.resume(list.poses()));
    }

    fn arrange(&mut self, source: &JointSource<'_>, list: &mut BodyList, colouring: &mut Colouring) {
        let &JointSource { joints, slots, bodies, tuning } = source;
        colouring.begin();
        for &slot in slots {
            let joint = joints.at(slot);
            let (a, b) = joint.def.bodies();
            let parts = hinge_parts(&joint.def.kind);
            let indices = [(a, joint.def.frame_a), (b, joint.def.frame_b)].map(|(id, frame)| {
                let far = Some(frame).filter(|frame| parts.is_some() && frame.is_far());
                self.index_of_body(id.index(), far, bodies, list, tuning.rate)
            });
            indices.into_iter().for_each(|index| self.bodies[index].joints += 1);
            let ends = indices.map(|index| &self.bodies[index]);
            colouring.add(node(slot, ends[0], ends[1]));
            self.entries.push(match parts {
                Some(parts) => Entry::Hinge(self.hinges.push_input(slot, joint, ends, &parts, tuning)),
                None => Entry::Other(slot),
            });
            self.candidates.push(Candidate::of(joint, ends));
        }
        self.blocks.choose(&self.candidates, list.len());
        self.is_blocked.resize(if self.blocks.is_empty() { 0 } else { self.candidates.len() }, false);
        for &joint in self.blocks.chosen() {
            self.is_blocked[joint as usize] = true;
        }
        self.body_rotations.resize(list.len(), BodyRotation::default());
        self.quads.resize(list.len(), Quad::default());
    }

    /// Returns the index of a body in `self.bodies`, after adding it if necessary. A far anchor of a hinge is added as
    /// a body without mass.
    fn index_of_body(
        &mut self,
        slot: u32,
        far: Option<JointFrame>,
        bodies: &Arena<Body, BodyId>,
        list: &mut BodyList,
        rate: u32,
    ) -> usize {
        let body = bodies.at(slot);
        if far.is_some() || list.index_of(slot) == GROUND {
            self.anchors.push(Anchor { slot, far });
        }
        let (index, end) = match far {
            Some(frame) => {
                let pose = frame.far_pose(body);
                let index = list.add_far_anchor(slot, pose);
                (index, HingeBody::far_anchor(index, pose, &frame))
            }
            None => {
                let index = list.own_index_of(slot, body);
                (index, HingeBody::new(index, body, rate))
            }
        };
        if self.places.len() < list.len() {
            self.places.resize(list.len(), 0);
        }
        let place = &mut self.places[index as usize];
        if *place == 0 {
            self.turning.push(end.turning);
            self.bodies.push(end);
            *place = u32::try_from(self.bodies.len()).expect("fewer than 2^32 bodies");
        }
        *place as usize - 1
    }

    fn sort(&mut self, colouring: &mut Colouring) {
        let JointSet {
            entries,
            hinges,
            parts,
            anchored,
            others,
            places,
            bodies,
            body_rotations,
            is_blocked,
            ..
        } = self;
        let is_alone = |index: u32| bodies[places[index as usize] as usize - 1].joints == 1;
        colouring.sort(body_rotations.len(), parts.len());
        let input_of = |&index: &u32| match entries[index as usize] {
            Entry::Hinge(input) if !is_blocked.get(index as usize).is_some_and(|&blocked| blocked) => {
                Some(input)
            }
            Entry::Hinge(_) | Entry::Other(_) => None,
        };
        hinges.push_overflow(colouring.overflow(false).iter().filter_map(input_of));
        for (number, part) in parts.iter_mut().enumerate() {
            for group in colouring.colours(false, number) {
                hinges.push_colour(part, group.indices.iter().filter_map(input_of), is_alone);
            }
            part.add_anchored_bodies(anchored);
        }
        others.extend(colouring.order().iter().filter_map(|&index| match entries[index as usize] {
            Entry::Hinge(_) => None,
            Entry::Other(slot) => {
                Some((slot, is_blocked.get(index as usize).is_some_and(|&blocked| blocked)))
            }
        }));
    }

    fn prepare_others(&mut self, source: &JointSource<'_>, indices: &BodyList) {
        self.list.clear();
        for &(slot, is_blocked) in &self.others {
            let joint = source.joints.at(slot);
            let slots = <[BodyId; 2]>::from(joint.def.bodies()).map(BodyId::index);
            let bodies = slots.map(|slot| source.bodies.at(slot));
            self.list.push(
                slot,
                joint,
                slots.map(|slot| indices.index_of(slot)),
                bodies,
                source.tuning,
                is_blocked,
            );
        }
    }

    pub(crate) fn blocked_count(&self) -> usize {
        self.blocks.chosen().len()
    }

    /// Must be called after [`Self::prepare`].
    pub(in crate::solver) fn prepare_blocks(&mut self) {
        if !self.blocks.is_arranged() {
            self.arrange_blocks();
        }
        self.blocks.take_impulses(&mut self.hinges, &mut self.list);
    }

    fn arrange_blocks(&mut self) {
        let JointSet { blocks, hinges, list, blocked_parts, entries, candidates, .. } = self;
        list.blocked_parts(|slot, part| blocked_parts.push((slot, part)));
        blocked_parts.sort_by_key(|&(slot, _)| slot);
        let number = |&joint: &u32| match entries[joint as usize] {
            Entry::Hinge(input) => Ok(hinges.push_blocked(input)),
            Entry::Other(slot) => Err(slot),
        };
        let numbers: Vec<_> = blocks.chosen().iter().map(number).collect();
        blocks.arrange(hinges, blocked_parts, candidates, &numbers);
    }

    /// Whether the body with this index has a joint.
    pub(in crate::solver) fn holds(&self, index: u32) -> bool {
        self.places.get(index as usize).is_some_and(|&place| place != 0)
    }

    /// Computes arms, gains and gaps with one thread. Hinges are refreshed by their next operation.
    pub(in crate::solver) fn refresh(&mut self, context: &StepContext<'_>) {
        self.split().shares().for_each(|mut share| share.refresh(context));
    }

    pub(in crate::solver) fn split(&mut self) -> JointSplit<'_> {
        let JointSet { turning, body_rotations, quads, hinges, parts, list, blocks, .. } = self;
        JointSplit {
            is_empty: turning.is_empty(),
            own: OwnJoints { hinges, list, blocks, turning, places: &self.places, anchored: &self.anchored },
            parts,
            rotations: TeamLock::new(BodyRotations { body_rotations, quads }),
        }
    }

    pub(in crate::solver) fn store(&mut self, joints: &mut Arena<Joint, JointId>) {
        self.blocks.return_impulses(&mut self.hinges, &mut self.list);
        self.hinges.store(joints, &self.body_rotations);
        self.parts.iter_mut().for_each(|part| part.store(joints, &self.body_rotations));
        self.list.store(joints, &self.body_rotations);
    }
}
