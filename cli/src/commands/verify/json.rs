//! A verdict as one line of JSON.

use std::path::Path;

use lockstep2d::replay::{ClaimDifference, Verdict};
use serde::Serialize;

/// What every line has.
#[derive(Serialize)]
struct Line<'a> {
    file: String,
    verdict: &'static str,
    ticks: u64,
    hash: Option<String>,
    #[serde(flatten)]
    details: Details<'a>,
}

/// What a line has for its verdict only.
#[derive(Serialize)]
#[serde(untagged)]
enum Details<'a> {
    None {},
    FinalHash { claim: &'static str, claimed: String, actual: String },
    Claim { claim: &'a str, claimed: Option<i64>, actual: Option<i64> },
    Diverged { last_equal: Option<u64>, first_different: u64 },
    Malformed { offset: u64, why: String },
    LimitExceeded { limit: &'static str, value: u64, max: u64 },
    Unverifiable { why: String },
}

pub(super) fn line(file: &Path, verdict: &Verdict) -> String {
    let line = Line {
        file: file.display().to_string(),
        verdict: verdict.name(),
        ticks: verdict.ticks(),
        hash: verdict.hash().map(|hash| hash.to_string()),
        details: details(verdict),
    };
    serde_json::to_string(&line).expect("strings and numbers have a JSON form")
}

fn details(verdict: &Verdict) -> Details<'_> {
    match verdict {
        Verdict::Match { .. } | Verdict::Incomplete { .. } => Details::None {},
        Verdict::ClaimMismatch { difference: ClaimDifference::FinalHash { claimed, actual }, .. } => {
            Details::FinalHash {
                claim: "final_hash",
                claimed: claimed.to_string(),
                actual: actual.to_string(),
            }
        }
        Verdict::ClaimMismatch { difference: ClaimDifference::Value { name, claimed, actual }, .. } => {
            Details::Claim { claim: name, claimed: *claimed, actual: *actual }
        }
        Verdict::Diverged { last_equal, first_different } => {
            Details::Diverged { last_equal: *last_equal, first_different: *first_different }
        }
        Verdict::Malformed { offset, flaw } => Details::Malformed { offset: *offset, why: flaw.to_string() },
        Verdict::LimitExceeded { limit, value, max } => {
            Details::LimitExceeded { limit: limit.name(), value: *value, max: *max }
        }
        Verdict::Unverifiable { why } => Details::Unverifiable { why: why.to_string() },
    }
}
