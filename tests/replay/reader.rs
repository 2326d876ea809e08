//! A [`Reader`] reports its offset and the offsets of errors, and keeps the limits of header fields exactly.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::SetupError;
use lockstep2d::replay::{Flaw, Limits, Part, ReadError, Reader};

use crate::counter::inputs_at;
use crate::forge::{CHAIN, Forged, forge};
use crate::record;

#[test]
fn it_knows_how_far_it_has_read() {
    let file = record(5, 3, inputs_at);
    let mut reader = Reader::open(&file, &Limits::default()).unwrap();
    let mut offsets = vec![reader.offset()];
    assert_eq!(reader.ticks(), 0);
    for ticks in [3, 5] {
        assert!(matches!(reader.next_part().unwrap(), Some(Part::Inputs(_))));
        assert_eq!(reader.ticks(), ticks);
        offsets.push(reader.offset());
    }
    // The first four bytes of a block are the length of its payload.
    for pair in offsets.windows(2) {
        let start = usize::try_from(pair[0]).unwrap();
        let length = u32::from_le_bytes(file[start..start + 4].try_into().unwrap());
        assert!(pair[1] > pair[0] + u64::from(length) && pair[1] < file.len() as u64);
    }
}

#[test]
fn a_block_of_unknown_kind_is_named_where_its_kind_is() {
    let mut file = record(5, 3, inputs_at);
    let start = Reader::open(&file, &Limits::default()).unwrap().offset();
    file[usize::try_from(start).unwrap() + 4] = 99;
    let error = Reader::open(&file, &Limits::default()).unwrap().next_part().unwrap_err();
    assert_eq!(error, ReadError::Malformed { offset: start + 4, flaw: Flaw::BlockKind { kind: 99 } });
    assert_eq!(error.to_string(), format!("at byte {}: a block of unknown kind 99", start + 4));
}

#[test]
fn a_refused_setup_says_why() {
    let error = SetupError { why: "no floor".into() };
    assert_eq!(error.to_string(), "the setup cannot start a game: no floor");
}

/// A replay whose header names other rules.
fn with_name(name: &str) -> Vec<u8> {
    forge(&record(5, 3, inputs_at), |forged| {
        let length = u32::from_le_bytes(forged.header[32..36].try_into().unwrap()) as usize;
        forged.header.splice(40..40 + length, name.bytes());
        forged.header[32..36].copy_from_slice(&u32::try_from(name.len()).unwrap().to_le_bytes());
    })
}

#[test]
fn names_of_rules_have_1_to_64_bytes() {
    let read =
        |file: &[u8]| Reader::open(file, &Limits::default()).map(|reader| reader.header().rules_name.len());
    assert_eq!(read(&with_name("x")), Ok(1));
    assert_eq!(read(&with_name(&"x".repeat(64))), Ok(64));
    for name in [String::new(), "x".repeat(65)] {
        assert_eq!(read(&with_name(&name)), Err(ReadError::Malformed { offset: 32, flaw: Flaw::RulesName }));
    }
}

#[test]
fn a_header_may_have_64_players_and_no_more() {
    let read = |players: u32| {
        let file = forge(&record(5, 3, inputs_at), |forged| {
            forged.header[20..24].copy_from_slice(&players.to_le_bytes());
        });
        Reader::open(&file, &Limits::default()).map(|reader| reader.header().players)
    };
    assert_eq!(read(64), Ok(64));
    assert_eq!(read(65), Err(ReadError::Malformed { offset: 20, flaw: Flaw::Players { count: 65 } }));
}

#[test]
fn a_chain_hash_that_is_wrong_is_named_where_it_stands() {
    let mut file = record(3, 3, inputs_at);
    let mut reader = Reader::open(&file, &Limits::default()).unwrap();
    reader.next_part().unwrap();
    let payload = usize::try_from(reader.offset()).unwrap() + 5;
    let mut forged = Forged::take_apart(&file);
    let ticks = forged.trailer()[..8].to_vec();
    assert_eq!(file[payload..payload + 8], ticks, "expected the trailer here");
    // The block's checksum covers the chain hash, so the checksum is repaired.
    file[payload + CHAIN.start] ^= 1;
    let start = payload - 5;
    let end = file.len() - 8;
    let before: [u8; 16] = forged.trailer()[CHAIN].try_into().unwrap();
    let block = StateHash::of_bytes(&file[start..end]).0;
    let chain = StateHash::of_bytes(&[before, block.to_le_bytes()].concat()).0;
    file[end..].copy_from_slice(&chain.to_le_bytes()[..8]);
    let mut reader = Reader::open(&file, &Limits::default()).unwrap();
    reader.next_part().unwrap();
    let error = reader.next_part().unwrap_err();
    assert_eq!(error, ReadError::Malformed { offset: (payload + CHAIN.start) as u64, flaw: Flaw::Chain });
}
