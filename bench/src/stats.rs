//! Quantiles, geometric means and power-law fits.

/// Quantile, interpolated linearly. NaN for an empty slice.
pub fn quantile(values: &[f64], fraction: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = fraction * last as f64;
    let (below, above) = (sorted[at.floor() as usize], sorted[at.ceil() as usize]);
    below + (above - below) * (at - at.floor())
}

/// Median. NaN for an empty slice.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// First and third quartile.
pub fn quartiles(values: &[f64]) -> [f64; 2] {
    [quantile(values, 0.25), quantile(values, 0.75)]
}

/// Geometric mean. `None` for an empty slice.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|value| value.ln()).sum();
    (!values.is_empty()).then(|| (sum / values.len() as f64).exp())
}

/// Fits `y = c x^p` by least squares of the logarithms, and returns `p`.
pub fn power(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<_> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let middle_x = logs.iter().map(|point| point.0).sum::<f64>() / count;
    let middle_y = logs.iter().map(|point| point.1).sum::<f64>() / count;
    let slope = |(x, y): &(f64, f64)| (x - middle_x) * (y - middle_y);
    let spread = |(x, _): &(f64, f64)| (x - middle_x) * (x - middle_x);
    logs.iter().map(slope).sum::<f64>() / logs.iter().map(spread).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middles() {
        assert_eq!(median(&[5.0, 1.0, 3.0]), 3.0);
        assert_eq!(median(&[4.0, 1.0]), 2.5);
        assert_eq!(quartiles(&[1.0, 2.0, 3.0, 4.0, 5.0]), [2.0, 4.0]);
        assert!(median(&[]).is_nan());
        assert!((geometric_mean(&[1.0, 4.0, 16.0]).unwrap() - 4.0).abs() < 1e-12);
        assert_eq!(geometric_mean(&[]), None);
    }

    #[test]
    fn powers() {
        let points: Vec<_> = [1.0, 4.0, 16.0, 64.0].map(|x: f64| (x, 3.0 * x.powf(1.25))).into();
        assert!((power(&points) - 1.25).abs() < 1e-12);
    }
}
