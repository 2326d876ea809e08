//! [`Verifier`]: verifies one file.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use lockstep2d::replay::Limits;

use super::cache::Cache;
use super::judge::{Outcome, Shared};
use super::report::Digests;
use super::signers::{Signed, Signers};
use super::tasks;
use super::watch::Work;
use crate::error::CommandError;
use crate::files;

pub(super) struct Verifier {
    pub(super) judge: fn(&[u8], &Limits, &Shared, &Work) -> Outcome,
    pub(super) limits: Limits,
    pub(super) time_max: Option<Duration>,
    pub(super) cache: Option<Cache>,
    pub(super) signers: Option<Signers>,
    pub(super) shared: Shared,
}

pub(super) struct Verified {
    pub(super) path: PathBuf,
    pub(super) outcome: Outcome,
    pub(super) digests: Digests,
    pub(super) cached: bool,
    /// Error in writing the report to the cache. `None` if it was written, or was not to be written.
    pub(super) unkept: Option<io::Error>,
    /// Result of the signature check, which is never cached.
    pub(super) signed: Option<Signed>,
}

impl Verifier {
    pub(super) fn verify(&self, path: PathBuf) -> Result<Verified, CommandError> {
        let at_work = self.shared.watch.begin(path.clone(), self.time_max);
        let bytes = self.read(&path).map_err(CommandError::read(&path))?;
        let digests = Digests::of(&bytes, &self.limits);
        let signed =
            self.signers.as_ref().map(|signers| signers.check(&path, digests.game.as_ref())).transpose()?;
        let judge = || (self.judge)(&bytes, &self.limits, &self.shared, at_work.work());
        let verified = |outcome, cached, unkept| Verified { path, outcome, digests, cached, unkept, signed };
        let Some(cache) = &self.cache else {
            return Ok(verified(judge(), false, None));
        };
        let key = cache.key(&digests.blake3);
        if let Some(report) = cache.get(&key) {
            return Ok(verified(Outcome::Report(report), true, None));
        }
        let outcome = judge();
        let unkept = match &outcome {
            Outcome::Report(report) if report.is_final() => cache.put(&key, report.clone()).err(),
            _ => None,
        };
        Ok(verified(outcome, false, unkept))
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        if path.as_os_str() == tasks::INPUT {
            files::read_from(io::stdin().lock(), 0, self.limits.file_bytes)
        } else {
            files::read(path, self.limits.file_bytes)
        }
    }
}
