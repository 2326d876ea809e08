//! The choice and the order of the joints that are solved in blocks.
//!
//! One iteration solves a body with one joint exactly, and a chain of similar bodies well. Iterations fail at bodies
//! whose joints disturb each other, and may add energy there. An impulse at the point of a hinge changes the velocity
//! of the point through both bodies. The *share* of a body is its part of this change: large if the body is light or
//! its arm is long. A body is *crowded* if two or more joints hold it and
//!
//! - one of them is not a revolute joint, or
//! - its share is large at two hinges ([`PAIR_MIN`]), or
//! - the sum of its shares over all hinges, without the largest share, is large ([`SUM_MIN`]).
//!
//! Joints of a crowded body are solved in a block if they have rows for a block. Crowded bodies with a common joint
//! share a block, up to [`ROWS_MAX`] rows.

use alloc::vec::Vec;

use super::super::super::body_list::GROUND;
use super::super::super::row::MassFractions;
use super::super::def::JointKind;
use super::super::hinge::{HingeBody, shares};
use super::super::options::JointLimit;
use super::super::state::Joint;
use crate::math::{Fx, Unit, fx_mul};

/// Largest number of rows of a block. The cost of a full matrix grows with the third power of the rows: a block of this
/// size costs about as much as 5000 contacts.
pub(super) const ROWS_MAX: u32 = 96;

/// A body is crowded if it has a share of at least this at each of two hinges.
const PAIR_MIN: Unit = Unit::lit("0.6");

/// A body is crowded if the sum of its shares, without the largest share, is at least this: 1.52. In cloth of discs,
/// each with four hinges, the sum is 1.5, so cloth is not solved in blocks.
const SUM_MIN: i64 = (1 << 30) / 100 * 152;

/// A joint that may be solved in a block.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Candidate {
    /// The bodies of the joint, with the ground for a body that no impulse changes.
    pub(in super::super) bodies: [u32; 2],
    /// Number of the joint's rows in a block: those of springs, limits and motors along one direction, and those that
    /// hold the bodies. A joint without such rows is not solved in a block.
    pub(in super::super) rows: u32,
    /// Whether the joint has rows besides the row of a motor.
    pub(in super::super) holds: bool,
    pub(in super::super) is_hinge: bool,
    /// Reduced mass in kg: `1 / (1 / M + 1 / M')` for bodies of the masses `M` and `M'`.
    pub(in super::super) reduced_mass: Fx,
    /// Shares of the bodies at the point of a revolute joint; 0 for other joints.
    pub(in super::super) shares: [Unit; 2],
}

impl Candidate {
    pub(in super::super) fn of(joint: &Joint, [a, b]: [&HingeBody; 2]) -> Self {
        let limits = |limit: Option<JointLimit>| if limit.is_some() { 2 } else { 0 };
        let (holding, motor, is_hinge) = match &joint.def.kind {
            JointKind::Revolute(kind) => {
                (2 + u32::from(kind.spring.is_some()) + limits(kind.limit), kind.motor, true)
            }
            JointKind::Weld(_) => (3, None, false),
            JointKind::Prismatic(kind) => {
                (2 + u32::from(kind.spring.is_some()) + limits(kind.limit), kind.motor, false)
            }
            JointKind::Wheel(kind) => {
                (1 + u32::from(kind.spring.is_some()) + limits(kind.limit), kind.motor, false)
            }
            JointKind::Distance(kind) => {
                let parts = u32::from(kind.rod.is_some()) + u32::from(kind.spring.is_some());
                (parts + limits(kind.limit), kind.motor, false)
            }
            JointKind::Gear(_) | JointKind::Rack(_) | JointKind::Pulley(_) => (1, None, false),
            JointKind::Motor(kind) => {
                let linear = if kind.linear_spring.is_some() { 2 } else { 0 };
                (linear + u32::from(kind.angular_spring.is_some()), kind.angular, false)
            }
            JointKind::Filter => (0, None, false),
        };
        let (rows, holds) = (holding + u32::from(motor.is_some()), holding > 0);
        let shares = if is_hinge { shares(joint, [a, b]) } else { [Unit::ZERO; 2] };
        // The lighter body has the larger fraction, which has more significant bits.
        let fractions = MassFractions::of_masses(a.mass, b.mass);
        let (mass, fraction) =
            if fractions.a > fractions.b { (a.mass, fractions.a) } else { (b.mass, fractions.b) };
        let reduced_mass = fx_mul(mass, fraction.into());
        Candidate { bodies: [a.changed(), b.changed()], rows, holds, is_hinge, reduced_mass, shares }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Crowd {
    joints: u32,
    holds: u32,
    others: bool,
    sum: i64,
    largest: Unit,
    second: Unit,
}

impl Crowd {
    fn add(&mut self, share: Unit, joint: &Candidate) {
        self.joints += 1;
        self.holds += u32::from(joint.holds);
        self.others |= joint.holds && !joint.is_hinge;
        self.sum += i64::from(share.to_bits());
        self.second = self.second.max(share.min(self.largest));
        self.largest = self.largest.max(share);
    }

    fn is_crowded(&self) -> bool {
        let rest = self.sum - i64::from(self.largest.to_bits());
        self.holds >= 2 && (self.others || self.second >= PAIR_MIN || rest >= SUM_MIN)
    }
}

/// Largest number of rows of a joint: a slider with a spring, two limits and a motor.
const JOINT_ROWS_MAX: usize = 6;

/// The joints of a crowded body, as ranges of `Choice::of_body`: one range for each number of rows.
#[derive(Clone, Copy, Debug, Default)]
struct JointsOfBody {
    /// For each range, the first joint that is not in a block yet.
    next: [u32; JOINT_ROWS_MAX],
    ends: [u32; JOINT_ROWS_MAX],
    /// Number of the last walk that visited the body.
    walk: u32,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Choice {
    crowds: Vec<Crowd>,
    /// Index of each body in `bodies`, or [`NOT_CROWDED`].
    places: Vec<u32>,
    bodies: Vec<JointsOfBody>,
    of_body: Vec<u32>,
    /// Whether a candidate is in the current walk or in an earlier block.
    taken: Vec<bool>,
    settled: Vec<bool>,
    queue: Vec<u32>,
    walks: u32,
    /// Chosen candidates, block by block, in the order of elimination.
    pub(super) order: Vec<u32>,
    pub(super) block_ends: Vec<usize>,
}

const NOT_CROWDED: u32 = u32::MAX;

impl Choice {
    /// Chooses the joints and divides them among blocks. Takes time proportional to the number of joints, even if very
    /// many are at one body.
    pub(super) fn choose(&mut self, candidates: &[Candidate], body_count: usize) {
        self.order.clear();
        self.block_ends.clear();
        self.count(candidates, body_count);
        if !self.crowds.iter().any(Crowd::is_crowded) {
            return;
        }
        self.list(candidates);
        for flags in [&mut self.taken, &mut self.settled] {
            flags.clear();
            flags.resize(candidates.len(), false);
        }
        self.walks = 0;
        for first in 0..candidates.len() {
            let is_chosen = candidates[first].rows > 0
                && candidates[first].bodies.iter().any(|&body| self.places[body as usize] != NOT_CROWDED);
            // The block starts again at its rim (`add_block`), and may be full before it reaches the joint `first`.
            while is_chosen && !self.settled[first] {
                self.add_block(candidates, index(first));
            }
        }
    }

    /// Adds a block of joints that crowded bodies connect with `start`.
    fn add_block(&mut self, candidates: &[Candidate], start: u32) {
        // The last joint of the first walk is at the rim of the block. The order that starts at this joint gives the
        // matrix a narrow envelope (`matrix.rs`).
        self.walk(candidates, start);
        let rim = self.queue.last().copied().unwrap_or(start);
        for &joint in &self.queue {
            self.taken[joint as usize] = false;
        }
        self.walk(candidates, rim);
        for &joint in &self.queue {
            self.settled[joint as usize] = true;
        }
        // Reverse Cuthill-McKee order.
        self.order.extend(self.queue.iter().rev());
        self.block_ends.push(self.order.len());
    }

    fn count(&mut self, candidates: &[Candidate], body_count: usize) {
        self.crowds.clear();
        self.crowds.resize(body_count, Crowd::default());
        for joint in candidates.iter().filter(|joint| joint.rows > 0) {
            for (&body, &share) in joint.bodies.iter().zip(&joint.shares) {
                self.crowds[body as usize].add(share, joint);
            }
        }
        // The ground connects no joints.
        self.crowds[GROUND as usize] = Crowd::default();
    }

    /// Lists the joints of each crowded body by their number of rows, in ascending order.
    fn list(&mut self, candidates: &[Candidate]) {
        let Choice { crowds, places, bodies, of_body, .. } = self;
        bodies.clear();
        places.clear();
        places.extend(crowds.iter().map(|crowd| {
            if !crowd.is_crowded() {
                return NOT_CROWDED;
            }
            bodies.push(JointsOfBody::default());
            index(bodies.len() - 1)
        }));
        let listed = |candidate: &Candidate, bodies: &mut Vec<JointsOfBody>| {
            let places = candidate.bodies.map(|body| places[body as usize]);
            let places = places.into_iter().filter(|&place| place != NOT_CROWDED && candidate.rows > 0);
            let class = candidate.rows.saturating_sub(1) as usize;
            let mut at = [None; 2];
            for (at, place) in at.iter_mut().zip(places) {
                let end = &mut bodies[place as usize].ends[class];
                *at = Some(*end);
                *end += 1;
            }
            at
        };
        for candidate in candidates {
            listed(candidate, bodies);
        }
        let mut total = 0;
        for JointsOfBody { next, ends, .. } in bodies.iter_mut() {
            for (next, end) in next.iter_mut().zip(ends) {
                let count = *end;
                (*next, *end) = (total, total);
                total += count;
            }
        }
        of_body.clear();
        of_body.resize(total as usize, 0);
        for (joint, candidate) in (0..).zip(candidates) {
            for at in listed(candidate, bodies).into_iter().flatten() {
                of_body[at as usize] = joint;
            }
        }
    }

    /// Lists the joints that crowded bodies connect with `start`, breadth first, until the block is full.
    fn walk(&mut self, candidates: &[Candidate], start: u32) {
        self.walks += 1;
        self.queue.clear();
        self.queue.push(start);
        self.taken[start as usize] = true;
        let mut rows = candidates[start as usize].rows;
        let mut at = 0;
        while at < self.queue.len() {
            for body in candidates[self.queue[at] as usize].bodies {
                let place = self.places[body as usize];
                if place != NOT_CROWDED {
                    rows = self.take_joints_of(place, rows);
                }
            }
            at += 1;
        }
    }

    /// Adds the joints of a body to the walk, in ascending order, as long as they fit in the block. Takes and returns
    /// the number of rows in the walk. This number only grows during a walk, so a joint that does not fit is not tried
    /// again.
    fn take_joints_of(&mut self, place: u32, mut rows: u32) -> u32 {
        let Choice { bodies, of_body, taken, settled, queue, walks, .. } = self;
        let JointsOfBody { next, ends, walk } = &mut bodies[place as usize];
        if *walk == *walks {
            return rows;
        }
        *walk = *walks;
        for (next, &end) in next.iter_mut().zip(&*ends) {
            while *next < end && settled[of_body[*next as usize] as usize] {
                *next += 1;
            }
        }
        let mut heads = *next;
        loop {
            let mut first: Option<(u32, u32)> = None;
            for ((more, head), &end) in (1..).zip(&mut heads).zip(&*ends) {
                if rows + more > ROWS_MAX {
                    break;
                }
                while *head < end && taken[of_body[*head as usize] as usize] {
                    *head += 1;
                }
                if *head < end {
                    let joint = of_body[*head as usize];
                    first = Some(first.map_or((joint, more), |first| first.min((joint, more))));
                }
            }
            let Some((joint, more)) = first else { return rows };
            taken[joint as usize] = true;
            queue.push(joint);
            rows += more;
        }
    }
}

fn index(at: usize) -> u32 {
    u32::try_from(at).expect("fewer than 2^32 joints")
}
