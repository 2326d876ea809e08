//! [`LockstepPlugin`], its settings and its system sets.

use core::marker::PhantomData;
use core::time::Duration;

use bevy::app::{App, Plugin, RunFixedMainLoop, RunFixedMainLoopSystems};
use bevy::prelude::{
    IntoScheduleConfigs, Reflect, ReflectResource, Res, Resource, SystemSet, not, resource_exists,
    resource_removed,
};

use crate::error::LockstepFailed;
use crate::events::{ConfirmedEvent, MatchEvent, PredictedEvent, RetractedEvent};
use crate::game::LockstepGame;
use crate::inputs::Inputs;
use crate::lockstep::Lockstep;
use crate::systems::{begin_inputs, clear_status, remove_views, send_events, step, write_views};
use crate::views::{BodyView, BodyViews};

/// Plays the resource [`Lockstep<G>`] while there is one, shows its bodies as views, and sends its events. An app can
/// have one such plugin, because [`BodyViews`] and [`LockstepStatus`] belong to a single game.
#[derive(Clone, Copy, Debug)]
pub struct LockstepPlugin<G> {
    settings: LockstepSettings,
    game: PhantomData<fn() -> G>,
}

impl<G> Default for LockstepPlugin<G> {
    fn default() -> Self {
        LockstepPlugin { settings: LockstepSettings::default(), game: PhantomData }
    }
}

impl<G> LockstepPlugin<G> {
    /// Sets the scale of the views.
    #[must_use]
    pub const fn pixels_per_metre(mut self, pixels: f32) -> Self {
        self.settings.pixels_per_metre = pixels;
        self
    }

    /// Sets all settings.
    #[must_use]
    pub const fn settings(mut self, settings: LockstepSettings) -> Self {
        self.settings = settings;
        self
    }
}

/// Settings of views, which can be changed at any time.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource)]
pub struct LockstepSettings {
    /// Units of `Transform` per metre. A unit is a pixel in Bevy's default 2D camera.
    pub pixels_per_metre: f32,
    /// Whether views are interpolated between the last two ticks. Interpolated views are up to a tick late.
    pub interpolate: bool,
    /// Time in which the displacement of a view halves after a rollback has moved its body. Zero moves the view at
    /// once.
    pub smoothing_half_life: Duration,
    /// Displacements above this limit, in metres, are jumps without smoothing or interpolation. The limit applies to
    /// displacements by a rollback, and to movements in a tick that are more than twice as far as the body's speed
    /// explains.
    pub smoothing_limit: f32,
}

impl Default for LockstepSettings {
    /// 100 pixels per metre, interpolation, a half-life of 40 ms, and jumps above 2 m.
    fn default() -> Self {
        LockstepSettings {
            pixels_per_metre: 100.0,
            interpolate: true,
            smoothing_half_life: Duration::from_millis(40),
            smoothing_limit: 2.0,
        }
    }
}

impl LockstepSettings {
    /// Draws views exactly where the bodies are, for tests and screenshots.
    #[must_use]
    pub const fn exact(mut self) -> Self {
        self.interpolate = false;
        self.smoothing_half_life = Duration::ZERO;
        self
    }
}

/// Status of the game, updated in each frame. Has its default value while there is no game.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource)]
pub struct LockstepStatus {
    /// Number of ticks played.
    pub tick: u64,
    /// Number of confirmed ticks, which no rollback can change.
    pub confirmed: u64,
    /// Number of ticks played in this frame, including repeated ones.
    pub stepped: u32,
    /// Largest number of ticks that a rollback in this frame went back.
    pub rolled_back: u32,
    /// Whether the game is paused.
    pub paused: bool,
    /// Time that the driver took in this frame.
    pub step_time: Duration,
}

/// System sets of the plugin in `RunFixedMainLoop`, in the order in which they run.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LockstepSystems {
    /// Systems of the game that fill [`Inputs`], once a frame.
    Inputs,
    /// The driver plays ticks: none, one, or several.
    Step,
    /// The plugin spawns, moves and despawns views.
    Views,
    /// The plugin sends events.
    Events,
}

impl<G: LockstepGame> Plugin for LockstepPlugin<G> {
    fn build(&self, app: &mut App) {
        use LockstepSystems::{Events, Inputs as InputSystems, Step, Views};
        app.insert_resource(self.settings)
            .init_resource::<LockstepStatus>()
            .init_resource::<BodyViews>()
            .init_resource::<Inputs<G>>()
            .add_message::<ConfirmedEvent>()
            .add_message::<PredictedEvent>()
            .add_message::<RetractedEvent>()
            .add_message::<MatchEvent>()
            .add_message::<LockstepFailed>()
            .register_type::<BodyView>()
            .register_type::<LockstepSettings>()
            .register_type::<LockstepStatus>()
            .configure_sets(
                RunFixedMainLoop,
                (InputSystems, Step, Views, Events).chain().in_set(RunFixedMainLoopSystems::FixedMainLoop),
            )
            .add_systems(
                RunFixedMainLoop,
                (
                    begin_inputs::<G>
                        .in_set(RunFixedMainLoopSystems::FixedMainLoop)
                        .before(InputSystems)
                        .run_if(resource_exists::<Lockstep<G>>),
                    step::<G>.in_set(Step).run_if(resource_exists::<Lockstep<G>>),
                    clear_status.in_set(Step).run_if(not(resource_exists::<Lockstep<G>>)),
                    (
                        write_views::<G>.run_if(resource_exists::<Lockstep<G>>),
                        remove_views.run_if(resource_removed::<Lockstep<G>>),
                    )
                        .in_set(Views),
                    send_events::<G>.in_set(Events).run_if(resource_exists::<Lockstep<G>>),
                ),
            );
    }
}

/// Run condition: there is a game.
pub fn has_lockstep<G: LockstepGame>(lockstep: Option<Res<Lockstep<G>>>) -> bool {
    lockstep.is_some()
}

/// Run condition: there is a game, and it is neither paused nor stopped by an error.
pub fn is_running<G: LockstepGame>(lockstep: Option<Res<Lockstep<G>>>) -> bool {
    lockstep.is_some_and(|lockstep| !lockstep.is_paused() && lockstep.failure().is_none())
}

/// Run condition: ticks were played in this frame.
pub fn has_stepped(status: Res<LockstepStatus>) -> bool {
    status.stepped > 0
}

/// Run condition: there was a rollback in this frame.
pub fn has_rolled_back(status: Res<LockstepStatus>) -> bool {
    status.rolled_back > 0
}
