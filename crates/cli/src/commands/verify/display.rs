//! [`Display`]: prints the results of `verify` line by line, and the summary.

use std::fmt;
use std::path::Path;

use super::Arguments;
use super::interrupt::{self, Interrupt};
use super::judge::{Outcome, Shared};
use super::pool::{Pause, Sink};
use super::progress::Progress;
use super::report::{self, Digests, Report};
use super::signers::Signed;
use super::totals::Totals;
use super::verifier::Verified;
use crate::clock::Clock;
use crate::console::{BAD, Console, DOUBTFUL, GOOD};
use crate::context::CommandResult;
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::{OneLine, Shown};

pub(super) struct Display<'a, 'c> {
    json: bool,
    /// Time limit of a file in seconds, for messages. 0 if there is no limit.
    max_seconds: u64,
    console: &'a mut Console<'c>,
    shared: &'a Shared,
    interrupt: Interrupt,
    progress: Progress,
    clock: Clock,
    totals: Totals,
    exit: Exit,
    is_cache_failing: bool,
}

impl Sink<Result<Verified, CommandError>> for Display<'_, '_> {
    type Error = CommandError;

    fn result(&mut self, result: Result<Verified, CommandError>) -> Result<(), CommandError> {
        match result {
            Err(error) => self.trouble(&error)?,
            Ok(verified) => self.line(&verified)?,
        }
        self.progress.update(&self.totals, self.shared, self.clock.elapsed());
        Ok(())
    }

    /// Prints a note about each file whose verification takes long (see `Watch`), and updates the progress line.
    fn pause(&mut self) -> Result<Pause, CommandError> {
        for work in self.shared.watch.overdue() {
            self.progress.aside(|| self.console.note(work));
        }
        self.progress.update(&self.totals, self.shared, self.clock.elapsed());
        Ok(if self.interrupt.caught().is_some() { Pause::End } else { Pause::Continue })
    }

    /// Prints the signal and the unfinished files, and ends the process without waiting for these files.
    fn end(&mut self) {
        let Some((name, signal)) = self.interrupt.caught() else { return };
        self.totals.elapsed = self.clock.elapsed();
        let at_work = self.shared.watch.at_work();
        self.progress.aside(|| {
            for work in &at_work {
                self.console.note(work);
            }
            let count = at_work.len();
            self.console.note(format_args!("{}; stopped by {name} with {count} files at work", self.totals));
        });
        let _ = self.console.out.flush();
        interrupt::end_process(signal);
    }
}

impl<'a, 'c> Display<'a, 'c> {
    pub(super) fn new(arguments: &Arguments, console: &'a mut Console<'c>, shared: &'a Shared) -> Self {
        Display {
            json: arguments.json,
            max_seconds: arguments.max_seconds.unwrap_or(0),
            progress: Progress::new(console.is_terminal && !arguments.json),
            interrupt: Interrupt::listen(console.owns_process),
            console,
            shared,
            clock: Clock::start(),
            totals: Totals::default(),
            exit: Exit::Success,
            is_cache_failing: false,
        }
    }

    /// Prints an error. With `--json`, a path that cannot be read also gets a line among the results.
    fn trouble(&mut self, error: &CommandError) -> Result<(), CommandError> {
        self.exit = Exit::Trouble;
        if let (true, CommandError::Read { path, error }) = (self.json, error) {
            self.progress.aside(|| self.console.line(report::unread(path, error)))?;
        }
        self.progress.aside(|| self.console.error(error));
        Ok(())
    }

    fn line(&mut self, verified: &Verified) -> Result<(), CommandError> {
        let Verified { path, outcome, digests, cached, unkept, signed } = verified;
        let signed = signed.as_ref();
        let report = match outcome {
            Outcome::Report(report) => report,
            Outcome::OutOfTime { ticks } => return self.out_of_time(path, digests, signed, *ticks),
            Outcome::Stopped => return Ok(()),
        };
        self.totals.add(report, *cached);
        if !report.is_match() {
            self.exit = self.exit.max(Exit::NoMatch);
        }
        self.count_signed(signed);
        if let Some(error) = unkept.as_ref().filter(|_| !self.is_cache_failing) {
            // Warns only once, because the cause is usually the same for all files.
            self.is_cache_failing = true;
            let warning = format!("verdicts cannot be cached: {error}");
            self.progress.aside(|| self.console.warning(warning));
        }
        self.progress.aside(|| match self.json {
            true => self.console.line(report.json(path, digests, *cached, signed)),
            false => self.console.line(Line { path, report, signed }),
        })
    }

    /// Prints that a file has exceeded its time limit. The command then exits with [`Exit::Trouble`], as for a file
    /// that cannot be read.
    fn out_of_time(
        &mut self,
        path: &Path,
        digests: &Digests,
        signed: Option<&Signed>,
        ticks: u64,
    ) -> Result<(), CommandError> {
        self.exit = Exit::Trouble;
        self.totals.add_undecided(ticks);
        self.count_signed(signed);
        let seconds = self.max_seconds;
        self.progress.aside(|| match self.json {
            true => self.console.line(report::out_of_time(path, digests, signed, seconds, ticks)),
            false => self.console.line(format_args!(
                "{}: {DOUBTFUL}out of time{DOUBTFUL:#}: no verdict after {seconds} s and {ticks} ticks",
                Shown(path)
            )),
        })
    }

    fn count_signed(&mut self, signed: Option<&Signed>) {
        if signed.is_some_and(|signed| !signed.is_valid()) {
            self.totals.add_unsigned();
            self.exit = self.exit.max(Exit::Unsigned);
        }
    }

    pub(super) fn finish(mut self) -> CommandResult {
        self.progress.finish();
        self.totals.elapsed = self.clock.elapsed();
        if self.json {
            self.console.note(&self.totals);
        } else if self.totals.files > 0 {
            self.console.line(&self.totals)?;
        }
        Ok(self.exit)
    }
}

struct Line<'a> {
    path: &'a Path,
    report: &'a Report,
    signed: Option<&'a Signed>,
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let style = match self.report {
            report if report.is_match() => GOOD,
            report if report.is_doubtful() => DOUBTFUL,
            _ => BAD,
        };
        let text = &self.report.text;
        let (word, rest) = text.split_once(':').unwrap_or((text, ""));
        write!(f, "{}: {style}{word}{style:#}:{}", Shown(self.path), OneLine(rest))?;
        if let Some(signed) = self.signed {
            let style = if signed.is_valid() { GOOD } else { BAD };
            write!(f, "; {style}{}{style:#}", OneLine(&signed.to_string()))?;
        }
        Ok(())
    }
}
