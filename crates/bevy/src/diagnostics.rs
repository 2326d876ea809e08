//! [`LockstepDiagnosticsPlugin`]: figures for Bevy's diagnostics.

use core::marker::PhantomData;

use bevy::app::{App, Plugin, Update};
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::{IntoScheduleConfigs, Local, Res, resource_exists};
use lockstep2d::codec;

use crate::game::LockstepGame;
use crate::lockstep::Lockstep;
use crate::plugin::LockstepStatus;

/// Measures the diagnostics whose paths are the constants of this type. `LogDiagnosticsPlugin`, for example, prints
/// them.
#[derive(Clone, Copy, Debug)]
pub struct LockstepDiagnosticsPlugin<G>(PhantomData<fn() -> G>);

impl<G> Default for LockstepDiagnosticsPlugin<G> {
    fn default() -> Self {
        LockstepDiagnosticsPlugin(PhantomData)
    }
}

impl<G> LockstepDiagnosticsPlugin<G> {
    /// Time that the driver takes in a frame, in milliseconds: [`LockstepStatus::step_time`].
    pub const STEP: DiagnosticPath = DiagnosticPath::const_new("lockstep/step");
    /// Largest number of ticks by which a rollback went back in a frame.
    pub const ROLLBACK: DiagnosticPath = DiagnosticPath::const_new("lockstep/rollback");
    /// Number of played ticks that are not confirmed.
    pub const PREDICTED: DiagnosticPath = DiagnosticPath::const_new("lockstep/predicted");
    /// Bytes of a save, measured every 64 frames.
    pub const SAVE: DiagnosticPath = DiagnosticPath::const_new("lockstep/save");
    /// Longest round trip to another player, or to the dedicated server of a match, in milliseconds.
    pub const PING: DiagnosticPath = DiagnosticPath::const_new("lockstep/ping");
}

impl<G: LockstepGame> Plugin for LockstepDiagnosticsPlugin<G> {
    fn build(&self, app: &mut App) {
        app.register_diagnostic(Diagnostic::new(Self::STEP).with_suffix("ms"))
            .register_diagnostic(Diagnostic::new(Self::ROLLBACK).with_suffix(" ticks"))
            .register_diagnostic(Diagnostic::new(Self::PREDICTED).with_suffix(" ticks"))
            .register_diagnostic(Diagnostic::new(Self::SAVE).with_suffix(" bytes"))
            .register_diagnostic(Diagnostic::new(Self::PING).with_suffix("ms"))
            .add_systems(Update, measure::<G>.run_if(resource_exists::<Lockstep<G>>));
    }
}

/// Number of frames between two measurements of the size of a save. Each measurement encodes a save, which takes time.
const SAVE_INTERVAL: u32 = 64;

fn measure<G: LockstepGame>(
    lockstep: Res<Lockstep<G>>,
    status: Res<LockstepStatus>,
    mut frame: Local<u32>,
    mut diagnostics: Diagnostics,
) {
    type Paths<G> = LockstepDiagnosticsPlugin<G>;
    diagnostics.add_measurement(&Paths::<G>::STEP, || status.step_time.as_secs_f64() * 1e3);
    diagnostics.add_measurement(&Paths::<G>::ROLLBACK, || status.rolled_back.into());
    diagnostics
        .add_measurement(&Paths::<G>::PREDICTED, || status.tick.saturating_sub(status.confirmed) as f64);
    if frame.is_multiple_of(SAVE_INTERVAL) {
        diagnostics
            .add_measurement(&Paths::<G>::SAVE, || codec::encode(&lockstep.game().save()).len() as f64);
    }
    *frame = frame.wrapping_add(1);
    let Some(session) = lockstep.peer().and_then(|peer| peer.session()) else { return };
    let links = session.view().voters.iter().filter_map(|voter| session.link(voter.id));
    if let Some(longest) = links.map(|link| link.round_trip).max() {
        diagnostics.add_measurement(&Paths::<G>::PING, || longest as f64 * 1e-3);
    }
}
