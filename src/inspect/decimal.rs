#[cfg(test)]
mod tests;

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
