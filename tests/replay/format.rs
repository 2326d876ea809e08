//! A recorded replay matches, a damaged one does not, and the bytes are those of `docs/FORMAT.md`.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::{Flaw, Limits, Recording, Step, Verdict, VerifiedReplay};

use crate::counter::{Counter, add, inputs_at, setup};
use crate::{record, verdict};

/// State hash of the game after `ticks` ticks, simulated without a replay.
fn hash_after(ticks: u64) -> StateHash {
    let mut game = Counter::new(&setup()).unwrap();
    for tick in 0..ticks {
        game.step(&inputs_at(tick));
    }
    game.state_hash()
}

#[test]
fn a_recording_matches() {
    for (ticks, interval) in [(0, 10), (1, 10), (9, 10), (10, 10), (11, 10), (100, 1), (1000, 60), (7, 3600)]
    {
        let file = record(ticks, interval, inputs_at);
        let expected = Verdict::Match { ticks, hash: hash_after(ticks) };
        assert_eq!(verdict(&file), expected, "{ticks} ticks, a checkpoint every {interval}");
    }
}

#[test]
fn a_file_cut_at_any_byte_is_incomplete_or_malformed() {
    let file = record(35, 10, inputs_at);
    let mut ticks_seen = Vec::new();
    for length in 0..file.len() {
        match verdict(&file[..length]) {
            Verdict::Incomplete { ticks, hash } => {
                assert_eq!(hash, hash_after(ticks), "cut at {length}");
                ticks_seen.push(ticks);
            }
            Verdict::Malformed { flaw: Flaw::HeaderCut, offset } => {
                assert_eq!(offset, length as u64);
                assert!(ticks_seen.is_empty(), "a cut after the header must be incomplete, at {length}");
            }
            other => panic!("cut at {length}: {other}"),
        }
    }
    ticks_seen.dedup();
    assert_eq!(ticks_seen, [0, 10, 20, 30, 35], "expected the ticks of every whole block");
}

#[test]
fn a_file_with_any_bit_flipped_never_matches() {
    let file = record(35, 10, inputs_at);
    assert!(verdict(&file).is_match());
    for bit in 0..file.len() * 8 {
        let mut damaged = file.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(!verdict(&damaged).is_match(), "byte {}, bit {}", bit / 8, bit % 8);
    }
}

#[test]
fn bytes_after_the_trailer_are_malformed() {
    let mut file = record(5, 10, inputs_at);
    let end = file.len() as u64;
    file.push(0);
    let expected = Verdict::Malformed { offset: end, flaw: Flaw::TrailingBytes { count: 1 } };
    assert_eq!(verdict(&file), expected);
    file.pop();
    let twice = [file.clone(), file.clone()].concat();
    assert_eq!(verdict(&twice), Verdict::Malformed { offset: end, flaw: Flaw::TrailingBytes { count: end } });
}

#[test]
fn what_is_not_a_replay_is_malformed() {
    assert_eq!(verdict(b""), Verdict::Malformed { offset: 0, flaw: Flaw::HeaderCut });
    let magic = Verdict::Malformed { offset: 0, flaw: Flaw::Magic };
    assert_eq!(verdict(b"\x89PNG\r\n\x1a\n and so on"), magic);
    let file = record(5, 10, inputs_at);
    let as_text: Vec<u8> = file.iter().copied().filter(|byte| *byte != b'\r').collect();
    assert_eq!(verdict(&as_text), magic, "a file with rewritten line endings");
}

#[test]
fn a_replay_can_be_stopped_at_any_tick() {
    let file = record(35, 10, inputs_at);
    let mut replay = VerifiedReplay::<Counter>::open(&file, &Limits::default()).unwrap();
    assert_eq!(replay.ticks(), 35);
    for tick in 0..=35 {
        assert_eq!(replay.tick(), tick);
        assert_eq!(replay.game().state_hash(), hash_after(tick), "after tick {tick}");
        let expected = if tick < 35 { Step::Ticked } else { Step::Ended };
        assert_eq!(replay.step(), Ok(expected));
    }
    assert!(replay.conclude().is_match());

    let mut replay = VerifiedReplay::<Counter>::open(&file, &Limits::default()).unwrap();
    for _ in 0..34 {
        replay.step().unwrap();
    }
    assert_eq!(replay.conclude(), Verdict::Incomplete { ticks: 34, hash: hash_after(34) });
}

/// The recording has four ticks of the counter, and a checkpoint every three ticks.
#[test]
fn the_bytes_are_those_of_the_document() {
    let mut recording = Recording::<Counter>::start(&setup(), 3).unwrap();
    for inputs in [add(1, 0), add(1, 0), add(2, -1), add(2, -1)] {
        recording.step(&inputs).unwrap();
    }
    let written = recording.finish().unwrap();
    let documented = example_of(include_str!("../../docs/FORMAT.md"));
    assert!(
        written == documented,
        "the example in docs/FORMAT.md differs from the encoding. If the layout change is intended, raise \
         FORMAT_VERSION; if the state hash changed, raise SEMANTICS; then replace it by:\n{}",
        hex_lines(&written)
    );
    assert!(verdict(&documented).is_match());
}

/// Bytes of the example in the document's `hex` block: the hexadecimal digits before the `|` of each line.
fn example_of(document: &str) -> Vec<u8> {
    let (_, rest) = document.split_once("```hex\n").expect("an example in the document");
    let (block, _) = rest.split_once("```").expect("an end of the example");
    let digits = block.lines().filter_map(|line| line.split('|').next());
    digits
        .flat_map(str::split_whitespace)
        .map(|byte| u8::from_str_radix(byte, 16).expect("two hexadecimal digits"))
        .collect()
}

fn hex_lines(bytes: &[u8]) -> String {
    let line = |chunk: &[u8]| chunk.iter().map(|byte| format!("{byte:02x} ")).collect::<String>() + "\n";
    bytes.chunks(16).map(line).collect()
}
