//! What a reader says of where it is.

use lockstep2d::lockstep::SetupError;
use lockstep2d::replay::{Flaw, Limits, Part, ReadError, Reader};

use crate::counter::inputs_at;
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
    // A block is as long as its first four bytes say, after them, its kind and its checksum.
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
