//! Batches of constraints of one kind, and the loops that run a stage of the solver over them.
//!
//! No two constraints of a colour change the same body. The batches of a colour may therefore be solved in any order
//! and on several threads. Constraints that fit no colour form the overflow, which one thread solves one by one.
//!
//! Each kind of constraint defines the parts of its batches ([`BatchKind`]), and each stage of the solver defines an
//! operation on one batch ([`Operation`]).

use alloc::vec::Vec;
use core::cell::Cell;
use core::fmt::Debug;

use super::body::SolverBody;
use super::context::StepContext;
use super::limits::Faults;
use crate::simd::{GROUND, Kernel, Lanes, Layout, Scalar, WIDTH, prefetch, with_data};

pub(super) trait BatchKind: Clone + Debug + 'static {
    /// The part that the iterations of the solver read and write.
    type Batch<const N: usize>: Clone + Debug + Send;
    /// The part that only some operations read. It is separate because passes over large piles are memory-bound.
    type Record<const N: usize>: Clone + Debug + Sync;
    /// The part that only some batches have.
    type Extra<const N: usize>: Clone + Debug + Send;

    fn bodies<const N: usize>(batch: &Self::Batch<N>) -> &[[u32; N]; 2];

    fn has_extra<const N: usize>(batch: &Self::Batch<N>) -> bool;
}

/// An operation of the solver on one batch.
pub(super) trait Operation<K: BatchKind>: Copy + Send + Sync {
    /// Implementations must be `#[inline(always)]`, like [`Kernel::run`].
    fn apply<L: Lanes<N>, const N: usize>(self, parts: BatchParts<'_, K, N>);
}

pub(super) struct BatchParts<'a, K: BatchKind, const N: usize> {
    pub(super) batch: &'a mut K::Batch<N>,
    pub(super) record: &'a K::Record<N>,
    pub(super) extra: Option<&'a mut K::Extra<N>>,
    pub(super) bodies: &'a [Cell<SolverBody>],
    pub(super) faults: &'a mut Faults,
}

#[derive(Clone, Debug)]
pub(super) struct BatchList<K: BatchKind> {
    /// The constraints that fit no colour, in the order in which they are solved.
    pub(super) overflow: Batches<K, 1>,
    /// For each thread, the batches that it solves, colour by colour.
    pub(super) coloured: Vec<Coloured<K>>,
}

pub(super) type Coloured<K> = Layout<Batches<K, WIDTH>, Batches<K, 1>>;

#[derive(Debug)]
pub(super) struct BatchShare<'a, K: BatchKind> {
    /// `None` if there is no overflow.
    overflow: Option<Overflow<'a, K>>,
    pub(super) coloured: &'a mut Coloured<K>,
}

#[derive(Debug)]
enum Overflow<'a, K: BatchKind> {
    Own(&'a mut Batches<K, 1>),
    OfAnotherThread,
}

#[derive(Clone, Debug)]
pub(super) struct Batches<K: BatchKind, const N: usize> {
    pub(super) batches: Vec<K::Batch<N>>,
    pub(super) records: Vec<K::Record<N>>,
    /// One extra for each batch that has one, in the order of the batches.
    pub(super) extras: Vec<K::Extra<N>>,
    /// For each colour, the numbers of batches and extras up to its end. The overflow counts as one colour.
    colour_ends: Vec<ColourEnd>,
}

#[derive(Clone, Copy, Debug, Default)]
struct ColourEnd {
    batches: usize,
    extras: usize,
}

impl<K: BatchKind> Default for BatchList<K> {
    fn default() -> Self {
        BatchList { overflow: Batches::default(), coloured: Vec::from([Coloured::default()]) }
    }
}

impl<K: BatchKind, const N: usize> Default for Batches<K, N> {
    fn default() -> Self {
        Batches { batches: Vec::new(), records: Vec::new(), extras: Vec::new(), colour_ends: Vec::new() }
    }
}

impl<K: BatchKind, const N: usize> Batches<K, N> {
    pub(super) fn clear(&mut self) {
        self.clear_all_but_batches();
        self.batches.clear();
        self.records.clear();
    }

    /// Clears everything except the batches and records, which the caller overwrites.
    pub(super) fn clear_all_but_batches(&mut self) {
        self.extras.clear();
        self.colour_ends.clear();
    }

    /// Ends a colour after the first `batches` batches.
    pub(super) fn end_colour(&mut self, batches: usize) {
        self.colour_ends.push(ColourEnd { batches, extras: self.extras.len() });
    }
}

impl<K: BatchKind> BatchList<K> {
    pub(super) fn is_empty(&self) -> bool {
        self.overflow.batches.is_empty() && self.coloured.iter().all(Coloured::is_empty)
    }

    pub(super) fn has_extras(&self) -> bool {
        !self.overflow.extras.is_empty() || self.coloured.iter().any(Coloured::has_extras)
    }

    pub(super) fn shares(&mut self) -> impl Iterator<Item = BatchShare<'_, K>> {
        let has_overflow = !self.overflow.batches.is_empty();
        let mut own = Some(&mut self.overflow).filter(|_| has_overflow);
        self.coloured.iter_mut().map(move |coloured| {
            let overflow = own.take().map(Overflow::Own);
            BatchShare { overflow: overflow.or(has_overflow.then_some(Overflow::OfAnotherThread)), coloured }
        })
    }
}

impl<K: BatchKind> BatchShare<'_, K> {
    pub(super) fn own_overflow(&mut self) -> Option<&mut Batches<K, 1>> {
        match &mut self.overflow {
            Some(Overflow::Own(batches)) => Some(batches),
            Some(Overflow::OfAnotherThread) | None => None,
        }
    }

    /// Runs an operation over the overflow, if it belongs to this thread. If there is an overflow, all threads wait
    /// until it has been solved.
    pub(super) fn run_overflow(&mut self, operation: impl Operation<K>, context: &StepContext<'_>) {
        match &mut self.overflow {
            None => return,
            Some(Overflow::Own(batches)) => batches.run_in_order(operation, context),
            Some(Overflow::OfAnotherThread) => {}
        }
        context.wait();
    }
}

impl<K: BatchKind> Batches<K, 1> {
    pub(super) fn run_in_order(&mut self, operation: impl Operation<K>, context: &StepContext<'_>) {
        let Batches { batches, records, extras, .. } = self;
        if batches.is_empty() {
            return;
        }
        let mut faults = 0;
        let (bodies, faults_of_run) = (context.bodies, &mut faults);
        Run { batches, records, extras, operation, bodies, faults: faults_of_run }.run::<Scalar<1>>();
        context.add_faults(faults);
    }
}

impl<K: BatchKind> Coloured<K> {
    fn is_empty(&self) -> bool {
        with_data!(self, batches => batches.batches.is_empty())
    }

    fn has_extras(&self) -> bool {
        with_data!(self, batches => !batches.extras.is_empty())
    }

    /// Runs an operation over the batches of a thread. Waits after each colour for the other threads.
    pub(super) fn run_coloured(&mut self, operation: impl Operation<K>, context: &StepContext<'_>) {
        match self {
            Layout::Wide(batches, vectors) => {
                batches.for_each_colour(operation, context, |kernel| vectors.run(kernel));
            }
            Layout::Single(batches) => {
                batches.for_each_colour(operation, context, |kernel| kernel.run::<Scalar<1>>());
            }
        }
    }
}

impl<K: BatchKind, const N: usize> Batches<K, N> {
    fn for_each_colour<O: Operation<K>>(
        &mut self,
        operation: O,
        context: &StepContext<'_>,
        run: impl Fn(Run<'_, K, O, N>),
    ) {
        let Batches { batches, records, extras, colour_ends } = self;
        // A single thread needs no barriers between colours.
        let all = [ColourEnd { batches: batches.len(), extras: extras.len() }];
        let ends = if context.is_alone() { &all } else { colour_ends.as_slice() };
        let (mut start, mut faults) = (ColourEnd::default(), 0);
        for &end in ends {
            let batches = &mut batches[start.batches..end.batches];
            if !batches.is_empty() {
                let records = &records[start.batches..end.batches];
                let extras = &mut extras[start.extras..end.extras];
                let (bodies, faults) = (context.bodies, &mut faults);
                run(Run { batches, records, extras, operation, bodies, faults });
            }
            start = end;
            context.wait();
        }
        context.add_faults(faults);
    }
}

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
                // Prefetch the bodies of the next batch.
                prefetch(K::bodies(next));
            }
            let extra = if K::has_extra(batch) { extras.next() } else { None };
            let is_single = has_one_constraint(K::bodies(batch));
            let parts = BatchParts { batch, record, extra, bodies, faults };
            // The kernel for one lane takes less than half the instructions of the kernel for eight lanes. In a small
            // world, most batches have one constraint.
            if is_single { operation.apply::<Scalar<1>, N>(parts) } else { operation.apply::<L, N>(parts) }
        }
    }
}

#[inline(always)]
fn has_one_constraint<const N: usize>(bodies: &[[u32; N]; 2]) -> bool {
    bodies.iter().all(|side| side.get(1) == Some(&GROUND))
}
