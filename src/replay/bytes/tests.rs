use super::*;

#[test]
fn varints_come_back() {
    for value in [0, 1, 127, 128, 300, 16_383, 16_384, 1 << 21, (1 << 28) - 1, 1 << 28, u32::MAX] {
        let mut bytes = Vec::new();
        put_varint(value, &mut bytes);
        let mut cursor = Cursor::new(&bytes, 0);
        assert_eq!(cursor.varint(), Ok(value));
        assert!(cursor.is_empty(), "{value} leaves bytes unread");
    }
    let mut bytes = Vec::new();
    put_varint(300, &mut bytes);
    assert_eq!(bytes, [0xac, 0x02], "low group first");
}

#[test]
fn a_varint_has_one_form() {
    let number = Err(ReadError::Malformed { offset: 7, flaw: Flaw::Number });
    for padded in [&[0x80, 0x00][..], &[0xff, 0x80, 0x00]] {
        assert_eq!(Cursor::new(padded, 7).varint(), number, "{padded:?} is not the shortest form");
    }
    for over in [&[0xff, 0xff, 0xff, 0xff, 0x10][..], &[0xff, 0xff, 0xff, 0xff, 0xff, 0x01]] {
        assert_eq!(Cursor::new(over, 7).varint(), number, "{over:?} exceeds u32");
    }
    let cut = Err(ReadError::Malformed { offset: 7, flaw: Flaw::BlockCut });
    assert_eq!(Cursor::new(&[0xff, 0xff], 7).varint(), cut);
    assert_eq!(Cursor::new(&[], 7).varint(), cut);
}
