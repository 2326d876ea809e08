//! [`Progress`]: the progress line of `verify` on a terminal.

use std::sync::atomic::Ordering;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::judge::Shared;
use super::totals::{Totals, rate};

/// Highest redraw rate in Hz.
const PER_SECOND: u8 = 10;

/// The progress line. It does not show the total number of files, because folders are listed during verification.
pub(super) struct Progress(Option<ProgressBar>);

impl Progress {
    pub(super) fn new(is_shown: bool) -> Self {
        Progress(is_shown.then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(PER_SECOND));
            let style = ProgressStyle::with_template("{spinner} {elapsed_precise} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
            bar
        }))
    }

    pub(super) fn update(&self, totals: &Totals, shared: &Shared, elapsed: Duration) {
        if let Some(bar) = &self.0 {
            let ticks = shared.ticks.load(Ordering::Relaxed);
            bar.set_message(message(totals.files, totals.matches, rate(ticks, elapsed)));
            bar.tick();
        }
    }

    /// Hides the line while `print` runs.
    pub(super) fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        match &self.0 {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    pub(super) fn finish(self) {
        if let Some(bar) = self.0 {
            bar.finish_and_clear();
        }
    }
}

fn message(files: u64, matches: u64, rate: u128) -> String {
    let failed = files - matches;
    format!("{files} files done, {matches} match, {failed} failed, {rate} ticks per second")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_says_how_far_things_are() {
        assert_eq!(message(12, 9, 2000), "12 files done, 9 match, 3 failed, 2000 ticks per second");
    }
}
