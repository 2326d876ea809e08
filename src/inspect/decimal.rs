use core::fmt;

/// `bits / 2^fraction_bits` in decimal.
pub(super) struct Decimal {
    negative: bool,
    whole: u128,
    /// The fraction times 10^`digits`.
    fraction: u128,
    digits: usize,
}

impl Decimal {
    /// Returns `None` if the computation exceeds 128 bits.
    pub(super) fn new(bits: i128, fraction_bits: u32) -> Option<Self> {
        // A bit is worth log10(2) decimal digits, slightly less than 4/13. The additional digit gives neighbouring
        // numbers different texts.
        let digits = fraction_bits * 4 / 13 + u32::from(fraction_bits > 0);
        let scale = 10u128.checked_pow(digits)?;
        let one = 1u128.checked_shl(fraction_bits)?;
        let scaled = bits.unsigned_abs().checked_mul(scale)?.checked_add(one / 2)? >> fraction_bits;
        let (whole, fraction) = (scaled / scale, scaled % scale);
        Some(Decimal { negative: bits < 0, whole, fraction, digits: usize::try_from(digits).ok()? })
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Decimal { negative, whole, mut fraction, mut digits } = *self;
        write!(f, "{}{whole}", if negative { "-" } else { "" })?;
        if fraction == 0 {
            return Ok(());
        }
        while fraction % 10 == 0 {
            (fraction, digits) = (fraction / 10, digits - 1);
        }
        write!(f, ".{fraction:0digits$}")
    }
}

#[cfg(test)]
mod tests {
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
}
