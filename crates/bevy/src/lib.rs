//! Deterministic 2D physics, rollback multiplayer and replays for Bevy, on [`lockstep2d`].
//!
//! The simulation is one resource, [`Lockstep<G>`](Lockstep), for any [`Game`](lockstep2d::lockstep::Game). A driver
//! plays it: [local](Lockstep::local), a [replay](Lockstep::replay), a [match](Lockstep::host) over a network, or a
//! [sync test](Lockstep::sync_test).
//!
//! Entities are *views* of the bodies in the game. The plugin writes interpolated poses to their `Transform`s, and
//! never reads a pose from there. Bevy changes the simulation only through [`Inputs`], and no component needs to be
//! registered for rollback.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_lockstep2d::prelude::*;
//! use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
//! use lockstep2d::{fx, lockstep::{Sandbox, SandboxSetup}, world::Command};
//!
//! let spawn = |body, shape| Command::Spawn { body, shapes: vec![ShapeDef::new(shape)] };
//! let ground = Polygon::rectangle(fx!(20), fx!(1))?;
//! let ball = Geometry::circle(fx!(0.5))?;
//! let commands = vec![
//!     spawn(BodyDef::fixed(), Geometry::from(ground)),
//!     spawn(BodyDef::dynamic().position((fx!(0), fx!(4))), ball),
//! ];
//! let game = Lockstep::<Sandbox>::local(&SandboxSetup { commands, ..SandboxSetup::default() })?;
//!
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, LockstepPlugin::<Sandbox>::default())).insert_resource(game);
//! app.update();
//! let mut views = app.world_mut().query::<(&BodyView, &Transform)>();
//! assert_eq!(views.iter(app.world()).count(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The systems of [`LockstepPlugin`] run in the schedule `RunFixedMainLoop`, in the sets of [`LockstepSystems`].
//! Systems that fill [`Inputs`] belong in [`LockstepSystems::Inputs`].

// Floats are allowed here, because views affect a game only through its inputs.
#![deny(missing_docs, clippy::iter_over_hash_type, clippy::unwrap_used)]
#![warn(unreachable_pub)]

mod diagnostics;
mod drag;
mod drivers;
mod error;
mod events;
mod game;
#[cfg(feature = "gizmos")]
mod gizmos;
mod inputs;
mod level;
mod lockstep;
mod observed;
#[cfg(feature = "picking")]
mod picking;
mod plugin;
mod poses;
mod smoothing;
mod step_log;
mod systems;
mod views;

pub use diagnostics::LockstepDiagnosticsPlugin;
pub use drag::{DragHand, DragPlugin, to_metres};
pub use drivers::AnyTransport;
pub use error::{LockstepError, LockstepFailed};
pub use events::{BodyEvent, ConfirmedEvent, MatchEvent, PredictedEvent, RetractedEvent, WorldEvent};
pub use game::LockstepGame;
#[cfg(feature = "gizmos")]
pub use gizmos::{LockstepGizmos, LockstepGizmosPlugin};
pub use inputs::Inputs;
pub use level::{LevelError, SpawnBody, SpawnJoint, build_level};
pub use lockstep::{DriverKind, Lockstep};
pub use observed::{Observed, ObservedSave};
#[cfg(feature = "picking")]
pub use picking::{LockstepPickingPlugin, PointerDragPlugin};
pub use plugin::{
    LockstepPlugin, LockstepSettings, LockstepStatus, LockstepSystems, has_lockstep, has_rolled_back,
    has_stepped, is_running,
};
pub use poses::Pose;
pub use views::{BodyView, BodyViews};

/// The types that most programs need.
pub mod prelude {
    pub use crate::{
        BodyEvent, BodyView, BodyViews, ConfirmedEvent, Inputs, Lockstep, LockstepPlugin, LockstepSettings,
        LockstepStatus, LockstepSystems, MatchEvent, PredictedEvent, WorldEvent, has_lockstep,
        has_rolled_back, has_stepped, is_running,
    };
}

// The examples of README.md use gizmos.
#[cfg(all(doctest, feature = "gizmos"))]
#[doc = include_str!("../README.md")]
mod readme {}
