//! What of a polygon or a line is near the image.
//!
//! The rasteriser counts in fixed-point pixels: points a billion pixels away would overflow, and a floor or a chain
//! of a world easily reaches so far on a screen that is zoomed in.

use tiny_skia::{Path, PathBuilder};

/// Points within so many pixels of the image are left where they are; further ones are cut off there, where not even
/// a border as wide would be seen.
const MARGIN: f32 = 2048.0;

/// The image, and what is near it.
pub(super) struct Area {
    size: [f32; 2],
}

impl Area {
    pub(super) fn of(width: u32, height: u32) -> Self {
        Area { size: [width as f32, height as f32] }
    }

    /// Whether the box around points and a border is anywhere on the image. Nothing is where a coordinate is no number.
    pub(super) fn is_touched(&self, points: &[[f32; 2]], margin: f32) -> bool {
        let margin = margin.min(MARGIN);
        !points.is_empty()
            && points.iter().flatten().all(|coordinate| coordinate.is_finite())
            && (0..2).all(|axis| {
                let low = points.iter().map(|point| point[axis]).fold(f32::MAX, f32::min);
                let high = points.iter().map(|point| point[axis]).fold(f32::MIN, f32::max);
                low - margin <= self.size[axis] && high + margin >= 0.0
            })
    }

    /// Whether some of the points are too far away.
    pub(super) fn is_exceeded(&self, points: &[[f32; 2]]) -> bool {
        points.iter().any(|&point| self.sides().iter().any(|side| !side.has(point)))
    }

    /// The part of a convex polygon that is near, side by side (Sutherland and Hodgman).
    pub(super) fn polygon(&self, points: &[[f32; 2]]) -> Vec<[f32; 2]> {
        self.sides().iter().fold(points.to_vec(), |points, side| side.cut(&points))
    }

    /// The parts of a line through points that are near.
    pub(super) fn lines(&self, points: &[[f32; 2]], closed: bool) -> Option<Path> {
        let mut path = PathBuilder::new();
        let back = closed.then(|| points.first()).flatten();
        for (&from, &to) in points.iter().zip(points.iter().skip(1).chain(back)) {
            if let Some([from, to]) = self.segment(from, to) {
                path.move_to(from[0], from[1]);
                path.line_to(to[0], to[1]);
            }
        }
        path.finish()
    }

    /// The part of a line that is near, side by side.
    fn segment(&self, mut from: [f32; 2], mut to: [f32; 2]) -> Option<[[f32; 2]; 2]> {
        for side in self.sides() {
            match (side.has(from), side.has(to)) {
                (true, true) => {}
                (true, false) => to = side.crossing(from, to),
                (false, true) => from = side.crossing(from, to),
                (false, false) => return None,
            }
        }
        Some([from, to])
    }

    /// What is near lies on the inner side of all of these.
    fn sides(&self) -> [Side; 4] {
        let [width, height] = self.size;
        let low = |axis| Side { axis, sign: -1.0, bound: -MARGIN };
        let high = |axis, size| Side { axis, sign: 1.0, bound: size + MARGIN };
        [low(0), high(0, width), low(1), high(1, height)]
    }
}

/// A half plane in which a coordinate goes up to a bound, or if the sign is negative, down to it.
struct Side {
    axis: usize,
    sign: f32,
    bound: f32,
}

impl Side {
    fn has(&self, point: [f32; 2]) -> bool {
        (point[self.axis] - self.bound) * self.sign <= 0.0
    }

    /// Where a line from one side to the other meets the bound, which it does exactly, however long it is.
    fn crossing(&self, from: [f32; 2], to: [f32; 2]) -> [f32; 2] {
        let (a, b) = (from.map(f64::from), to.map(f64::from));
        let share = (f64::from(self.bound) - a[self.axis]) / (b[self.axis] - a[self.axis]);
        let mut crossing = [0, 1].map(|axis| (a[axis] + share * (b[axis] - a[axis])) as f32);
        crossing[self.axis] = self.bound;
        crossing
    }

    /// What of a convex polygon is inside.
    fn cut(&self, points: &[[f32; 2]]) -> Vec<[f32; 2]> {
        let mut kept = Vec::with_capacity(points.len() + 2);
        for (i, &to) in points.iter().enumerate() {
            let from = points[(i + points.len() - 1) % points.len()];
            if self.has(from) != self.has(to) {
                kept.push(self.crossing(from, to));
            }
            if self.has(to) {
                kept.push(to);
            }
        }
        kept
    }
}
