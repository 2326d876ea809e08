//! One sub-step: the stages of E. Catto's soft step (Solver2D, `solve_soft_step.c`).
//!
//! All threads of a tick run the same stage at the same time, each on its own bodies and constraints. A barrier
//! ([`StepContext::wait`]) precedes every stage that reads bodies of other threads, and follows every stage over
//! constraints.

use super::COLD_ROUNDS;
use super::contact::{
    self, Constants, ContactShare, FastImpact, Measure, MeasureApproach, PointOrder, PredictImpacts,
};
use super::contact_velocity::ContactVelocities;
use super::context::{Bias, Relax, StepContext};
use super::integrate::{MovingBody, integrate_displacements, integrate_velocities};
use super::joint::JointShare;

/// The bodies and constraints of one thread.
pub(super) struct SolverShare<'a, 'set> {
    pub(super) moving: &'a [MovingBody],
    pub(super) contacts: ContactShare<'a>,
    pub(super) velocities: &'a mut ContactVelocities,
    pub(super) joints: JointShare<'a, 'set>,
}

impl SolverShare<'_, '_> {
    /// Performs one sub-step. `index` counts the sub-steps of all ticks. `is_first` tells whether this is the first
    /// sub-step of the tick.
    pub(super) fn sub_step(&mut self, index: u64, is_first: bool, context: &StepContext<'_>) {
        let SolverShare { moving, contacts, velocities, joints } = self;
        let tuning = context.tuning;
        let iterations = tuning.iterations;
        let cold_iterations = if contacts.has_cold() { iterations * COLD_ROUNDS } else { 0 };
        let constants = Constants::new(tuning);

        if is_first && contacts.has_extras() {
            contacts.run(MeasureApproach, context);
        }
        joints.predict_rotations(context);
        velocities.measure(context);
        integrate_velocities(moving, context);
        context.wait();

        if contacts.has_extras() {
            contacts.run(PredictImpacts { constants, is_first }, context);
        }
        joints.warm_start(context);
        let is_warm = velocities.apply(context);
        context.wait();
        if !is_warm {
            contacts.run(contact::WarmStart, context);
        }

        // Solve with bias. The additional rounds of cold contacts come first. After the joints, they would solve the impact
        // of a body as if nothing held it, and its hinges would open.
        for iteration in iterations..cold_iterations {
            contacts.run_cold(
                contact::Solve { pass: Bias, order: PointOrder::of(index, iteration), constants },
                context,
            );
        }
        for iteration in 0..iterations {
            let solve = contact::Solve { pass: Bias, order: PointOrder::of(index, iteration), constants };
            contacts.run_overflow(solve, context);
            velocities.exempt(context, || joints.solve(Bias, context));
            contacts.run_coloured(solve, context);
        }

        velocities.exempt(context, || integrate_displacements(moving, context));
        context.wait();
        joints.refresh(context);

        // Relax: solve without bias.
        let (iterations, cold_iterations) = if tuning.relax { (iterations, cold_iterations) } else { (0, 0) };
        for iteration in iterations..cold_iterations {
            contacts.run_cold(
                contact::Solve { pass: Relax, order: PointOrder::of(index, iteration), constants },
                context,
            );
        }
        for iteration in 0..iterations {
            let solve = contact::Solve { pass: Relax, order: PointOrder::of(index, iteration), constants };
            contacts.run_overflow(solve, context);
            velocities.exempt(context, || joints.solve(Relax, context));
            contacts.run_coloured(solve, context);
        }
        if !tuning.relax {
            contacts.run(Measure, context);
        }
        if contacts.may_bounce() {
            velocities.forget(context, || contacts.run(FastImpact::Withdraw, context));
            velocities.exempt(context, || contacts.bounce(context));
        }
        contacts.add_hits(context);
        if contacts.may_bounce() {
            contacts.run(FastImpact::Clear, context);
        }
    }
}
