use super::*;

fn close(a: Fx, b: Fx) {
    assert!((a - b).abs() < fx!(0.00001), "expected {b}, got {a}");
}

fn dynamic(shapes: &[ShapeDef]) -> Result<MassProperties, WorldError> {
    MassProperties::dynamic(MassSource::Shapes, shapes.iter())
}

#[test]
fn textbook_shapes_have_textbook_masses() {
    let rectangle = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.5)).unwrap()).density(fx!(3));
    let properties = dynamic(&[rectangle]).unwrap();
    close(properties.mass, fx!(6));
    // k^2 = (w^2 + h^2) / 12 = 5 / 12
    close(fx_mul(properties.gyration, properties.gyration), fx!(5 / 12));

    let disc = ShapeDef::new(Geometry::circle(fx!(2)).unwrap()).offset((fx!(1), fx!(-1)));
    let properties = dynamic(&[disc]).unwrap();
    close(properties.mass, fx_mul(fx!(4), PI));
    close(fx_mul(properties.gyration, properties.gyration), fx!(2));
    assert_eq!(properties.centre, disc.offset);

    let pill = Geometry::capsule(Vec2::new(fx!(-1), fx!(3)), Vec2::new(fx!(3), fx!(3)), fx!(0.5)).unwrap();
    let properties = dynamic(&[ShapeDef::new(pill).density(fx!(2))]).unwrap();
    close(properties.mass, fx!(8) + PI / 2);
    close(properties.centre.x, fx!(1));
    close(properties.centre.y, fx!(3));
    // (4 (16 + 1) / 12 + pi/4 (1/8 + 4 + 8 / (3 pi))) / (4 + pi/4)
    close(fx_mul(properties.gyration, properties.gyration), fx!(2.000481555));

    let corner = Vec2::new;
    let triangle =
        Polygon::new(&[corner(fx!(0), fx!(0)), corner(fx!(3), fx!(0)), corner(fx!(0), fx!(3))]).unwrap();
    let properties = dynamic(&[ShapeDef::new(triangle)]).unwrap();
    close(properties.mass, fx!(4.5));
    close(properties.centre.x, fx!(1));
    close(properties.centre.y, fx!(1));
    // k^2 = (a^2 + b^2) / 18 = 1
    close(properties.gyration, fx!(1));
}

#[test]
fn a_rounded_rail_weighs_its_core_its_sides_and_four_quarter_discs() {
    let rail = Polygon::rectangle(fx!(0.4), fx!(20)).unwrap().rounded(fx!(0.2)).unwrap();
    let properties = dynamic(&[ShapeDef::new(rail).density(fx!(3)).offset((fx!(1), fx!(2)))]).unwrap();
    // The density, 3, times the areas of core and sides (48.32) and of the corners (0.04 pi). The tolerance allows for
    // the rounding of 0.2 and 0.4 to `Length`, by 5e-8 and 1e-7.
    let expected = fx!(144.96) + fx_mul(fx!(0.12), PI);
    assert!((properties.mass - expected).abs() < fx!(0.0001), "expected {expected}, got {}", properties.mass);
    assert_eq!(properties.centre, Vec2::new(fx!(1), fx!(2)));
}

#[test]
fn two_halves_weigh_like_the_whole() {
    let half = |x| ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.5)).unwrap()).offset((x, fx!(4)));
    let halves = dynamic(&[half(fx!(-0.5)), half(fx!(0.5))]).unwrap();
    let whole = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.5)).unwrap()).offset((fx!(0), fx!(4)));
    let whole = dynamic(&[whole]).unwrap();
    close(halves.mass, whole.mass);
    close(halves.gyration, whole.gyration);
    close(halves.centre.y, whole.centre.y);
}

#[test]
fn small_and_large_bodies_keep_their_proportions() {
    for half in [fx!(0.005), fx!(0.05), fx!(5), fx!(100)] {
        let square = ShapeDef::new(Polygon::square(half).unwrap());
        let gyration = dynamic(&[square]).unwrap().gyration;
        // k = 2 h / sqrt(6)
        let expected = fx_mul(half, fx!(0.816496580928));
        let error = (gyration - expected).abs();
        assert!(
            error <= fx_mul(expected, fx!(0.0001)),
            "half extent {half}: expected {expected}, got {gyration}"
        );
    }
}

#[test]
fn bodies_without_mass_are_immovable_and_overweight_ones_refused() {
    let line = ShapeDef::new(Geometry::segment(Vec2::ZERO, Vec2::new(fx!(1), fx!(0))).unwrap());
    assert_eq!(dynamic(&[line]), Ok(MassProperties::immovable()));
    assert_eq!(dynamic(&[]), Ok(MassProperties::immovable()));
    let speck = ShapeDef::new(Geometry::circle(fx!(0.002)).unwrap()).density(fx!(0.01));
    assert!(matches!(dynamic(&[speck]), Err(WorldError::MassOutOfRange { .. })));
    let lead = ShapeDef::new(Polygon::square(fx!(100)).unwrap()).density(fx!(100000));
    assert!(matches!(dynamic(&[lead]), Err(WorldError::MassOutOfRange { .. })));
}
