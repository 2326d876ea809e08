//! Clips polygons and lines to the surroundings of the image.
//!
//! The rasteriser has fixed-point coordinates, which overflow for points a billion pixels away. A floor easily extends
//! so far when the camera is zoomed in.

use tiny_skia::{Path, PathBuilder};

/// Distance from the image at which shapes are clipped, in pixels. Strokes up to this width along the clipping border
/// are invisible.
const MARGIN: f32 = 2048.0;

pub(super) struct Area {
    size: [f32; 2],
}

impl Area {
    pub(super) fn of(width: u32, height: u32) -> Self {
        Area { size: [width as f32, height as f32] }
    }

    /// Whether the bounding box of points, extended by a margin, overlaps the image. `false` if a coordinate is not
    /// finite.
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

    /// Whether any point lies further than [`MARGIN`] from the image.
    pub(super) fn is_exceeded(&self, points: &[[f32; 2]]) -> bool {
        points.iter().any(|&point| self.sides().iter().any(|side| !side.has(point)))
    }

    /// Clips a convex polygon (Sutherland and Hodgman). Returns the corners of the clipped polygon.
    pub(super) fn polygon(&self, points: &[[f32; 2]]) -> Vec<[f32; 2]> {
        self.sides().iter().fold(points.to_vec(), |points, side| side.cut(&points))
    }

    /// Clips a line through points. The result may consist of several parts. `None` if nothing of the line is left.
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

    /// The sides of the area, which is the intersection of four half planes.
    fn sides(&self) -> [Side; 4] {
        let [width, height] = self.size;
        let low = |axis| Side { axis, sign: -1.0, bound: -MARGIN };
        let high = |axis, size| Side { axis, sign: 1.0, bound: size + MARGIN };
        [low(0), high(0, width), low(1), high(1, height)]
    }
}

/// A half plane, in which one coordinate is at most `bound`, or at least `bound` if the sign is negative.
struct Side {
    axis: usize,
    sign: f32,
    bound: f32,
}

impl Side {
    fn has(&self, point: [f32; 2]) -> bool {
        (point[self.axis] - self.bound) * self.sign <= 0.0
    }

    /// The point where a line crosses the bound. Its coordinate on `axis` is exactly `bound`, whatever the rounding
    /// errors are.
    fn crossing(&self, from: [f32; 2], to: [f32; 2]) -> [f32; 2] {
        let (a, b) = (from.map(f64::from), to.map(f64::from));
        let share = (f64::from(self.bound) - a[self.axis]) / (b[self.axis] - a[self.axis]);
        let mut crossing = [0, 1].map(|axis| (a[axis] + share * (b[axis] - a[axis])) as f32);
        crossing[self.axis] = self.bound;
        crossing
    }

    /// The part of a convex polygon inside the half plane.
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
