//! [`Camera`]: transforms between world and screen coordinates.

use lockstep2d::math::{Aabb, Fx, Vec2};

/// Smallest scale, in pixels per metre: a billion metres on ten pixels.
const SCALE_MIN: f64 = 1e-8;
/// Largest scale, in pixels per metre: a micrometre per pixel.
const SCALE_MAX: f64 = 1e6;

/// Distance in pixels by which clipped lines extend beyond the visible area, because strokes have a width.
const MARGIN: f64 = 16.0;

/// Visible part of a world, without rotation: y points up in the world and down on the screen.
///
/// ```
/// use lockstep2d::{fx, math::{Aabb, Vec2}};
/// use lockstep2d_render::Camera;
/// // 20 m by 10 m of the world in a window of 800 by 400 pixels.
/// let window = Aabb::new(Vec2::new(fx!(-10), fx!(0)), Vec2::new(fx!(10), fx!(10)));
/// let mut camera = Camera::new(window, [0.0, 0.0], [800.0, 400.0]);
/// assert_eq!(camera.place(Vec2::new(fx!(-10), fx!(10))), [0.0, 0.0]);
/// // The mouse wheel: the world point below the pointer stays there.
/// let pointer = [600.0, 300.0];
/// let below = camera.point(pointer);
/// camera.zoom(2.0, pointer);
/// assert_eq!((camera.place(below), camera.length(fx!(1))), (pointer, 80.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World point in the middle of the area. It is in fixed point, so that it is precise far from the origin.
    pub centre: Vec2<Fx>,
    /// Pixels per metre.
    pub scale: f64,
    /// Centre of the screen area, in pixels.
    pub middle: [f64; 2],
    /// Half the size of the screen area, in pixels.
    pub half: [f64; 2],
}

impl Camera {
    /// Fits a window of the world into an area of the screen. The area is given by its upper left corner and its size
    /// in pixels.
    #[must_use]
    pub fn new(window: Aabb, corner: [f32; 2], size: [f32; 2]) -> Self {
        let [width, height] = size.map(|side| f64::from(side.max(1.0)));
        let sides = window.upper - window.lower;
        let side = |side: Fx| metres(side).abs().max(0.02);
        let scale = (width / side(sides.x)).min(height / side(sides.y)).clamp(SCALE_MIN, SCALE_MAX);
        let middle = [f64::from(corner[0]) + width / 2.0, f64::from(corner[1]) + height / 2.0];
        Camera { centre: window.centre(), scale, middle, half: [width / 2.0, height / 2.0] }
    }

    /// Converts a world point to screen coordinates.
    #[must_use]
    pub fn place(&self, point: Vec2<Fx>) -> [f32; 2] {
        // The difference is computed before the conversion to `f32`, whose 24 bits are too few for world coordinates.
        let x = difference(point.x, self.centre.x) * self.scale;
        let y = difference(point.y, self.centre.y) * self.scale;
        [(self.middle[0] + x) as f32, (self.middle[1] - y) as f32]
    }

    /// Converts a length in the world to pixels.
    #[must_use]
    pub fn length(&self, length: Fx) -> f32 {
        (metres(length) * self.scale) as f32
    }

    /// Converts screen coordinates to a world point. Saturates at the range of world coordinates.
    #[must_use]
    pub fn point(&self, [x, y]: [f32; 2]) -> Vec2<Fx> {
        let x = (f64::from(x) - self.middle[0]) / self.scale;
        let y = (self.middle[1] - f64::from(y)) / self.scale;
        let far = |from: Fx, by: f64| {
            from.saturating_add(Fx::saturating_from_num(if by.is_nan() { 0.0 } else { by }))
        };
        Vec2::new(far(self.centre.x, x), far(self.centre.y, y))
    }

    /// Moves the picture by this many pixels.
    pub fn pan(&mut self, [x, y]: [f32; 2]) {
        let [left, up] = [self.middle[0] - f64::from(x), self.middle[1] - f64::from(y)];
        self.centre = self.point([left as f32, up as f32]);
    }

    /// Multiplies the scale by a factor. The world point at the screen position `about` stays there.
    pub fn zoom(&mut self, factor: f32, about: [f32; 2]) {
        let fixed = self.point(about);
        self.scale = (self.scale * f64::from(factor)).clamp(SCALE_MIN, SCALE_MAX);
        let now = self.place(fixed);
        self.pan([about[0] - now[0], about[1] - now[1]]);
    }

    /// Whether a mark that extends `size` pixels around a screen position is visible.
    #[must_use]
    pub fn sees(&self, [x, y]: [f32; 2], size: f32) -> bool {
        let beside =
            |at: f32, middle: f64, half: f64| (f64::from(at) - middle).abs() <= half + f64::from(size);
        beside(x, self.middle[0], self.half[0]) && beside(y, self.middle[1], self.half[1])
    }

    /// Whether the bounding box of the points overlaps the visible area, enlarged by 16 pixels on each side.
    #[must_use]
    pub fn sees_any(&self, points: &[[f32; 2]]) -> bool {
        let beyond = |axis: usize| {
            let side = |at: f32| {
                let from_middle = f64::from(at) - self.middle[axis];
                (from_middle < -self.half[axis] - MARGIN, from_middle > self.half[axis] + MARGIN)
            };
            points.iter().all(|point| side(point[axis]).0) || points.iter().all(|point| side(point[axis]).1)
        };
        !(points.is_empty() || beyond(0) || beyond(1))
    }

    /// Clips a line to the visible area, enlarged by 16 pixels on each side (Liang and Barsky, "A New Concept and
    /// Method for Line Clipping", 1984), because coordinates further away may be too large for a rasteriser. Returns
    /// `None` if the line lies outside.
    #[must_use]
    pub fn clipped(&self, [from, to]: [[f32; 2]; 2]) -> Option<[[f32; 2]; 2]> {
        if self.sees(from, MARGIN as f32) && self.sees(to, MARGIN as f32) {
            return Some([from, to]);
        }
        let (start, way) =
            (from.map(f64::from), [0, 1].map(|axis| f64::from(to[axis]) - f64::from(from[axis])));
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            let low = self.middle[axis] - self.half[axis] - MARGIN - start[axis];
            let high = self.middle[axis] + self.half[axis] + MARGIN - start[axis];
            if way[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low / way[axis], high / way[axis]);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
        let at = |t: f64| [0, 1].map(|axis| (start[axis] + way[axis] * t) as f32);
        (first <= last).then(|| [at(first), at(last)])
    }
}

fn metres(length: Fx) -> f64 {
    difference(length, Fx::ZERO)
}

fn difference(a: Fx, b: Fx) -> f64 {
    let difference = match a.to_bits().checked_sub(b.to_bits()) {
        Some(bits) => bits as f64,
        // The distance of two points may exceed the fixed-point range.
        None => a.to_bits() as f64 - b.to_bits() as f64,
    };
    difference / (1i64 << Fx::FRAC_NBITS) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use lockstep2d::fx;

    fn camera(centre: Fx) -> Camera {
        let (middle, half) = (Vec2::new(centre, centre), Vec2::new(fx!(5), fx!(5)));
        Camera::new(Aabb::new(middle - half, middle + half), [100.0, 0.0], [1000.0, 500.0])
    }

    #[test]
    fn a_window_is_in_the_middle_upright_and_as_large_as_it_fits() {
        let camera = camera(fx!(0));
        assert_eq!(camera.scale, 50.0);
        assert_eq!(camera.place(Vec2::ZERO), [600.0, 250.0]);
        assert_eq!(camera.place(Vec2::new(fx!(1), fx!(5))), [650.0, 0.0]);
        assert_eq!(camera.length(fx!(0.5)), 25.0);
    }

    #[test]
    fn a_millimetre_is_seen_a_billion_metres_out() {
        let far = fx!(1000000000);
        let mut camera = camera(far);
        camera.zoom(1000.0, [600.0, 250.0]);
        let [x, y] = camera.place(Vec2::new(far + fx!(0.001), far));
        assert!((x - 650.0).abs() < 0.01 && (y - 250.0).abs() < 0.01, "{x} {y}");
    }

    #[test]
    fn the_point_under_the_pointer_stays_there_while_one_zooms_and_comes_along_while_one_pans() {
        let mut camera = camera(fx!(3));
        let pointer = [321.0, 77.0];
        let held = camera.point(pointer);
        camera.zoom(1.7, pointer);
        let [x, y] = camera.place(held);
        assert!((x - 321.0).abs() < 0.01 && (y - 77.0).abs() < 0.01, "{x} {y}");
        camera.pan([10.0, -20.0]);
        let [x, y] = camera.place(held);
        assert!((x - 331.0).abs() < 0.01 && (y - 57.0).abs() < 0.01, "{x} {y}");
        (0..1000).for_each(|_| camera.zoom(0.5, pointer));
        assert!(camera.place(camera.centre).iter().all(|at| at.is_finite()));
    }

    #[test]
    fn lines_are_cut_where_the_picture_ends() {
        let camera = camera(fx!(0));
        let [from, to] =
            camera.clipped([[-1e9, 250.0], [1e9, 250.0]]).expect("the line should cross the area");
        assert!((from[0] - 84.0).abs() < 1.0 && (to[0] - 1116.0).abs() < 1.0, "{from:?} {to:?}");
        assert_eq!(camera.clipped([[-1e9, 900.0], [1e9, 900.0]]), None);
        assert_eq!(camera.clipped([[0.0, -500.0], [-500.0, 0.0]]), None);
        let inside = [[200.0, 10.0], [300.0, 20.0]];
        assert_eq!(camera.clipped(inside), Some(inside));
    }
}
