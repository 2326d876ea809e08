//! No forged file with repaired checksums matches. The verifier refuses content that no recorder
//! writes, and names the right flaw.

use lockstep2d::hash::StateHash;
use lockstep2d::replay::{
    ClaimDifference, FORMAT_VERSION, Flaw, Limits, Mismatch, Step, Verdict, VerifiedReplay,
};

use crate::counter::{Counter, inputs_at};
use crate::forge::{CHAIN, Forged, INPUTS, KEYFRAME, TRAILER, forge};
use crate::{record, verdict};

/// A replay with three full blocks of ten ticks, a block of five ticks, and the trailer.
fn original() -> Vec<u8> {
    record(35, 10, inputs_at)
}

/// Verdict on a changed replay with repaired checksums.
fn forged(change: impl FnOnce(&mut Forged)) -> Verdict {
    verdict(&forge(&original(), change))
}

fn assert_flaw(verdict: Verdict, expected: Flaw) {
    match verdict {
        Verdict::Malformed { flaw, .. } => assert_eq!(flaw, expected),
        other => panic!("{other}, expected: {expected}"),
    }
}

#[test]
fn the_forger_repairs_perfectly() {
    let file = original();
    assert_eq!(forge(&file, |_| {}), file);
    assert_eq!(
        forge(&file, |forged| forged.trailer()[CHAIN].fill(0)),
        file,
        "expected the chain hash to be repaired"
    );
}

#[test]
fn no_flipped_bit_matches_even_with_checksums_repaired() {
    let file = original();
    let intact = Forged::take_apart(&file);
    for bit in 0..intact.header.len() * 8 {
        let mut forged = intact.clone();
        forged.header[bit / 8] ^= 1 << (bit % 8);
        assert!(!verdict(&forged.put_together()).is_match(), "header, byte {}, bit {}", bit / 8, bit % 8);
    }
    for (index, (kind, payload)) in intact.blocks.iter().enumerate() {
        for bit in 0..payload.len() * 8 {
            if *kind == TRAILER && CHAIN.contains(&(bit / 8)) {
                continue; // The chain hash is repaired.
            }
            let mut forged = intact.clone();
            forged.payload(index)[bit / 8] ^= 1 << (bit % 8);
            let verdict = verdict(&forged.put_together());
            assert!(!verdict.is_match(), "block {index}, byte {}, bit {}", bit / 8, bit % 8);
        }
    }
}

#[test]
fn an_input_that_the_game_ignores_is_bound_all_the_same() {
    // The flipped bit is the wink of the first player. Layout of a run: ticks, length, add, wink, add, wink.
    let verdict = forged(|forged| forged.payload(0)[3] ^= 1);
    assert_eq!(verdict, Verdict::Diverged { last_equal: Some(0), first_different: 10 });
}

#[test]
fn a_setup_that_makes_no_difference_is_bound_all_the_same() {
    let verdict = forged(|forged| {
        let label = forged.header.len() - 17;
        assert_eq!(forged.header[label], b'a');
        forged.header[label] = b'b';
    });
    assert_eq!(verdict, Verdict::Diverged { last_equal: None, first_different: 0 });
}

#[test]
fn a_divergence_is_told_to_the_block() {
    let verdict = forged(|forged| forged.payload(2)[2] ^= 1);
    assert_eq!(verdict, Verdict::Diverged { last_equal: Some(20), first_different: 30 });
    let verdict = forged(|forged| *forged.payload(3).last_mut().unwrap() ^= 1);
    assert_eq!(verdict, Verdict::Diverged { last_equal: Some(30), first_different: 35 });
}

#[test]
fn a_cut_file_that_diverges_is_diverged() {
    let file = forge(&original(), |forged| {
        forged.payload(1)[2] ^= 1;
        forged.blocks.truncate(3);
    });
    let diverged = Verdict::Diverged { last_equal: Some(10), first_different: 20 };
    assert_eq!(verdict(&file), diverged);
    assert_eq!(verdict(&file[..file.len() - 1]), diverged, "truncated inside the third block");
    let first_only = forge(&file, |forged| forged.blocks.truncate(1));
    assert!(matches!(verdict(&first_only), Verdict::Incomplete { ticks: 10, .. }));
}

#[test]
fn ticks_cannot_be_added_removed_or_moved() {
    let ticks = |trailer, blocks| Flaw::Ticks { trailer, blocks };
    assert_flaw(forged(|forged| forged.set_ticks(34)), ticks(34, 35));
    assert_flaw(forged(|forged| drop(forged.blocks.remove(3))), ticks(35, 30));
    assert_flaw(forged(|forged| forged.blocks.insert(1, forged.blocks[0].clone())), ticks(35, 45));

    let without_the_last = forged(|forged| {
        forged.blocks.remove(3);
        forged.set_ticks(30);
    });
    match without_the_last {
        Verdict::ClaimMismatch { ticks: 30, difference: ClaimDifference::FinalHash { .. }, .. } => {}
        other => panic!("{other}"),
    }
    let swapped = forged(|forged| forged.blocks.swap(0, 1));
    assert_eq!(swapped, Verdict::Diverged { last_equal: Some(0), first_different: 10 });
    // The last block has one run of five ticks.
    let shorter = forged(|forged| {
        assert_eq!(forged.payload(3)[0], 5);
        forged.payload(3)[0] = 4;
        forged.set_ticks(34);
    });
    assert_eq!(shorter, Verdict::Diverged { last_equal: Some(30), first_different: 34 });
}

#[test]
fn the_end_cannot_be_restated() {
    let file = original();
    let Verdict::Match { hash: actual, .. } = verdict(&file) else { panic!("the original does not match") };
    let other_hash = forged(|forged| forged.trailer()[8] ^= 1);
    let difference = ClaimDifference::FinalHash { claimed: StateHash(actual.0 ^ 1), actual };
    assert_eq!(other_hash, Verdict::ClaimMismatch { ticks: 35, hash: actual, difference });

    let value = |name: &str, claimed, actual_value| Verdict::ClaimMismatch {
        ticks: 35,
        hash: actual,
        difference: ClaimDifference::Value { name: name.into(), claimed, actual: actual_value },
    };
    // Layout of the claims: count 2; length 4, "half", 8 bytes of value; length 3, "sum", 8 bytes of value.
    let count = CHAIN.end;
    let (half, sum) = (count + 1, count + 1 + 13);
    assert_eq!(forged(|forged| forged.trailer()[sum + 4] ^= 64), value("sum", Some(40 ^ 64), Some(40)));
    assert_eq!(forged(|forged| forged.trailer()[sum + 3] = b'n'), value("sum", None, Some(40)));
    assert_eq!(forged(|forged| forged.trailer()[half + 1] = b'b'), value("balf", Some(20), None));
    let none = forged(|forged| {
        forged.trailer()[count] = 0;
        forged.trailer().truncate(half);
    });
    assert_eq!(none, value("half", None, Some(20)));
}

#[test]
fn what_could_be_written_otherwise_is_refused() {
    let run = [0xfd, 0, 1, 0]; // -3 and 1, as in the first run of ticks
    let replace_first = |with: &[u8]| {
        forged(|forged| {
            let payload = forged.payload(0);
            assert_eq!(
                payload[..6],
                [[4, 4].as_slice(), &run].concat(),
                "expected four ticks before the wink"
            );
            payload.splice(..6, with.iter().copied());
        })
    };
    let split = [[3, 4].as_slice(), &run, &[1, 4], &run].concat();
    assert_flaw(replace_first(&split), Flaw::SplitRun);
    let empty = [[0, 4].as_slice(), &[9, 0, 9, 0], &[4, 4], &run].concat();
    assert_flaw(replace_first(&empty), Flaw::EmptyRun);
    let padded = [[0x84, 0x00, 4].as_slice(), &run].concat();
    assert_flaw(replace_first(&padded), Flaw::Number);
    let longer = [[9, 4].as_slice(), &run].concat();
    assert_flaw(replace_first(&longer), Flaw::BlockTicks { ticks: 15, interval: 10 });
    assert_flaw(replace_first(&[4, 4, 0xfd, 2, 1, 0]), Flaw::Inputs); // a bool with the value 2
    assert_flaw(replace_first(&[4, 3, 0xfd, 0, 1]), Flaw::Inputs);
    assert_flaw(replace_first(&[4, 5, 0xfd, 0, 1, 0, 0]), Flaw::Inputs);
    assert_flaw(replace_first(&[4, 0]), Flaw::Inputs);
}

#[test]
fn blocks_out_of_place_are_refused() {
    let checkpoint_only = forged(|forged| *forged.payload(0) = vec![7; 16]);
    assert_flaw(checkpoint_only, Flaw::EmptyBlock);
    assert_flaw(forged(|forged| forged.payload(0).truncate(15)), Flaw::BlockCut);
    assert_flaw(forged(|forged| forged.payload(0).clear()), Flaw::BlockCut);
    assert_flaw(forged(|forged| forged.blocks.swap(2, 3)), Flaw::BlockAfterLast);
    for kind in [0, KEYFRAME, 4, 255] {
        let unknown = forged(|forged| forged.blocks.insert(1, (kind, vec![1, 2, 3])));
        assert_flaw(unknown, Flaw::BlockKind { kind });
    }
    assert_flaw(forged(|forged| forged.blocks[0].0 = TRAILER), Flaw::BlockCut);
    assert_flaw(forged(|forged| forged.blocks[4].0 = INPUTS), Flaw::BlockAfterLast);
}

#[test]
fn a_trailer_out_of_shape_is_refused() {
    let count = CHAIN.end;
    assert_flaw(forged(|forged| forged.trailer().truncate(39)), Flaw::BlockCut);
    assert_flaw(forged(|forged| forged.trailer().truncate(count)), Flaw::BlockCut);
    assert_flaw(forged(|forged| forged.trailer().truncate(count + 5)), Flaw::BlockCut);
    assert_flaw(forged(|forged| forged.trailer().push(0)), Flaw::TrailerLength);
    assert_flaw(forged(|forged| forged.trailer()[count + 1] = 0), Flaw::ClaimName);
    assert_flaw(forged(|forged| forged.trailer()[count + 1] = 65), Flaw::ClaimName);
    assert_flaw(forged(|forged| forged.trailer()[count + 2] = 0xff), Flaw::ClaimName);
    assert_flaw(forged(|forged| forged.trailer()[count + 2] = b'z'), Flaw::ClaimOrder);
    let too_many = forged(|forged| drop(forged.trailer().splice(count..=count, [0x81, 0x02])));
    assert_flaw(too_many, Flaw::Claims { count: 257 });
    let twice = forged(|forged| {
        let trailer = forged.trailer();
        trailer[count] = 3;
        let sum = trailer[count + 14..].to_vec();
        trailer.extend(sum);
    });
    assert_flaw(twice, Flaw::ClaimOrder);
}

#[test]
fn a_chain_hash_of_another_file_is_refused() {
    // The checksum of the trailer is repaired. Only the chain hash inside the trailer is wrong.
    let file = original();
    let trailer = Forged::take_apart(&file).blocks.pop().unwrap().1;
    let payload = file.len() - 8 - trailer.len();
    let mut damaged = file.clone();
    damaged[payload + CHAIN.start + 8] ^= 1;
    let before = StateHash(u128::from_le_bytes(trailer[CHAIN].try_into().unwrap()));
    let block = &damaged[payload - 5..file.len() - 8];
    let chain = StateHash::of_digests([before, StateHash::of_bytes(block)]);
    let end = damaged.len() - 8;
    damaged[end..].copy_from_slice(&chain.0.to_le_bytes()[..8]);
    assert_flaw(verdict(&damaged), Flaw::Chain);
}

#[test]
fn a_header_out_of_shape_is_refused() {
    let with = |at: usize, number: u32| {
        forged(|forged| forged.header[at..at + 4].copy_from_slice(&number.to_le_bytes()))
    };
    assert_flaw(with(20, 65), Flaw::Players { count: 65 });
    assert_flaw(with(20, 3), Flaw::PlayersDisagree { header: 3, game: 2 });
    assert_flaw(with(24, 0), Flaw::TickRate);
    assert_flaw(with(24, 50), Flaw::TickRateDisagrees { header: 50, game: 60 });
    assert_flaw(with(28, 0), Flaw::CheckpointInterval);
    assert_flaw(with(32, 0), Flaw::RulesName);
    assert_flaw(with(32, 65), Flaw::RulesName);
    assert_flaw(forged(|forged| forged.header[40] = 0xff), Flaw::RulesName);
    let setup = 40 + "counter".len();
    assert_flaw(with(setup, 1001), Flaw::SetupRefused { why: "the sum starts above 1000".into() });
    assert_flaw(with(setup + 4, 2), Flaw::Setup);
    assert_flaw(with(setup + 4, 0), Flaw::Setup);
}

#[test]
fn a_file_of_another_program_is_unverifiable() {
    let with = |at: usize, number: u32| match forged(|forged| {
        forged.header[at..at + 4].copy_from_slice(&number.to_le_bytes());
    }) {
        Verdict::Unverifiable { why } => why,
        other => panic!("{other}"),
    };
    assert_eq!(with(8, 2), Mismatch::Format { file: 2, here: FORMAT_VERSION });
    let here = lockstep2d::SEMANTICS;
    assert_eq!(with(12, here + 1), Mismatch::Semantics { file: here + 1, here });
    let rules = |name: &str, version| (name.to_string(), version);
    let (file, here) = (rules("counter", 4), rules("counter", 3));
    assert_eq!(with(16, 4), Mismatch::Rules { file, here: here.clone() });
    let file = rules("dounter", 3);
    assert_eq!(with(40, u32::from_le_bytes(*b"doun")), Mismatch::Rules { file, here });
}

#[test]
fn a_verdict_is_final() {
    let file = forge(&original(), |forged| forged.payload(1)[2] ^= 1);
    let mut replay = VerifiedReplay::<Counter>::open(&file, &Limits::default()).unwrap();
    let diverged = Verdict::Diverged { last_equal: Some(10), first_different: 20 };
    for tick in 1..20 {
        assert_eq!(replay.step(), Ok(Step::Ticked), "tick {tick}");
    }
    for _ in 0..3 {
        assert_eq!(replay.step(), Err(diverged.clone()));
    }
    assert_eq!(replay.conclude(), diverged);
}
