//! [`Catalogue`]: the scenes of a game, for `scenes` and `record`.

use lockstep2d::lockstep::Game;

/// The inputs of all players for a tick, given its number and the game before it.
pub type Script<G> = Box<dyn FnMut(u64, &G) -> Vec<<G as Game>::Input>>;

/// The scenes of a game.
pub trait Catalogue<G: Game> {
    /// All scenes, in the order in which to list them.
    fn scenes(&self) -> Vec<SceneInfo>;

    /// Opens the scene of this name, or returns `None` if there is none. The same name and seed give the same scene.
    fn open(&self, name: &str, seed: u64) -> Option<Scene<G>>;
}

/// The description of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneInfo {
    /// The name.
    pub name: &'static str,
    /// One-line description.
    pub about: &'static str,
    /// The default number of ticks to record.
    pub ticks: u64,
}

/// A scene that can be recorded.
pub struct Scene<G: Game> {
    /// The setup of the game.
    pub setup: G::Setup,
    /// The default number of ticks to record.
    pub ticks: u64,
    /// The inputs of the players.
    pub script: Script<G>,
}
