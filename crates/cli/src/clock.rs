//! [`Clock`]: elapsed time, for reports and for `--max-seconds`.

#![expect(clippy::disallowed_types, reason = "the time never reaches a simulation")]

use std::time::Duration;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock(std::time::Instant);

impl Clock {
    pub(crate) fn start() -> Self {
        Clock(std::time::Instant::now())
    }

    pub(crate) fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }
}
