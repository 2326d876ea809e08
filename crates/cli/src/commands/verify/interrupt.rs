//! [`Interrupt`]: SIGINT and SIGTERM, so that the files at work can be named before the process ends.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{SigId, flag, low_level};

/// The signals, their numbers as flags, and their names.
const SIGNALS: [(i32, usize, &str); 2] = [(SIGINT, 1, "SIGINT"), (SIGTERM, 2, "SIGTERM")];

/// Listens for the signals while it exists. A second signal has its ordinary effect, also if the output is blocked.
pub(super) struct Interrupt {
    /// The flag of the signal, 0 before one arrives.
    caught: Arc<AtomicUsize>,
    ids: Vec<SigId>,
}

impl Interrupt {
    /// Listens, or without `owns_process` does nothing: signals of a program that uses the tool as a library are its
    /// own.
    pub(super) fn listen(owns_process: bool) -> Self {
        let (caught, again) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        let mut ids = Vec::new();
        for (signal, number, _) in SIGNALS.into_iter().filter(|_| owns_process) {
            // In this order: at the first signal, `again` is still false. What cannot be registered is not caught.
            ids.extend(flag::register_conditional_default(signal, Arc::clone(&again)));
            ids.extend(flag::register(signal, Arc::clone(&again)));
            ids.extend(flag::register_usize(signal, Arc::clone(&caught), number));
        }
        Interrupt { caught, ids }
    }

    /// The signal that arrived: its name and number.
    pub(super) fn caught(&self) -> Option<(&'static str, i32)> {
        let caught = self.caught.load(Ordering::Relaxed);
        SIGNALS.iter().find(|(_, number, _)| *number == caught).map(|(signal, _, name)| (*name, *signal))
    }
}

impl Drop for Interrupt {
    fn drop(&mut self) {
        for id in self.ids.drain(..) {
            low_level::unregister(id);
        }
    }
}

/// Ends the process as the signal would have done, so that the caller sees the same status.
pub(super) fn end_process(signal: i32) {
    let _ = low_level::emulate_default_handler(signal);
}
