//! [`Bar`]: a scale bar.

use alloc::format;
use alloc::string::String;

use crate::math::{Fx, ratio};

/// A scale bar of a round length.
///
/// ```
/// use lockstep2d::{draw::Bar, fx};
/// // A picture is 7.3 m wide, and the bar may take a third of it.
/// let bar = Bar::up_to(|length| length * 3 <= fx!(7.3)).expect("a millimetre fits");
/// assert_eq!((bar.length, bar.label.as_str()), (fx!(2), "2 m"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bar {
    /// Length in metres.
    pub length: Fx,
    /// Length with its unit.
    pub label: String,
}

impl Bar {
    /// The longest bar that fits, with a length of 1, 2 or 5 times a power of ten millimetres, at most 2 000 000 km.
    /// `None` if not even 1 mm fits.
    #[must_use]
    pub fn up_to(fits: impl Fn(Fx) -> bool) -> Option<Self> {
        let lengths = (0u32..13).flat_map(|power| [1i64, 2, 5].map(|digit| digit * 10i64.pow(power)));
        let metres = |millimetres: i64| ratio(millimetres, 1000);
        let possible = |length: Fx| length < Fx::MAX && fits(length);
        let length = lengths.take_while(|&length| possible(metres(length))).last()?;
        let label = if length < 1000 { format!("{length} mm") } else { format!("{} m", length / 1000) };
        Some(Bar { length: metres(length), label })
    }
}
