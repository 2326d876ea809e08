//! [`Totals`]: the summary of all files.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use super::report::Report;

#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    pub(super) files: u64,
    pub(super) matches: u64,
    /// Number of files for each verdict except a match.
    others: BTreeMap<String, u64>,
    /// Number of files without a verdict because of `--max-seconds`.
    undecided: u64,
    unsigned: u64,
    cached: u64,
    /// Number of ticks that this run has played: those of undecided files, and of reports that did not come from the
    /// cache.
    ticks: u64,
    pub(super) elapsed: Duration,
}

impl Totals {
    pub(super) fn add_undecided(&mut self, ticks: u64) {
        self.files += 1;
        self.undecided += 1;
        self.ticks = self.ticks.saturating_add(ticks);
    }

    /// Counts a file whose signatures are not valid. The file is also counted by its verdict.
    pub(super) fn add_unsigned(&mut self) {
        self.unsigned += 1;
    }

    pub(super) fn add(&mut self, report: &Report, cached: bool) {
        self.files += 1;
        if report.is_match() {
            self.matches += 1;
        } else {
            *self.others.entry(report.verdict.clone()).or_default() += 1;
        }
        if cached {
            self.cached += 1;
        } else {
            self.ticks = self.ticks.saturating_add(report.ticks);
        }
    }
}

/// Ticks per second.
pub(super) fn rate(ticks: u64, elapsed: Duration) -> u128 {
    u128::from(ticks) * 1_000_000_000 / elapsed.as_nanos().max(1)
}

impl fmt::Display for Totals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Totals { files, matches, others, undecided, unsigned, cached, ticks, elapsed } = self;
        write!(f, "{matches} of {files} files match")?;
        if !others.is_empty() {
            let others = others.iter().map(|(verdict, count)| format!("{count} {verdict}"));
            write!(f, " ({})", others.collect::<Vec<_>>().join(", "))?;
        }
        if *undecided > 0 {
            write!(f, "; {undecided} out of time")?;
        }
        if *unsigned > 0 {
            write!(f, "; {unsigned} not signed as required")?;
        }
        if *cached > 0 {
            write!(f, "; {cached} known from the cache")?;
        }
        write!(f, "; {ticks} ticks in {elapsed:.1?}, {} ticks per second", rate(*ticks, *elapsed))
    }
}
