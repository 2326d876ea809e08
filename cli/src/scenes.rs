//! [`Catalogue`]: the scenes of a game, for `scenes` and `record`.

use lockstep2d::lockstep::Game;

/// The inputs of all players for a tick, given its number and the game before it.
pub type Script<G> = Box<dyn FnMut(u64, &G) -> Vec<<G as Game>::Input>>;

/// The scenes of a game.
pub trait Catalogue<G: Game> {
    /// What there is, in the order in which to list it.
    fn scenes(&self) -> Vec<SceneInfo>;

    /// The scene of this name, or `None` if there is none. The same name and seed give the same scene.
    fn open(&self, name: &str, seed: u64) -> Option<Scene<G>>;
}

/// What a list says of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneInfo {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in a line.
    pub about: &'static str,
    /// For how many ticks it is recorded if nobody says otherwise.
    pub ticks: u64,
}

/// A scene to record.
pub struct Scene<G: Game> {
    /// What the game starts from.
    pub setup: G::Setup,
    /// For how many ticks it is recorded if nobody says otherwise.
    pub ticks: u64,
    /// What the players do.
    pub script: Script<G>,
}
