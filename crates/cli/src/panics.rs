//! [`catch`]: catches a panic of the game. `verify` then continues with other files, and other commands end with an
//! error.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::path::{Path, PathBuf};
use std::sync::Once;

use crate::context::CommandResult;
use crate::error::CommandError;

/// Maximum number of characters of a panic message. Longer messages are cut, because they may quote the file.
const MESSAGE_CHARS_MAX: usize = 400;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Panic {
    pub(crate) message: String,
    /// File, line and column. `None` if the panic started on another thread.
    pub(crate) location: Option<String>,
}

/// The verdict on a file that made the game panic. The library has no such verdict.
pub(crate) const PANICKED: &str = "panicked";

pub(crate) struct PanicText<'a> {
    pub(crate) panic: &'a Panic,
    /// Number of ticks that were played, if the command counts them.
    pub(crate) ticks: Option<u64>,
}

impl fmt::Display for PanicText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PanicText { panic: Panic { message, location }, ticks } = self;
        write!(f, "{PANICKED}: the game")?;
        if let Some(ticks) = ticks {
            write!(f, ", after {ticks} ticks")?;
        }
        if let Some(location) = location {
            write!(f, ", at {location}")?;
        }
        write!(f, ": {message}")
    }
}

thread_local! {
    /// Whether panics on this thread are caught.
    static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
    /// Location of the last caught panic on this thread.
    static LOCATION: RefCell<Option<String>> = const { RefCell::new(None) };
    /// The files whose ticks the command on this thread is playing.
    static FILES: RefCell<Vec<PathBuf>> = const { RefCell::new(Vec::new()) };
    /// Number of ticks that the command on this thread has played, if it counts them.
    static TICKS: Cell<Option<u64>> = const { Cell::new(None) };
}

/// Records which files are played from now on, for the error of [`guard`].
pub(crate) fn playing(files: &[&Path]) {
    FILES.set(files.iter().map(|file| file.to_path_buf()).collect());
}

/// Records the number of played ticks, for the error of [`guard`].
pub(crate) fn played(ticks: u64) {
    TICKS.set(Some(ticks));
}

/// Calls `work`. A panic is returned instead of printed. After a panic, the data that `work` was changing must not be
/// used.
pub(crate) fn catch<T>(work: impl FnOnce() -> T) -> Result<T, Panic> {
    listen();
    IS_CAUGHT.set(true);
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    IS_CAUGHT.set(false);
    result.map_err(|payload| Panic { message: message(payload.as_ref()), location: LOCATION.take() })
}

/// Installs a hook that records the location of caught panics. Other panics are passed to the previous hook.
fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| {
        let others = panic::take_hook();
        panic::set_hook(Box::new(move |info: &PanicHookInfo<'_>| {
            if IS_CAUGHT.get() {
                LOCATION.set(info.location().map(ToString::to_string));
            } else {
                others(info);
            }
        }));
    });
}

/// Runs a command that plays a file. A panic of the game stops the command with an error that names this file, or the
/// files of the last call of [`playing`].
pub(crate) fn guard(file: &Path, command: impl FnOnce() -> CommandResult) -> CommandResult {
    playing(&[file]);
    TICKS.set(None);
    catch(command).unwrap_or_else(|panic| {
        Err(CommandError::Panicked { paths: FILES.take(), panic, ticks: TICKS.get() })
    })
}

fn message(payload: &(dyn Any + Send)) -> String {
    let message = match (payload.downcast_ref::<&str>(), payload.downcast_ref::<String>()) {
        (Some(message), _) => message,
        (_, Some(message)) => message.as_str(),
        _ => "without a message",
    };
    message.chars().take(MESSAGE_CHARS_MAX).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_are_told_apart_and_work_goes_on() {
        assert_eq!(catch(|| 7), Ok(7));
        let fixed = catch(|| panic!("fixed")).unwrap_err();
        assert_eq!(fixed.message, "fixed");
        assert!(fixed.location.unwrap().contains("panics.rs:"));
        let written = catch(|| panic!("{}", "x".repeat(1000))).unwrap_err();
        assert_eq!(written.message, "x".repeat(MESSAGE_CHARS_MAX));
        let other = catch(|| panic::resume_unwind(Box::new(7))).unwrap_err();
        assert_eq!(other, Panic { message: "without a message".into(), location: None });
        assert_eq!(catch(|| 8), Ok(8));
    }
}
