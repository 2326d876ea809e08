//! [`Interrupt`]: catches SIGINT and SIGTERM, to print the unfinished files before the process ends.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{SigId, flag, low_level};

/// The signals that are caught: for each, the number that the system uses, the number that [`Interrupt`] stores, and
/// the name.
const SIGNALS: [(i32, usize, &str); 2] = [(SIGINT, 1, "SIGINT"), (SIGTERM, 2, "SIGTERM")];

/// Catches the signals while this value exists. A second signal ends the process at once, even while the output is
/// blocked.
pub(super) struct Interrupt {
    /// Number of the signal that arrived: the second value in [`SIGNALS`]. 0 if none has arrived.
    caught: Arc<AtomicUsize>,
    ids: Vec<SigId>,
}

impl Interrupt {
    /// Begins to catch the signals. If `owns_process` is false, catches none, because a program that uses the tool as a
    /// library handles its signals itself.
    pub(super) fn listen(owns_process: bool) -> Self {
        let (caught, again) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        let mut ids = Vec::new();
        for (signal, number, _) in SIGNALS.into_iter().filter(|_| owns_process) {
            // Handlers run in the order of registration. At the first signal, the first handler still finds `again` to
            // be false, so it does not end the process. A signal that cannot be registered is not caught.
            ids.extend(flag::register_conditional_default(signal, Arc::clone(&again)));
            ids.extend(flag::register(signal, Arc::clone(&again)));
            ids.extend(flag::register_usize(signal, Arc::clone(&caught), number));
        }
        Interrupt { caught, ids }
    }

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

/// Ends the process with the default action of the signal.
pub(super) fn end_process(signal: i32) {
    let _ = low_level::emulate_default_handler(signal);
}
