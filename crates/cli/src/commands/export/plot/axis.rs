//! [`Axis`]: round tick marks of an axis, and [`Unit`]: the unit of its labels.

/// A physical quantity, which determines the possible units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// An energy in J.
    Energy,
    /// A length in metres.
    Length,
    Count,
}

impl Unit {
    /// Size and name of the largest unit that does not exceed the absolute value, or of the smallest unit if every unit
    /// exceeds it. An energy of 0 is in J.
    pub(super) fn fitting(self, value: f64) -> (f64, &'static str) {
        let units: &[(f64, &str)] = match self {
            Unit::Energy => &[(0.001, "mJ"), (1.0, "J"), (1e3, "kJ"), (1e6, "MJ"), (1e9, "GJ")],
            Unit::Length => &[(0.001, "mm"), (1.0, "m"), (1e3, "km")],
            Unit::Count => &[(1.0, "")],
        };
        let fitting = units.iter().rev().find(|(unit, _)| value.abs() >= *unit);
        *fitting.unwrap_or(if value == 0.0 && self == Unit::Energy { &units[1] } else { &units[0] })
    }
}

/// Equally spaced round numbers that enclose a range. The step between them is 1, 2 or 5 times a power of ten.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) step: f64,
    /// The first number, as a multiple of `step`.
    first: i64,
    /// The last number, as a multiple of `step`.
    last: i64,
    digits: usize,
}

impl Axis {
    /// An axis around the range from `low` to `high`, with 1 to `steps_max` steps. If `low` equals `high`, the range is
    /// extended to 0; if both are 0, the range is 0 to 1.
    pub(super) fn around(low: f64, high: f64, steps_max: i64) -> Self {
        Self::with_power(-15, low, high, steps_max)
    }

    /// An axis of whole numbers around a range.
    pub(super) fn around_counts(low: f64, high: f64, steps_max: i64) -> Self {
        Self::with_power(0, low, high, steps_max)
    }

    /// An axis whose step is at least `10^power_min`.
    fn with_power(power_min: i32, low: f64, high: f64, steps_max: i64) -> Self {
        let (low, high) = match (low, high) {
            (0.0, 0.0) => (0.0, 1.0),
            (low, high) if low == high => (low.min(0.0), high.max(0.0)),
            range => range,
        };
        let powers = power_min..=30;
        let rounds = powers.flat_map(|power| [1, 2, 5].map(|digit| (digit, power)));
        let mut axes = rounds.map(|(digit, power)| {
            // Parsing gives the float nearest to the decimal number. Computing it by multiplication could give a
            // neighbouring float.
            let step: f64 = format!("{digit}e{power}").parse().unwrap_or(1.0);
            // The casts saturate if the step is far too small.
            let (first, last) = ((low / step).floor() as i64, (high / step).ceil() as i64);
            Axis { step, first, last, digits: usize::try_from(-power).unwrap_or(0) }
        });
        let fitting = axes.find(|axis| {
            let is_exact = axis.first > i64::MIN && axis.last < i64::MAX;
            is_exact && axis.last.saturating_sub(axis.first) <= steps_max
        });
        fitting.unwrap_or(Axis { step: 1.0, first: 0, last: 1, digits: 0 })
    }

    pub(super) fn low(&self) -> f64 {
        self.first as f64 * self.step
    }

    pub(super) fn high(&self) -> f64 {
        self.last as f64 * self.step
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = (f64, String)> {
        (self.first..=self.last).map(|steps| {
            let value = steps as f64 * self.step;
            (value, format!("{value:.*}", self.digits))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        Axis::around(low, high, 5).numbers().map(|(_, label)| label).collect()
    }

    #[test]
    fn numbers_are_round_and_enclose_the_range() {
        assert_eq!(labels(0.0, 10.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(0.0, 0.31), ["0.0", "0.1", "0.2", "0.3", "0.4"]);
        assert_eq!(labels(-37.0, 120.0), ["-50", "0", "50", "100", "150"]);
        assert_eq!(labels(0.0, 0.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(7.0, 7.0), ["0", "2", "4", "6", "8"]);
        assert_eq!(labels(10_000.0, 10_020.0), ["10000", "10005", "10010", "10015", "10020"]);
        let counts = |high: f64| {
            Axis::around_counts(0.0, high, 5).numbers().map(|(_, label)| label).collect::<Vec<_>>()
        };
        assert_eq!(
            [counts(0.0), counts(1.0), counts(2.0)],
            [vec!["0", "1"], vec!["0", "1"], vec!["0", "1", "2"]]
        );
        for high in [1e-9, 0.003, 1.0, 9.99, 12_345.0, 1e18] {
            let axis = Axis::around(0.0, high, 5);
            assert!(axis.low() <= 0.0 && axis.high() >= high, "{axis:?}");
            assert!(axis.numbers().count() <= 6 && axis.high() < high * 2.6, "{axis:?}");
        }
    }

    #[test]
    fn units_fit_the_value() {
        assert_eq!(Unit::Length.fitting(0.0031), (0.001, "mm"));
        assert_eq!(Unit::Length.fitting(0.0), (0.001, "mm"));
        assert_eq!(Unit::Length.fitting(2.5), (1.0, "m"));
        assert_eq!(Unit::Energy.fitting(-1500.0), (1e3, "kJ"));
        assert_eq!(Unit::Energy.fitting(0.0), (1.0, "J"));
        assert_eq!(Unit::Count.fitting(20_000.0), (1.0, ""));
    }
}
