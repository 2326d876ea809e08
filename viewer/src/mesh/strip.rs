//! [`Strip`]: the corners of a line, moved to its sides.

type Point = [f32; 2];

/// Sharper corners than this are cut off: 1 + the cosine of the angle by which a line turns. At a turn by 126 degrees a
/// mitre is 2.2 times as long as the line is half wide; in sharper ones it would be a thorn.
const SHARP: f32 = 0.4;

/// Segments shorter than this, in the units of a list, have no direction.
pub(super) const SHORTEST: f32 = 1e-3;

/// The corners of a line, with the direction from its middle to its left side: of length 1 along the line, longer where
/// it turns, so that the sides stay as far apart as the line is wide.
#[derive(Clone, Debug, Default)]
pub(super) struct Strip {
    /// Points, each further than nothing from the one before.
    points: Vec<Point>,
    /// Of the segment that begins at each point; to its left.
    normals: Vec<Point>,
    /// Points and sideways directions. A sharp corner is there twice.
    pub(super) corners: Vec<(Point, Point)>,
}

impl Strip {
    /// Follows a line through points. `false` if it has no length.
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
            // The way back to the first point is the last segment.
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
