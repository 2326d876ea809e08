//! [`App`]: the state of the viewer. Input events and elapsed time change it, and it fills a draw list.

mod compare;
mod hand;
mod help;
mod input;
mod inspector;
mod layers;
mod player;
mod remark;
mod screen;
mod theme;
mod timeline;
mod view;

use std::fmt;
use std::time::Duration;

use lockstep2d::draw::Layers;
use lockstep2d::hash::StateHash;
use lockstep2d_render::DrawList;

pub use layers::LAYER_KEYS;
pub(crate) use layers::layers_at_first;

use crate::content::Content;
use crate::source::{OpenError, Source};
use compare::Comparison;
use hand::Hand;
use input::Pointer;
use inspector::Inspector;
use layers::LayerList;
use player::Player;
use remark::Remark;
use view::View;

/// The viewer: handles [`Event`](crate::Event)s, advances with elapsed time, and draws into a [`DrawList`].
///
/// ```
/// use std::time::Duration;
/// use lockstep2d_viewer::{App, Event, Key};
///
/// let mut app = App::default();
/// app.show_scene("pyramid", 0);
/// app.handle(Event::Resized([800.0, 600.0]));
/// app.advance(Duration::from_secs(1));
/// app.handle(Event::Pressed(Key::Space));
/// assert!(app.draw().items().len() > 100, "at least one item for each body");
/// assert!(app.report().to_string().starts_with("pyramid"));
/// ```
pub struct App {
    content: Content,
    source: Option<Box<dyn Source>>,
    comparison: Option<Comparison>,
    /// Name and contents of the shown file. A comparison opens the file again.
    file: Option<(String, &'static [u8])>,
    message: Option<Remark>,
    player: Player,
    view: View,
    layers: Layers,
    /// The layer list as it was last drawn, to find the layer that is clicked.
    layer_list: Option<LayerList>,
    inspector: Inspector,
    hand: Hand,
    pointer: Pointer,
    help: bool,
    size: [f32; 2],
    list: DrawList,
    requests: Vec<Request>,
}

/// Request to the host of the app, which has access to files.
///
/// ```
/// use lockstep2d_viewer::{App, Request};
///
/// let mut app = App::default();
/// app.show_scene("pendulum", 0);
/// app.save(); // as the key `s` does
/// for Request::Save { name, bytes } in app.take_requests() {
///     assert_eq!(name, "pendulum.replay");
///     # if false {
///     std::fs::write(name, bytes)?;
///     # }
/// }
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Write a file.
    Save {
        /// File name.
        name: String,
        /// Contents of the file.
        bytes: Vec<u8>,
    },
}

/// Description of what is shown.
///
/// ```
/// use lockstep2d_viewer::{App, Report};
///
/// let mut app = App::default();
/// app.show_scene("pendulum", 0);
/// app.advance(std::time::Duration::from_secs(1));
/// let Report { name, tick, ticks, .. } = app.report();
/// assert_eq!((name.as_str(), tick, ticks), ("pendulum", 60, None));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// Name of the source; "nothing" if there is no source.
    pub name: String,
    /// The current tick.
    pub tick: u64,
    /// The last tick; `None` if the source has no end.
    pub ticks: Option<u64>,
    /// Hash of the state at the current tick; `None` if there is no source.
    pub hash: Option<StateHash>,
    /// Verdict of a replay, errors and other messages.
    pub status: String,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} · tick {}", self.name, self.tick)?;
        self.ticks.map_or(Ok(()), |ticks| write!(f, " of {ticks}"))?;
        self.hash.map_or(Ok(()), |hash| write!(f, " · {hash}"))?;
        write!(f, " · {}", self.status)
    }
}

impl Default for App {
    /// The [sandbox](crate::sandbox) without a source.
    fn default() -> Self {
        crate::sandbox().app()
    }
}

impl App {
    pub(crate) fn new(content: Content) -> Self {
        let layers = content.layers;
        App {
            content,
            source: None,
            comparison: None,
            file: None,
            message: None,
            player: Player::default(),
            view: View::default(),
            layers,
            layer_list: None,
            inspector: Inspector::default(),
            hand: Hand::default(),
            pointer: Pointer::default(),
            help: false,
            size: [960.0, 720.0],
            list: DrawList::default(),
            requests: Vec::new(),
        }
    }

    /// Closes the current source and shows another one. Resets the comparison, the view, the selection and the
    /// playback.
    pub fn show(&mut self, source: Box<dyn Source>) {
        self.close();
        self.source = Some(source);
        (self.comparison, self.file, self.message) = (None, None, None);
        (self.player, self.view) = (Player::default(), View::default());
        (self.inspector, self.hand) = <_>::default();
        self.pointer.cease();
    }

    /// Shows a file: a replay, a divergence report or a snapshot.
    ///
    /// # Errors
    /// [`OpenError`], which is also shown as a message. The previous source then stays.
    pub fn show_file(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), OpenError> {
        // A source borrows its file for `'static`, so the bytes are never freed.
        let bytes: &'static [u8] = bytes.leak();
        let source = self.noted(name, self.content.open(name, bytes))?;
        self.show(source);
        self.file = Some((name.into(), bytes));
        Ok(())
    }

    /// Shows a second file over the current one, and searches for the first difference between them. If no file is
    /// shown, the second file is shown alone.
    ///
    /// # Errors
    /// [`OpenError`], which is also shown as a message. The previous source then stays.
    pub fn compare_with(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), OpenError> {
        let Some((first, first_bytes)) = self.file.clone() else { return self.show_file(name, bytes) };
        let bytes: &'static [u8] = bytes.leak();
        let other = self.noted(name, self.content.open(name, bytes))?;
        let mut scouts = [
            self.noted(&first, self.content.open(&first, first_bytes))?,
            self.noted(name, self.content.open(name, bytes))?,
        ];
        // The search starts at the first tick that both sources have. A snapshot may start at a later tick than a
        // replay, even after its end.
        let start = scouts.iter().map(|scout| scout.first()).max().unwrap_or(0);
        for scout in &mut scouts {
            let reached = scout.seek(start).map_err(OpenError::Tick);
            self.noted(scout.name(), reached)?;
            if scout.tick() != start {
                return self.noted(name, Err(OpenError::NoCommonTick { first }));
            }
        }
        self.message = None;
        self.comparison = Some(Comparison::new(other, scouts));
        self.follow_with_other();
        Ok(())
    }

    /// Shows a scene, or a message if it cannot be opened. Returns `false` if no scene has this name.
    pub fn show_scene(&mut self, name: &str, seed: u64) -> bool {
        let Some(scene) = self.content.scene(name) else { return false };
        match (scene.open)(seed, &self.content.limits) {
            Ok(source) => self.show(source),
            Err(error) => self.message = Some(Remark::error(format!("{name}: {error}"))),
        }
        true
    }

    /// Names and descriptions of all scenes.
    pub fn scenes(&self) -> impl Iterator<Item = (&str, &str)> {
        self.content.scenes.iter().map(|scene| (scene.name.as_str(), scene.about.as_str()))
    }

    /// Name of the scene that is shown at the start.
    #[must_use]
    pub fn first_scene(&self) -> Option<String> {
        self.content.first_scene().map(str::to_owned)
    }

    /// Plays the source for `time`, the real time since the last call, and continues background work.
    pub fn advance(&mut self, time: Duration) {
        let Some(source) = &mut self.source else { return };
        source.think();
        if let Err(error) = self.player.advance(time, source.as_mut()) {
            self.message = Some(Remark::error(error.to_string()));
        }
        if let Some(comparison) = &mut self.comparison {
            comparison.other.think();
            comparison.think();
        }
        self.follow_with_other();
    }

    /// Draws the current state and returns the draw list.
    pub fn draw(&mut self) -> &DrawList {
        screen::draw(self);
        &self.list
    }

    /// Describes what is shown.
    #[must_use]
    pub fn report(&self) -> Report {
        let Some(source) = &self.source else {
            let status = self.message().unwrap_or("drop a replay here").to_owned();
            return Report { name: "nothing".into(), tick: 0, ticks: None, hash: None, status };
        };
        Report {
            name: source.name().into(),
            tick: source.tick(),
            ticks: source.ticks(),
            hash: Some(source.hash()),
            // A message replaces the remarks. The message may be an error about another file. A verdict beside it would
            // then seem to refer to that file.
            status: self.message().map_or_else(|| self.status(), str::to_owned),
        }
    }

    /// Takes the requests made since the last call.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// Shows a message.
    pub fn tell(&mut self, message: String) {
        self.message = Some(Remark::plain(message));
    }

    /// The message that is shown.
    #[must_use]
    pub fn message(&self) -> Option<&str> {
        self.message.as_ref().map(|message| message.text.as_str())
    }

    fn remarks(&self) -> Vec<Remark> {
        let source = self.source.as_ref().map(|source| Remark::status_of(source.as_ref()));
        let comparison = self.comparison.as_ref().map(|comparison| Remark::plain(comparison.status()));
        let all = [source, comparison, self.message.clone()];
        all.into_iter().flatten().filter(|remark| !remark.text.is_empty()).collect()
    }

    fn status(&self) -> String {
        self.remarks().into_iter().map(|remark| remark.text).collect::<Vec<_>>().join(" · ")
    }

    /// Shows the error of a result as a message about `name`. Returns the result.
    fn noted<T>(&mut self, name: &str, result: Result<T, OpenError>) -> Result<T, OpenError> {
        result.inspect_err(|error| self.message = Some(Remark::error(format!("{name}: {error}"))))
    }

    fn follow_with_other(&mut self) {
        let (Some(source), Some(comparison)) = (&self.source, &mut self.comparison) else { return };
        let end = comparison.other.ticks().unwrap_or(u64::MAX);
        if let Err(error) = comparison.other.seek(source.tick().min(end)) {
            self.message = Some(Remark::error(format!("{}: {error}", comparison.other.name())));
        }
    }

    /// Shows the scene that is `by` places further in the list. After the last scene comes the first.
    fn show_neighbour(&mut self, by: usize) {
        let name = self.source.as_ref().map_or("", |source| source.name());
        let scenes = &self.content.scenes;
        let here = scenes.iter().position(|scene| scene.name == name).unwrap_or(0);
        let next = scenes.iter().cycle().nth(here + by).map(|scene| scene.name.clone());
        if let Some(next) = next {
            self.show_scene(&next, 0);
        }
    }

    /// Closes the source, for example leaves a network match. Must be called before the program ends.
    pub fn close(&mut self) {
        if let Some(source) = &mut self.source {
            source.close();
        }
    }

    /// Requests that the recording is saved as a replay. Shows a message if nothing is recorded.
    pub fn save(&mut self) {
        let Some(source) = &mut self.source else { return };
        let name = format!("{}.replay", source.name());
        match source.save_replay() {
            None => self.message = Some(Remark::plain("nothing to save: this source is not recorded")),
            Some(Ok(bytes)) => {
                self.message = Some(Remark::plain(format!("{name}: {} ticks saved", source.recorded())));
                self.requests.push(Request::Save { name, bytes });
            }
            Some(Err(error)) => self.message = Some(Remark::error(error.to_string())),
        }
    }
}
