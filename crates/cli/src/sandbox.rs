//! The sandbox's scenes, for the `lockstep2d` command.

use lockstep2d::lockstep::Sandbox;

use crate::scenes::{Catalogue, Scene, SceneInfo};

/// The scenes that come with the engine.
///
/// ```
/// use lockstep2d::lockstep::Sandbox;
/// use lockstep2d_cli::{Exit, SandboxScenes, Tool};
/// let (mut out, mut err) = (vec![], vec![]);
/// let tool = Tool::<Sandbox>::new().with_scenes(SandboxScenes);
/// assert_eq!(tool.run_with(["lockstep2d", "scenes"], &mut out, &mut err), Exit::Success);
/// assert!(String::from_utf8_lossy(&out).contains("pyramid"));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct SandboxScenes;

impl Catalogue<Sandbox> for SandboxScenes {
    fn scenes(&self) -> Vec<SceneInfo> {
        let info = |scene: &lockstep2d_scenes::Scene| SceneInfo {
            name: scene.name,
            about: scene.about,
            ticks: scene.ticks,
        };
        lockstep2d_scenes::ALL.iter().map(info).collect()
    }

    fn open(&self, name: &str, seed: u64) -> Option<Scene<Sandbox>> {
        let scene = lockstep2d_scenes::Scene::find(name)?;
        let script = |tick: u64, game: &Sandbox| vec![scene.commands(tick, game)];
        Some(Scene { setup: scene.setup(seed), ticks: scene.ticks, script: Box::new(script) })
    }
}
