use alloc::string::String;

use super::*;

#[test]
fn values_come_back_at_every_length() {
    for length in [0, 1, 4087, 4088, 4089, (1 << 20) - 8, (1 << 20) - 7, 3 << 20] {
        let text = "x".repeat(length);
        assert_eq!(
            decode::<String>(&encode(&text)),
            Ok(text),
            "a string of {length} bytes should round-trip"
        );
    }
}

#[test]
fn a_string_that_is_not_there_is_not_allocated() {
    for length in [1, 1 << 20, 1 << 40, u64::MAX] {
        let decoded = decode::<String>(&length.to_le_bytes());
        assert!(
            matches!(decoded, Err(DecodeError::Invalid { .. })),
            "a missing string of {length} bytes should be rejected"
        );
    }
}

/// If a string's announced length exceeds the input by more than the slack, the decoder reports an exceeded limit.
#[test]
fn an_announced_length_is_limited_by_how_much_there_is() {
    for count in [8, 4 << 10, (4 << 10) + 1, 1 << 20] {
        for (missing, reason) in [(16, "UnexpectedEnd { additional: 16 }"), (17, "LimitExceeded")] {
            let mut bytes = encode::<u64>(&(count as u64 - 8 + missing));
            bytes.resize(count, b'x');
            let Err(DecodeError::Invalid { why }) = decode::<String>(&bytes) else {
                panic!("{missing} of {count} bytes are missing");
            };
            assert!(why.contains(reason), "{missing} of {count} bytes are missing: {why}");
        }
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let error = decode::<u8>(&[1, 2, 3]).expect_err("two bytes too many");
    assert_eq!(error, DecodeError::TrailingBytes { count: 2 });
    assert_eq!(alloc::format!("{error}"), "2 bytes after the end of the value");
    let error = decode::<u64>(&[1, 2, 3]).expect_err("five bytes too few");
    assert!(alloc::format!("{error}").starts_with("not a valid encoding: "), "{error}");
    let error = DecodeError::TooLong { count: 1 << 40 };
    assert_eq!(alloc::format!("{error}"), "1099511627776 bytes, at most 268435456 are decoded");
}
