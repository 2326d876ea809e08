//! [`sandbox`]: the viewer of the plain physics world.

use lockstep2d::lockstep::Sandbox;
use lockstep2d_scenes::ALL;

use crate::live::Live;
use crate::source::{Source, SourceError};
use crate::viewer::Viewer;

/// Name of the scene that is shown at the start.
const FIRST: &str = "ragdoll";

/// Returns the viewer of the sandbox: its scenes are live worlds in which the user can act.
#[must_use]
pub fn sandbox() -> Viewer<Sandbox> {
    let viewer = Viewer::new()
        .name("lockstep2d-viewer")
        .about("Shows replays, snapshots and live scenes of lockstep2d");
    let with_scenes = ALL.iter().fold(viewer, |viewer, scene| {
        viewer.limited_source(scene.name, scene.about, move |seed, limits| {
            let live = Live::scene(scene, seed).map_err(SourceError::of)?;
            Ok(Box::new(live.limited(limits)) as Box<dyn Source>)
        })
    });
    with_scenes.first(FIRST)
}
