//! [`Curve`]: values over ticks, reduced to the number of points that a plot can show.

/// Maximum number of columns. A column is a group of consecutive ticks.
const COLUMNS: u64 = 1000;

/// Values over ticks. Each column keeps its first, lowest, highest and last value.
pub(super) struct Curve {
    pub(super) name: &'static str,
    pub(super) colour: &'static str,
    first: u64,
    last: u64,
    columns: Vec<Column>,
}

struct Column {
    at: u64,
    first: (u64, f64),
    lowest: (u64, f64),
    highest: (u64, f64),
    last: (u64, f64),
}

impl Curve {
    pub(super) fn new(name: &'static str, colour: &'static str, first: u64, last: u64) -> Self {
        Curve { name, colour, first, last, columns: Vec::new() }
    }

    pub(super) fn add(&mut self, tick: u64, value: f64) {
        let ticks = u128::from(self.last - self.first) + 1;
        let at = u128::from(tick - self.first) * u128::from(COLUMNS.min(ticks as u64)) / ticks;
        let (at, point) = (at as u64, (tick, value));
        match self.columns.last_mut().filter(|column| column.at == at) {
            Some(column) => {
                if value < column.lowest.1 {
                    column.lowest = point;
                }
                if value > column.highest.1 {
                    column.highest = point;
                }
                column.last = point;
            }
            None => {
                self.columns.push(Column { at, first: point, lowest: point, highest: point, last: point })
            }
        }
    }

    pub(super) fn shift(&mut self, by: f64) {
        for Column { first, lowest, highest, last, .. } in &mut self.columns {
            [first, lowest, highest, last].into_iter().for_each(|point| point.1 += by);
        }
    }

    pub(super) fn points(&self) -> Vec<(u64, f64)> {
        let mut points = Vec::new();
        for Column { first, lowest, highest, last, .. } in &self.columns {
            let mut column = [*first, *lowest, *highest, *last];
            column.sort_by_key(|(tick, _)| *tick);
            points.extend(column);
        }
        points.dedup_by_key(|(tick, _)| *tick);
        points
    }

    /// The first tick with the highest value, and this value.
    pub(super) fn highest(&self) -> (u64, f64) {
        let highest = self.columns.iter().map(|column| column.highest);
        highest.reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap_or((self.first, 0.0))
    }

    pub(super) fn lowest(&self) -> f64 {
        self.columns.iter().map(|column| column.lowest.1).reduce(f64::min).unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_curve_has_every_tick() {
        let mut curve = Curve::new("", "", 10, 20);
        (10..=20u32).for_each(|tick| curve.add(tick.into(), f64::from(tick * tick)));
        let expected: Vec<(u64, f64)> =
            (10..=20u32).map(|tick| (tick.into(), f64::from(tick * tick))).collect();
        assert_eq!(curve.points(), expected);
        assert_eq!((curve.highest(), curve.lowest()), ((20, 400.0), 100.0));
        curve.shift(-100.0);
        assert_eq!((curve.highest(), curve.lowest(), curve.points()[0]), ((20, 300.0), 0.0, (10, 0.0)));
    }

    #[test]
    fn a_long_curve_keeps_its_extremes_and_its_ends() {
        let mut curve = Curve::new("", "", 0, 99_999);
        for tick in 0..100_000u32 {
            let value = match tick {
                31_415 => 7.0,
                92_653 => -3.0,
                _ => f64::from(tick % 5) / 10.0,
            };
            curve.add(tick.into(), value);
        }
        let points = curve.points();
        assert!(points.len() as u64 <= 4 * COLUMNS, "{}", points.len());
        assert!(points.contains(&(31_415, 7.0)) && points.contains(&(92_653, -3.0)));
        assert_eq!((points.first(), points.last()), (Some(&(0, 0.0)), Some(&(99_999, 0.4))));
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!((curve.highest(), curve.lowest()), ((31_415, 7.0), -3.0));
    }
}
