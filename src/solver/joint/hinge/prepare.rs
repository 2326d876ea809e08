//! Copies hinges into batches in the order in which they are solved, and writes their impulses back to the joints.

use alloc::vec::Vec;

use super::super::super::batches::{Batches, Coloured};
use super::super::super::body_list::GROUND;
use super::super::super::settings::Tuning;
use super::super::parts::slot;
use super::super::pose::BodyRotation;
use super::super::state::{Joint, JointImpulses, nearest_turns};
use super::angle::AngleRows;
use super::batch::{Batch, Records, Shape};
use super::{AngleInput, AngleParts, HingeBody, HingeSet, HingeShare, Hinges, Input};
use crate::body::{Arena, JointId, Pose};
use crate::math::{Fx, Length, Speed, Unit, Vec2};
use crate::simd::{Machine, with_data};

impl HingeSet {
    pub(in super::super) fn clear(&mut self) {
        let HingeSet { inputs, angles, memo: _, tuned: _, overflow, blocked, blocked_extras, is_stale } =
            self;
        *is_stale = true;
        inputs.clear();
        angles.clear();
        overflow.clear();
        blocked.clear();
        blocked_extras.clear();
    }

    /// Adds the input of a hinge, and returns the index of the input.
    pub(in super::super) fn push_input(
        &mut self,
        slot: u32,
        joint: &Joint,
        ends: [&HingeBody; 2],
        parts: &AngleParts,
        tuning: &Tuning,
    ) -> u32 {
        let HingeSet { inputs, angles, memo, .. } = self;
        let angle = if parts.is_empty() { None } else { Some(count(angles)) };
        let input = Input::new(slot, joint, ends, angle, tuning);
        if angle.is_some() {
            let rows = AngleInput::new(parts, ends, &joint.impulses, memo, tuning.rate, &input.softness);
            angles.push(rows);
        }
        inputs.push(input);
        count(inputs) - 1
    }

    /// Adds batches for the hinges that fit no colour. `indices` are indices of inputs.
    pub(in super::super) fn push_overflow(&mut self, indices: impl Iterator<Item = u32> + Clone) {
        let HingeSet { inputs, angles, overflow, .. } = self;
        for has_angle in [false, true] {
            let indices =
                indices.clone().filter(|&index| inputs[index as usize].angle.is_some() == has_angle);
            overflow.push(inputs, angles, indices);
        }
    }

    /// Adds batches for the hinges of one colour to the share of one thread. `indices` are indices of inputs.
    /// `is_alone` returns whether a body has no joint except the hinge.
    pub(in super::super) fn push_colour(
        &mut self,
        part: &mut HingeShare,
        indices: impl Iterator<Item = u32> + Clone,
        is_alone: impl Fn(u32) -> bool,
    ) {
        let HingeSet { inputs, angles, tuned, .. } = self;
        let HingeShare { ordinary: batches, anchored, .. } = part;
        for has_angle in [false, true] {
            let indices =
                indices.clone().filter(|&index| inputs[index as usize].angle.is_some() == has_angle);
            let is_anchored = |&index: &u32| inputs[index as usize].anchored_body().is_some_and(&is_alone);
            let is_tuned = |&index: &u32| inputs[index as usize].is_tuned;
            let ordinary = indices.clone().filter(|index| !is_anchored(index) && !is_tuned(index));
            batches.push(inputs, angles, ordinary);
            anchored.push(inputs, angles, indices.clone().filter(is_anchored));
            // Sorts the tuned hinges by softness, because all hinges of a batch must have the same softness.
            tuned.clear();
            tuned.extend(indices.filter(is_tuned));
            let softness = |&index: &u32| inputs[index as usize].softness.to_bits();
            tuned.sort_by_key(softness);
            for equal in tuned.chunk_by(|a, b| softness(a) == softness(b)) {
                batches.push(inputs, angles, equal.iter().copied());
            }
        }
        batches.end_colour();
        anchored.end_colour();
    }

    /// Copies the impulses and angles of the joints into the existing batches again.
    pub(in super::super) fn reload(&mut self, joints: &Arena<Joint, JointId>) {
        self.overflow.reload(joints);
        self.blocked.reload(joints);
    }

    pub(in super::super) fn resume(&mut self, poses: &[Pose]) {
        self.overflow.resume(poses);
        self.blocked.resume(poses);
    }

    pub(in super::super) fn store(
        &mut self,
        joints: &mut Arena<Joint, JointId>,
        body_rotations: &[BodyRotation],
    ) {
        self.overflow.store(joints, body_rotations);
        self.blocked.store(joints, body_rotations);
    }
}

impl HingeShare {
    pub(in super::super) fn clear(&mut self) {
        let HingeShare { ordinary, anchored, is_stale } = self;
        *is_stale = true;
        with_data!(ordinary, batches => batches.clear());
        with_data!(anchored, batches => batches.clear());
    }

    /// Chooses the layout of the batches, which must be empty.
    pub(in super::super) fn fit(&mut self, machine: Machine) {
        self.ordinary.fit(machine);
        self.anchored.fit(machine);
    }

    pub(in super::super) fn add_anchored_bodies(&self, all: &mut Vec<u32>) {
        with_data!(&self.anchored, batches => batches.add_anchored_bodies(all));
    }

    pub(in super::super) fn reload(&mut self, joints: &Arena<Joint, JointId>) {
        self.ordinary.reload(joints);
        self.anchored.reload(joints);
    }

    pub(in super::super) fn resume(&mut self, poses: &[Pose]) {
        self.ordinary.resume(poses);
        self.anchored.resume(poses);
    }

    pub(in super::super) fn store(
        &mut self,
        joints: &mut Arena<Joint, JointId>,
        body_rotations: &[BodyRotation],
    ) {
        self.ordinary.store(joints, body_rotations);
        self.anchored.store(joints, body_rotations);
    }
}

fn count<T>(parts: &[T]) -> u32 {
    u32::try_from(parts.len()).expect("fewer than 2^32 joints")
}

impl Coloured<Hinges> {
    fn push(&mut self, inputs: &[Input], angle_inputs: &[AngleInput], indices: impl Iterator<Item = u32>) {
        with_data!(self, batches => batches.push(inputs, angle_inputs, indices));
    }

    fn end_colour(&mut self) {
        with_data!(self, batches => batches.end_colour(batches.batches.len()));
    }

    fn reload(&mut self, joints: &Arena<Joint, JointId>) {
        with_data!(self, batches => batches.reload(joints));
    }

    fn resume(&mut self, poses: &[Pose]) {
        with_data!(self, batches => batches.resume(poses));
    }

    fn store(&mut self, joints: &mut Arena<Joint, JointId>, body_rotations: &[BodyRotation]) {
        with_data!(self, batches => batches.store(joints, body_rotations));
    }
}

impl<const N: usize> Batches<Hinges, N> {
    /// Adds the body that each hinge moves to `all`. All hinges must be anchored.
    fn add_anchored_bodies(&self, all: &mut Vec<u32>) {
        for (Batch { changed: [a, b], .. }, records) in self.batches.iter().zip(&self.records) {
            all.extend(a.iter().zip(b).take(records.len).map(|(&a, &b)| if a == GROUND { b } else { a }));
        }
    }

    /// Adds batches of hinges. No two of `N` successive hinges may share a body that impulses change. All hinges must
    /// have the same softness, and either all or none of them must have rows on the angle.
    pub(super) fn push(
        &mut self,
        inputs: &[Input],
        angle_inputs: &[AngleInput],
        indices: impl Iterator<Item = u32>,
    ) {
        let Batches { batches, records, extras, .. } = self;
        let mut lane = N;
        for index in indices {
            let input = &inputs[index as usize];
            if lane == N {
                lane = 0;
                let (has_angle, is_tuned) = (input.angle.is_some(), input.is_tuned);
                batches.push(Batch { has_angle, is_tuned, ..Batch::NONE });
                records.push(Records { softness: input.softness, ..Records::NONE });
                extras.extend(input.angle.map(|_| AngleRows::NONE));
            }
            let (Some(batch), Some(records)) = (batches.last_mut(), records.last_mut()) else { return };
            batch.put(lane, input);
            records.put(lane, input);
            if let (Some(place), Some(rows)) = (input.angle, extras.last_mut()) {
                rows.put(lane, &angle_inputs[place as usize]);
            }
            lane += 1;
        }
    }

    fn reload(&mut self, joints: &Arena<Joint, JointId>) {
        let mut extras = self.extras.iter_mut();
        for (batch, records) in self.batches.iter_mut().zip(&mut self.records) {
            let mut rows = if batch.has_angle { extras.next() } else { None };
            for lane in 0..records.len {
                let joint = joints.at(records.slots[lane]);
                let lambda = joint.impulses.point(slot::HOLD);
                batch.lambda[0].0[lane] = lambda.x.to_bits();
                batch.lambda[1].0[lane] = lambda.y.to_bits();
                records.turns[lane] = joint.turns;
                if let Some(rows) = &mut rows {
                    rows.reload(lane, &joint.impulses);
                }
            }
        }
    }

    fn resume(&mut self, poses: &[Pose]) {
        for (batch, records) in self.batches.iter().zip(&mut self.records) {
            for lane in 0..records.len {
                let [a, b] = [0, 1].map(|side: usize| poses[batch.bodies[side][lane] as usize]);
                records.shape.put_between(lane, b.centre - a.centre);
                records.turns[lane] =
                    nearest_turns(records.turns[lane], (b.angle - a.angle) + records.rest[lane]);
            }
        }
    }

    fn store(&mut self, joints: &mut Arena<Joint, JointId>, body_rotations: &[BodyRotation]) {
        let mut extras = self.extras.iter();
        for (batch, records) in self.batches.iter().zip(&mut self.records) {
            let rows = if batch.has_angle { extras.next() } else { None };
            for lane in 0..records.len {
                let joint = joints.at_mut(records.slots[lane]);
                let [a, b] =
                    [0, 1].map(|side: usize| body_rotations[batch.bodies[side][lane] as usize].turns);
                records.turns[lane] = records.turns[lane].wrapping_add(b).wrapping_sub(a);
                joint.turns = records.turns[lane];
                let [spring, drive, lower, upper] = rows.map_or([Speed::ZERO; 4], |rows| rows.impulses(lane));
                let [x, y] = [0, 1].map(|axis: usize| Speed::from_bits(batch.lambda[axis].0[lane]));
                joint.impulses = JointImpulses([spring, drive, lower, upper, x, y]);
            }
        }
    }
}

impl<const N: usize> Batch<N> {
    fn put(&mut self, lane: usize, input: &Input) {
        for i in 0..2 {
            self.bodies[i][lane] = input.bodies[i];
            self.changed[i][lane] = input.changed[i];
            self.lambda[i].0[lane] = input.lambda[i];
        }
    }
}

impl<const N: usize> Records<N> {
    fn put(&mut self, lane: usize, input: &Input) {
        self.len = lane + 1;
        self.slots[lane] = input.slot;
        self.turns[lane] = input.turns;
        self.rest[lane] = input.rest;
        self.shape.put(lane, input);
    }
}

impl<const N: usize> Shape<N> {
    fn put(&mut self, lane: usize, input: &Input) {
        for side in 0..2 {
            self.arms[side][0].0[lane] = input.arms[side].x.to_bits();
            self.arms[side][1].0[lane] = input.arms[side].y.to_bits();
            self.ratios[side][0].0[lane] = input.ratios[side].x.to_bits();
            self.ratios[side][1].0[lane] = input.ratios[side].y.to_bits();
            self.gap_factors[side].0[lane] = input.gap_factors[side];
        }
        self.fractions[0].0[lane] = input.fractions.a.to_bits();
        self.fractions[1].0[lane] = input.fractions.b.to_bits();
        self.put_between(lane, input.between);
    }

    fn put_between(&mut self, lane: usize, Vec2 { x, y }: Vec2<Fx>) {
        self.between[0][lane] = widened(x);
        self.between[1][lane] = widened(y);
    }
}

/// A component of the vector between the centres of mass, in metres with 52 fraction bits. The sums that compute the
/// gap must stay below 2048 m, so the component is clamped to 1024 m: two arms add at most 849 m.
fn widened(between: Fx) -> i64 {
    const FARTHEST: Fx = crate::fx!(1024);
    const EXTRA: u32 = Length::FRAC_NBITS + Unit::FRAC_NBITS - Fx::FRAC_NBITS;
    between.clamp(-FARTHEST, FARTHEST).to_bits() << EXTRA
}
