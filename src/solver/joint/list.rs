//! Joints other than hinges, solved one by one before the hinges. Rows and points that belong to a block are solved by
//! the block.

use alloc::vec::Vec;

use core::cell::Cell;

use super::super::body::SolverBody;
use super::super::body_pair::{BodyPair, Remainders};
use super::super::context::{Pass, StepContext};
use super::super::limits::Faults;
use super::super::row::MassFractions;
use super::super::settings::Tuning;
use super::super::softness::Softness;
use super::coupling::Coupling;
use super::def::JointKind;
use super::parts::{Direction, Parts};
use super::point::JointPoint;
use super::pose::{BodyRotation, Ends};
use super::row::JointRow;
use super::state::{Joint, JointImpulses};
use crate::body::{Arena, Body, JointId};
use crate::math::{Speed, Unit};

#[derive(Clone, Debug, Default)]
pub(super) struct JointList {
    joints: Vec<JointConstraint>,
    /// For each joint, the data that every pass reads. It is stored apart from `joints`, so that passes read little
    /// memory.
    links: Vec<Link>,
    rows: Vec<JointRow>,
    points: Vec<JointPoint>,
    couplings: Vec<Coupling>,
}

#[derive(Clone, Copy, Debug)]
struct JointConstraint {
    slot: u32,
    ends: Ends,
}

#[derive(Clone, Copy, Debug)]
struct Link {
    bodies: [u32; 2],
    rows: u16,
    points: u16,
    remainders: Remainders,
}

impl Link {
    #[inline]
    fn change(
        &mut self,
        context: &StepContext<'_>,
        faults: &mut Faults,
        change: impl FnOnce(&mut BodyPair<'_>),
    ) {
        let remainders = &mut self.remainders;
        SolverBody::change_pair(context.bodies, self.bodies, |a, b| {
            change(&mut BodyPair { a, b, remainders, faults });
        });
    }
}

/// A row or a point that a block solves, by its index in `rows` or `points` of the [`JointList`].
#[derive(Clone, Copy, Debug)]
pub(super) enum ListPart {
    Row(usize),
    Point(usize),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct BlockedPart {
    pub(super) part: ListPart,
    pub(super) bodies: [u32; 2],
    pub(super) fractions: MassFractions,
    pub(super) mass_scale: Unit,
    pub(super) task: BlockedTask,
    pub(super) is_limited: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BlockedTask {
    Hold,
    /// Solved in the bias pass only.
    Spring,
    /// The impulse is never negative.
    Limit,
    /// The impulse is limited in magnitude.
    Drive,
}

struct Walk<'a> {
    links: core::slice::IterMut<'a, Link>,
    rows: &'a mut [JointRow],
    points: &'a mut [JointPoint],
}

impl<'a> Iterator for Walk<'a> {
    type Item = (&'a mut Link, &'a mut [JointRow], &'a mut [JointPoint]);

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
    pub(super) fn clear(&mut self) {
        let JointList { joints, links, rows, points, couplings } = self;
        joints.clear();
        links.clear();
        rows.clear();
        points.clear();
        couplings.clear();
    }

    pub(super) fn push(
        &mut self,
        slot: u32,
        joint: &Joint,
        indices: [u32; 2],
        bodies: [&Body; 2],
        tuning: &Tuning,
        is_blocked: bool,
    ) {
        let (rows_before, points_before) = (self.rows.len(), self.points.len());
        let mut parts = Parts {
            rows: &mut self.rows,
            points: &mut self.points,
            impulses: &joint.impulses,
            masses: (bodies[0].mass(), bodies[1].mass()),
            rate: tuning.rate,
            softness: joint.softness(tuning),
            coupling: u32::try_from(self.couplings.len()).expect("fewer than 2^32 joints"),
        };
        match &joint.def.kind {
            JointKind::Prismatic(kind) => kind.prepare(&mut parts),
            JointKind::Distance(kind) => kind.prepare(&mut parts),
            JointKind::Weld(kind) => kind.prepare(&mut parts),
            JointKind::Wheel(kind) => kind.prepare(&mut parts),
            JointKind::Motor(kind) => kind.prepare(&mut parts),
            JointKind::Gear(kind) => kind.prepare(&mut parts),
            JointKind::Rack(kind) => kind.prepare(&mut parts),
            JointKind::Pulley(kind) => kind.prepare(&mut parts),
            JointKind::Revolute(_) | JointKind::Filter => {}
        }
        self.couplings.extend(Coupling::prepare(joint, bodies));
        let (rows, points) = (&mut self.rows[rows_before..], &mut self.points[points_before..]);
        if is_blocked {
            rows.iter_mut().for_each(|row| row.is_blocked = true);
            points.iter_mut().for_each(|point| point.is_blocked = point.softness().is_some());
        }
        let (rows, points) = (count(rows), count(points));
        self.links.push(Link { bodies: indices, rows, points, remainders: Remainders::starting(bodies) });
        self.joints.push(JointConstraint { slot, ends: Ends::prepare(joint, indices, bodies) });
    }

    pub(super) fn refresh(
        &mut self,
        bodies: &[Cell<SolverBody>],
        body_rotations: &[BodyRotation],
        tuning: &Tuning,
    ) {
        let JointList { joints, links, rows, points, couplings } = self;
        let walk = Walk { links: links.iter_mut(), rows, points };
        for (joint, (_, rows, points)) in joints.iter().zip(walk) {
            let pose = joint.ends.pose(bodies, body_rotations);
            for point in points {
                point.refresh(&pose);
            }
            for row in rows {
                let measure = match row.direction {
                    Direction::Coupled(index) => {
                        couplings[index as usize].measure(&joint.ends, &pose, bodies, body_rotations)
                    }
                    direction => joint.ends.measure(direction, &pose, body_rotations),
                };
                row.refresh(&measure, tuning.rate);
            }
        }
    }

    pub(super) fn warm_start(&mut self, context: &StepContext<'_>) {
        let mut faults = 0;
        for (link, rows, points) in self.walk() {
            link.change(context, &mut faults, |bodies| {
                rows.iter_mut().for_each(|row| row.warm_start(bodies));
                points.iter_mut().for_each(|point| point.warm_start(bodies));
            });
        }
        context.add_faults(faults);
    }

    pub(super) fn solve(&mut self, pass: Pass, context: &StepContext<'_>) {
        let mut faults = 0;
        for (link, rows, points) in self.walk() {
            link.change(context, &mut faults, |bodies| {
                for row in rows.iter_mut().filter(|row| !row.is_blocked) {
                    row.solve(pass, bodies);
                }
                for point in points.iter_mut().filter(|point| !point.is_blocked) {
                    point.solve(pass, bodies);
                }
            });
        }
        context.add_faults(faults);
    }

    pub(super) fn store(&mut self, joints: &mut Arena<Joint, JointId>, body_rotations: &[BodyRotation]) {
        for (constraint, (_, rows, points)) in self.walk_joints() {
            let joint = joints.at_mut(constraint.slot);
            joint.turns = constraint.ends.turns(body_rotations);
            joint.impulses = JointImpulses::default();
            for row in rows {
                joint.impulses.0[usize::from(row.slot)] = row.lambda;
            }
            for point in points {
                joint.impulses.set_point(point.slot, point.lambda);
            }
        }
    }

    /// Calls `each` for every row and point that a block solves, with the slot of its joint.
    pub(super) fn blocked_parts(&self, mut each: impl FnMut(u32, BlockedPart)) {
        let (mut row, mut point) = (0, 0);
        for (joint, link) in self.joints.iter().zip(&self.links) {
            let (rows, points) = (row..row + usize::from(link.rows), point..point + usize::from(link.points));
            (row, point) = (rows.end, points.end);
            let part = |part, softness: &Softness, task, is_limited| BlockedPart {
                part,
                bodies: link.bodies,
                fractions: joint.ends.fractions(),
                mass_scale: softness.mass_scale,
                task,
                is_limited,
            };
            for at in rows.filter(|&at| self.rows[at].is_blocked) {
                let row = &self.rows[at];
                each(
                    joint.slot,
                    part(ListPart::Row(at), row.softness(), row.blocked_task(), row.is_limited_spring()),
                );
            }
            for at in points.filter(|&at| self.points[at].is_blocked) {
                let point = &self.points[at];
                let Some(softness) = point.softness() else { continue };
                let is_limited = point.impulse_max() != Speed::MAX;
                each(joint.slot, part(ListPart::Point(at), softness, BlockedTask::Spring, is_limited));
            }
        }
    }

    pub(super) fn row(&self, at: usize) -> &JointRow {
        &self.rows[at]
    }

    pub(super) fn row_mut(&mut self, at: usize) -> &mut JointRow {
        &mut self.rows[at]
    }

    pub(super) fn point(&self, at: usize) -> &JointPoint {
        &self.points[at]
    }

    pub(super) fn point_mut(&mut self, at: usize) -> &mut JointPoint {
        &mut self.points[at]
    }

    fn walk(&mut self) -> Walk<'_> {
        Walk { links: self.links.iter_mut(), rows: &mut self.rows, points: &mut self.points }
    }

    fn walk_joints(&mut self) -> impl Iterator<Item = (&JointConstraint, <Walk<'_> as Iterator>::Item)> {
        let JointList { joints, links, rows, points, .. } = self;
        joints.iter().zip(Walk { links: links.iter_mut(), rows, points })
    }
}

fn count<T>(parts: &[T]) -> u16 {
    u16::try_from(parts.len()).expect("a joint has a handful of parts")
}
