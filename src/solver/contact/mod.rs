//! Contacts: one row along the normal for each point, and one along the tangent for both points.
//!
//! The equations below use the rows and gains of `row.rs`, the separation `s0` at the start of the tick, and the
//! displacements `dx` since then. They apply to each contact of a batch:
//!
//! ```text
//! J  = (-n, -eA, n, eB)                                  the form of the rows along the normal and the tangent
//! vn = J v,    s = s0 + J dx
//! w  = massScale (vn + bias) + impulseScale L,           L' = clamp(L - w, lo, hi),   d = L' - L
//! vA -= gA d n,  uA -= fA d,  vB += gB d n,  uB += fB d
//! ```
//!
//! The operations on a batch are in `warm_start`, `solve` (the equations for `w` and `L'`), `measure`, `impact`,
//! `restitution` and `hit`. `prepare` fills the batches of a tick, `rows` computes their rows, and `store` returns the
//! impulses to the state. `overflow_policy` keeps numbers within their formats.
//!
//! The difference of two velocities fits its format, because each velocity is below 512 m/s. Lanes without a contact
//! have gains of 0, so their other numbers do not matter.

mod arms;
mod batch;
mod constants;
mod extras;
mod fast_impact;
mod hit;
mod impact;
mod input;
mod jacobian;
mod measure;
mod overflow_policy;
mod prepare;
mod prospect;
mod restitution;
mod rolling;
mod rows;
mod solve;
mod store;
mod surface;
mod warm_start;

use alloc::vec::Vec;

use super::batches::{BatchKind, BatchList, BatchShare, Operation};
use super::context::StepContext;
use crate::math::Speed;
use batch::Batch;
pub(super) use constants::Constants;
use extras::ContactExtras;
pub(super) use fast_impact::FastImpact;
use hit::AddHits;
pub(super) use impact::{MeasureApproach, PredictImpacts};
pub(crate) use input::ActiveContact;
pub(super) use input::ContactSource;
pub(super) use measure::Measure;
use prospect::Prospect;
use restitution::ApplyRestitution;
pub(super) use solve::{PointOrder, Solve};
pub(crate) use store::ContactResults;
pub(super) use store::ContactStore;
use store::Records;
pub(crate) use surface::{Surface, SurfaceSide};
pub(super) use warm_start::WarmStart;

/// Largest impulse of friction and of rolling resistance. The difference of two such impulses fits the format.
const TANGENT_MAX: Speed = Speed::lit("511");

/// Number of passes in which elastic contacts that bounce at the same time are solved against each other. With one
/// pass, a box in a closed room would gain half of its energy within a minute.
const RESTITUTION_PASSES: u32 = 12;

/// All contacts of a tick.
///
/// A contact is cold if neither of its bodies has an initial guess of the impulses on this body. A body has no guess if
/// none of its contacts had points in the last tick, or if an impact may drive the body between two walls. Cold
/// contacts need more iterations.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactSet {
    warm: BatchList<Contacts>,
    cold: BatchList<Contacts>,
    prospects: Vec<Prospect>,
    warm_starts: Vec<WarmStarts>,
    features: Features,
}

#[derive(Clone, Copy, Debug, Default)]
struct Features {
    /// Whether any contact is elastic: its restitution is above `restitution::ELASTIC`.
    elastic: bool,
    /// Whether any contact has a restitution.
    bounces: bool,
    cold: bool,
    hits: bool,
    extras: bool,
}

#[derive(Debug)]
pub(super) struct ContactShare<'a> {
    warm: BatchShare<'a, Contacts>,
    cold: BatchShare<'a, Contacts>,
    features: Features,
}

impl ContactSet {
    pub(super) fn shares(&mut self) -> impl Iterator<Item = ContactShare<'_>> {
        let ContactSet { warm, cold, features, .. } = self;
        warm.shares().zip(cold.shares()).map(|(warm, cold)| ContactShare { warm, cold, features: *features })
    }

    pub(super) fn has_hits(&self) -> bool {
        self.features.hits
    }

    /// Whether any contact of a body may bounce. `body` is the index of the body in the body list.
    pub(super) fn bounces(&self, body: u32) -> bool {
        self.prospects[body as usize].bounces()
    }
}

impl ContactShare<'_> {
    pub(super) fn run_overflow(&mut self, operation: impl Operation<Contacts>, context: &StepContext<'_>) {
        self.warm.run_overflow(operation, context);
        self.cold.run_overflow(operation, context);
    }

    pub(super) fn run_coloured(&mut self, operation: impl Operation<Contacts>, context: &StepContext<'_>) {
        self.warm.coloured.run_coloured(operation, context);
        self.cold.coloured.run_coloured(operation, context);
    }

    pub(super) fn run(&mut self, operation: impl Operation<Contacts>, context: &StepContext<'_>) {
        self.run_overflow(operation, context);
        self.run_coloured(operation, context);
    }

    pub(super) fn has_cold(&self) -> bool {
        self.features.cold
    }

    pub(super) fn has_extras(&self) -> bool {
        self.features.extras
    }

    pub(super) fn may_bounce(&self) -> bool {
        self.features.bounces
    }

    pub(super) fn run_cold(&mut self, operation: impl Operation<Contacts>, context: &StepContext<'_>) {
        self.cold.run_overflow(operation, context);
        self.cold.coloured.run_coloured(operation, context);
    }

    pub(super) fn bounce(&mut self, context: &StepContext<'_>) {
        for pass in 0..if self.features.elastic { RESTITUTION_PASSES } else { 1 } {
            let restitution = ApplyRestitution { again: pass > 0 };
            self.run(restitution, context);
        }
    }

    pub(super) fn add_hits(&mut self, context: &StepContext<'_>) {
        if self.features.hits {
            self.run(AddHits, context);
        }
    }
}

#[derive(Clone, Debug)]
pub(super) enum Contacts {}

impl BatchKind for Contacts {
    type Batch<const N: usize> = Batch<N>;
    type Record<const N: usize> = Records<N>;
    type Extra<const N: usize> = ContactExtras<N>;

    #[inline(always)]
    fn bodies<const N: usize>(batch: &Batch<N>) -> &[[u32; N]; 2] {
        &batch.bodies
    }

    #[inline(always)]
    fn has_extra<const N: usize>(batch: &Batch<N>) -> bool {
        batch.extras
    }
}

/// Statistics of warm starting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct WarmStarts {
    /// Number of points in contact.
    pub(crate) points: u32,
    /// Number of points that already existed in the last tick.
    pub(crate) kept: u32,
    /// Number of points with an impulse in the last tick that no longer exist, although the shapes still touch.
    pub(crate) lost: u32,
}

impl core::iter::Sum for WarmStarts {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(WarmStarts::default(), |a, b| WarmStarts {
            points: a.points + b.points,
            kept: a.kept + b.kept,
            lost: a.lost + b.lost,
        })
    }
}
