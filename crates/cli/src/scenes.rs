//! [`Catalogue`]: the scenes of a game, for `scenes` and `record`.

use lockstep2d::lockstep::Game;

/// A function that returns the inputs of all players for a tick. Its arguments are the number of the tick and the game
/// before the tick.
pub type Script<G> = Box<dyn FnMut(u64, &G) -> Vec<<G as Game>::Input>>;

/// The scenes of a game.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// use lockstep2d_cli::{Catalogue, Scene, SceneInfo};
/// # use lockstep2d::{body::BodyDef, world::Command};
/// /// The levels of a game; here, of the sandbox.
/// struct Levels;
/// impl Catalogue<Sandbox> for Levels {
///     fn scenes(&self) -> Vec<SceneInfo> {
///         vec![SceneInfo { name: "empty", about: "somebody adds a body a second", ticks: 600 }]
///     }
///     fn open(&self, name: &str, _seed: u64) -> Option<Scene<Sandbox>> {
///         let spawn = Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] };
///         let script = move |tick, _: &_| vec![if tick % 60 == 0 { vec![spawn.clone()] } else { vec![] }];
///         let scene = || Scene { setup: SandboxSetup::default(), ticks: 600, script: Box::new(script) };
///         (name == "empty").then(scene)
///     }
/// }
/// let mut scene = Levels.open("empty", 0).expect("it is in the list");
/// let mut game = Sandbox::new(&scene.setup).expect("a valid setup");
/// (0..scene.ticks).for_each(|tick| {
///     let inputs = (scene.script)(tick, &game);
///     game.step(&inputs);
/// });
/// assert_eq!(game.world().body_count(), 10);
/// ```
pub trait Catalogue<G: Game> {
    /// All scenes, in the order in which the command `scenes` prints them.
    fn scenes(&self) -> Vec<SceneInfo>;

    /// Opens the scene of this name, if there is one. Calls with equal names and seeds must return equal scenes.
    fn open(&self, name: &str, seed: u64) -> Option<Scene<G>>;
}

/// The description of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneInfo {
    /// The name, as in [`Catalogue::open`].
    pub name: &'static str,
    /// One-line description.
    pub about: &'static str,
    /// The default number of ticks to record: [`Scene::ticks`].
    pub ticks: u64,
}

/// A scene that can be recorded.
pub struct Scene<G: Game> {
    /// The setup of the game.
    pub setup: G::Setup,
    /// The default number of ticks to record.
    pub ticks: u64,
    /// Returns the inputs of the players for each tick.
    pub script: Script<G>,
}
