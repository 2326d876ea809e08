//! [`Strip`]: the corners of a line with their sideways offsets (mitre joins).

type Point = [f32; 2];

/// Mitre limit, as 1 + the cosine of the turning angle. At the limit (127 degrees) a mitre extends 2.2 half-widths.
/// Sharper corners have no mitre.
const SHARP: f32 = 0.4;

/// Segments up to this length, in units of the draw list, are skipped, because their direction is not reliable.
pub(super) const SHORTEST: f32 = 1e-3;

/// Corners of a line. Each has the offset of the mitre to its left side, for a half-width of 1.
#[derive(Clone, Debug, Default)]
pub(super) struct Strip {
    /// Points of the line. A point closer than [`SHORTEST`] to its predecessor is left out.
    points: Vec<Point>,
    /// Left unit normal of the segment that starts at each point.
    normals: Vec<Point>,
    /// Points and sideways offsets. A sharp corner appears twice.
    pub(super) corners: Vec<(Point, Point)>,
}

impl Strip {
    /// Computes the corners of a line through points. Returns `false` if the line has no length.
    pub(super) fn follow(&mut self, points: &[Point], closed: bool) -> bool {
        self.points.clear();
        self.normals.clear();
        self.corners.clear();
        for &point in points {
            self.add(point);
        }
        let Some(&first) = self.points.first() else { return false };
        if closed {
            self.add(first);
            // The first point was added again only to get the normal of the last segment, so it is removed again.
            if self.points.len() > 1 {
                self.points.pop();
            }
        }
        let Some(&last) = self.normals.last() else { return false };
        let mut before = if closed { last } else { self.normals[0] };
        for (at, &point) in self.points.iter().enumerate() {
            let after = self.normals.get(at).copied().unwrap_or(last);
            turn(&mut self.corners, point, before, after);
            before = after;
        }
        true
    }

    fn add(&mut self, point: Point) {
        if let Some(last) = self.points.last() {
            let [x, y] = [point[0] - last[0], point[1] - last[1]];
            let length = (x * x + y * y).sqrt();
            if length <= SHORTEST {
                return;
            }
            self.normals.push([y / length, -x / length]);
        }
        self.points.push(point);
    }
}

fn turn(corners: &mut Vec<(Point, Point)>, point: Point, before: Point, after: Point) {
    let scale = 1.0 + before[0] * after[0] + before[1] * after[1];
    if scale < SHARP {
        corners.push((point, before));
        corners.push((point, after));
    } else {
        corners.push((point, [(before[0] + after[0]) / scale, (before[1] + after[1]) / scale]));
    }
}
