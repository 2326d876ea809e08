//! [`CommandError`]: why a command had to stop.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use lockstep2d::inspect::InspectError;
use lockstep2d::replay::{KeyframesError, RecordError, SeekError, Verdict};
use lockstep2d::report::{CompareError, EvidenceError, TraceError};

use crate::exit::Exit;
use crate::files::{EXTENSION, Shown};

/// Why a command had to stop.
#[derive(Debug)]
pub(crate) enum CommandError {
    /// Our own output cannot be written.
    Output(io::Error),
    /// A file cannot be read.
    Read { path: PathBuf, error: io::Error },
    /// A folder has no replays.
    NothingToVerify { path: PathBuf },
    /// There is only one standard input.
    InputTwice,
    /// A file cannot be written.
    Write { path: PathBuf, error: io::Error },
    /// There is no such scene.
    UnknownScene { name: String, known: Vec<&'static str> },
    /// The scene cannot be recorded.
    Record(RecordError),
    /// A replay ends before the tick that was asked for.
    NoSuchTick { path: PathBuf, tick: u64, ticks: u64 },
    /// A replay cannot be played as far as was asked for.
    Replay { path: PathBuf, verdict: Verdict },
    /// A keyframe is none of the replay.
    Keyframe { path: PathBuf, error: SeekError },
    /// A file has no keyframes of the replay.
    Keyframes { path: PathBuf, error: KeyframesError },
    /// A line of inputs has none for every player.
    Inputs { path: PathBuf, line: u64, why: String },
    /// A state has no form for people, or none in JSON.
    State { why: String },
    /// There is nothing under the name that was asked for.
    NothingThere { what: String },
    /// The game shows no world of which there could be pictures.
    NoPictures,
    /// Neither an option nor the name of a file says in which format to write.
    NoFormat,
    /// What is no text cannot go to a terminal.
    NoOutput { format: &'static str },
    /// An option makes no sense in a format.
    Useless { option: &'static str, format: &'static str },
    /// A file has one state, of which the format makes nothing.
    OneState { path: PathBuf, format: &'static str },
    /// A file is nothing that can be compared.
    Evidence { path: PathBuf, error: EvidenceError },
    /// A replay cannot be traced.
    Trace { path: PathBuf, error: TraceError },
    /// Two files cannot be compared with each other.
    Compare(CompareError),
}

impl CommandError {
    /// Makes an error of what went wrong in reading the file at `path`.
    pub(crate) fn read(path: &Path) -> impl Fn(io::Error) -> Self {
        move |error| CommandError::Read { path: path.to_path_buf(), error }
    }

    /// Makes an error of what went wrong in writing the file at `path`.
    pub(crate) fn write(path: &Path) -> impl Fn(io::Error) -> Self {
        move |error| CommandError::Write { path: path.to_path_buf(), error }
    }

    /// Makes an error of a verdict on the replay at `path`, or of why there is none.
    pub(crate) fn replay<V: Into<Verdict>>(path: &Path) -> impl Fn(V) -> Self {
        move |verdict| CommandError::Replay { path: path.to_path_buf(), verdict: verdict.into() }
    }

    /// How a command that stops for this ends.
    pub(crate) fn exit(&self) -> Exit {
        match self {
            CommandError::Replay { .. } | CommandError::Trace { .. } => Exit::NoMatch,
            _ => Exit::Trouble,
        }
    }

    /// Whether whoever read our output has gone, as `head` does, and nobody is left to tell.
    pub(crate) fn is_reader_gone(&self) -> bool {
        matches!(self, CommandError::Output(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

impl fmt::Display for CommandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CommandError::Output(error) => write!(f, "cannot write the output: {error}"),
            CommandError::Read { path, error } => write!(f, "cannot read {}: {error}", Shown(path)),
            CommandError::NothingToVerify { path } => {
                write!(f, "{}: nothing to verify, no *.{EXTENSION} here", Shown(path))
            }
            CommandError::InputTwice => write!(f, "the standard input can be read only once"),
            CommandError::Write { path, error } => write!(f, "cannot write {}: {error}", Shown(path)),
            CommandError::UnknownScene { name, known } => {
                write!(f, "there is no scene {name:?}; there are {}", known.join(", "))
            }
            CommandError::Record(error) => write!(f, "cannot record: {error}"),
            CommandError::NoSuchTick { path, tick, ticks } => {
                write!(f, "{} has {ticks} ticks, there is no tick {tick}", Shown(path))
            }
            CommandError::Replay { path, verdict } => write!(f, "{}: {verdict}", Shown(path)),
            CommandError::Keyframe { path, error } => write!(f, "{}: {error}", Shown(path)),
            CommandError::Keyframes { path, error } => {
                write!(f, "{}: {error}; delete it to have it written anew", Shown(path))
            }
            CommandError::Inputs { path, line, why } => write!(f, "{}, line {line}: {why}", Shown(path)),
            CommandError::State { why } => write!(f, "cannot show the state: {why}"),
            CommandError::NothingThere { what } => write!(f, "there is no {what} in this state"),
            CommandError::NoPictures => write!(f, "this game shows no world, so there are no pictures of it"),
            CommandError::NoFormat => write!(
                f,
                "in which format? Say --svg, --png, --gif, --apng, --json or --plot, or -o with a name that ends in one"
            ),
            CommandError::NoOutput { format } => write!(f, "{format} needs a file to write: -o FILE"),
            CommandError::Useless { option, format } => write!(f, "{option} makes no sense with {format}"),
            CommandError::OneState { path, format } => {
                write!(f, "{} has one state, which is too few for {format}", Shown(path))
            }
            CommandError::Evidence { path, error } => write!(f, "{}: {error}", Shown(path)),
            CommandError::Trace { path, error } => write!(f, "{}: {error}", Shown(path)),
            CommandError::Compare(error) => write!(f, "cannot compare: {error}"),
        }
    }
}

impl From<InspectError> for CommandError {
    fn from(error: InspectError) -> Self {
        CommandError::State { why: error.to_string() }
    }
}

impl From<RecordError> for CommandError {
    fn from(error: RecordError) -> Self {
        CommandError::Record(error)
    }
}
