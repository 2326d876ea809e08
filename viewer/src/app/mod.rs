//! [`App`]: everything between a person and a world.

mod compare;
mod hand;
mod help;
mod input;
mod inspector;
mod layers;
mod player;
mod screen;
mod theme;
mod timeline;
mod view;

use std::fmt;
use std::time::Duration;

use lockstep2d::draw::Layers;
use lockstep2d::hash::StateHash;
use lockstep2d::scenes::{self, Scene};
use lockstep2d_picture::DrawList;

pub use layers::LAYER_KEYS;

use crate::live::Live;
use crate::source::{OpenError, Source, open};
use compare::Comparison;
use hand::Hand;
use input::Pointer;
use inspector::Inspector;
use layers::LayerList;
use player::Player;
use view::View;

/// The viewer: it takes notice of [`Event`](crate::Event)s, lets time pass, and says what there is to see.
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
/// assert!(app.draw().items().len() > 100, "a box for each body, and the rest");
/// assert!(app.report().to_string().starts_with("pyramid"));
/// ```
pub struct App {
    source: Option<Box<dyn Source>>,
    comparison: Option<Comparison>,
    /// The file that is shown, to open it again beside another one.
    file: Option<(String, &'static [u8])>,
    /// What the last thing that went wrong, or was saved, has to say.
    message: Option<String>,
    player: Player,
    view: View,
    layers: Layers,
    /// Where the layers were last listed, to be clicked.
    layer_list: Option<LayerList>,
    inspector: Inspector,
    hand: Hand,
    pointer: Pointer,
    help: bool,
    size: [f32; 2],
    list: DrawList,
    requests: Vec<Request>,
}

/// What somebody with files has to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Write a file.
    Save {
        /// What to call it.
        name: String,
        /// What is in it.
        bytes: Vec<u8>,
    },
}

/// What is shown, in words: for a line of text beside the picture, and for tests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// What is shown.
    pub name: String,
    /// Where it is.
    pub tick: u64,
    /// The last tick, if there is one.
    pub ticks: Option<u64>,
    /// The hash of the state.
    pub hash: Option<StateHash>,
    /// Whether it verifies, what went wrong.
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
    /// With nothing to show yet.
    fn default() -> Self {
        App {
            source: None,
            comparison: None,
            file: None,
            message: None,
            player: Player::default(),
            view: View::default(),
            layers: layers::AT_FIRST,
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
}

impl App {
    /// Shows something, from its start.
    pub fn show(&mut self, source: Box<dyn Source>) {
        self.source = Some(source);
        (self.comparison, self.file, self.message) = (None, None, None);
        (self.player, self.view) = (Player::default(), View::default());
        (self.inspector, self.hand, self.pointer) = <_>::default();
    }

    /// Shows a file: a replay, a report of a divergence, or a snapshot.
    ///
    /// # Errors
    /// [`OpenError`], which is shown too. What was there before stays.
    pub fn show_file(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), OpenError> {
        // What is shown borrows the file for as long as the program runs.
        let bytes: &'static [u8] = bytes.leak();
        let source = self.noted(name, open(name, bytes))?;
        self.show(source);
        self.file = Some((name.into(), bytes));
        Ok(())
    }

    /// Shows a second file over the one that is shown, at the same ticks, and looks for the first difference.
    ///
    /// # Errors
    /// [`OpenError`], which is shown too. What was there before stays.
    pub fn compare_with(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), OpenError> {
        let Some((first, first_bytes)) = self.file.clone() else { return self.show_file(name, bytes) };
        let bytes: &'static [u8] = bytes.leak();
        let other = self.noted(name, open(name, bytes))?;
        let mut scouts = [open(&first, first_bytes)?, open(name, bytes)?];
        self.message = None;
        // A snapshot begins later than a replay.
        let start = scouts.iter().map(|scout| scout.first()).max().unwrap_or(0);
        for scout in &mut scouts {
            if let Err(error) = scout.seek(start) {
                self.message = Some(format!("{}: {error}", scout.name()));
            }
        }
        self.comparison = Some(Comparison::new(other, scouts));
        self.follow_with_other();
        Ok(())
    }

    /// Shows a scene in which one can act. `false` if there is none of this name.
    pub fn show_scene(&mut self, name: &str, seed: u64) -> bool {
        let Some(scene) = Scene::find(name) else { return false };
        match Live::scene(scene, seed) {
            Ok(live) => self.show(Box::new(live)),
            Err(error) => self.message = Some(format!("{name}: {error}")),
        }
        true
    }

    /// Lets time pass.
    pub fn advance(&mut self, time: Duration) {
        let Some(source) = &mut self.source else { return };
        source.think();
        if let Err(error) = self.player.advance(time, source.as_mut()) {
            self.message = Some(error.to_string());
        }
        if let Some(comparison) = &mut self.comparison {
            comparison.other.think();
            comparison.think();
        }
        self.follow_with_other();
    }

    /// What there is to see now.
    pub fn draw(&mut self) -> &DrawList {
        screen::draw(self);
        &self.list
    }

    /// What is shown, in words.
    #[must_use]
    pub fn report(&self) -> Report {
        let Some(source) = &self.source else {
            let status = self.message.clone().unwrap_or_else(|| "drop a replay here".into());
            return Report { name: "nothing".into(), tick: 0, ticks: None, hash: None, status };
        };
        Report {
            name: source.name().into(),
            tick: source.tick(),
            ticks: source.ticks(),
            hash: Some(source.hash()),
            // A verdict beside what went wrong with another file would seem to be about that one.
            status: self.message.clone().unwrap_or_else(|| self.remarks().join(" · ")),
        }
    }

    /// What somebody with files has to do since the last time.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// Shows a message, such as what went wrong with a file that was to be saved.
    pub fn tell(&mut self, message: String) {
        self.message = Some(message);
    }

    /// What there is to say about what is shown, and about what has just been done.
    fn remarks(&self) -> Vec<String> {
        let source = self.source.as_ref().map(|source| source.status());
        let comparison = self.comparison.as_ref().map(Comparison::status);
        let all = [source, comparison, self.message.clone()];
        all.into_iter().flatten().filter(|remark| !remark.is_empty()).collect()
    }

    /// Shows what went wrong with a file.
    fn noted<T>(&mut self, name: &str, result: Result<T, OpenError>) -> Result<T, OpenError> {
        result.inspect_err(|error| self.message = Some(format!("{name}: {error}")))
    }

    fn follow_with_other(&mut self) {
        let (Some(source), Some(comparison)) = (&self.source, &mut self.comparison) else { return };
        let end = comparison.other.ticks().unwrap_or(u64::MAX);
        if let Err(error) = comparison.other.seek(source.tick().min(end)) {
            self.message = Some(format!("{}: {error}", comparison.other.name()));
        }
    }

    /// Shows the scene that is so many further in the list, round and round.
    fn show_neighbour(&mut self, by: usize) {
        let name = self.source.as_ref().map_or("", |source| source.name());
        let here = scenes::ALL.iter().position(|scene| scene.name == name).unwrap_or(0);
        let next = scenes::ALL[(here + by) % scenes::ALL.len()].name;
        self.show_scene(next, 0);
    }

    /// Asks for a replay of what is shown to be saved, if it is something that is recorded.
    pub fn save(&mut self) {
        let Some(source) = &mut self.source else { return };
        let name = format!("{}.replay", source.name());
        match source.save_replay() {
            None => self.message = Some("nothing is recorded here that could be saved".into()),
            Some(Ok(bytes)) => {
                self.message = Some(format!("{name}: {} ticks saved", source.recorded()));
                self.requests.push(Request::Save { name, bytes });
            }
            Some(Err(error)) => self.message = Some(error.to_string()),
        }
    }
}
