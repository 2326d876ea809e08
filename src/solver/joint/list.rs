//! Joints that are solved one by one, with their rows and points.

use alloc::vec::Vec;

use super::super::settings::Tuning;
use super::def::JointKind;
use super::parts::Parts;
use super::place::Ends;
use super::point::JointPoint;
use super::row::JointRow;
use super::state::Joint;
use crate::body::Body;

/// Joints one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct JointList {
    pub(super) joints: Vec<JointConstraint>,
    /// For each joint what every pass needs, so that the passes read little memory.
    links: Vec<Link>,
    /// Of all joints in turn.
    rows: Vec<JointRow>,
    points: Vec<JointPoint>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct JointConstraint {
    pub(super) slot: u32,
    pub(super) ends: Ends,
    /// How many rows and points come before its own in the list that it was first put into.
    starts: (u32, u32),
}

/// The bodies of a joint, and how many rows and points are its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) body_a: u32,
    pub(super) body_b: u32,
    rows: u16,
    points: u16,
}

/// Goes through joints with their rows and points.
pub(super) struct Walk<'a> {
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
    pub(super) fn clear(&mut self) {
        let JointList { joints, links, rows, points } = self;
        joints.clear();
        links.clear();
        rows.clear();
        points.clear();
    }

    /// Takes a joint that is no hinge, with the indices of its bodies.
    pub(super) fn push(
        &mut self,
        slot: u32,
        joint: &Joint,
        a: (u32, &Body),
        b: (u32, &Body),
        tuning: &Tuning,
    ) {
        let starts = (count(&self.rows), count(&self.points));
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
        let (rows, points) = (share(&self.rows, starts.0), share(&self.points, starts.1));
        self.links.push(Link { body_a: a.0, body_b: b.0, rows, points });
        self.joints.push(JointConstraint { slot, ends: Ends::prepare(joint, a, b), starts });
    }

    /// Appends a joint of another list.
    pub(super) fn copy(&mut self, other: &Self, index: u32) {
        let index = index as usize;
        let (link, joint) = (other.links[index], other.joints[index]);
        let (rows, points) = (joint.starts.0 as usize, joint.starts.1 as usize);
        self.joints.push(joint);
        self.links.push(link);
        self.rows.extend_from_slice(&other.rows[rows..rows + usize::from(link.rows)]);
        self.points.extend_from_slice(&other.points[points..points + usize::from(link.points)]);
    }

    pub(super) fn walk(&mut self) -> Walk<'_> {
        Walk { links: self.links.iter(), rows: &mut self.rows, points: &mut self.points }
    }

    /// The same, with the joints.
    pub(super) fn walk_joints(
        &mut self,
    ) -> impl Iterator<Item = (&JointConstraint, <Walk<'_> as Iterator>::Item)> {
        let JointList { joints, links, rows, points } = self;
        joints.iter().zip(Walk { links: links.iter(), rows, points })
    }
}

fn count<T>(parts: &[T]) -> u32 {
    u32::try_from(parts.len()).expect("parts are counted in 32 bits")
}

/// How many there are more than there were.
fn share<T>(parts: &[T], before: u32) -> u16 {
    u16::try_from(parts.len() - before as usize).expect("a joint has a handful of parts")
}
