//! Batches of constraints of one kind, and how a stage of the solver runs over them.
//!
//! Contacts and hinges are solved in batches. No two constraints of a colour change the same body, so that the batches
//! of a colour may be solved in any order and on several threads. Constraints that fit no colour are the overflow: they
//! are solved one after the other, by the same code with one lane.
//!
//! Each kind of constraint defines the parts of its batches ([`BatchKind`]), and each stage of the solver an operation
//! on one batch ([`Operation`]).

use alloc::vec::Vec;
use core::cell::Cell;
use core::fmt::Debug;

use super::body::SolverBody;
use super::context::StepContext;
use super::limits::Faults;
use crate::simd::{Kernel, Lanes, Scalar, Shared, WIDTH, prefetch};

/// Smallest number of batches in a job. Handing a smaller job to a thread costs more than doing it.
const BATCHES_PER_JOB: usize = 16;

/// A kind of constraint. `N` constraints of the kind are solved at a time.
pub(super) trait BatchKind: Clone + Debug + 'static {
    /// The part that every operation reads and writes.
    type Batch<const N: usize>: Clone + Debug + Send;
    /// The part that only some operations read. It is stored separately, because passes over large piles are
    /// memory-bound.
    type Record<const N: usize>: Clone + Debug + Sync;
    /// The part that only some batches have.
    type Extra<const N: usize>: Clone + Debug + Send;

    /// The indices of the bodies of each lane: those of A and those of B.
    fn bodies<const N: usize>(batch: &Self::Batch<N>) -> &[[u32; N]; 2];

    /// Whether a batch has an extra.
    fn has_extra<const N: usize>(batch: &Self::Batch<N>) -> bool;
}

/// An operation of the solver on one batch.
pub(super) trait Operation<K: BatchKind>: Copy + Send + Sync {
    /// Must be `#[inline(always)]`: see [`Kernel::run`].
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, K, N>);
}

/// A batch with its record and its extra, and the bodies and the count of faults that an operation changes.
pub(super) struct BatchParts<'a, K: BatchKind, const N: usize> {
    pub(super) batch: &'a mut K::Batch<N>,
    pub(super) record: &'a K::Record<N>,
    pub(super) extra: Option<&'a mut K::Extra<N>>,
    pub(super) bodies: &'a [Cell<SolverBody>],
    pub(super) faults: &'a mut Faults,
}

/// All constraints of a kind.
#[derive(Clone, Debug)]
pub(super) struct BatchList<K: BatchKind> {
    /// The overflow: the constraints that fit no colour, in the order in which they are solved.
    pub(super) overflow: Batches<K, 1>,
    /// All other constraints, colour by colour.
    pub(super) coloured: Batches<K, WIDTH>,
}

/// Batches in the order in which they are solved.
#[derive(Clone, Debug)]
pub(super) struct Batches<K: BatchKind, const N: usize> {
    pub(super) batches: Vec<K::Batch<N>>,
    /// One for each batch.
    pub(super) records: Vec<K::Record<N>>,
    /// One for each batch that has an extra, in the order of the batches.
    pub(super) extras: Vec<K::Extra<N>>,
    /// End of each colour's range of batches. The overflow counts as one colour.
    pub(super) colour_ends: Vec<usize>,
}

impl<K: BatchKind> Default for BatchList<K> {
    fn default() -> Self {
        BatchList { overflow: Batches::default(), coloured: Batches::default() }
    }
}

impl<K: BatchKind, const N: usize> Default for Batches<K, N> {
    fn default() -> Self {
        Batches { batches: Vec::new(), records: Vec::new(), extras: Vec::new(), colour_ends: Vec::new() }
    }
}

impl<K: BatchKind, const N: usize> Batches<K, N> {
    pub(super) fn clear(&mut self) {
        let Batches { batches, records, extras, colour_ends } = self;
        batches.clear();
        records.clear();
        extras.clear();
        colour_ends.clear();
    }

    /// Ends the current colour, unless it has no batch.
    pub(super) fn end_colour(&mut self) {
        let end = self.batches.len();
        if self.colour_ends.last().map_or(end > 0, |&last| end > last) {
            self.colour_ends.push(end);
        }
    }
}

impl<K: BatchKind> BatchList<K> {
    /// Whether there are no constraints.
    pub(super) fn is_empty(&self) -> bool {
        self.overflow.batches.is_empty() && self.coloured.batches.is_empty()
    }

    /// Whether any batch has an extra.
    pub(super) fn has_extras(&self) -> bool {
        !self.overflow.extras.is_empty() || !self.coloured.extras.is_empty()
    }

    /// Runs an operation over the overflow, one constraint after the other.
    pub(super) fn run_overflow(&mut self, operation: impl Operation<K>, context: &StepContext<'_>) {
        let Batches { batches, records, extras, .. } = &mut self.overflow;
        if batches.is_empty() {
            return;
        }
        let mut faults = 0;
        let (bodies, faults_of_run) = (context.bodies, &mut faults);
        Run { batches, records, extras, operation, bodies, faults: faults_of_run }.run::<Scalar<1>>();
        context.add_faults(faults);
    }

    /// Runs an operation over the coloured constraints, colour by colour. All threads share the batches of a colour.
    pub(super) fn run_coloured(&mut self, operation: impl Operation<K>, context: &StepContext<'_>) {
        let StepContext { machine, threads, .. } = *context;
        let Batches { batches, records, extras, colour_ends } = &mut self.coloured;
        if batches.is_empty() {
            return;
        }
        if threads.count() == 1 {
            // The batches are in the order of the colours.
            let mut faults = 0;
            let bodies = context.bodies;
            machine.run(Run { batches, records, extras, operation, bodies, faults: &mut faults });
            context.add_faults(faults);
            return;
        }
        let bodies = Shared::within_a_colour(context.bodies);
        let (mut start, mut extras) = (0, &mut extras[..]);
        for &end in colour_ends.iter() {
            let (colour, records) = (&mut batches[start..end], &records[start..end]);
            start = end;
            let share = threads.share(colour.len(), BATCHES_PER_JOB);
            let jobs = colour.chunks_mut(share).zip(records.chunks(share)).map(|(batches, records)| {
                let count = batches.iter().filter(|batch| K::has_extra(batch)).count();
                let (own, others) = core::mem::take(&mut extras).split_at_mut(count);
                extras = others;
                (batches, records, own)
            });
            let faults = threads.run(jobs, |(batches, records, extras)| {
                let mut faults = 0;
                let bodies = bodies.bodies();
                machine.run(Run { batches, records, extras, operation, bodies, faults: &mut faults });
                faults
            });
            context.add_faults(faults);
        }
    }
}

/// An operation over batches of `N` constraints.
struct Run<'a, K: BatchKind, O, const N: usize> {
    batches: &'a mut [K::Batch<N>],
    records: &'a [K::Record<N>],
    extras: &'a mut [K::Extra<N>],
    operation: O,
    bodies: &'a [Cell<SolverBody>],
    faults: &'a mut Faults,
}

impl<K: BatchKind, O: Operation<K>, const N: usize> Kernel<N> for Run<'_, K, O, N> {
    #[inline(always)]
    fn run<L: Lanes<N>>(self) {
        let Run { batches, records, extras, operation, bodies, faults } = self;
        let (mut extras, mut records) = (extras.iter_mut(), records.iter());
        let mut rest = batches;
        while let ([batch, others @ ..], Some(record)) = (rest, records.next()) {
            rest = others;
            if let Some(next) = rest.first() {
                // The bodies of the next batch are read through these indices.
                prefetch(K::bodies(next));
            }
            let extra = if K::has_extra(batch) { extras.next() } else { None };
            operation.apply::<L, N>(BatchParts { batch, record, extra, bodies, faults });
        }
    }
}
