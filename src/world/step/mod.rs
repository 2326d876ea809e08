mod areas;
mod contact_events;
mod continuous;
mod finalise;
mod first_impacts;
mod impact;
mod joint_thresholds;
mod motion;
mod narrow_phase;
mod pair_update;
mod passing;
mod phases;
mod recycle;
mod refit;
mod report;
mod sensor_events;
mod sleep;
mod solver_work;
mod speculative;
mod wake;

use super::World;
use super::cache::Scratch;
use super::stats::Phase;
use crate::solver::Tuning;
use phases::PhaseView;

impl World {
    /// Advances the world by one tick of `1 / tick_rate` seconds.
    #[doc(alias = "simulate")]
    pub fn step(&mut self) {
        if self.phases.is_some() {
            self.step_with_phase_log();
        } else {
            self.advance(|_, _| {});
        }
    }

    /// Like [`World::step`], but calls `begin` at the beginning of each phase. The tick adds nothing to
    /// [`World::phase_digests`].
    ///
    /// ```
    /// # use lockstep2d::world::World;
    /// let mut phases = Vec::new();
    /// World::default().step_observed(|phase| phases.push(phase));
    /// assert_eq!(phases.len(), 7);
    /// ```
    #[doc(alias = "profile")]
    pub fn step_observed(&mut self, mut begin: impl FnMut(Phase)) {
        self.advance(|phase, _| begin(phase));
    }

    fn advance(&mut self, begin: impl FnMut(Phase, PhaseView<'_>)) {
        let threads = self.scratch.solver.threads.clone();
        let bodies = self.scratch.awake.bodies().len();
        threads.run_tick(bodies, |parts| self.run_phases(parts, begin));
    }

    /// Simulates a tick on `parts` threads. Calls `begin` at the beginning of each phase, with a view of the results of
    /// the earlier phases.
    fn run_phases(&mut self, parts: usize, mut begin: impl FnMut(Phase, PhaseView<'_>)) {
        let World { state, scratch, phases: _ } = self;
        let state = &mut **state;
        scratch.solver.parts = parts;
        let settings = state.config.solver;
        let pairs_before = solver_work::pairs(state);
        let tuning = Tuning::new(&settings, state.config.gravity, state.config.tick_rate);

        begin(Phase::BroadPhase, PhaseView::of(state, scratch));
        scratch.awake.refresh(state);
        refit::refit_boxes(state, scratch);
        pair_update::update_pairs(state, scratch);
        if wake::wake_touched(state, scratch) {
            pair_update::update_pairs(state, scratch);
        }
        scratch.awake.refresh(state);

        begin(Phase::NarrowPhase, PhaseView::of(state, scratch));
        narrow_phase::find_manifolds(state, scratch);

        begin(Phase::Prepare, PhaseView::of(state, scratch));
        let Scratch { solver, awake, contacts, .. } = scratch;
        let output = contacts.output();
        solver.prepare_bodies(&state.bodies, awake.bodies(), &tuning);
        solver.prepare_joints(&state.joints, awake.joints(), &state.bodies, &tuning);
        solver.prepare_contacts(&output.touching, &output.manifolds, &state.contacts, &tuning);
        areas::apply_areas(state, scratch, &tuning);
        let can_solve = solver_work::spend(state, scratch, pairs_before);
        let Scratch { solver, .. } = scratch;
        if can_solve {
            solver.prepare_blocks(&tuning);
        }

        begin(Phase::Solve, PhaseView::of(state, scratch));
        let Scratch { solver, .. } = scratch;
        let first_sub_step = state.tick.wrapping_mul(settings.sub_steps.into());
        // If the work budget does not cover the sub-steps, the tick skips them. The state is then wrong, and the caller
        // that has set the budget discards it.
        let sub_steps = if can_solve { settings.sub_steps } else { 0 };
        solver.sub_steps(first_sub_step, sub_steps, &tuning, &mut state.contacts);
        solver.store_joints(&mut state.joints);

        begin(Phase::Finalise, PhaseView::of(state, scratch));
        contact_events::report_contacts(state, scratch);
        finalise::finalise_poses(state, scratch);
        sensor_events::report_sensors(state, scratch);
        joint_thresholds::report_joints(state, scratch, &tuning);

        begin(Phase::Sleep, PhaseView::of(state, scratch));
        sleep::fall_asleep(state, scratch);

        begin(Phase::Report, PhaseView::of(state, scratch));
        report::report_moves(state, scratch);
        report::count(state, scratch);
        // Wraps, because a decoded snapshot may have any tick, even `u64::MAX`.
        state.tick = state.tick.wrapping_add(1);
    }
}
