//! [`judge`]: plays one file and reports on it; panics of the game are caught.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use lockstep2d::lockstep::Game;
use lockstep2d::replay::{FORMAT_VERSION, Limits, Mismatch, Reader, Step, Verdict, VerifiedReplay};

use super::panics;
use super::report::{Needs, Report};

/// Number of ticks between checks of the stop flag and updates of the tick counter.
const TICKS_BETWEEN: u64 = 64;

/// State that all threads share.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// Set when no more results are needed.
    pub(super) stop: AtomicBool,
    /// Ticks that were played, without the last few of the files being played.
    pub(super) ticks: AtomicU64,
}

/// Plays a file and returns its report, or `None` if it was stopped.
pub(super) fn judge<G: Game>(bytes: &[u8], limits: &Limits, shared: &Shared) -> Option<Report> {
    let tick = Cell::new(0);
    let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    let result = panics::catch(|| play::<G>(bytes, limits, shared, &tick));
    shared.ticks.fetch_add(tick.get() % TICKS_BETWEEN, Ordering::Relaxed);
    match result {
        Ok(report) => report,
        Err(panic) => Some(Report::of_panic(length, tick.get(), &panic)),
    }
}

fn play<G: Game>(bytes: &[u8], limits: &Limits, shared: &Shared, tick: &Cell<u64>) -> Option<Report> {
    let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    let mut playback = match VerifiedReplay::<G>::open(bytes, limits) {
        Ok(playback) => playback,
        Err(verdict) => {
            let needs = needs(bytes, limits, &verdict);
            return Some(Report::new(length, &verdict, &[], needs));
        }
    };
    let claims = playback.trailer().map(|trailer| trailer.claims.clone()).unwrap_or_default();
    loop {
        match playback.step() {
            Ok(Step::Ticked) => {}
            Ok(Step::Ended) => return Some(Report::new(length, &playback.conclude(), &claims, None)),
            Err(verdict) => return Some(Report::new(length, &verdict, &[], None)),
        }
        tick.set(playback.tick());
        if tick.get().is_multiple_of(TICKS_BETWEEN) {
            shared.ticks.fetch_add(TICKS_BETWEEN, Ordering::Relaxed);
            if shared.stop.load(Ordering::Relaxed) {
                return None;
            }
        }
    }
}

/// The versions that a file needs which this program cannot verify.
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
