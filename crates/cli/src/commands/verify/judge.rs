//! [`judge`]: plays one file and reports on it. A panic of the game is caught and reported.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use lockstep2d::lockstep::Game;
use lockstep2d::replay::{FORMAT_VERSION, Limits, Mismatch, Reader, Step, Verdict, VerifiedReplay};

use super::report::{Needs, Report};
use super::watch::{Watch, Work};
use crate::panics;

/// State that all threads share.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// Set when no more results are needed. Each thread then stops its file before the next tick.
    pub(super) stop: AtomicBool,
    /// Number of ticks played so far in all files together.
    pub(super) ticks: AtomicU64,
    pub(super) watch: Watch,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Report(Report),
    /// The file has exceeded its time limit.
    OutOfTime {
        /// Number of ticks that were played before.
        ticks: u64,
    },
    /// The verification was stopped by [`Shared::stop`].
    Stopped,
}

pub(super) fn judge<G: Game>(bytes: &[u8], limits: &Limits, shared: &Shared, work: &Work) -> Outcome {
    let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    let result = panics::catch(|| play::<G>(bytes, limits, shared, work));
    match result {
        Ok(outcome) => outcome,
        Err(panic) => Outcome::Report(Report::of_panic(length, work.tick(), &panic)),
    }
}

fn play<G: Game>(bytes: &[u8], limits: &Limits, shared: &Shared, work: &Work) -> Outcome {
    let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    let mut replay = match VerifiedReplay::<G>::open(bytes, limits) {
        Ok(replay) => replay,
        Err(verdict) => {
            let needs = needs(bytes, limits, &verdict);
            return Outcome::Report(Report::new(length, &verdict, &[], needs));
        }
    };
    let claims = replay.trailer().map(|trailer| trailer.claims.clone()).unwrap_or_default();
    work.set_ticks(replay.ticks());
    let report =
        |verdict: &Verdict, claims: &[_]| Outcome::Report(Report::new(length, verdict, claims, None));
    loop {
        // Checked before every tick, because a single tick may take long.
        if shared.stop.load(Ordering::Relaxed) {
            return Outcome::Stopped;
        }
        if work.is_out_of_time() {
            return Outcome::OutOfTime { ticks: replay.tick() };
        }
        match replay.step() {
            Ok(Step::Ticked) => {}
            Ok(Step::Ended) => return report(&replay.conclude(), &claims),
            Err(verdict) => return report(&verdict, &[]),
        }
        work.set_tick(replay.tick());
        shared.ticks.fetch_add(1, Ordering::Relaxed);
    }
}

/// The versions that a file requires, if its verdict is [`Verdict::Unverifiable`]. `None` for other verdicts.
fn needs(bytes: &[u8], limits: &Limits, verdict: &Verdict) -> Option<Needs> {
    match verdict {
        Verdict::Unverifiable { why: Mismatch::Format { file, .. } } => {
            Some(Needs { format: *file, semantics: None, rules: None, rules_version: None })
        }
        Verdict::Unverifiable { .. } => {
            let reader = Reader::open(bytes, limits).ok()?;
            let header = reader.header();
            Some(Needs {
                format: FORMAT_VERSION,
                semantics: Some(header.semantics),
                rules: Some(header.rules_name.to_string()),
                rules_version: Some(header.rules_version),
            })
        }
        _ => None,
    }
}
