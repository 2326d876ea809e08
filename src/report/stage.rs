use core::fmt;

use crate::world::Phase;

/// The stage of a tick in which two equal states became different.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Before the world's step. Possible causes are different inputs, the rules of the game, code outside the rules
    /// that changes the state, or a memory error.
    BeforeStep,
    /// In a phase of the world's step.
    Phase(Phase),
    /// After the world's step, or in state outside the world.
    AfterStep,
}

impl Stage {
    /// The stage as one word, for other programs.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Stage::BeforeStep => "before_step",
            Stage::Phase(Phase::BroadPhase) => "broad_phase",
            Stage::Phase(Phase::NarrowPhase) => "narrow_phase",
            Stage::Phase(Phase::Prepare) => "prepare",
            Stage::Phase(Phase::Solve) => "solve",
            Stage::Phase(Phase::Finalise) => "finalise",
            Stage::Phase(Phase::Sleep) => "sleep",
            Stage::Phase(Phase::Report) => "report",
            Stage::AfterStep => "after_step",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stage::BeforeStep => "before the step of the world",
            Stage::Phase(Phase::BroadPhase) => "in the broad phase",
            Stage::Phase(Phase::NarrowPhase) => "in the narrow phase",
            Stage::Phase(Phase::Prepare) => "in the preparation of constraints",
            Stage::Phase(Phase::Solve) => "in the solver",
            Stage::Phase(Phase::Finalise) => "in the finalisation of poses",
            Stage::Phase(Phase::Sleep) => "while putting islands to sleep",
            Stage::Phase(Phase::Report) => "in the report of events",
            Stage::AfterStep => "after the step of the world",
        })
    }
}
