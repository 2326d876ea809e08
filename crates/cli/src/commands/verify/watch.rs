//! [`Watch`]: the files that are being verified, so that slow ones can be reported and stopped.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::totals::rate;
use crate::clock::Clock;
use crate::files::Shown;

/// Seconds until a file is reported for the first time. The time to the next report is then always equal to the elapsed
/// time, up to [`NAMED_AGAIN_MAX`]: reports come after 5, 10, 20, 40, 80, 140 s and so on.
const NAMED_AFTER: u64 = 5;
/// Longest time between two reports of a file, in seconds.
const NAMED_AGAIN_MAX: u64 = 60;

/// Value of [`Work::ticks`] until the game is set up.
const UNKNOWN: u64 = u64::MAX;

#[derive(Debug, Default)]
pub(super) struct Watch {
    works: Mutex<BTreeMap<u64, Arc<Work>>>,
    begun: AtomicU64,
}

#[derive(Debug)]
pub(super) struct Work {
    path: PathBuf,
    clock: Clock,
    time_max: Option<Duration>,
    tick: AtomicU64,
    /// Number of ticks in the file, or [`UNKNOWN`].
    ticks: AtomicU64,
    /// Time of the next report, in seconds since the file was begun.
    named_at: AtomicU64,
}

/// A file that is being verified. Dropping this value removes the file from the [`Watch`].
pub(super) struct AtWork<'a> {
    watch: &'a Watch,
    number: u64,
    work: Arc<Work>,
}

impl Watch {
    /// Adds a file. `time_max` is the longest time that its verification may take.
    pub(super) fn begin(&self, path: PathBuf, time_max: Option<Duration>) -> AtWork<'_> {
        let number = self.begun.fetch_add(1, Ordering::Relaxed);
        let work = Arc::new(Work {
            path,
            clock: Clock::start(),
            time_max,
            tick: AtomicU64::new(0),
            ticks: AtomicU64::new(UNKNOWN),
            named_at: AtomicU64::new(NAMED_AFTER),
        });
        self.works().insert(number, Arc::clone(&work));
        AtWork { watch: self, number, work }
    }

    /// The files that are being verified, in the order in which they were begun.
    pub(super) fn at_work(&self) -> Vec<Arc<Work>> {
        self.works().values().map(Arc::clone).collect()
    }

    pub(super) fn overdue(&self) -> Vec<Arc<Work>> {
        self.works().values().filter(|work| work.is_overdue()).map(Arc::clone).collect()
    }

    fn works(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Work>>> {
        self.works.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Work {
    /// Stores the number of ticks in the file, which is known when the game has been set up.
    pub(super) fn set_ticks(&self, ticks: u64) {
        self.ticks.store(ticks, Ordering::Relaxed);
    }

    pub(super) fn set_tick(&self, tick: u64) {
        self.tick.store(tick, Ordering::Relaxed);
    }

    pub(super) fn tick(&self) -> u64 {
        self.tick.load(Ordering::Relaxed)
    }

    pub(super) fn is_out_of_time(&self) -> bool {
        self.time_max.is_some_and(|most| self.clock.elapsed() >= most)
    }

    fn is_overdue(&self) -> bool {
        let now = self.clock.elapsed().as_secs();
        let at = self.named_at.load(Ordering::Relaxed);
        if now < at {
            return false;
        }
        self.named_at.store(now + now.clamp(1, NAMED_AGAIN_MAX), Ordering::Relaxed);
        true
    }
}

impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (elapsed, tick) = (self.clock.elapsed(), self.tick());
        write!(f, "{}: at work for {:.0?}, ", Shown(&self.path), Duration::from_secs(elapsed.as_secs()))?;
        match self.ticks.load(Ordering::Relaxed) {
            UNKNOWN => write!(f, "not at the first tick yet"),
            ticks => write!(f, "tick {tick} of {ticks}, {} ticks per second", rate(tick, elapsed)),
        }
    }
}

impl AtWork<'_> {
    pub(super) fn work(&self) -> &Work {
        &self.work
    }
}

impl Drop for AtWork<'_> {
    fn drop(&mut self) {
        self.watch.works().remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_at_work_until_they_are_done() {
        let watch = Watch::default();
        let first = watch.begin("a\n.replay".into(), None);
        let second = watch.begin("b.replay".into(), Some(Duration::ZERO));
        assert!(second.work().is_out_of_time() && !first.work().is_out_of_time());
        first.work().set_ticks(9);
        first.work().set_tick(4);
        let shown: Vec<String> = watch.at_work().iter().map(ToString::to_string).collect();
        assert!(shown[0].starts_with("a\\n.replay: at work for 0"), "{shown:?}");
        assert!(shown[0].contains(", tick 4 of 9, "), "{shown:?}");
        assert!(shown[1].ends_with("not at the first tick yet"), "{shown:?}");
        drop(first);
        assert_eq!(watch.at_work().len(), 1);
        assert!(watch.overdue().is_empty(), "named after {NAMED_AFTER} s");
    }
}
