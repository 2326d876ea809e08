//! Transformation from the world to the picture: `p = (x - centre) pixels / metres`, relative to the middle of the
//! picture and with y flipped.
//!
//! Coordinates are integers in hundredths of a pixel, which print as the same text on every machine. The scale is a
//! fraction of two integers, because a fixed-point number would have no digits left for a window as wide as the world.

#[cfg(test)]
mod tests;

use core::fmt;

use crate::fx;
use crate::math::{Aabb, Fx, Vec2, div_round, saturate_wide, segment_intersection};

/// Minimum width and height of the window in metres. With a much narrower window in a picture of 960 pixels, the
/// largest polygons (110 m from the centre to a side) would have coordinates above 2^23 pixels, at which common
/// renderers (cairo) overflow.
const WINDOW_MIN: Fx = fx!(0.02);

/// A coordinate or length in hundredths of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Pixel(pub(super) i64);

impl fmt::Display for Pixel {
    /// Omits trailing zeros, because numbers are most of the text of a large picture.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hundredths = self.0.unsigned_abs();
        let (whole, rest) = (hundredths / 100, hundredths % 100);
        if self.0 < 0 {
            f.write_str("-")?;
        }
        match (rest, rest % 10) {
            (0, _) => write!(f, "{whole}"),
            (_, 0) => write!(f, "{whole}.{}", rest / 10),
            _ => write!(f, "{whole}.{rest:02}"),
        }
    }
}

/// Maps a window of the world to an area of pixels.
pub(super) struct Screen {
    centre: Vec2<Fx>,
    size: (u32, u32),
    /// Numerator of the scale, in pixels.
    pixels: i128,
    /// Denominator of the scale, in units of [`Fx`].
    units: i128,
    /// The visible part of the world, slightly enlarged, so that lines clipped at its border end outside of the
    /// picture.
    pub(super) seen: Aabb,
}

impl Screen {
    /// Shows a window at the largest scale at which it fits into `size` pixels.
    pub(super) fn new(window: Aabb, size: (u32, u32)) -> Self {
        let window = Aabb::new(window.lower.min(window.upper), window.lower.max(window.upper));
        let units = |lower: Fx, upper: Fx| {
            (i128::from(upper.to_bits()) - i128::from(lower.to_bits())).max(WINDOW_MIN.to_bits().into())
        };
        let (width, height) = (units(window.lower.x, window.upper.x), units(window.lower.y, window.upper.y));
        let (pixels_x, pixels_y) = (i128::from(size.0), i128::from(size.1));
        let wide = width * pixels_y >= height * pixels_x;
        let (pixels, units) = if wide { (pixels_x, width) } else { (pixels_y, height) };
        // Adds 16 pixels for the width of strokes.
        let reach = |size: i128| Fx::from_bits(saturate_wide((size / 2 + 16) * units / pixels + 1));
        let reach = Vec2::new(reach(pixels_x), reach(pixels_y));
        let centre = window.centre();
        Screen { centre, size, pixels, units, seen: Aabb::new(centre - reach, centre + reach) }
    }

    pub(super) fn place(&self, point: Vec2<Fx>) -> (Pixel, Pixel) {
        let from = |value: Fx, centre: Fx| i128::from(value.to_bits()) - i128::from(centre.to_bits());
        let x = self.scaled(from(point.x, self.centre.x));
        let y = self.scaled(from(point.y, self.centre.y));
        let middle = |size: u32| i64::from(size) * 50;
        (Pixel(middle(self.size.0).saturating_add(x)), Pixel(middle(self.size.1).saturating_sub(y)))
    }

    pub(super) fn length(&self, length: Fx) -> Pixel {
        Pixel(self.scaled(length.to_bits().into()))
    }

    fn scaled(&self, units: i128) -> i64 {
        saturate_wide(div_round(units * self.pixels * 100, self.units))
    }

    /// The visible part of a line.
    pub(super) fn clipped(&self, from: Vec2<Fx>, to: Vec2<Fx>) -> Option<(Vec2<Fx>, Vec2<Fx>)> {
        let Aabb { lower, upper } = self.seen;
        if self.seen.contains_point(from) && self.seen.contains_point(to) {
            return Some((from, to));
        }
        let corners = [lower, Vec2::new(upper.x, lower.y), upper, Vec2::new(lower.x, upper.y)];
        let borders = (0..4).map(|i| (corners[i], corners[(i + 1) % 4]));
        let crossings = borders.filter_map(|(start, end)| segment_intersection(from, to, start, end));
        let ends = [from, to].into_iter().filter(|&end| self.seen.contains_point(end));
        // A line through a corner crosses two borders at the same point, so the second end is the point farthest from
        // the first one.
        let mut points = ends.chain(crossings);
        let first = points.next()?;
        Some((first, points.max_by_key(|&point| first.distance(point))?))
    }
}
