//! [`Report`]: the verdict on a file's bytes, as it is printed and cached.

use std::io;
use std::path::Path;

use lockstep2d::replay::{ClaimDifference, Limits, Verdict};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::signers::Signed;
use crate::console::json_text;
use crate::identity::GameDigest;
use crate::panics::{PANICKED, Panic, PanicText};

/// The verdict on a file's bytes. Unless it is a panic, it depends only on the bytes, the limits and the program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Report {
    /// Readable text: the verdict, a colon, the details.
    pub(super) text: String,
    pub(super) verdict: String,
    pub(super) ticks: u64,
    hash: Option<String>,
    /// Number of bytes read from the file: at most one more than the size limit.
    bytes: u64,
    /// Further fields of the JSON line. The verdict determines their names.
    details: Map<String, Value>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Digests {
    /// BLAKE3 digest of the bytes that were read or, with [`Digests::of_part`], of the whole file.
    pub(super) blake3: blake3::Hash,
    pub(super) game: Option<GameDigest>,
}

impl Digests {
    /// The digests of a file. `game` is `None` if the file is damaged, has another format version or exceeds a limit.
    pub(super) fn of(bytes: &[u8], limits: &Limits) -> Self {
        Self::of_part(bytes, limits, blake3::hash(bytes))
    }

    /// Like [`Digests::of`], but `bytes` may be only the beginning of the file. `blake3` is the digest of the whole
    /// file.
    pub(super) fn of_part(bytes: &[u8], limits: &Limits, blake3: blake3::Hash) -> Self {
        Digests { blake3, game: GameDigest::of_any(bytes, limits).ok() }
    }

    fn texts(&self) -> (String, Option<String>) {
        (self.blake3.to_string(), self.game.map(|game| game.to_string()))
    }
}

/// The versions that a file requires. If this program cannot read the format of the file, only `format` is set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Needs {
    pub(super) format: u32,
    pub(super) semantics: Option<u32>,
    pub(super) rules: Option<String>,
    pub(super) rules_version: Option<u32>,
}

impl Report {
    /// `claims` come from the trailer. `needs` are the versions that the file requires, if this program cannot verify
    /// the file.
    pub(super) fn new(bytes: u64, verdict: &Verdict, claims: &[(String, i64)], needs: Option<Needs>) -> Self {
        let mut text = verdict.to_string();
        if verdict.is_match() && !claims.is_empty() {
            let claims = claims.iter().map(|(name, value)| format!("{name} {value}"));
            text += &format!("; {}", claims.collect::<Vec<_>>().join(", "));
        }
        Report {
            text,
            verdict: verdict.name().into(),
            ticks: verdict.ticks(),
            hash: verdict.hash().map(|hash| hash.to_string()),
            bytes,
            details: details(verdict, claims, needs),
        }
    }

    pub(super) fn of_panic(bytes: u64, ticks: u64, panic: &Panic) -> Self {
        let Panic { message, location } = panic;
        let text = PanicText { panic, ticks: Some(ticks) }.to_string();
        let details = object(json!({ "why": message, "location": location }));
        Report { text, verdict: PANICKED.into(), ticks, hash: None, bytes, details }
    }

    pub(super) fn is_match(&self) -> bool {
        self.verdict == "match"
    }

    /// Whether the file may be valid although it does not match.
    pub(super) fn is_doubtful(&self) -> bool {
        matches!(self.verdict.as_str(), "incomplete" | "unverifiable")
    }

    /// Whether the report may be cached, because every other run gives the same one. After a panic this is not certain:
    /// the machine may have caused it, or the game may be mended later.
    pub(super) fn is_final(&self) -> bool {
        self.verdict != PANICKED
    }

    pub(super) fn json(
        &self,
        file: &Path,
        digests: &Digests,
        cached: bool,
        signed: Option<&Signed>,
    ) -> String {
        #[derive(Serialize)]
        struct Whole<'a> {
            file: String,
            verdict: &'a str,
            ticks: u64,
            hash: Option<&'a str>,
            bytes: u64,
            blake3: String,
            game: Option<String>,
            cached: bool,
            #[serde(flatten)]
            signed: Option<&'a Signed>,
            #[serde(flatten)]
            details: &'a Map<String, Value>,
        }
        let Report { text: _, verdict, ticks, hash, bytes, details } = self;
        let (ticks, hash, bytes) = (*ticks, hash.as_deref(), *bytes);
        let file = file.display().to_string();
        let (blake3, game) = digests.texts();
        let line = Whole { file, verdict, ticks, hash, bytes, blake3, game, cached, signed, details };
        json_text(&line)
    }
}

/// The JSON line of a file that cannot be read. It contains no verdict.
pub(super) fn unread(file: &Path, error: &io::Error) -> String {
    json_text(&json!({ "file": file.display().to_string(), "error": error.to_string() }))
}

/// The JSON line of a file that has exceeded its time limit. It contains no verdict.
pub(super) fn out_of_time(
    file: &Path,
    digests: &Digests,
    signed: Option<&Signed>,
    seconds: u64,
    ticks: u64,
) -> String {
    #[derive(Serialize)]
    struct OutOfTime<'a> {
        file: String,
        stopped: &'static str,
        seconds: u64,
        ticks: u64,
        blake3: String,
        game: Option<String>,
        cached: bool,
        #[serde(flatten)]
        signed: Option<&'a Signed>,
    }
    let file = file.display().to_string();
    let (blake3, game) = digests.texts();
    let stopped = "max_seconds";
    json_text(&OutOfTime { file, stopped, seconds, ticks, blake3, game, cached: false, signed })
}

fn details(verdict: &Verdict, claims: &[(String, i64)], needs: Option<Needs>) -> Map<String, Value> {
    let stated = || claims.iter().map(|(name, value)| (name.clone(), json!(value))).collect::<Map<_, _>>();
    object(match verdict {
        Verdict::Match { .. } => json!({ "claims": stated() }),
        Verdict::Incomplete { .. } => json!({}),
        Verdict::ClaimMismatch { difference: ClaimDifference::FinalHash { claimed, actual }, .. } => json!({
            "claim": "final_hash",
            "claimed": claimed.to_string(),
            "actual": actual.to_string(),
            "claims": stated(),
        }),
        Verdict::ClaimMismatch { difference: ClaimDifference::Value { name, claimed, actual }, .. } => {
            json!({ "claim": name, "claimed": claimed, "actual": actual, "claims": stated() })
        }
        Verdict::Diverged { last_equal, first_different } => {
            json!({ "last_equal": last_equal, "first_different": first_different })
        }
        Verdict::Malformed { offset, flaw } => json!({ "offset": offset, "why": flaw.to_string() }),
        Verdict::LimitExceeded { limit, value, max } => {
            json!({ "limit": limit.name(), "value": value, "max": max })
        }
        Verdict::Unverifiable { why } => json!({ "why": why.to_string(), "needs": needs }),
    })
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}
