//! A comparison as a JSON document.

use std::path::Path;

use lockstep2d::inspect::{Difference, Value};
use lockstep2d::report::{Blame, Comparison, Group, Side, Subject, Trajectory};
use serde_json::{Value as Json, json};

pub(super) fn document([a, b]: [&Path; 2], found: &Comparison) -> Json {
    let subjects: Vec<Json> = found.subjects.iter().map(subject).collect();
    let began: Vec<Json> = found.began.iter().map(subject).collect();
    let input = found
        .input
        .as_ref()
        .map(|input| json!({"tick": input.tick, "seat": input.seat, "fields": fields(&input.differences)}));
    let explanation = found.explanation.as_ref().map(
        |one| json!({"tick": one.tick, "path": one.path, "bit": one.bit, "fields": fields(&one.differences)}),
    );
    let group = |group: &Group| json!({"hash": group.hash.to_string(), "seats": group.seats});
    let groups: Vec<Json> = found.groups.iter().map(group).collect();
    json!({
        "equal": found.is_equal(),
        "last_equal": found.last_equal,
        "first_different": found.first_different,
        "blame": blame(found.blame),
        "simulated": found.simulated,
        "a": side(a, &found.trajectories[0]),
        "b": side(b, &found.trajectories[1]),
        "checkpoint": found.checkpoint,
        "groups": groups,
        "setup": fields(&found.setup),
        "input": input,
        "claims": fields(&found.claims),
        "lengths": found.lengths,
        "explanation": explanation,
        "stage": found.stage.map(|stage| stage.name()),
        "tick": found.tick,
        "began": began,
        "subjects": subjects,
        "notes": found.notes,
    })
}

fn subject(subject: &Subject) -> Json {
    json!({
        "path": subject.path,
        "section": subject.section,
        "fields": fields(&subject.differences),
    })
}

fn side(file: &Path, trajectory: &Trajectory) -> Json {
    json!({
        "file": file.display().to_string(),
        "seats": trajectory.seats,
        "equal_until": trajectory.equal_until,
        "diverges": trajectory.diverges,
    })
}

fn blame(blame: Blame) -> &'static str {
    match blame {
        Blame::Nobody => "nobody",
        Blame::Side(Side::A) => "a",
        Blame::Side(Side::B) => "b",
        Blame::Both => "both",
        Blame::Unknown => "unknown",
    }
}

pub(in crate::commands) fn fields(differences: &[Difference]) -> Vec<Json> {
    let field = |difference: &Difference| {
        json!({
            "path": difference.field().path(),
            "name": difference.field().name(),
            "a": value(difference.a.as_ref()),
            "b": value(difference.b.as_ref()),
        })
    };
    differences.iter().map(field).collect()
}

/// A value as text. Numbers, angles and booleans also have their bits, which are text because they may exceed the range
/// of JSON numbers.
fn value(value: Option<&Value>) -> Json {
    value.map_or(
        Json::Null,
        |value| json!({"text": value.to_string(), "bits": value.bits().map(|bits| bits.to_string())}),
    )
}
