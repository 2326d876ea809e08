//! Messages about snapshots and reports.

use lockstep2d::codec::{DECODE_BYTES_MAX, DecodeError};
use lockstep2d::inspect::{InspectError, Value, differences, fields};
use lockstep2d::math::Angle;
use lockstep2d::replay::{Flaw, Mismatch, RecordError, Verdict};
use lockstep2d::report::{CompareError, EvidenceError, ReportError, ReportFlaw, Side, Stage, TraceError};
use lockstep2d::world::{Phase, SnapshotError, Violation};

use crate::says;

#[test]
fn decoding() {
    assert_eq!(DECODE_BYTES_MAX, 256 << 20);
    says([
        (DecodeError::Invalid { why: "a bad tag".into() }, "not a valid encoding: a bad tag"),
        (DecodeError::TrailingBytes { count: 3 }, "3 bytes after the end of the value"),
        (DecodeError::TooLong { count: 300_000_000 }, "300000000 bytes, at most 268435456 are decoded"),
    ]);
}

#[test]
fn snapshots() {
    says([
        (SnapshotError::NotASnapshot, "not the bytes of a world"),
        (SnapshotError::Format { found: 1 }, "format version 1, this engine reads 4"),
        (SnapshotError::Semantics { found: 2 }, "made with semantics 2, this engine has 25"),
        (SnapshotError::Length { announced: 500, found: 499 }, "499 bytes where 500 are announced"),
        (SnapshotError::Hash, "the hash does not match the bytes"),
        (
            SnapshotError::Decode(DecodeError::TrailingBytes { count: 3 }),
            "3 bytes after the end of the value",
        ),
        (
            SnapshotError::Invalid(Violation { what: "the free list of bodies".into() }),
            "an impossible state: the free list of bodies",
        ),
    ]);
}

#[test]
fn reports() {
    says([
        (ReportError::NotAReport, "not a report"),
        (ReportError::Format { found: 1 }, "format version 1, this engine reads 2"),
        (ReportError::TooLong { bytes: 9, max: 8 }, "9 bytes, at most 8 are allowed"),
        (ReportError::Length { announced: 50, found: 49 }, "49 bytes where 50 are announced"),
        (ReportError::Hash, "the hash does not match the bytes"),
        (ReportError::Decode(DecodeError::TrailingBytes { count: 3 }), "3 bytes after the end of the value"),
        (ReportError::Invalid(ReportFlaw::RulesName), "the name of the rules is empty or too long"),
        (ReportError::Invalid(ReportFlaw::Players), "more players than a game can have"),
        (
            ReportError::Invalid(ReportFlaw::Seats),
            "the seats are not in ascending order, or one of them does not exist",
        ),
        (ReportError::Invalid(ReportFlaw::Hashes), "there is not one hash for each seat"),
        (ReportError::Invalid(ReportFlaw::History), "the ticks of the history are not in ascending order"),
        (
            ReportError::Invalid(ReportFlaw::Saves),
            "the ticks of the saves are not ascending ticks of the history",
        ),
        (
            ReportError::Invalid(ReportFlaw::Phases),
            "the ticks of the phases are not ascending ticks of the history, or one has too many",
        ),
    ]);
}

#[test]
fn comparisons() {
    let why = Mismatch::Semantics { file: 2, here: 5 };
    let verdict = Verdict::Malformed { offset: 0, flaw: Flaw::Magic };
    says([
        (CompareError::Kinds, "a snapshot can only be compared with another snapshot"),
        (
            CompareError::Unverifiable { side: Side::A, why },
            "A: made with engine semantics 2, this program has 5",
        ),
        (
            CompareError::Replay { side: Side::B, verdict: verdict.clone() },
            "the replay of B: malformed: at byte 0: this is not a replay file",
        ),
        (
            CompareError::Inspect(InspectError { why: "nested too deep".into() }),
            "the value cannot be inspected: nested too deep",
        ),
    ]);
    says([
        (EvidenceError::Report(ReportError::Hash), "a damaged report: the hash does not match the bytes"),
        (EvidenceError::World(SnapshotError::Hash), "a damaged snapshot: the hash does not match the bytes"),
        (
            EvidenceError::Report(ReportError::Format { found: 1 }),
            "a report of another version: format version 1, this engine reads 2",
        ),
        (
            EvidenceError::World(SnapshotError::Semantics { found: 2 }),
            "a snapshot of another version: made with semantics 2, this engine has 25",
        ),
        (
            EvidenceError::World(SnapshotError::Format { found: 1 }),
            "a snapshot of another version: format version 1, this engine reads 4",
        ),
        (EvidenceError::Unknown, "neither a report nor a replay nor a snapshot"),
    ]);
    says([
        (TraceError::Replay(verdict), "malformed: at byte 0: this is not a replay file"),
        (TraceError::Record(RecordError::TickRate), "a tick rate of zero"),
        (
            TraceError::TooLong { bytes: 200, max: 100 },
            "a report of 200 bytes, at most 100 are allowed: trace fewer ticks",
        ),
    ]);
}

#[test]
fn stages() {
    let all = [
        (Stage::BeforeStep, "before_step", "before the step of the world"),
        (Stage::Phase(Phase::BroadPhase), "broad_phase", "in the broad phase"),
        (Stage::Phase(Phase::NarrowPhase), "narrow_phase", "in the narrow phase"),
        (Stage::Phase(Phase::Prepare), "prepare", "in the preparation of constraints"),
        (Stage::Phase(Phase::Solve), "solve", "in the solver"),
        (Stage::Phase(Phase::Finalise), "finalise", "in the finalisation of poses"),
        (Stage::Phase(Phase::Sleep), "sleep", "while putting islands to sleep"),
        (Stage::Phase(Phase::Report), "report", "in the report of events"),
        (Stage::AfterStep, "after_step", "after the step of the world"),
    ];
    for (stage, name, text) in all {
        assert_eq!((stage.name(), stage.to_string().as_str()), (name, text));
    }
}

#[test]
fn values() {
    let half_turn = Angle::from_bits(1 << 31);
    says([
        (Value::Bool(true), "true"),
        (Value::Unsigned(7), "7"),
        (Value::Signed(-7), "-7"),
        (Value::Fixed { bits: 3 << 31, fraction_bits: Some(32) }, "1.5 (bits 6442450944)"),
        (Value::Fixed { bits: -3, fraction_bits: None }, "bits -3"),
        (Value::Angle(half_turn), "180 degrees (bits 2147483648)"),
        (Value::Float(0x3f80_0000), "a float (bits 0x3f800000)"),
        (Value::Text("a \"b\"".into()), "\"a \\\"b\\\"\""),
        (Value::Bytes(vec![1, 255]), "2 bytes 01 ff"),
        (Value::Bytes(vec![0; 17]), "17 bytes 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 ..."),
        (Value::Name("Circle"), "Circle"),
        (Value::Empty, "empty"),
    ]);
}

#[test]
fn what_differs() {
    let (a, b) = (fields(&[1, 2, 3]).expect("numbers"), fields(&vec![1, 4]).expect("numbers"));
    let found = differences(&a, &b);
    let texts: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert_eq!(texts, ["[1]: 2 | 4", "[2]: 3 | nothing"]);
}
