use super::*;
use crate::fx;
use crate::math::Rng;

fn point(x: i32, y: i32) -> Vec2<Fx> {
    Vec2::new(x.into(), y.into())
}

#[test]
fn bad_outlines_are_refused_with_the_reason() {
    let new =
        |points: &[(i32, i32)]| Polygon::new(&points.iter().map(|&(x, y)| point(x, y)).collect::<Vec<_>>());
    assert_eq!(new(&[(0, 0), (1, 0)]), Err(GeometryError::VertexCount { count: 2 }));
    assert_eq!(new(&[(0, 0); 9]), Err(GeometryError::VertexCount { count: 9 }));
    let clockwise = [(0, 0), (0, 1), (1, 0)];
    assert_eq!(new(&clockwise), Err(GeometryError::Clockwise));
    let clockwise_and_concave = [(0, 4), (1, 1), (4, 0), (0, 0)];
    assert!(matches!(new(&clockwise_and_concave), Err(GeometryError::NotConvex { .. })));
    let collinear = [(0, 0), (1, 0), (2, 0)];
    assert!(matches!(new(&collinear), Err(GeometryError::NotConvex { .. })));
    let concave = [(0, 0), (4, 0), (1, 1), (0, 4)];
    assert!(matches!(new(&concave), Err(GeometryError::NotConvex { .. })));
    let pentagram = [(0, 10), (-6, -8), (9, 3), (-9, 3), (6, -8)];
    assert!(matches!(new(&pentagram), Err(GeometryError::NotConvex { .. })));
    let doubled = [(0, 0), (0, 0), (1, 0), (0, 1)];
    assert!(matches!(new(&doubled), Err(GeometryError::ShortEdge { .. })));
    assert!(matches!(new(&[(0, 0), (121, 0), (0, 1)]), Err(GeometryError::SizeOutOfRange { .. })));
    assert!(Polygon::rectangle(fx!(0), fx!(1)).is_err());
    assert!(Polygon::rectangle(fx!(-1), fx!(1)).is_err());
    let bounds = [fx!(0.00025), SHAPE_EXTENT_MAX];
    assert!(bounds.map(Polygon::square).iter().all(Result::is_ok));
    assert!(Polygon::regular(4, -SHAPE_EXTENT_MAX).is_ok() && Polygon::regular(8, SHAPE_EXTENT_MAX).is_ok());
    assert!(matches!(Polygon::square(fx!(0.00024)), Err(GeometryError::ShortEdge { vertex: 0 })));
}

#[test]
fn a_hull_is_the_smallest_convex_polygon_around_the_points() {
    let mut rng = Rng::new(7);
    let mut built = 0;
    for _ in 0..2000 {
        let points: Vec<_> = (0..rng.below(12) + 3)
            .map(|_| Vec2::new(rng.range(fx!(-5), fx!(5)), rng.range(fx!(-5), fx!(5))))
            .collect();
        let Ok(hull) = Polygon::hull(&points) else { continue };
        built += 1;
        for &vertex in hull.vertices() {
            assert!(
                points.iter().any(|point| point.narrow() == vertex),
                "a hull vertex should be an input point"
            );
        }
        for (&vertex, &normal) in hull.vertices().iter().zip(hull.normals()) {
            for point in &points {
                let outside: Length = (point.narrow() - vertex).dot(normal);
                assert!(
                    outside <= Length::from_bits(2),
                    "expected no point outside of the hull, got one {outside} outside"
                );
            }
        }
    }
    assert!(built > 1500, "expected over 1500 hulls, got {built}");
}

#[test]
fn stored_bytes_are_checked_like_any_other_input() {
    let square = Polygon::square(fx!(1)).unwrap().rounded(fx!(0.25)).unwrap();
    let bytes = crate::codec::encode(&square);
    assert_eq!(crate::codec::decode::<Polygon>(&bytes), Ok(square));
    let concave = Repr {
        vertices: [(0, 0), (4, 0), (1, 1), (0, 4)].map(|(x, y)| point(x, y).narrow()).to_vec(),
        radius: Length::ZERO,
    };
    assert!(crate::codec::decode::<Polygon>(&crate::codec::encode(&concave)).is_err());
}
