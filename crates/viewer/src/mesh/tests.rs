//! Compares meshes, rasterised by a simple software renderer, with the exact coverage of the shapes in the list.

use lockstep2d_render::{CELL_HEIGHT, CELL_WIDTH, Colour, DrawList, glyph};

use super::{Atlas, Chunk, Mesh, Screen, Vertex};

const SIDE: usize = 64;
const SCREEN: Screen = Screen { size: [SIDE as f32; 2], pixel: 1.0 };
const WHITE: Colour = Colour::hex(0xffffff);

fn mesh_of(list: &DrawList, screen: &Screen) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.build(list, screen);
    for chunk in mesh.chunks() {
        assert!(chunk.vertices.len() <= Chunk::VERTICES && chunk.indices.len() <= Chunk::INDICES);
        assert!(chunk.indices.iter().all(|&index| usize::from(index) < chunk.vertices.len()));
        assert_eq!(chunk.indices.len() % 3, 0);
    }
    mesh
}

/// Brightness of each pixel when a list is drawn in white on black, computed by the formula of the shader.
fn drawn(list: &DrawList) -> Vec<f32> {
    let mesh = mesh_of(list, &SCREEN);
    let atlas = Atlas::default();
    let mut pixels = vec![0.0; SIDE * SIDE];
    for chunk in mesh.chunks() {
        for triangle in chunk.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|at| &chunk.vertices[usize::from(triangle[at])]);
            for (at, pixel) in pixels.iter_mut().enumerate() {
                let point = [(at % SIDE) as f32 + 0.5, (at / SIDE) as f32 + 0.5];
                if let Some(sample) = sample(corners, point) {
                    let opacity = coverage(&atlas, sample) * f32::from(corners[0].colour[3]) / 255.0;
                    *pixel += (1.0 - *pixel) * opacity;
                }
            }
        }
    }
    pixels
}

fn sample(corners: [&Vertex; 3], point: [f32; 2]) -> Option<[f32; 3]> {
    let [a, b, c] = corners.map(|corner| corner.position);
    let cross =
        |a: [f32; 2], b: [f32; 2], c: [f32; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let area = cross(a, b, c);
    // The point is slightly off the pixel centre, because a point exactly on a shared edge would count for two
    // triangles.
    let point = [point[0] + 1.3e-3, point[1] + 2.7e-3];
    let weights = [cross(point, b, c), cross(a, point, c), cross(a, b, point)].map(|part| part / area);
    let inside = area != 0.0 && weights.iter().all(|&weight| weight >= 0.0);
    let mix = |at: usize| (0..3).map(|corner| corners[corner].sample[at] * weights[corner]).sum();
    inside.then(|| [0, 1, 2].map(mix))
}

fn coverage(atlas: &Atlas, [u, v, text]: [f32; 3]) -> f32 {
    if text < 0.5 {
        return (v - u.abs()).clamp(0.0, 1.0);
    }
    let [x, y] = [u * Atlas::WIDTH as f32, v * Atlas::HEIGHT as f32].map(|at| at as usize);
    f32::from(atlas.pixels[(y * Atlas::WIDTH + x) * 4 + 3]) / 255.0
}

/// Compares every pixel with the expected coverage at its centre.
fn assert_covers(list: &DrawList, tolerance: f32, expected: impl Fn([f32; 2]) -> f32) {
    for (at, pixel) in drawn(list).into_iter().enumerate() {
        let point = [(at % SIDE) as f32 + 0.5, (at / SIDE) as f32 + 0.5];
        let expected = expected(point);
        assert!((pixel - expected).abs() <= tolerance, "{point:?}: {pixel} instead of {expected}");
    }
}

/// Returns the distance of a point from a segment, and whether the closest point lies between the ends.
fn distance([px, py]: [f32; 2], [ax, ay]: [f32; 2], [bx, by]: [f32; 2]) -> (f32, bool) {
    let [x, y] = [bx - ax, by - ay];
    let along = ((px - ax) * x + (py - ay) * y) / (x * x + y * y);
    let on = along.clamp(0.0, 1.0);
    let [dx, dy] = [px - ax - on * x, py - ay - on * y];
    ((dx * dx + dy * dy).sqrt(), (0.0..=1.0).contains(&along))
}

const BOX: [[f32; 2]; 4] = [[20.2, 10.3], [12.1, 40.4], [45.7, 49.4], [53.8, 19.3]];

fn edges() -> impl Iterator<Item = ([f32; 2], [f32; 2])> {
    (0..4).map(|at| (BOX[at], BOX[(at + 1) % 4]))
}

fn inside(point: [f32; 2]) -> bool {
    edges().all(|([ax, ay], [bx, by])| (bx - ax) * (point[1] - ay) - (by - ay) * (point[0] - ax) < 0.0)
}

fn depth(point: [f32; 2]) -> f32 {
    let edge = edges().map(|(a, b)| distance(point, a, b).0).fold(f32::MAX, f32::min);
    if inside(point) { edge } else { -edge }
}

#[test]
fn a_line_covers_what_is_near_it() {
    for width in [1.0, 1.5, 4.0] {
        let (a, b) = ([5.3, 9.8], [55.1, 41.2]);
        let mut list = DrawList::default();
        list.line([a, b], WHITE, width);
        assert_covers(&list, 0.01, |point| match distance(point, a, b) {
            (distance, true) => (width / 2.0 + 0.5 - distance).clamp(0.0, 1.0),
            (_, false) => 0.0,
        });
    }
}

#[test]
fn a_thin_line_is_faint() {
    let mut list = DrawList::default();
    list.line([[10.0, 20.5], [50.0, 20.5]], WHITE, 0.25);
    assert_covers(&list, 0.01, |[x, y]| if (10.0..50.0).contains(&x) && y == 20.5 { 0.25 } else { 0.0 });
}

#[test]
fn an_area_with_a_border_and_one_without() {
    let mut list = DrawList::default();
    list.polygon(BOX, WHITE, Colour::NONE, 0.0);
    // At corners, the antialiased edge misses a fraction of a pixel.
    assert_covers(&list, 0.3, |point| (depth(point) + 0.5).clamp(0.0, 1.0));
    let backwards = BOX.into_iter().rev();
    let mut other = DrawList::default();
    other.polygon(backwards, WHITE, Colour::NONE, 0.0);
    for (a, b) in drawn(&list).into_iter().zip(drawn(&other)) {
        assert!((a - b).abs() < 0.01, "the direction of the outline should make no difference");
    }

    list.clear();
    list.polygon(BOX, WHITE, WHITE, 3.0);
    // The border is 1.5 pixels wide on each side. At the corners, mitres extend further.
    let near_corner =
        |point| BOX.iter().any(|&corner| distance(point, corner, [corner[0] + 0.1, corner[1]]).0 < 4.0);
    for (at, pixel) in drawn(&list).into_iter().enumerate() {
        let point = [(at % SIDE) as f32 + 0.5, (at / SIDE) as f32 + 0.5];
        let expected = (depth(point) + 2.0).clamp(0.0, 1.0);
        assert!(near_corner(point) || (pixel - expected).abs() < 0.01, "{point:?}: {pixel}, {expected}");
    }
}

fn disc([x, y]: [f32; 2], radius: f32, corners: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..corners).map(move |corner| {
        let (sin, cos) = (std::f32::consts::TAU * corner as f32 / corners as f32).sin_cos();
        [x + radius * cos, y + radius * sin]
    })
}

#[test]
fn discs_are_round_whatever_their_size() {
    for (radius, corners) in [(0.7, 8), (3.0, 8), (9.3, 24), (25.0, 60), (20.0, 80)] {
        let middle = [31.3, 30.8];
        let mut list = DrawList::default();
        list.polygon(disc(middle, radius, corners), WHITE, Colour::NONE, 0.0);
        // The tolerance includes the largest distance between the edges of the polygon and the circle through its
        // corners.
        let tolerance = 0.02 + radius * (1.0 - (std::f32::consts::PI / corners as f32).cos());
        assert_covers(&list, tolerance, |point| {
            let depth = radius - distance(point, middle, [middle[0] + 1e-3, middle[1]]).0;
            (depth + 0.5).clamp(0.0, 1.0)
        });
    }
}

#[test]
fn rectangles_on_whole_pixels_are_sharp() {
    let mut list = DrawList::default();
    list.rectangle([7.0, 11.0], [20.0, 9.0], WHITE);
    assert_covers(&list, 0.011, |[x, y]| f32::from((7.0..27.0).contains(&x) && (11.0..20.0).contains(&y)));
}

#[test]
fn a_line_is_as_wide_behind_a_corner_and_cut_off_behind_a_sharp_one() {
    let points = [[8.0, 32.5], [32.0, 32.5], [32.0, 8.0], [33.0, 56.0]];
    let mut list = DrawList::default();
    list.line(points, WHITE, 3.0);
    let pixels = drawn(&list);
    let at = |x: usize, y: usize| pixels[y * SIDE + x];
    assert!(at(33, 33) > 0.2, "the corner should have a mitre");
    assert!([12, 20, 28].iter().all(|&x| at(x, 31) == 1.0 && at(x, 32) == 1.0 && at(x, 34) < 0.6));
    assert!((0..5).all(|y| at(32, y) == 0.0), "a turn by almost 180 degrees should have no mitre");
}

#[test]
fn text_is_the_glyphs_in_their_cells() {
    let text = "Ag1 –µ";
    let mut list = DrawList::default();
    list.text([10.4, 20.0], 1.0, WHITE, text);
    let glyphs: Vec<_> = text.chars().map(glyph).collect();
    assert_covers(&list, 0.005, |[x, y]| {
        let [x, y] = [x - 10.0, y - 20.0];
        if x < 0.0 || !(0.0..CELL_HEIGHT).contains(&y) {
            return 0.0;
        }
        let Some(glyph) = glyphs.get((x / CELL_WIDTH) as usize) else { return 0.0 };
        f32::from(glyph[y as usize][(x % CELL_WIDTH) as usize]) / 255.0
    });
}

#[test]
fn what_is_later_lies_on_top_text_too() {
    let black = Colour::hex(0);
    let mut list = DrawList::default();
    list.text([10.0, 20.0], 1.0, WHITE, "M");
    list.rectangle([0.0, 0.0], [64.0, 64.0], black);
    list.text([10.0, 40.0], 1.0, WHITE, "M");
    let mesh = mesh_of(&list, &SCREEN);
    let order: Vec<bool> = mesh.chunks()[0].vertices.iter().map(|vertex| vertex.sample[2] == 1.0).collect();
    let mut runs = order;
    runs.dedup();
    assert_eq!(runs, [true, false, true]);
}

#[test]
fn what_cannot_be_seen_makes_no_triangles() {
    let mut list = DrawList::default();
    list.rectangle([70.0, 0.0], [20.0, 20.0], WHITE);
    list.rectangle([0.0, -30.0], [20.0, 20.0], WHITE);
    list.line([[f32::NAN, 1.0], [2.0, 2.0]], WHITE, 1.0);
    list.line([[1.0, 1.0], [f32::INFINITY, 2.0]], WHITE, 1.0);
    list.line([[5.0, 5.0], [5.0, 5.0]], WHITE, 1.0);
    list.line([[5.0, 5.0]], WHITE, 1.0);
    list.line([], WHITE, 1.0);
    list.polygon([[5.0, 5.0], [9.0, 9.0]], WHITE, Colour::NONE, 0.0);
    list.polygon(BOX, Colour::NONE, Colour::NONE, 2.0);
    list.text([0.0, 64.0], 1.0, WHITE, "below");
    list.text([f32::NAN, 3.0], f32::NAN, WHITE, "nowhere");
    assert_eq!(mesh_of(&list, &SCREEN).chunks().iter().map(|chunk| chunk.indices.len()).sum::<usize>(), 0);
}

#[test]
fn long_lines_and_long_lists_take_several_chunks() {
    let wave = |at: u32| [(at % 64) as f32, (at % 61) as f32];
    let mut list = DrawList::default();
    list.line((0..100_000).map(wave), WHITE, 1.0);
    list.polygon((0..20_000).map(wave), Colour::NONE, WHITE, 1.0);
    for _ in 0..20_000 {
        list.polygon(BOX, WHITE, WHITE, 1.2);
    }
    let mesh = mesh_of(&list, &SCREEN);
    assert!(mesh.chunks().len() > 15, "{}", mesh.chunks().len());
    let boxes = mesh.chunks().iter().flat_map(|chunk| &chunk.vertices);
    let corners = boxes.filter(|vertex| BOX.contains(&vertex.position)).count();
    assert_eq!(corners, 80_000, "expected the four corners of each of the 20 000 areas");
}

#[test]
fn half_the_size_of_a_pixel_is_half_the_width_of_a_smooth_edge() {
    let mut list = DrawList::default();
    list.line([[10.0, 20.0], [50.0, 20.0]], WHITE, 2.0);
    let mesh = mesh_of(&list, &Screen { pixel: 0.5, ..SCREEN });
    let vertices = &mesh.chunks()[0].vertices;
    assert!(vertices.iter().all(|vertex| (vertex.position[1] - 20.0).abs() == 1.25));
    assert!(vertices.iter().all(|vertex| vertex.sample[1] == 2.5), "the reach should be in screen pixels");
}

#[test]
fn a_mesh_can_be_made_again() {
    let mut list = DrawList::default();
    let mut mesh = Mesh::default();
    list.line((0..100_000).map(|at| [(at % 64) as f32, 3.0]), WHITE, 1.0);
    mesh.build(&list, &SCREEN);
    list.clear();
    list.rectangle([1.0, 1.0], [5.0, 5.0], WHITE);
    mesh.build(&list, &SCREEN);
    assert_eq!(mesh.chunks(), mesh_of(&list, &SCREEN).chunks());
}
