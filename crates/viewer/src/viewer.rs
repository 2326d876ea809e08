//! [`Viewer`]: the viewer program of a game.

use std::process::ExitCode;
use std::rc::Rc;

use lockstep2d::draw::Layers;
use lockstep2d::inspect::fields;
use lockstep2d::lockstep::Game;
use lockstep2d::peer::PeerOptions;
use lockstep2d::replay::Limits;
use serde::Serialize;

use crate::app::{App, layers_at_first};
use crate::canvas::Canvas;
use crate::content::{Content, OpenReplay, OpenScene, Scene};
#[cfg(not(target_arch = "wasm32"))]
use crate::desktop;
use crate::play::{Bot, Controls, LocalMatch, Player, Presentation, listed};
use crate::source::{Replay, Source, SourceError};
#[cfg(target_arch = "wasm32")]
use crate::window;

/// The viewer program of a game, in a window or on a web page.
///
/// ```text
/// Viewer::<MyGame>::new().scene("hill", "a car on a hill", |seed| seed).keys(keys).run()
/// ```
///
/// A viewer without scenes shows replays, divergence reports and snapshots. In a scene, the players take the seats in
/// the order in which they were added to the viewer.
pub struct Viewer<G: Game> {
    pub(crate) name: String,
    pub(crate) about: String,
    pub(crate) scenes: Vec<SceneOf<G>>,
    first: Option<String>,
    pub(crate) players: Vec<Player<G>>,
    pub(crate) presentation: Presentation<G>,
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) online: Option<PeerOptions>,
    limits: Limits,
    layers: Layers,
}

pub(crate) struct SceneOf<G: Game> {
    pub(crate) name: String,
    about: String,
    pub(crate) kind: SceneKind<G>,
}

pub(crate) enum SceneKind<G: Game> {
    Setup(Rc<dyn Fn(u64) -> G::Setup>),
    /// A [`Source`] implemented by the game.
    Source(OpenScene),
}

impl<G: Game + 'static> Default for Viewer<G> {
    fn default() -> Self {
        Self::new()
    }
}

impl<G: Game + 'static> Viewer<G> {
    /// Creates a viewer without scenes. The name of the program is the name of the rules.
    #[must_use]
    pub fn new() -> Self {
        Viewer {
            name: G::RULES.name.to_owned(),
            about: format!("Plays {}, and shows its replays and snapshots", G::RULES.name),
            scenes: Vec::new(),
            first: None,
            players: Vec::new(),
            presentation: Presentation::default(),
            #[cfg(not(target_arch = "wasm32"))]
            online: None,
            limits: Limits::default(),
            layers: layers_at_first(),
        }
    }

    /// Sets the name of the program, for the title of the window and error messages.
    #[must_use]
    pub fn name(self, name: impl Into<String>) -> Self {
        Viewer { name: name.into(), ..self }
    }

    /// Sets the first line of the `--help` text.
    #[must_use]
    pub fn about(self, about: impl Into<String>) -> Self {
        Viewer { about: about.into(), ..self }
    }

    /// Adds a scene that can be played. The arguments are its name, its description, and a function that returns its
    /// setup for a random seed. The viewer starts with the first scene, unless [`Viewer::first`] names another.
    #[must_use]
    pub fn scene(
        mut self,
        name: impl Into<String>,
        about: impl Into<String>,
        setup: impl Fn(u64) -> G::Setup + 'static,
    ) -> Self {
        let kind = SceneKind::Setup(Rc::new(setup));
        self.scenes.push(SceneOf { name: name.into(), about: about.into(), kind });
        self
    }

    /// Adds a scene with its own [`Source`]. The players of the viewer do not take part in it.
    #[must_use]
    pub fn source(
        self,
        name: impl Into<String>,
        about: impl Into<String>,
        open: impl Fn(u64) -> Result<Box<dyn Source>, SourceError> + 'static,
    ) -> Self {
        self.limited_source(name, about, move |seed, _| open(seed))
    }

    /// Adds a scene with its own [`Source`]. `open` gets the random seed and the limits of the viewer.
    pub(crate) fn limited_source(
        mut self,
        name: impl Into<String>,
        about: impl Into<String>,
        open: impl Fn(u64, &Limits) -> Result<Box<dyn Source>, SourceError> + 'static,
    ) -> Self {
        let kind = SceneKind::Source(Rc::new(open));
        self.scenes.push(SceneOf { name: name.into(), about: about.into(), kind });
        self
    }

    /// Sets the scene that is shown at the start, by its name.
    #[must_use]
    pub fn first(self, scene: impl Into<String>) -> Self {
        Viewer { first: Some(scene.into()), ..self }
    }

    /// Adds a person at the keyboard. In a network match, the local player uses the keys of all persons.
    #[must_use]
    pub fn keys(mut self, controls: Controls<G::Input>) -> Self {
        self.players.push(Player::Keys(controls));
        self
    }

    /// Adds a bot. `bot` creates it; its arguments are the scene's random seed and the seat number, which counts from
    /// 0.
    #[must_use]
    pub fn bot(mut self, bot: impl Fn(u64, usize) -> Bot<G> + 'static) -> Self {
        self.players.push(Player::Bot(Rc::new(bot)));
        self
    }

    /// Sets a function that draws over the world.
    #[must_use]
    pub fn draw(mut self, draw: impl Fn(&G, &mut Canvas<'_>) + 'static) -> Self {
        self.presentation.draw = Rc::new(draw);
        self
    }

    /// Sets a function that returns a line of text about the game, such as its score.
    #[must_use]
    pub fn status(mut self, status: impl Fn(&G) -> String + 'static) -> Self {
        self.presentation.status = Rc::new(status);
        self
    }

    /// Sets a function that returns the game's own state for the inspector. By default, the inspector saves the game in
    /// every frame and lists the fields of [`Game::Save`] except those of the world.
    #[must_use]
    pub fn state<S: Serialize>(mut self, state: impl Fn(&G) -> S + 'static) -> Self {
        let list = move |game: &G| listed(&fields(&state(game)).unwrap_or_default());
        self.presentation.state = Rc::new(list);
        self
    }

    /// Sets the layers that are on at the start. The default is outlines and joints.
    #[must_use]
    pub fn layers(self, layers: Layers) -> Self {
        Viewer { layers, ..self }
    }

    /// Sets the limits for the replays that the viewer opens, and for the recordings of scenes that have a setup.
    /// Network matches are recorded without limits.
    #[must_use]
    pub fn limits(self, limits: Limits) -> Self {
        Viewer { limits, ..self }
    }

    /// Adds network matches over UDP, with the arguments `--host`, `--join` and `--watch`. A match plays the scene of
    /// `--scene`. Without this argument, it plays the first scene with a setup. `--lockstep`, `--rollback` and
    /// `--players` override `options`. Has no effect on a web page, which has neither sockets nor arguments.
    #[must_use]
    pub fn online(self, options: PeerOptions) -> Self {
        #[cfg(not(target_arch = "wasm32"))]
        let viewer = Viewer { online: Some(options), ..self };
        #[cfg(target_arch = "wasm32")]
        let (viewer, _) = (self, options);
        viewer
    }

    /// Runs the program with the arguments of this process, until its window is closed. On a web page, returns at once.
    ///
    /// The exit code is 0, or 2 after an error. The error is printed.
    #[must_use]
    pub fn run(self) -> ExitCode {
        #[cfg(not(target_arch = "wasm32"))]
        return self.run_with(std::env::args_os());
        #[cfg(target_arch = "wasm32")]
        return self.run_on_page();
    }

    /// Like [`Viewer::run`] on a desktop, with these arguments. The first argument is the program's name.
    #[cfg(not(target_arch = "wasm32"))]
    #[must_use]
    pub fn run_with<A>(self, arguments: impl IntoIterator<Item = A>) -> ExitCode
    where
        A: Into<std::ffi::OsString> + Clone,
    {
        desktop::run(self, arguments.into_iter().map(Into::into).collect())
    }

    #[cfg(target_arch = "wasm32")]
    fn run_on_page(self) -> ExitCode {
        let mut app = self.app();
        if let Some(first) = app.first_scene() {
            app.show_scene(&first, 0);
        }
        let options = window::Options { title: self.name, size: [0; 2], script: None, output: None };
        match window::show(app, options) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                miniquad::error!("{}", error);
                ExitCode::from(2)
            }
        }
    }

    /// Returns the viewer without a window and without a source, for tests and custom windows.
    #[must_use]
    pub fn app(&self) -> App {
        App::new(self.content())
    }

    fn content(&self) -> Content {
        let presentation = self.presentation.clone();
        let open: OpenReplay = Rc::new(move |name, bytes, limits| {
            let replay = Replay::<G>::open(name, bytes, limits)?;
            Ok(Box::new(replay.presented(presentation.clone())))
        });
        Content {
            scenes: self.scenes.iter().map(|scene| self.erased(scene)).collect(),
            first: self.first.clone(),
            rules: G::RULES.name,
            open,
            limits: self.limits.clone(),
            layers: self.layers,
        }
    }

    fn erased(&self, scene: &SceneOf<G>) -> Scene {
        let (name, about) = (scene.name.clone(), scene.about.clone());
        let open: OpenScene = match &scene.kind {
            SceneKind::Source(open) => Rc::clone(open),
            SceneKind::Setup(setup) => {
                let (setup, players) = (Rc::clone(setup), self.players.clone());
                let (name, presentation) = (name.clone(), self.presentation.clone());
                Rc::new(move |seed, limits| {
                    let local = LocalMatch::new(name.clone(), &setup(seed), &players, seed);
                    let local = local.map_err(SourceError::of)?;
                    Ok(Box::new(local.presented(presentation.clone()).limited(limits)))
                })
            }
        };
        Scene { name, about, open }
    }
}
