//! Pictures show the world, are reproducible, and do not change it.

use lockstep2d::body::{BodyDef, BodyKind, Geometry, Name, Polygon, ShapeDef, WorldError};
use lockstep2d::draw::{
    Bar, ContactProximity, Form, Frame, Layers, Legend, Primitive, Style, Subject, View, fit, primitives, svg,
};
use lockstep2d::fx;
use lockstep2d::math::{Aabb, Angle, Fx, Vec2};
use lockstep2d::solver::{Distance, Gear, JointDef, JointKind, Motor, Prismatic, Revolute, Weld, Wheel};
use lockstep2d::world::{Config, World};

const GROUND_TOP: Fx = fx!(0);

/// A ground, a box at rest on it, a pendulum, and a lift. Gravity is tilted, so friction keeps the box from sliding.
fn scene() -> World {
    build_scene().expect("a valid scene")
}

fn build_scene() -> Result<World, WorldError> {
    let gravity = Vec2::new(fx!(1), fx!(-10));
    let mut world = World::new(Config { gravity, sleeping: false, ..Config::default() })?;
    let slab = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(1))?);
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[slab])?;
    let crate_ = ShapeDef::new(Polygon::square(fx!(0.5))?);
    world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[crate_])?;
    let post = world.spawn(&BodyDef::fixed().position((fx!(3), fx!(4))), &[])?;
    let bob = ShapeDef::new(Geometry::circle(fx!(0.25))?);
    let bob = world.spawn(&BodyDef::dynamic().position((fx!(4.5), fx!(4))), &[bob])?;
    world.add_joint(&JointDef::new(post, bob, Revolute::new()).anchor_b((fx!(-1.5), fx!(0))))?;
    let lift = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.1))?.rounded(fx!(0.1))?);
    let lift_def = BodyDef::kinematic().position((fx!(-3), fx!(1))).velocity((fx!(0), fx!(1)));
    world.spawn(&lift_def, &[lift])?;
    for _ in 0..60 {
        world.step();
    }
    Ok(world)
}

fn count(found: &[Primitive], style: Style) -> usize {
    found.iter().filter(|primitive| primitive.style == style).count()
}

#[test]
fn every_layer_has_its_primitives() {
    let found = primitives(&scene(), Layers::ALL);
    let expected = [
        (Style::Fixed, 1),
        // A box has one outline. A circle has an outline and a radius.
        (Style::Dynamic, 3),
        (Style::Kinematic, 1),
        (Style::FatBox, 4),
        (Style::ContactPoint(ContactProximity::Touching), 2),
        (Style::ContactPoint(ContactProximity::Speculative), 0),
        (Style::ContactNormal(ContactProximity::Touching), 2),
        (Style::ContactNormal(ContactProximity::Speculative), 0),
        // An arm is drawn from the centre of a movable body to the joint, so only the bob has one.
        (Style::JointArm, 1),
        (Style::JointAnchor, 2),
        (Style::JointGap, 1),
        (Style::CentreOfMass, 3),
    ];
    for (style, expected) in expected {
        assert_eq!(count(&found, style), expected, "{style:?}");
    }
    assert!(count(&found, Style::Velocity) >= 2, "expected velocities of the bob and the lift");
}

#[test]
fn a_layer_that_is_off_shows_nothing() {
    let world = scene();
    assert_eq!(primitives(&world, Layers::NONE), []);
    assert_eq!(count(&primitives(&world, Layers::default()), Style::Velocity), 0);
    let points = primitives(&world, Layers { contact_points: true, ..Layers::NONE });
    assert_eq!(count(&points, Style::ContactPoint(ContactProximity::Touching)), points.len());
}

#[test]
fn primitives_are_where_the_world_is() {
    let world = scene();
    let found = primitives(&world, Layers::ALL);
    for Primitive { style, subject, form } in &found {
        match (style, form) {
            (Style::ContactPoint(_), Form::Point(place)) => {
                assert!((place.y - GROUND_TOP).abs() < fx!(0.005), "{place:?}");
                assert!((place.x.abs() - fx!(0.5)).abs() < fx!(0.005), "{place:?}");
            }
            (Style::ContactNormal(_), Form::Direction { direction, .. }) => {
                assert!(direction.y > Fx::lit("0.999"), "expected an upward normal: {direction:?}");
            }
            (Style::JointGap, Form::Line { from, to }) => assert!(from.distance(*to) < fx!(0.01)),
            (Style::CentreOfMass, Form::Point(place)) => {
                let Subject::Body(id) = *subject else { panic!("{subject:?}") };
                assert_eq!(*place, world.body(id).unwrap().centre_of_mass());
            }
            (Style::Dynamic, Form::Line { from, to }) => {
                let radius = from.distance(*to);
                assert!(
                    (radius - fx!(0.25)).abs() < fx!(0.0001),
                    "expected the radius of the bob, found {radius}"
                );
            }
            _ => {}
        }
    }
}

#[test]
fn a_point_that_only_may_touch_is_told_apart() {
    let mut world = World::default();
    let floor = Geometry::segment(Vec2::new(fx!(-5), fx!(0)), Vec2::new(fx!(5), fx!(0))).unwrap();
    world.spawn(&BodyDef::fixed(), &[ShapeDef::new(floor)]).unwrap();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let falling = BodyDef::dynamic().position((fx!(0), fx!(0.75))).velocity((fx!(0), fx!(-30)));
    world.spawn(&falling, &[ball]).unwrap();
    world.step();
    let found = primitives(&world, Layers::ALL);
    assert_eq!(count(&found, Style::ContactPoint(ContactProximity::Speculative)), 1);
    assert_eq!(count(&found, Style::ContactNormal(ContactProximity::Speculative)), 1);
    assert_eq!(count(&found, Style::ContactPoint(ContactProximity::Touching)), 0);
}

#[test]
fn drawing_changes_nothing_and_repeats_exactly() {
    let world = scene();
    let before = (world.state_hash(), world.to_bytes());
    let view = View { layers: Layers::ALL, ..View::default() };
    let picture = svg(&world, &view);
    assert_eq!((world.state_hash(), world.to_bytes()), before);
    assert_eq!(svg(&world, &view), picture);
    assert_eq!(svg(&scene(), &view), picture);
    assert!(picture.contains(&world.state_hash().to_string()));
}

#[test]
fn after_a_restore_contacts_are_missing_until_the_next_tick() {
    let mut world = scene();
    let snapshot = world.save();
    world.restore(&snapshot);
    let found = primitives(&world, Layers::ALL);
    assert_eq!(count(&found, Style::ContactPoint(ContactProximity::Touching)), 0);
    assert_eq!(count(&found, Style::FatBox), 4);
    world.step();
    let found = primitives(&world, Layers::ALL);
    assert_eq!(count(&found, Style::ContactPoint(ContactProximity::Touching)), 2);
}

#[test]
fn after_a_removal_the_contacts_of_all_other_bodies_stay() {
    let mut world = World::new(Config { sleeping: false, ..Config::default() }).unwrap();
    let slab = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(1)).unwrap());
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[slab]).unwrap();
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap());
    let mut boxes = Vec::new();
    for x in 0..6 {
        let place = BodyDef::dynamic().position((Fx::from_num(x), fx!(0.5)));
        boxes.push(world.spawn(&place, std::slice::from_ref(&square)).unwrap());
    }
    (0..30).for_each(|_| world.step());
    let layers = Layers { contact_points: true, contact_forces: true, solver_colours: true, ..Layers::NONE };
    let before = primitives(&world, layers);
    let own = world.shapes_of(boxes[2]);
    let is_own =
        |subject: Subject| matches!(subject, Subject::Contact(a, b) if own.contains(&a) || own.contains(&b));
    let expected: Vec<_> = before.iter().filter(|found| !is_own(found.subject)).cloned().collect();
    assert!(expected.len() > 20 && expected.len() < before.len(), "{} of {}", expected.len(), before.len());
    world.despawn(boxes[2]).unwrap();
    assert_eq!(primitives(&world, layers), expected, "the same points, forces and colours");

    // The world continues like a copy that a restore has left without cached contacts.
    let mut restored = world.clone();
    restored.restore(&world.save());
    (0..30).for_each(|_| {
        world.step();
        restored.step();
        assert_eq!(world.state_hash(), restored.state_hash());
    });
}

/// Returns a world after one tick, and the figures of its legend. In the world, a joint of this kind connects a ball to
/// a fixed body 3 m away. The ball is inside a sensor of the fixed body.
#[expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
fn figures_of(kind: impl Into<JointKind>) -> (World, String) {
    let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).unwrap();
    let zone = ShapeDef::new(Geometry::circle(fx!(10)).unwrap()).sensor();
    let post = world.spawn(&BodyDef::fixed(), &[zone]).unwrap();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let ball = world.spawn(&BodyDef::dynamic().position((fx!(3), fx!(0))), &[ball]).unwrap();
    world.add_joint(&JointDef::new(post, ball, kind)).unwrap();
    world.step();
    let styles = primitives(&world, Layers::ALL).into_iter().map(|found| found.style);
    let figures = Legend::of(&world, styles).figures;
    (world, figures)
}

#[test]
fn sensors_are_no_overlap_and_what_a_joint_allows_is_no_gap() {
    let allowed: [JointKind; 8] = [
        Distance::rod(fx!(3)).into(),
        Distance::rope(fx!(5)).into(),
        Distance::new().spring(fx!(1), fx!(0.5), fx!(1)).into(),
        Prismatic::new().into(),
        Wheel::new().into(),
        Weld::rigid().linear(fx!(1), fx!(0.5)).into(),
        Motor::new().into(),
        JointKind::Filter,
    ];
    for kind in allowed {
        let (world, figures) = figures_of(kind);
        assert!(figures.contains("deepest overlap 0.0 mm"), "{kind:?}: {figures}");
        assert!(figures.contains("widest joint gap 0.0 mm"), "{kind:?}: {figures}");
        let found = primitives(&world, Layers { joints: true, ..Layers::NONE });
        assert_eq!(count(&found, Style::JointGap), 0, "{kind:?}");
        assert_eq!(
            count(&found, Style::JointArm),
            1 + 1,
            "{kind:?}: to the centre, and from anchor to anchor"
        );
    }
    let (mut world, figures) = figures_of(Distance::rope(fx!(2)));
    assert!(!figures.contains("widest joint gap 0.0 mm"), "{figures}");
    let (id, _) = world.joints().next().unwrap();
    let error = world.joint_error(id).unwrap();
    let drawn = primitives(&world, Layers { joints: true, ..Layers::NONE });
    let gaps: Vec<Fx> = drawn.iter().filter(|found| found.style == Style::JointGap).map(length_of).collect();
    assert!(gaps.len() == 1 && (gaps[0] - error).abs() < fx!(0.0001), "{gaps:?}, not {error}");
    world.disable_joint(id).unwrap();
    assert_eq!(world.widest_joint_gap(), Fx::ZERO, "a disabled joint holds nothing together");
}

#[test]
fn the_error_of_a_gear_without_a_pitch_point_is_an_angle() {
    for (teeth_b, unit) in [(-20, " mrad"), (40, " mm")] {
        let mut world = World::default();
        let disc = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
        let [a, b] = [fx!(0), fx!(3)].map(|x| {
            world.spawn(&BodyDef::dynamic().position((x, fx!(0))), std::slice::from_ref(&disc)).unwrap()
        });
        let turned = JointDef::new(a, b, Gear::new(20, teeth_b)).angle_b(Angle::from_radians(fx!(0.01)));
        let id = world.add_joint(&turned).unwrap();
        let is_angle = teeth_b == -20;
        assert_eq!(world.joint_error_is_angle(id), Some(is_angle));
        let error = world.joint_error(id).unwrap();
        assert!(error > fx!(0.01), "{error}");
        assert_eq!(world.widest_joint_gap(), if is_angle { Fx::ZERO } else { error });
        let drawn = primitives(&world, Layers { joint_errors: true, ..Layers::NONE });
        let Form::Label { text, .. } = &drawn[0].form else { panic!("expected a label: {drawn:?}") };
        assert!(text.ends_with(unit), "{text}");
    }
}

fn length_of(primitive: &Primitive) -> Fx {
    let Form::Line { from, to } = primitive.form else { panic!("expected a line: {primitive:?}") };
    from.distance(to)
}

#[test]
fn a_legend_names_every_style_once_and_labels_name_bodies() {
    let mut world = scene();
    let (id, _) = world.bodies().nth(1).unwrap();
    world.set_name(id, Some(Name::new("crate").unwrap())).unwrap();
    let zone = ShapeDef::new(Geometry::circle(fx!(2)).unwrap()).sensor();
    world.spawn(&BodyDef::dynamic(), &[zone]).unwrap();
    let found = primitives(&world, Layers::ALL);
    assert_eq!(count(&found, Style::Sensor), 2, "a circle and its radius");
    let names = Legend::of(&world, found.iter().map(|found| found.style)).names;
    for (at, (name, _)) in names.iter().enumerate() {
        assert!(!name.is_empty() && names[..at].iter().all(|(other, _)| other != name), "{names:?}");
    }
    let only = |layers| primitives(&world, layers).into_iter().map(|found| found.style);
    let normals = Legend::of(&world, only(Layers { contact_normals: true, ..Layers::NONE }));
    assert_eq!(normals.names, [("touching", 0xc62828)]);
    let labels = primitives(&world, Layers { ids: true, ..Layers::NONE });
    let is_named =
        |found: &Primitive| matches!(&found.form, Form::Label { text, .. } if text.ends_with(" crate"));
    assert_eq!(labels.iter().filter(|found| is_named(found)).count(), 1);
}

#[test]
fn pictures_are_well_formed_for_any_view() {
    let world = scene();
    let corner = |size: Fx| Aabb::new(Vec2::new(-size, -size), Vec2::new(size, size));
    let frames =
        [fx!(0), fx!(0.001), fx!(1), fx!(1000), Fx::MAX, fx!(-3)].map(|size| Frame::Window(corner(size)));
    for frame in frames.into_iter().chain([Frame::Fit]) {
        for (width, height) in [(0, 0), (960, 720), (u32::MAX, 100)] {
            let title = "<&\"' \u{1} ünïcode".to_string();
            let view = View { width, height, frame, layers: Layers::ALL, title };
            check_well_formed(&svg(&world, &view));
        }
    }
    let picture = svg(&world, &View { title: "<b>&".into(), ..View::default() });
    assert!(picture.contains("&lt;b&gt;&amp;") && !picture.contains("<b>"));
    check_well_formed(&svg(&World::default(), &View::default()));
}

#[test]
fn a_picture_has_an_element_for_each_body_and_style() {
    let view = View { layers: Layers::ALL, ..View::default() };
    let picture = svg(&scene(), &view);
    // Four bodies have shapes. The two dynamic ones have a second element, which shows their island.
    assert_eq!(picture.matches("<title>body ").count(), 4 + 2);
    // A path for each of these six elements, one for each of 12 styles, and one for the scale bar.
    assert_eq!(picture.matches("<path ").count(), 4 + 2 + 12 + 1);
    // The labels are the ids of four bodies and the error of the joint. The ground has no label, because its centre is
    // below the picture.
    assert_eq!(picture.matches(" dy=\"-3\">").count(), 4 + 1);
    assert!(picture.len() < 8000, "{} bytes", picture.len());
}

#[test]
fn what_cannot_be_seen_is_left_out() {
    let far = Aabb::new(Vec2::new(fx!(500), fx!(500)), Vec2::new(fx!(501), fx!(501)));
    let picture = svg(&scene(), &View { frame: Frame::Window(far), ..View::default() });
    assert_eq!(picture.matches("<path ").count(), 1, "expected only the scale bar");
}

#[test]
fn the_fit_holds_what_matters() {
    let mut world = scene();
    let window = fit(&world);
    for (_, body) in world.bodies().filter(|(_, body)| body.kind() != BodyKind::Fixed) {
        assert!(window.contains_point(body.centre_of_mass()));
    }
    assert!(window.contains_point(Vec2::new(fx!(3), fx!(4))), "expected the pivot of the pendulum");
    assert!(window.upper.x - window.lower.x < fx!(15), "expected less than the whole ground: {window:?}");

    let runaway = ShapeDef::new(Geometry::circle(fx!(1)).unwrap());
    world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(-1000000))), &[runaway]).unwrap();
    assert_eq!(fit(&world), window);
}

#[test]
fn the_fit_shows_the_ground_below_what_falls() {
    let mut world = World::default();
    let slope = Geometry::segment(Vec2::new(fx!(-1000000), fx!(0)), Vec2::new(fx!(1000000), fx!(0))).unwrap();
    world.spawn(&BodyDef::fixed(), &[ShapeDef::new(slope)]).unwrap();
    assert!(fit(&world).contains_point(Vec2::ZERO));
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let def = BodyDef::dynamic().position((fx!(70), fx!(9))).angle(Angle::EIGHTH);
    world.spawn(&def, &[ball]).unwrap();
    let window = fit(&world);
    assert!(window.contains_point(Vec2::new(fx!(70), fx!(0))), "{window:?}");
    assert!(window.upper.y < fx!(12), "{window:?}");
}

/// Checks that tags are closed in order, that attributes are quoted, and that text has no raw markup.
fn check_well_formed(document: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = document;
    let mut roots = 0;
    while let Some(start) = rest.find('<') {
        check_text(&rest[..start]);
        let end = start + rest[start..].find('>').expect("a tag has an end");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "expected tags to be closed in order");
            continue;
        }
        let empty = tag.ends_with('/');
        let tag = tag.trim_end_matches('/');
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
        assert!(name.chars().all(|c| c.is_ascii_lowercase()), "{name}");
        assert_eq!(attributes.matches('"').count() % 2, 0, "{tag}");
        for attribute in attributes.split_inclusive("\" ") {
            let (key, value) = attribute.trim_end().split_once('=').unwrap_or((attribute, "\"\""));
            assert!(!key.contains('"') && value.starts_with('"'), "{tag}");
        }
        roots += usize::from(open.is_empty());
        if !empty {
            open.push(name);
        }
    }
    assert!(open.is_empty() && roots == 1 && rest.trim().is_empty(), "expected one root element");
}

fn check_text(text: &str) {
    for (place, _) in text.match_indices('&') {
        let known = ["&lt;", "&gt;", "&amp;"].iter().any(|entity| text[place..].starts_with(entity));
        assert!(known, "{text}");
    }
    assert!(!text.chars().any(|c| c < ' ' && c != '\n'), "{text:?}");
}

/// The last case is the longest scale bar whose length fits an [`Fx`]: 2 000 000 km.
#[test]
fn the_label_of_a_bar_is_its_length() {
    let bars = [fx!(0.004), fx!(0.3), fx!(70), Fx::MAX].map(|most| Bar::up_to(|length| length <= most));
    let bars = bars.map(|bar| bar.map(|bar| (bar.length.round().to_num::<i64>(), bar.label)));
    let metres = |length: i64, label: &str| Some((length, label.to_string()));
    let expected = [metres(0, "2 mm"), metres(0, "200 mm"), metres(50, "50 m")];
    assert_eq!(bars[..3], expected);
    assert_eq!(bars[3], metres(2_000_000_000, "2000000000 m"));
}
