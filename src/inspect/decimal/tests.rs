use alloc::format;

use super::Decimal;

fn decimal(bits: i128, fraction_bits: u32) -> alloc::string::String {
    format!("{}", Decimal::new(bits, fraction_bits).expect("128 bits are enough"))
}

#[test]
fn numbers_are_written_as_people_do() {
    assert_eq!(decimal(5, 0), "5");
    assert_eq!(decimal(-5, 1), "-2.5");
    assert_eq!(decimal(-(5 << 30), 32), "-1.25");
    assert_eq!(decimal(1, 32), "0.0000000002");
    assert_eq!(decimal(i64::MIN.into(), 32), "-2147483648");
    assert_eq!(decimal(1, 21), "0.0000005");
    assert_eq!(decimal((1 << 21) / 10, 21), "0.0999999");
    assert!(Decimal::new(i128::MAX, 100).is_none());
}

#[test]
fn neighbours_are_written_differently() {
    for fraction_bits in 0..40 {
        for bits in (-40..40).chain((1 << fraction_bits) - 20..(1 << fraction_bits) + 20) {
            assert_ne!(decimal(bits, fraction_bits), decimal(bits + 1, fraction_bits));
        }
    }
}
