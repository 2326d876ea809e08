//! [`CommandError`]: the errors that stop a command.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use lockstep2d::inspect::InspectError;
use lockstep2d::replay::{KeyframesError, RecordError, SeekError, Verdict};
use lockstep2d::report::{CompareError, EvidenceError, TraceError};

use crate::exit::Exit;
use crate::files::{EXTENSION, Shown};
use crate::panics::{Panic, PanicText};
use crate::signature::{LineError, RandomError};

#[derive(Debug)]
pub(crate) enum CommandError {
    Output(io::Error),
    Read {
        path: PathBuf,
        error: io::Error,
    },
    NothingToVerify {
        path: PathBuf,
    },
    InputTwice,
    Write {
        path: PathBuf,
        error: io::Error,
    },
    Exists {
        path: PathBuf,
    },
    Busy {
        path: PathBuf,
    },
    UnknownScene {
        name: String,
        known: Vec<&'static str>,
    },
    Record(RecordError),
    NoSuchTick {
        path: PathBuf,
        tick: u64,
        ticks: u64,
    },
    Replay {
        path: PathBuf,
        verdict: Verdict,
    },
    /// The game panics while one of these files is played.
    Panicked {
        paths: Vec<PathBuf>,
        panic: Panic,
        ticks: Option<u64>,
    },
    /// The first tick of a range is after the last.
    Reversed {
        from: u64,
        to: u64,
    },
    /// A keyframe does not belong to the replay, or the game does not restore it exactly.
    Keyframe {
        path: PathBuf,
        error: SeekError,
    },
    Keyframes {
        path: PathBuf,
        error: KeyframesError,
    },
    /// A line of inputs does not have one valid input for each player.
    Inputs {
        path: PathBuf,
        line: u64,
        why: String,
    },
    /// A state cannot be decoded, or has no human-readable or JSON form.
    State {
        why: String,
    },
    NoBody {
        id: String,
    },
    /// A file does not have the requested state, or a state does not have the requested field.
    NothingThere {
        what: String,
    },
    /// The game does not expose its world, so it cannot be drawn.
    NoPictures,
    NoFormat,
    /// The extension of the output file belongs to another format than the selected one.
    Extension {
        path: PathBuf,
        option: &'static str,
        other: &'static str,
    },
    /// The file is a report or a save, which cannot be exported.
    NoReplay {
        path: PathBuf,
        kind: &'static str,
    },
    NoOutput {
        format: &'static str,
    },
    Useless {
        option: &'static str,
        format: &'static str,
    },
    OneState {
        path: PathBuf,
        format: &'static str,
    },
    /// A file is not a replay, report or snapshot. Or it is a report or snapshot that is damaged or of another version.
    Evidence {
        path: PathBuf,
        error: EvidenceError,
    },
    /// A replay cannot be traced.
    Trace {
        path: PathBuf,
        error: TraceError,
    },
    Line {
        path: PathBuf,
        error: LineError,
    },
    /// A file of keys or signatures is too large or is not text. Or a signature file is not a regular file.
    NoText {
        path: PathBuf,
    },
    Random(RandomError),
    KeyName {
        name: String,
    },
    Require {
        required: usize,
        names: usize,
    },
    InputSignatures,
    Compare(CompareError),
}

impl CommandError {
    pub(crate) fn read(path: &Path) -> impl Fn(io::Error) -> Self {
        move |error| CommandError::Read { path: path.to_path_buf(), error }
    }

    pub(crate) fn write(path: &Path) -> impl Fn(io::Error) -> Self {
        move |error| CommandError::Write { path: path.to_path_buf(), error }
    }

    pub(crate) fn line(path: &Path) -> impl Fn(LineError) -> Self {
        move |error| CommandError::Line { path: path.to_path_buf(), error }
    }

    pub(crate) fn replay<V: Into<Verdict>>(path: &Path) -> impl Fn(V) -> Self {
        move |verdict| CommandError::Replay { path: path.to_path_buf(), verdict: verdict.into() }
    }

    pub(crate) fn exit(&self) -> Exit {
        match self {
            CommandError::Replay { .. }
            | CommandError::Trace { error: TraceError::Replay(_), .. }
            | CommandError::Panicked { .. } => Exit::NoMatch,
            _ => Exit::Trouble,
        }
    }

    /// Whether the reader of the output has closed the pipe, as `head` does.
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
            CommandError::Exists { path } => {
                write!(f, "cannot write {}: it exists; --force replaces it", Shown(path))
            }
            CommandError::Busy { path } => {
                write!(f, "cannot write {}: another process is writing it", Shown(path))
            }
            CommandError::UnknownScene { name, known } => {
                write!(f, "there is no scene {name:?}; there are {}", known.join(", "))
            }
            CommandError::Record(error) => write!(f, "cannot record: {error}"),
            CommandError::Panicked { paths, panic, ticks } => {
                let paths: Vec<_> = paths.iter().map(|path| Shown(path).to_string()).collect();
                write!(f, "{}: {}", paths.join(" or "), PanicText { panic, ticks: *ticks })
            }
            CommandError::Reversed { from, to } => write!(f, "--from {from} is after --to {to}"),
            CommandError::NoSuchTick { path, tick, ticks } => {
                write!(f, "{} has {ticks} ticks, there is no tick {tick}", Shown(path))
            }
            CommandError::Replay { path, verdict } => write!(f, "{}: {verdict}", Shown(path)),
            CommandError::Keyframe { path, error } => write!(f, "{}: {error}", Shown(path)),
            CommandError::Keyframes { path, error } => {
                write!(f, "{}: {error}; delete it to have it written again", Shown(path))
            }
            CommandError::Inputs { path, line, why } => write!(f, "{}, line {line}: {why}", Shown(path)),
            CommandError::State { why } => write!(f, "cannot show the state: {why}"),
            CommandError::NoBody { id } => write!(
                f,
                "there is no body {id:?} in this state: a body is given by its number, its handle or its name, such as \
                 12, 12v1 or ball"
            ),
            CommandError::NothingThere { what } => write!(f, "there is no {what}"),
            CommandError::NoPictures => {
                write!(f, "this game exposes no world (`Game::world`), so it cannot be drawn")
            }
            CommandError::NoFormat => write!(
                f,
                "no format given: use --svg, --png, --gif, --apng, --json or --plot, or -o with an extension such as \
                 .svg"
            ),
            CommandError::Extension { path, option, other } => {
                write!(f, "{option} does not write {}: use {other}, or another name", Shown(path))
            }
            CommandError::NoReplay { path, kind } => write!(
                f,
                "{}: {kind}; a replay or a snapshot of a world can be exported (`inspect` describes other files)",
                Shown(path)
            ),
            CommandError::NoOutput { format } => write!(f, "{format} needs a file to write: -o FILE"),
            CommandError::Useless { option, format } => write!(f, "{option} makes no sense with {format}"),
            CommandError::OneState { path, format } => {
                write!(f, "{} has one state, which is too few for {format}", Shown(path))
            }
            CommandError::Evidence { path, error } => write!(f, "{}: {error}", Shown(path)),
            CommandError::Trace { path, error } => write!(f, "{}: {error}", Shown(path)),
            CommandError::Line { path, error } => write!(f, "{}: {error}", Shown(path)),
            CommandError::NoText { path } => write!(f, "{}: too large, or not text", Shown(path)),
            CommandError::Random(error) => write!(f, "cannot make a key: {error}"),
            CommandError::KeyName { name } => {
                write!(
                    f,
                    "{name:?} cannot be the name of a key: 1 to 64 bytes, without control characters or spaces at \
                     the ends"
                )
            }
            CommandError::Require { required, names } => {
                write!(f, "{required} signatures are required, but the keys have {names} names")
            }
            CommandError::InputSignatures => {
                write!(f, "the standard input has no signature file beside it: pass the path of the replay")
            }
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
