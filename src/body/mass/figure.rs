//! Area, centre of mass and radius of gyration of a rounded convex polygon.
//!
//! The core is the polygon without its rounding. It has the vertices `v_i`, the area `A`, the centre of mass `c` and
//! the radius of gyration `k`. Its moments about the origin, with `c_i = v_i x v_(i+1)` (D. Eberly, "Polyhedral Mass
//! Properties"), are
//!
//! ```text
//! A            = 1/2 sum c_i
//! A c          = 1/3 sum c_i (v_i + v_(i+1)) / 2
//! A (k² + c.c) = 1/6 sum c_i (v_i.v_i + v_i.v_(i+1) + v_(i+1).v_(i+1)) / 2
//! ```
//!
//! A rounding radius `r` adds a rectangle to every edge and a sector to every vertex. Let `v_i` be relative to the
//! core's centre `c`, `l_i` the length of the edge from `v_i`, `a_i = r theta_i` the arc about `v_i`, `l = sum l_i` and
//! `a = sum a_i`. `m` and `J` are the first and second moments about `c`. The rounded polygon has the area `A'`, the
//! centre `c'` and the radius of gyration `k'`:
//!
//! ```text
//! 2 A' = 2 A + r (2 l + a)
//! 2 m  = r sum (l_i (v_i + v_(i+1)) + a_i v_i)
//! 2 J  = 2 A k² + r (2/3 sum l_i (v_i.v_i + v_i.v_(i+1) + v_(i+1).v_(i+1)) + sum a_i v_i.v_i
//!                    + 4 r A + 2 r² l + r² a / 2)
//! c'   = c + m / A'
//! k'²  = J / A' - |m / A'|²
//! ```
//!
//! The line for `2 A'` is J. Steiner's formula (1840). `2 m` has no terms along the edge normals, because they cancel
//! around the outline.

use crate::math::{Angle, Fx, Length, Vec2, div_round, fx_mul, round_shift_wide};

/// Moments of a region of uniform density.
///
/// Sums do not overflow: at an extent of 110 m, `2 A` is below 2^17 m² with 44 fraction bits, `|v|` below 2^9 m with 32
/// fraction bits, and `2 J` below 2^30 m⁴ with 88 fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Figure {
    /// Twice the area in m², with 44 fraction bits.
    doubled_area: i128,
    /// Centre of mass in metres, with 32 fraction bits.
    centre: (i128, i128),
    /// Square of the radius of gyration in m², with 44 fraction bits.
    gyration_squared: i128,
}

impl Figure {
    /// Moments of a counter-clockwise polygon.
    pub(super) fn of_polygon(vertices: &[Vec2<Length>]) -> Figure {
        // Coordinates have 22 fraction bits, the area 44, the first moments 66 and the second moment 88.
        let (mut area, mut first_x, mut first_y, mut second) = (0i128, 0i128, 0i128, 0i128);
        for (i, start) in vertices.iter().enumerate() {
            let end = vertices[(i + 1) % vertices.len()];
            let (x1, y1) = (i128::from(start.x.to_bits()), i128::from(start.y.to_bits()));
            let (x2, y2) = (i128::from(end.x.to_bits()), i128::from(end.y.to_bits()));
            let cross = x1 * y2 - y1 * x2;
            area += cross;
            first_x += cross * (x1 + x2);
            first_y += cross * (y1 + y2);
            second += cross * (x1 * x1 + x1 * x2 + x2 * x2 + y1 * y1 + y1 * y2 + y2 * y2);
        }
        let centre_of = |first: i128| div_round(first << 10, 3 * area);
        let (x, y) = (centre_of(first_x), centre_of(first_y));
        let about_origin = div_round(second, 6 * area);
        let gyration_squared = (about_origin - ((x * x + y * y) >> 20)).max(0);
        Figure { doubled_area: area, centre: (x, y), gyration_squared }
    }

    /// Moments after rounding by `radius`. A radius of 0 returns the figure unchanged.
    pub(super) fn rounded(self, vertices: &[Vec2<Length>], radius: Length) -> Figure {
        let r = i128::from(Fx::from(radius).to_bits());
        let (mut edges, mut arcs) = (0i128, 0i128);
        // The first moments have 64 fraction bits, and the second moment 76.
        let (mut first_x, mut first_y, mut second) = (0i128, 0i128, 0i128);
        for (i, &vertex) in vertices.iter().enumerate() {
            let before = vertices[(i + vertices.len() - 1) % vertices.len()];
            let after = vertices[(i + 1) % vertices.len()];
            let edge = i128::from((after - vertex).widen().length().to_bits());
            let turn = turn_between(vertex - before, after - vertex);
            let arc = i128::from(fx_mul(radius.into(), turn.to_radians()).to_bits());
            edges += edge;
            arcs += arc;

            let ((x1, y1), (x2, y2)) = (self.about_centre(vertex), self.about_centre(after));
            first_x += edge * (x1 + x2) + arc * x1;
            first_y += edge * (y1 + y2) + arc * y1;
            let of_vertex = x1 * x1 + y1 * y1;
            let of_edge = of_vertex + x1 * x2 + y1 * y2 + x2 * x2 + y2 * y2;
            second += edge * div_round(2 * of_edge, 3 << 20) + arc * round_shift_wide(of_vertex, 20);
        }
        let rr = round_shift_wide(r * r, 20);
        second += 2 * r * self.doubled_area + 2 * rr * edges + rr * arcs / 2;

        let doubled_area = self.doubled_area + round_shift_wide(r * (2 * edges + arcs), 20);
        let moment = self.doubled_area * self.gyration_squared + r * round_shift_wide(second, 20);
        let moved = |first: i128| div_round(r * first, doubled_area << 20);
        let (x, y) = (moved(first_x), moved(first_y));
        Figure {
            doubled_area,
            centre: (self.centre.0 + x, self.centre.1 + y),
            gyration_squared: div_round(moment, doubled_area) - ((x * x + y * y) >> 20),
        }
    }

    /// Area in m², with 32 fraction bits, rounded down.
    pub(super) fn area(&self) -> i128 {
        self.doubled_area >> 13
    }

    pub(super) fn centre(&self) -> (i128, i128) {
        self.centre
    }

    pub(super) fn gyration_squared(&self) -> i128 {
        self.gyration_squared
    }

    fn about_centre(&self, vertex: Vec2<Length>) -> (i128, i128) {
        let vertex = vertex.widen();
        (i128::from(vertex.x.to_bits()) - self.centre.0, i128::from(vertex.y.to_bits()) - self.centre.1)
    }
}

/// Angle by which an outline turns at a vertex. The angles at all vertices sum to one turn.
fn turn_between(before: Vec2<Length>, after: Vec2<Length>) -> Angle {
    let product = |a: Length, b: Length| i64::from(a.to_bits()) * i64::from(b.to_bits());
    // Exact: edges are at most 220 m long on each axis, so a sum of two products has at most 61 bits.
    let dot = product(before.x, after.x) + product(before.y, after.y);
    let cross = product(before.x, after.y) - product(before.y, after.x);
    Angle::of(Vec2::new(Fx::from_bits(dot), Fx::from_bits(cross)))
}

#[cfg(test)]
mod tests;
