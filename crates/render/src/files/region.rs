//! [`Region`]: bounding rectangle of the changed pixels.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub(super) left: u32,
    pub(super) top: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Region {
    /// Bounding rectangle of the pixels for which `has_changed` is true. The argument of `has_changed` is the index of
    /// a pixel in row order. If no pixel has changed, returns the first pixel, because a frame cannot be empty.
    pub(super) fn around((width, height): (u32, u32), has_changed: impl Fn(usize) -> bool) -> Self {
        let columns = width as usize;
        let row = |y: u32| y as usize * columns..(y as usize + 1) * columns;
        let changed = |y: &u32| row(*y).any(&has_changed);
        let Some(top) = (0..height).find(changed) else {
            return Region { left: 0, top: 0, width: 1, height: 1 };
        };
        let bottom = (top..height).rfind(changed).unwrap_or(top);
        let (mut left, mut right) = (columns, 0);
        for y in top..=bottom {
            let start = row(y).start;
            // Only pixels to the left or right of the rectangle found so far can widen it.
            left = (0..left).find(|x| has_changed(start + x)).unwrap_or(left);
            right = (right..columns).rfind(|x| has_changed(start + x)).unwrap_or(right);
        }
        let (left, right) = (left as u32, right as u32);
        Region { left, top, width: right + 1 - left, height: bottom + 1 - top }
    }

    /// Indices of the region's pixels in an image of this width.
    pub(super) fn pixels(self, width: u32) -> impl Iterator<Item = usize> {
        let rows = self.top..self.top + self.height;
        rows.flat_map(move |y| {
            let start = y as usize * width as usize + self.left as usize;
            start..start + self.width as usize
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_as_small_as_it_can_be() {
        let (width, height) = (7u32, 5u32);
        // Tests every pair of pixels, and every single pixel.
        for a in 0..35usize {
            for b in 0..35usize {
                let region = Region::around((width, height), |pixel| pixel == a || pixel == b);
                let (column, row) = (|pixel: usize| pixel as u32 % 7, |pixel: usize| pixel as u32 / 7);
                let expected = Region {
                    left: column(a).min(column(b)),
                    top: row(a).min(row(b)),
                    width: column(a).abs_diff(column(b)) + 1,
                    height: row(a).abs_diff(row(b)) + 1,
                };
                assert_eq!(region, expected, "{a}, {b}");
                let pixels: Vec<usize> = region.pixels(width).collect();
                assert!(pixels.contains(&a) && pixels.contains(&b));
                assert_eq!(pixels.len() as u32, region.width * region.height);
            }
        }
        let nothing = Region::around((width, height), |_| false);
        assert_eq!((nothing.width, nothing.height), (1, 1));
    }
}
