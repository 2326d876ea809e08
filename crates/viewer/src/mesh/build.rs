//! Builds a mesh from a draw list.

use lockstep2d_render::{CELL_HEIGHT, CELL_WIDTH, Colour, DrawList, Item, Text};

use super::strip::SHORTEST;
use super::{Atlas, Chunk, Mesh, Screen, Vertex};

type Point = [f32; 2];

/// Value of [`Vertex::sample`] for full coverage: distance 0, reach 1.
const WHOLE: [f32; 3] = [0.0, 1.0, 0.0];
/// Maximum number of points of a strip. Each point becomes at most four vertices.
const RUN: usize = Chunk::VERTICES / 4 - 2;

impl Mesh {
    /// Builds the triangles of all visible items of a list.
    pub fn build(&mut self, list: &DrawList, screen: &Screen) {
        self.clear();
        let mut texts = list.texts().iter().peekable();
        for (at, item) in list.items().iter().enumerate() {
            while let Some(text) = texts.next_if(|text| text.after as usize <= at) {
                self.text(text, screen);
            }
            let points = list.points(item);
            if is_visible(points, item.width, screen) {
                self.item(item, points, screen);
            }
        }
        for text in texts {
            self.text(text, screen);
        }
    }

    fn item(&mut self, item: &Item, points: &[Point], screen: &Screen) {
        let bordered = !item.stroke.is_none() && item.width > 0.0;
        if item.closed && !item.fill.is_none() && points.len() > 2 {
            if bordered && item.width >= screen.pixel {
                // The border covers the edge of the area, so only the border is antialiased, on both of its sides.
                self.area(points, item.fill);
            } else {
                match regular(points) {
                    Some(disc) => self.disc(points, disc, item.fill, screen.pixel),
                    None => self.smooth_area(points, item.fill, screen.pixel),
                }
            }
        }
        if !bordered {
            return;
        }
        if points.len() <= RUN {
            self.stroke(points, item.closed, item, screen.pixel);
        } else {
            self.long_stroke(points, item, screen.pixel);
        }
    }

    fn area(&mut self, points: &[Point], fill: Colour) {
        let Some(fan) = fan(points.len()) else { return };
        let (chunk, first) = self.room(points.len());
        let colour = bytes(fill);
        chunk.vertices.extend(points.iter().map(|&position| Vertex { position, sample: WHOLE, colour }));
        chunk.indices.extend(fan.flatten().map(|index| first + index));
    }

    /// Adds a regular polygon as a fan around its centre. The reach in the samples is 0 half a pixel outside of the
    /// edge, and grows linearly to the centre, so that the edge fades over one pixel.
    fn disc(&mut self, points: &[Point], disc: Disc, fill: Colour, pixel: f32) {
        let [x, y] = disc.middle;
        let scale = 1.0 + pixel / 2.0 / disc.inner;
        let depth = disc.inner / pixel + 0.5;
        let colour = bytes(fill);
        let (chunk, middle) = self.room(points.len() + 1);
        chunk.vertices.push(Vertex { position: disc.middle, sample: [0.0, depth, 0.0], colour });
        chunk.vertices.extend(points.iter().map(|point| {
            let position = [x + (point[0] - x) * scale, y + (point[1] - y) * scale];
            Vertex { position, sample: [0.0; 3], colour }
        }));
        // The cast is exact, because a disc has at most 64 corners.
        let count = points.len() as u16;
        let mut last = middle + count;
        for next in middle + 1..=middle + count {
            chunk.indices.extend([middle, last, next]);
            last = next;
        }
    }

    /// Adds an area whose edge fades from half a pixel inside to half a pixel outside.
    fn smooth_area(&mut self, points: &[Point], fill: Colour, pixel: f32) {
        if points.len() > RUN || !self.strip.follow(points, true) {
            return;
        }
        let corners = std::mem::take(&mut self.strip.corners);
        // Where y points down, the left side of a clockwise outline is outside.
        let half = if turns_left(points) { -pixel / 2.0 } else { pixel / 2.0 };
        let (chunk, first) = self.room(2 * corners.len());
        let colour = bytes(fill);
        for &(point, side) in &corners {
            let outside = Vertex { position: beside(point, side, half), sample: [1.0, 1.0, 0.0], colour };
            chunk.vertices.push(outside);
            chunk.vertices.push(Vertex { position: beside(point, side, -half), sample: WHOLE, colour });
        }
        ribbon(&mut chunk.indices, first, corners.len(), true);
        if let Some(fan) = fan(corners.len()) {
            chunk.indices.extend(fan.flatten().map(|index| first + 2 * index + 1));
        }
        self.strip.corners = corners;
    }

    /// Adds a single segment without building a strip. It is the most common kind of line.
    fn segment(&mut self, [a, b]: [Point; 2], item: &Item, pixel: f32) {
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        let length = (x * x + y * y).sqrt();
        if length <= SHORTEST {
            return;
        }
        let side = [y / length, -x / length];
        let (colour, reach) = pen(item, pixel);
        let (chunk, first) = self.room(4);
        let vertex = |point, distance: f32| Vertex {
            position: beside(point, side, distance * pixel),
            sample: [distance, reach, 0.0],
            colour,
        };
        chunk.vertices.extend([vertex(a, reach), vertex(a, -reach), vertex(b, reach), vertex(b, -reach)]);
        chunk.indices.extend([0, 1, 2, 2, 1, 3].map(|index| first + index));
    }

    fn stroke(&mut self, points: &[Point], closed: bool, item: &Item, pixel: f32) {
        if let (&[a, b], false) = (points, closed) {
            return self.segment([a, b], item, pixel);
        }
        if !self.strip.follow(points, closed) {
            return;
        }
        let corners = std::mem::take(&mut self.strip.corners);
        let (colour, reach) = pen(item, pixel);
        let (chunk, first) = self.room(2 * corners.len());
        for &(point, side) in &corners {
            for distance in [reach, -reach] {
                let position = beside(point, side, distance * pixel);
                chunk.vertices.push(Vertex { position, sample: [distance, reach, 0.0], colour });
            }
        }
        ribbon(&mut chunk.indices, first, corners.len(), closed);
        self.strip.corners = corners;
    }

    /// Adds a line with more than [`RUN`] points, in pieces.
    fn long_stroke(&mut self, points: &[Point], item: &Item, pixel: f32) {
        let mut from = 0;
        while from + 1 < points.len() {
            let to = points.len().min(from + RUN);
            self.stroke(&points[from..to], false, item, pixel);
            from = to - 1;
        }
        if let (true, [first, .., last]) = (item.closed, points) {
            self.stroke(&[*last, *first], false, item, pixel);
        }
    }

    fn text(&mut self, text: &Text, screen: &Screen) {
        let Text { at, scale, colour, ref text, .. } = *text;
        let [width, height] = [CELL_WIDTH * scale, CELL_HEIGHT * scale];
        let [mut x, y] = at.map(|at| (at / screen.pixel).round() * screen.pixel);
        if colour.is_none() || !(y < screen.size[1] && y + height > 0.0) {
            return;
        }
        let colour = bytes(colour);
        for character in text.chars() {
            if !character.is_whitespace() && x < screen.size[0] && x + width > 0.0 {
                self.glyph([x, y], [x + width, y + height], Atlas::place(character), colour);
            }
            x += width;
        }
    }

    fn glyph(&mut self, upper: Point, lower: Point, place: [Point; 2], colour: [u8; 4]) {
        let (chunk, first) = self.room(4);
        let [[left, top], [right, bottom]] = place;
        let vertex = |position, [u, v]: Point| Vertex { position, sample: [u, v, 1.0], colour };
        chunk.vertices.extend([
            vertex(upper, [left, top]),
            vertex([lower[0], upper[1]], [right, top]),
            vertex([upper[0], lower[1]], [left, bottom]),
            vertex(lower, [right, bottom]),
        ]);
        chunk.indices.extend([0, 1, 2, 2, 1, 3].map(|index| first + index));
    }
}

/// Colour of a line, and its reach: half its width plus half a pixel, in screen pixels.
fn pen(item: &Item, pixel: f32) -> ([u8; 4], f32) {
    // A line thinner than a pixel is drawn one pixel wide, with its opacity reduced.
    let width = item.width / pixel;
    let mut colour = bytes(item.stroke);
    colour[3] = (f32::from(colour[3]) * width.min(1.0)).round() as u8;
    (colour, width.max(1.0) / 2.0 + 0.5)
}

/// Regular polygon: a mark or a circle.
struct Disc {
    middle: Point,
    /// Distance from the centre to the edges.
    inner: f32,
}

/// Recognises a regular polygon of 5 to 64 corners. The tolerance is about a hundredth of the edge length.
fn regular(points: &[Point]) -> Option<Disc> {
    if !(5..=64).contains(&points.len()) {
        return None;
    }
    let share = 1.0 / points.len() as f32;
    let sum = points.iter().fold([0.0; 2], |[x, y], point| [x + point[0], y + point[1]]);
    let middle = sum.map(|sum| sum * share);
    let square = |a: Point, b: Point| (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
    let (outer, edge) = (square(points[0], middle), square(points[0], points[1]));
    let tolerance = 0.02 * edge;
    let mut last = points[points.len() - 1];
    for &point in points {
        if (square(point, middle) - outer).abs() > tolerance || (square(point, last) - edge).abs() > tolerance
        {
            return None;
        }
        last = point;
    }
    let inner = (outer - edge / 4.0).sqrt();
    (inner > 0.0).then_some(Disc { middle, inner })
}

/// Whether a shape may overlap the screen. `false` if a coordinate is not finite.
fn is_visible(points: &[Point], width: f32, screen: &Screen) -> bool {
    // A mitre extends at most 2.2 half-widths of the line.
    let margin = 1.1 * width + 2.0 * screen.pixel;
    let mut seen = [[false; 2]; 2];
    for point in points {
        for axis in 0..2 {
            if !point[axis].is_finite() {
                return false;
            }
            seen[axis][0] |= point[axis] > -margin;
            seen[axis][1] |= point[axis] < screen.size[axis] + margin;
        }
    }
    seen == [[true; 2]; 2]
}

/// Triangle fan of a convex polygon. `None` if the polygon is empty or does not fit in a chunk.
fn fan(corners: usize) -> Option<impl Iterator<Item = [u16; 3]>> {
    let last =
        u16::try_from(corners.checked_sub(1)?).ok().filter(|&last| usize::from(last) < Chunk::VERTICES)?;
    Some((1..last).map(|corner| [0, corner, corner + 1]))
}

/// Appends the triangles of a strip of `pairs` pairs of vertices. The vertices alternate between the two sides of the
/// strip.
fn ribbon(indices: &mut Vec<u16>, first: u16, pairs: usize, closed: bool) {
    // The cast is exact, because the corners fit in a chunk.
    let pairs = pairs as u16;
    let mut quad = |a: u16, b: u16| {
        let [a, b] = [first + 2 * a, first + 2 * b];
        indices.extend([a, a + 1, b, b, a + 1, b + 1]);
    };
    for pair in 1..pairs {
        quad(pair - 1, pair);
    }
    if closed && pairs > 1 {
        quad(pairs - 1, 0);
    }
}

fn turns_left(points: &[Point]) -> bool {
    let [x, y] = points[0];
    let cross = |pair: &[Point]| {
        let [[ax, ay], [bx, by]] = [pair[0], pair[1]].map(|point| [point[0] - x, point[1] - y]);
        ax * by - ay * bx
    };
    points.windows(2).map(cross).sum::<f32>() < 0.0
}

fn beside(point: Point, side: Point, by: f32) -> Point {
    [point[0] + side[0] * by, point[1] + side[1] * by]
}

fn bytes(colour: Colour) -> [u8; 4] {
    let [red, green, blue] = colour.rgb;
    [red, green, blue, colour.opacity]
}
