//! [`Judge`]: the verdicts of `verify` for programs that hold files in memory, such as servers.

use std::marker::PhantomData;
use std::path::Path;
use std::sync::atomic::Ordering;

use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;

use super::cache;
use super::judge::{Outcome, Shared, judge};
use super::report::Digests;

/// Verifies replays of the game `G`. Several threads may use a judge at the same time. The lines that it returns are
/// those of `verify --json` without `--cache` and `--keys`.
///
/// ```
/// use lockstep2d::lockstep::Sandbox;
/// use lockstep2d::replay::{Limits, Recording};
/// use lockstep2d_cli::Judge;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let replay = Recording::<Sandbox>::start(&Default::default(), 60)?.finish()?;
/// let judge = Judge::<Sandbox>::new(Limits::default());
/// let judged = judge.judge("17.replay", &replay).ok_or("stopped")?;
/// assert_eq!(judged.verdict, "match");
/// assert!(judged.line.starts_with(r#"{"file":"17.replay","verdict":"match","ticks":0,"#));
/// # Ok(())
/// # }
/// ```
pub struct Judge<G: Game> {
    limits: Limits,
    shared: Shared,
    game: PhantomData<fn() -> G>,
}

/// The verdict on a file.
///
/// ```
/// use lockstep2d::{lockstep::Sandbox, replay::Limits};
/// use lockstep2d_cli::{Judge, Judged};
/// // A file that is not a replay also gets a verdict.
/// let judge = Judge::<Sandbox>::new(Limits::default());
/// let Judged { verdict, line } = judge.judge("18.replay", b"not a replay").expect("it was not stopped");
/// assert_eq!(verdict, "malformed");
/// assert!(line.contains(r#""file":"18.replay""#));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judged {
    /// Name of the verdict, as listed in VERIFYING.md.
    pub verdict: String,
    /// The line of JSON, without a line break.
    pub line: String,
}

impl<G: Game> Judge<G> {
    /// Creates a judge with these limits for each file.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Judge { limits, shared: Shared::default(), game: PhantomData }
    }

    /// The limits for each file.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Verifies the bytes of a file. If the game panics, the verdict is `panicked`. Returns `None` if [`Judge::stop`]
    /// has ended the verification.
    ///
    /// If the file is larger than the size limit, its bytes up to one byte after the limit are enough for the verdict.
    /// The digest in the line is then that of the passed bytes. [`Judge::judge_part`] takes the digest of the whole
    /// file.
    #[must_use]
    pub fn judge(&self, name: &str, bytes: &[u8]) -> Option<Judged> {
        self.judge_part(name, bytes, blake3::hash(bytes).as_bytes())
    }

    /// Like [`Judge::judge`], but the digest in the line is `blake3`, which should be that of the whole file.
    #[must_use]
    pub fn judge_part(&self, name: &str, bytes: &[u8], blake3: &[u8; 32]) -> Option<Judged> {
        let path = Path::new(name);
        let at_work = self.shared.watch.begin(path.to_path_buf(), None);
        match judge::<G>(bytes, &self.limits, &self.shared, at_work.work()) {
            Outcome::Report(report) => {
                let digests = Digests::of_part(bytes, &self.limits, (*blake3).into());
                let line = report.json(path, &digests, false, None);
                Some(Judged { verdict: report.verdict, line })
            }
            Outcome::OutOfTime { .. } | Outcome::Stopped => None,
        }
    }

    /// Stops the verification of all files before their next tick, also of files that are passed later. A stopped file
    /// gets no verdict. A file that cannot be opened as a replay still gets a verdict, because it has no tick to play.
    pub fn stop(&self) {
        self.shared.stop.store(true, Ordering::Relaxed);
    }

    /// Number of ticks simulated so far, in all files together.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.shared.ticks.load(Ordering::Relaxed)
    }

    /// Hash of everything that the verdict on a file depends on, as 64 hexadecimal digits. `blake3` is the BLAKE3
    /// digest of the file. The hash also covers the rules, the limits, and the versions of the file format, the
    /// semantics and the cache. `verify --cache` names its entries by this hash.
    #[must_use]
    pub fn key(&self, blake3: &[u8; 32]) -> String {
        cache::key(&cache::context(G::RULES, &self.limits), blake3).to_string()
    }
}
