//! [`Judge`]: the verdicts of `verify` for programs that hold files in memory, such as servers.

use std::marker::PhantomData;
use std::path::Path;
use std::sync::atomic::Ordering;

use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;

use super::cache;
use super::judge::{Outcome, Shared, judge};
use super::report::Digests;

/// Verifies files of the game `G`, on any thread. Returns the lines that `verify --json` prints without `--cache` and
/// `--keys`.
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
/// // A worker counts what it has verified.
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

    /// The limits.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Verifies the bytes of a file. If the game panics, the verdict is `panicked`. Returns `None` if [`Judge::stop`]
    /// has ended the verification.
    ///
    /// If the file is larger than the size limit, `bytes` may end one byte after the limit. The verdict is the same, but
    /// the line has the digest of these bytes: see [`Judge::judge_part`].
    #[must_use]
    pub fn judge(&self, name: &str, bytes: &[u8]) -> Option<Judged> {
        self.judge_part(name, bytes, blake3::hash(bytes).as_bytes())
    }

    /// Like [`Judge::judge`], with `blake3` as the digest of the whole file.
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

    /// Stops the verification of all files before their next tick. This includes files that are passed later. A stopped
    /// file gets no verdict. A file that cannot be opened still gets a verdict.
    pub fn stop(&self) {
        self.shared.stop.store(true, Ordering::Relaxed);
    }

    /// Number of ticks simulated so far, in all files together.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.shared.ticks.load(Ordering::Relaxed)
    }

    /// Hash of everything that the verdict on a file depends on, as 64 hexadecimal digits. `blake3` is the BLAKE3
    /// digest of the file. The hash also covers the rules, the limits and versions. `verify --cache` names its entries
    /// by this hash.
    #[must_use]
    pub fn key(&self, blake3: &[u8; 32]) -> String {
        cache::key(&cache::context(G::RULES, &self.limits), blake3).to_string()
    }
}
