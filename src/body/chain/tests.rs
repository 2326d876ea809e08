use super::*;
use crate::fx;

fn point(x: i32, y: i32) -> Vec2<Fx> {
    Vec2::new(x.into(), y.into())
}

fn neighbours(shape: &ShapeDef) -> (Option<Vec2<Fx>>, Option<Vec2<Fx>>) {
    match shape.geometry {
        Geometry::Link { before, after, .. } => (before, after),
        _ => unreachable!("a chain consists of links"),
    }
}

#[test]
fn links_know_their_neighbours() {
    let points = [point(0, 0), point(1, 0), point(2, 1)];
    let open = Chain::new(&points).links().unwrap();
    let found: Vec<_> = open.iter().map(neighbours).collect();
    assert_eq!(found, [(None, Some(points[2])), (Some(points[0]), None)]);
    let closed = Chain::new(&points).closed().links().unwrap();
    let found: Vec<_> = closed.iter().map(neighbours).collect();
    let [a, b, c] = points.map(Some);
    assert_eq!(found, [(c, c), (a, a), (b, b)]);
}

#[test]
fn bad_chains_are_refused_with_the_reason() {
    let points = [point(0, 0), point(1, 0), point(1, 0), point(2, 0)];
    let length = |chain: &Chain<'_>| matches!(chain.links(), Err(GeometryError::ChainLength { .. }));
    assert!(length(&Chain::new(&points[..0])) && length(&Chain::new(&points[..1])));
    assert!(length(&Chain::new(&points[..2]).closed()) && length(&Chain::new(&[]).closed()));
    assert!(length(&Chain::new(&alloc::vec![point(0, 0); 5000])));
    assert!(matches!(Chain::new(&points).links(), Err(GeometryError::SizeOutOfRange { .. })));
    let ice = Material { friction: fx!(0), ..Material::default() };
    let short = Chain::new(&points[..2]).materials(&[ice, ice]).links();
    assert!(matches!(short, Err(GeometryError::MaterialCount { links: 1, materials: 2 })));
}
