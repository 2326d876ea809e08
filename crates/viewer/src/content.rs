//! [`Content`]: the scenes and files that an app can show. Its type does not depend on the type of the game.

use std::rc::Rc;

use lockstep2d::draw::Layers;
use lockstep2d::replay::{Limits, Reader, Verdict};
use lockstep2d::report::Evidence;

use crate::source::{OpenError, Snapshot, Source, SourceError};

#[derive(Clone)]
pub(crate) struct Content {
    pub(crate) scenes: Vec<Scene>,
    /// Name of the scene that is shown at the start. `None` for the first scene.
    pub(crate) first: Option<String>,
    /// Name of the rules of the game.
    pub(crate) rules: &'static str,
    pub(crate) open: OpenReplay,
    pub(crate) limits: Limits,
    pub(crate) layers: Layers,
}

#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) about: String,
    pub(crate) open: OpenScene,
}

/// Opens a scene. The arguments are the random seed and the limits for its replay.
pub(crate) type OpenScene = Rc<dyn Fn(u64, &Limits) -> Result<Box<dyn Source>, SourceError>>;

/// Opens a replay of the game. The arguments are the name for display, the bytes of the file, and the limits.
pub(crate) type OpenReplay = Rc<dyn Fn(&str, &'static [u8], &Limits) -> Result<Box<dyn Source>, Verdict>>;

impl Content {
    pub(crate) fn scene(&self, name: &str) -> Option<&Scene> {
        self.scenes.iter().find(|scene| scene.name == name)
    }

    pub(crate) fn first_scene(&self) -> Option<&str> {
        let first = self.first.as_deref().filter(|first| self.scene(first).is_some());
        first.or_else(|| self.scenes.first().map(|scene| scene.name.as_str()))
    }

    /// Opens a replay, a divergence report or a snapshot. The first bytes of the file identify its kind. A report is
    /// shown as its replay.
    ///
    /// The source borrows the bytes, which stay allocated until the program ends.
    pub(crate) fn open(&self, name: &str, bytes: &'static [u8]) -> Result<Box<dyn Source>, OpenError> {
        match Evidence::read(bytes.to_vec(), &self.limits).map_err(OpenError::File)? {
            Evidence::Replay(_) => self.open_replay(name, bytes),
            Evidence::Report(report) if report.replay().is_empty() => Err(OpenError::EmptyReport),
            Evidence::Report(report) => self.open_replay(name, report.replay().to_vec().leak()),
            Evidence::World(world) => Ok(Box::new(Snapshot::new(name, *world))),
        }
    }

    fn open_replay(&self, name: &str, bytes: &'static [u8]) -> Result<Box<dyn Source>, OpenError> {
        let reader = Reader::open(bytes, &self.limits).map_err(|error| OpenError::Replay(error.into()))?;
        let theirs = reader.header().rules_name;
        if theirs != self.rules {
            return Err(OpenError::OtherGame { rules: theirs.to_owned(), shown: self.rules });
        }
        (self.open)(name, bytes, &self.limits).map_err(OpenError::Replay)
    }
}
