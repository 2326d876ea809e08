//! Fills batches with hinges in the order in which they are solved, and brings their impulses back.

use super::super::super::body_list::GROUND;
use super::super::super::colour::Group;
use super::super::super::settings::Tuning;
use super::super::parts::slot;
use super::super::place::Turned;
use super::super::state::{Joint, JointImpulses, nearest_turns};
use super::angle::AngleRows;
use super::batch::{Batch, Shape};
use super::{AngleInput, AngleParts, Batches, End, Expired, HingeSet, Input};
use crate::body::{Arena, JointId, Pose};
use crate::math::{Angle, Fx, Length, Speed, Unit, Vec2};

/// What it takes to bring the results of a batch back to its joints.
#[derive(Clone, Debug)]
pub(super) struct Records<const N: usize> {
    /// How many lanes are used.
    pub(super) len: usize,
    pub(super) slots: [u32; N],
    /// The angles of the joints at the start of the tick, and behind it at its end, in units of 2^-32 turn.
    pub(super) turns: [i64; N],
    /// The same while no body is turned.
    rest: [Angle; N],
}

impl HingeSet {
    pub(in super::super) fn clear(&mut self) {
        let HingeSet { inputs, angles, memo: _, serial, coloured, mounts, expired } = self;
        *expired = Expired::Everything;
        inputs.clear();
        angles.clear();
        serial.clear();
        coloured.clear();
        mounts.clear();
    }

    /// Takes a hinge, and returns the index of its input.
    pub(in super::super) fn push_input(
        &mut self,
        slot: u32,
        joint: &Joint,
        (a, b): (&End, &End),
        parts: &AngleParts,
        tuning: &Tuning,
    ) -> u32 {
        let HingeSet { inputs, angles, memo, .. } = self;
        let angle = if parts.is_empty() { None } else { Some(count(angles)) };
        let input = Input::new(slot, joint, a, b, angle);
        if angle.is_some() {
            angles.push(AngleInput::new(parts, (a, b), &joint.impulses, memo, tuning));
        }
        inputs.push(input);
        count(inputs) - 1
    }

    /// Adds the hinges of a group, given by their inputs. Those with rows on the angle keep to themselves, and so do mounts:
    /// those of a body that no other joint holds, by its index.
    pub(in super::super) fn push(
        &mut self,
        group: &Group<'_>,
        input_of: impl Fn(u32) -> Option<u32>,
        is_alone: impl Fn(u32) -> bool,
    ) {
        let HingeSet { inputs, angles, serial, coloured, mounts, .. } = self;
        for has_angle in [false, true] {
            let wanted = |&index: &u32| inputs[index as usize].angle.is_some() == has_angle;
            match group {
                Group::Serial(indices) => {
                    let indices = indices.iter().filter_map(|&index| input_of(index)).filter(wanted);
                    serial.push(inputs, angles, indices);
                }
                Group::Coloured(indices) => {
                    let is_mount = |&index: &u32| inputs[index as usize].mounted().is_some_and(&is_alone);
                    let indices = indices.iter().filter_map(|&index| input_of(index)).filter(wanted);
                    coloured.push(inputs, angles, indices.clone().filter(|index| !is_mount(index)));
                    mounts.push(inputs, angles, indices.filter(is_mount));
                }
            }
        }
    }

    /// The indices of the bodies that are mounted.
    pub(in super::super) fn mounted(&self) -> impl Iterator<Item = u32> {
        let Batches { batches, records, .. } = &self.mounts;
        batches.iter().zip(records).flat_map(|(Batch { changed: [a, b], .. }, records)| {
            a.iter().zip(b).take(records.len).map(|(&a, &b)| if a == GROUND { b } else { a })
        })
    }

    /// What the joints have been restored to, instead of what the last tick has stored.
    pub(in super::super) fn reload(&mut self, joints: &Arena<Joint, JointId>) {
        self.serial.reload(joints);
        self.coloured.reload(joints);
        self.mounts.reload(joints);
    }

    /// What the last tick has stored, with the bodies where they are now.
    pub(in super::super) fn resume(&mut self, poses: &[Pose]) {
        self.serial.resume(poses);
        self.coloured.resume(poses);
        self.mounts.resume(poses);
    }

    /// Keeps impulses and turns for the next tick.
    pub(in super::super) fn store(&mut self, joints: &mut Arena<Joint, JointId>, turned: &[Turned]) {
        self.serial.store(joints, turned);
        self.coloured.store(joints, turned);
        self.mounts.store(joints, turned);
    }
}

fn count<T>(parts: &[T]) -> u32 {
    u32::try_from(parts.len()).expect("fewer than 2^32 joints")
}

impl<const N: usize> Batches<N> {
    fn clear(&mut self) {
        let Batches { batches, shapes, angles, records } = self;
        batches.clear();
        shapes.clear();
        angles.clear();
        records.clear();
    }

    /// Adds batches of hinges that no two of `N` in turn share a body that impulses change.
    fn push(&mut self, inputs: &[Input], angle_inputs: &[AngleInput], indices: impl Iterator<Item = u32>) {
        let Batches { batches, shapes, angles, records } = self;
        let mut lane = N;
        for index in indices {
            let input = &inputs[index as usize];
            if lane == N {
                lane = 0;
                let mut batch = Batch::NONE;
                if input.angle.is_some() {
                    batch.angle = Some(count(angles));
                    angles.push(AngleRows::NONE);
                }
                batches.push(batch);
                shapes.push(Shape::NONE);
                records.push(Records { len: 0, slots: [0; N], turns: [0; N], rest: [Angle::ZERO; N] });
            }
            let (Some(batch), Some(shape)) = (batches.last_mut(), shapes.last_mut()) else { return };
            batch.put(lane, input);
            shape.put(lane, input);
            if let (Some(place), Some(rows)) = (input.angle, angles.last_mut()) {
                rows.put(lane, &angle_inputs[place as usize]);
            }
            if let Some(records) = records.last_mut() {
                records.len = lane + 1;
                records.slots[lane] = input.slot;
                records.turns[lane] = input.turns;
                records.rest[lane] = input.rest;
            }
            lane += 1;
        }
    }

    fn reload(&mut self, joints: &Arena<Joint, JointId>) {
        let Batches { batches, angles, records, .. } = self;
        for (batch, records) in batches.iter_mut().zip(records) {
            let mut rows = batch.angle.map(|place| &mut angles[place as usize]);
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
        for ((batch, shape), records) in self.batches.iter().zip(&mut self.shapes).zip(&mut self.records) {
            for lane in 0..records.len {
                let [a, b] = [0, 1].map(|side: usize| poses[batch.bodies[side][lane] as usize]);
                shape.put_between(lane, b.centre - a.centre);
                records.turns[lane] =
                    nearest_turns(records.turns[lane], (b.angle - a.angle) + records.rest[lane]);
            }
        }
    }

    fn store(&mut self, joints: &mut Arena<Joint, JointId>, turned: &[Turned]) {
        for (batch, records) in self.batches.iter().zip(&mut self.records) {
            let rows = batch.angle.map(|place| &self.angles[place as usize]);
            for lane in 0..records.len {
                let joint = joints.at_mut(records.slots[lane]);
                let [a, b] = [0, 1].map(|side: usize| turned[batch.bodies[side][lane] as usize].turns);
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

impl<const N: usize> Shape<N> {
    fn put(&mut self, lane: usize, input: &Input) {
        for side in 0..2 {
            self.arms[side][0].0[lane] = input.arms[side].x.to_bits();
            self.arms[side][1].0[lane] = input.arms[side].y.to_bits();
            self.ratios[side][0].0[lane] = input.ratios[side].x.to_bits();
            self.ratios[side][1].0[lane] = input.ratios[side].y.to_bits();
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

/// A distance between centres with 52 fraction bits. Two arms reach 849 m, so that beyond 1024 m it does not matter how
/// far they are apart, and no sum leaves the format.
fn widened(between: Fx) -> i64 {
    const FARTHEST: Fx = crate::fx!(1024);
    const EXTRA: u32 = Length::FRAC_NBITS + Unit::FRAC_NBITS - Fx::FRAC_NBITS;
    between.clamp(-FARTHEST, FARTHEST).to_bits() << EXTRA
}
