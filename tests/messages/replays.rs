//! Messages about replays.

use lockstep2d::codec::DecodeError;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::InputError;
use lockstep2d::replay::{
    ClaimDifference, Flaw, KeyframesError, KeyframesFlaw, LimitKind, Mismatch, ReadError, RecordError,
    SeekError, Verdict,
};

use crate::says;

#[test]
fn flaws_of_the_header() {
    says([
        (Flaw::Magic, "this is not a replay file"),
        (Flaw::HeaderCut, "the file ends inside the header"),
        (Flaw::RulesName, "the name of the rules is not 1 to 64 bytes of UTF-8"),
        (Flaw::HeaderChecksum, "the header does not match its checksum"),
        (Flaw::Players { count: 65 }, "65 players, at most 64 are possible"),
        (Flaw::TickRate, "a tick rate of zero"),
        (Flaw::CheckpointInterval, "a checkpoint interval of zero"),
        (Flaw::Setup, "the setup is not a valid setup of this game"),
        (Flaw::SetupRefused { why: "no floor".into() }, "the setup cannot start a game: no floor"),
        (
            Flaw::PlayersDisagree { header: 3, game: 2 },
            "the header states 3 players, its setup makes a game with 2",
        ),
        (
            Flaw::TickRateDisagrees { header: 30, game: 60 },
            "the header states 30 ticks per second, its setup makes a game with 60",
        ),
    ]);
}

#[test]
fn flaws_of_blocks() {
    says([
        (Flaw::BlockKind { kind: 99 }, "a block of unknown kind 99"),
        (Flaw::BlockChecksum, "the block does not match its checksum"),
        (Flaw::BlockCut, "the block ends in the middle of a field"),
        (Flaw::Number, "a number is too large or not in its shortest form"),
        (Flaw::EmptyBlock, "a block without a tick"),
        (Flaw::EmptyRun, "a run of no ticks"),
        (Flaw::SplitRun, "two neighbouring runs have the same inputs"),
        (Flaw::BlockTicks { ticks: 61, interval: 60 }, "61 ticks in a block, at a checkpoint interval of 60"),
        (Flaw::BlockAfterLast, "a block of inputs follows a block shorter than the checkpoint interval"),
        (Flaw::Inputs, "the bytes are not one valid input of this game for each player"),
    ]);
}

#[test]
fn flaws_of_the_trailer() {
    says([
        (Flaw::Ticks { trailer: 10, blocks: 9 }, "the trailer states 10 ticks, the blocks have 9"),
        (Flaw::Chain, "the trailer's chain hash is not that of this file"),
        (Flaw::Claims { count: 257 }, "257 claims, at most 256 are possible"),
        (Flaw::ClaimName, "the name of a claim is not 1 to 64 bytes of UTF-8"),
        (Flaw::ClaimOrder, "the claims are not in ascending order of their names"),
        (Flaw::TrailerLength, "bytes follow the last claim"),
        (Flaw::TrailingBytes { count: 5 }, "5 bytes follow the trailer"),
    ]);
}

#[test]
fn reading() {
    says([
        (
            ReadError::Malformed { offset: 40, flaw: Flaw::BlockCut },
            "at byte 40: the block ends in the middle of a field",
        ),
        (
            ReadError::LimitExceeded { limit: LimitKind::Players, value: 9, max: 8 },
            "9 players, at most 8 are allowed",
        ),
        (ReadError::OtherFormat { version: 7 }, "version 7 of the file format"),
    ]);
}

#[test]
fn limits() {
    let exceeded = |limit| Verdict::LimitExceeded { limit, value: 7, max: 6 };
    says([
        (exceeded(LimitKind::FileBytes), "limit exceeded: 7 bytes of the file, at most 6 are allowed"),
        (exceeded(LimitKind::SetupBytes), "limit exceeded: 7 bytes of the setup, at most 6 are allowed"),
        (exceeded(LimitKind::Players), "limit exceeded: 7 players, at most 6 are allowed"),
        (exceeded(LimitKind::BlockBytes), "limit exceeded: 7 bytes of a block, at most 6 are allowed"),
        (
            exceeded(LimitKind::BlockTicks),
            "limit exceeded: 7 ticks between checkpoints, at most 6 are allowed",
        ),
        (exceeded(LimitKind::Ticks), "limit exceeded: 7 ticks, at most 6 are allowed"),
        (exceeded(LimitKind::Bodies), "limit exceeded: 7 bodies, at most 6 are allowed"),
        (exceeded(LimitKind::TickWork), "limit exceeded: 7 work units in one tick, at most 6 are allowed"),
        (exceeded(LimitKind::TotalWork), "limit exceeded: 7 work units, at most 6 are allowed"),
    ]);
}

#[test]
fn verdicts() {
    let hash = StateHash(0xab);
    let all = 9;
    let difference = ClaimDifference::FinalHash { claimed: StateHash(1), actual: hash };
    says([
        (Verdict::Match { ticks: all, hash }, "match: 9 ticks, final hash 000000000000000000000000000000ab"),
        (
            Verdict::ClaimMismatch { ticks: all, hash, difference },
            "claim mismatch: all 9 ticks agree, but the trailer states the final hash \
             00000000000000000000000000000001, the game has 000000000000000000000000000000ab",
        ),
        (
            Verdict::Diverged { last_equal: Some(60), first_different: 120 },
            "diverged: equal at tick 60, different at tick 120",
        ),
        (
            Verdict::Diverged { last_equal: None, first_different: 0 },
            "diverged: different at tick 0, the start",
        ),
        (
            Verdict::Incomplete { ticks: all, hash },
            "incomplete: the first 9 ticks agree, then the file ends without a trailer",
        ),
        (
            Verdict::Malformed { offset: 3, flaw: Flaw::Magic },
            "malformed: at byte 3: this is not a replay file",
        ),
        (
            Verdict::Unverifiable { why: Mismatch::Format { file: 2, here: 1 } },
            "unverifiable: made in version 2 of the file format, this program reads 1",
        ),
    ]);
}

#[test]
fn claims() {
    let value = |claimed, actual| ClaimDifference::Value { name: "score".into(), claimed, actual };
    says([
        (value(Some(4), Some(-3)), "the trailer claims 4 as \"score\", the game reports -3"),
        (value(Some(4), None), "the trailer claims 4 as \"score\", the game reports no such value"),
        (value(None, Some(3)), "the trailer leaves out \"score\", which the game reports as 3"),
        (value(None, None), "neither the trailer nor the game has \"score\""),
    ]);
}

#[test]
fn mismatches_say_what_is_needed() {
    says([
        (Mismatch::Semantics { file: 2, here: 7 }, "made with engine semantics 2, this program has 7"),
        (
            Mismatch::Rules { file: ("shove".into(), 1), here: ("shove".into(), 4) },
            "made with the rules \"shove\" version 1, this program has \"shove\" version 4",
        ),
    ]);
}

#[test]
fn recording() {
    says([
        (RecordError::RulesName, "the name of the rules is not 1 to 64 bytes long"),
        (RecordError::Players { count: 70 }, "70 players, at most 64 are possible"),
        (RecordError::TickRate, "a tick rate of zero"),
        (
            RecordError::CheckpointInterval { ticks: 0 },
            "a checkpoint interval of 0 ticks, expected 1 to 3600",
        ),
        (RecordError::Setup, "the setup changes when it is encoded and decoded"),
        (RecordError::SetupRefused { why: "no floor".into() }, "the setup cannot start a game: no floor"),
        (
            RecordError::SetupLength { bytes: 16_777_217 },
            "a setup of 16777217 bytes, at most 16777216 are possible",
        ),
        (RecordError::Inputs(InputError::Count { players: 2, inputs: 3 }), "3 inputs for 2 players"),
        (RecordError::Inputs(InputError::NotCanonical), "the inputs do not survive encoding and decoding"),
        (
            RecordError::BlockLength { bytes: 16_777_218 },
            "a block of 16777218 bytes, at most 16777216 are possible",
        ),
        (RecordError::CheckpointDue, "the block is full, its checkpoint must be given before the next tick"),
        (RecordError::Claims, "at most 256 claims with different names of 1 to 64 bytes are possible"),
    ]);
}

#[test]
fn seeking() {
    says([
        (SeekError::NoSuchTick { tick: 11, ticks: 10 }, "there are 10 ticks, and no tick 11"),
        (
            SeekError::Replay(Verdict::Malformed { offset: 0, flaw: Flaw::Magic }),
            "malformed: at byte 0: this is not a replay file",
        ),
        (SeekError::Keyframe { tick: 60, why: "a bad tag".into() }, "the keyframe of tick 60: a bad tag"),
        (
            SeekError::Forgetful { tick: 8 },
            "after seeking backwards, tick 8 has another state: saving and loading this game loses state",
        ),
    ]);
}

#[test]
fn keyframes() {
    says([
        (KeyframesError::NotKeyframes, "this is not a file of keyframes"),
        (KeyframesError::Format { found: 9 }, "format version 9, this engine reads 1"),
        (KeyframesError::Semantics { found: 2 }, "made with engine semantics 2, this program has 25"),
        (
            KeyframesError::Rules { name: "shove".into(), version: 8 },
            "made with the rules \"shove\" version 8, which are not those of this program",
        ),
        (KeyframesError::OtherReplay, "the keyframes belong to another replay"),
        (KeyframesError::Length { announced: 90, found: 80 }, "80 bytes where 90 are announced"),
        (KeyframesError::Hash, "the hash does not match the bytes"),
        (
            KeyframesError::Decode(DecodeError::Invalid { why: "a bad tag".into() }),
            "not a valid encoding: a bad tag",
        ),
        (KeyframesError::Invalid(KeyframesFlaw::Interval), "an interval of zero"),
        (
            KeyframesError::Invalid(KeyframesFlaw::Ticks),
            "the ticks are not ascending multiples of the interval within the replay",
        ),
        (
            KeyframesError::Invalid(KeyframesFlaw::Checkpoint),
            "a keyframe at a tick without a checkpoint in the replay",
        ),
    ]);
}
