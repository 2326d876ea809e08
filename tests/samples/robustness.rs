//! Samples of Box2D's groups "Robustness" and "Issues".

use lockstep2d::body::{BodyDef, BodyKind, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::{ContactTuning, JointDef, Prismatic, Revolute, SolverSettings, Weld};
use lockstep2d::world::Config;

use super::{Stage, ball, capsule, hull, line, near, num, rect, square};

/// Adds a pyramid of boxes with density 1, except for the topmost box, which has the density `top`. Returns the topmost
/// box.
fn pyramid(stage: &mut Stage, half: Fx, rows: i32, top: Fx) -> lockstep2d::body::BodyId {
    let mut last = None;
    for row in 0..rows {
        for i in 0..rows - row {
            let x = half * i64::from(2 * i + row - rows + 1);
            let density = if row == rows - 1 { top } else { fx!(1) };
            last =
                Some(stage.add(Vec2::new(x, half * i64::from(2 * row + 1)), square(half).density(density)));
        }
    }
    last.expect("at least one row")
}

/// Sample "HighMassRatio1".
#[test]
fn a_pyramid_carries_a_heavy_top() {
    for density in [100, 200, 300] {
        let mut stage = Stage::with_floor();
        let top = pyramid(&mut stage, fx!(1), 10, num(density));
        stage.run(900);
        // A contact yields by about its load divided by m (2 pi 30 Hz)^2. This is 4 cm under 6 kN on a box of 4 kg, and
        // less in each row below.
        near(stage.place(top).y, fx!(19), fx!(0.25));
        near(stage.place(top).x, fx!(0), fx!(0.05));
        assert_eq!(stage.world.awake_body_count(), 0);
    }
}

/// Samples "HighMassRatio2" and "HighMassRatio3": 400 kg on two boxes of 1 kg, or two triangles of half a kilogram.
#[test]
fn small_things_carry_a_large_box() {
    let triangle = hull(&[at!(-0.5, 0), at!(0.5, 0), at!(0, 1)]);
    for (support, centre) in [(square(fx!(0.5)), fx!(0.5)), (triangle, fx!(0))] {
        let mut stage = Stage::with_floor();
        let supports = [fx!(-9), fx!(9)].map(|x| stage.add(Vec2::new(x, centre), support));
        let large = stage.add(at!(0, 14), square(fx!(10)));
        stage.run(900);
        near(stage.place(large).y, fx!(11), fx!(0.3));
        near(stage.angle(large), fx!(0), fx!(0.02));
        for id in supports {
            near(stage.place(id).x.abs(), fx!(9), fx!(0.5));
        }
    }
}

/// Sample "Overlap Recovery".
#[test]
fn overlaps_are_resolved_gently() {
    let mut stage = Stage::with_floor();
    for row in 0..4 {
        for i in row..4 {
            let x = fx!(0.375) * i64::from(2 * i - row - 3);
            stage.add(Vec2::new(x, fx!(0.5) + fx!(0.75) * i64::from(row)), square(fx!(0.5)));
        }
    }
    // The boxes overlap. Each contact pushes at up to 3 m/s, and these speeds add up over the three boxes of half a
    // row.
    stage.run_and(600, |stage| assert!(stage.fastest() < fx!(10), "{} m/s", stage.fastest()));
    assert!(stage.world.deepest_overlap() < fx!(0.02), "{} m deep", stage.world.deepest_overlap());
    assert!(stage.fastest() < fx!(0.05));
}

/// Sample "Tiny Pyramid": boxes of 5 cm.
#[test]
fn a_tiny_pyramid_stands() {
    let mut stage = Stage::of(Config::default().for_smallest(fx!(0.05)));
    stage.floor();
    let top = pyramid(&mut stage, fx!(0.025), 30, fx!(1));
    stage.run(300);
    near(stage.place(top).y, fx!(1.475), fx!(0.01));
    near(stage.place(top).x, fx!(0), fx!(0.005));
}

/// Sample "Cart": gravity of 22 m/s², and a chassis 600 times as heavy as a wheel.
#[test]
fn a_heavy_cart_stands_on_light_wheels() {
    let contact = ContactTuning::Soft { hertz: fx!(90), damping_ratio: fx!(10), push_speed: fx!(0.5) };
    let solver = SolverSettings { sub_steps: 12, contact, ..SolverSettings::default() };
    let mut stage = Stage::of(Config { solver, gravity: at!(0, -22), ..Config::default() });
    stage.floor();
    let chassis = stage.add(at!(0, 2), rect(fx!(1), fx!(0.25)).offset(at!(0, 0.25)).density(fx!(1000)));
    let wheel = ball(fx!(0.1)).density(fx!(50)).rolling_resistance(fx!(0.02));
    let wheels = [fx!(-0.9), fx!(0.9)].map(|x| {
        let place = Vec2::new(x, fx!(1.85));
        let wheel = stage.add(place, wheel);
        let def = stage.world.joint_at(chassis, wheel, Revolute::new(), place).expect("there");
        stage.join(def.softness(fx!(180), fx!(1)));
        wheel
    });
    stage.run(600);
    near(stage.place(chassis).y, fx!(0.25), fx!(0.02));
    near(stage.angle(chassis), fx!(0), fx!(0.01));
    for id in wheels {
        near(stage.place(id).y, fx!(0.1), fx!(0.02));
    }
    assert!(stage.world.widest_joint_gap() < fx!(0.02), "{} m", stage.world.widest_joint_gap());
}

/// Sample "Multiple Prismatic".
#[test]
fn a_row_of_sliders_recovers() {
    let solver = SolverSettings { sub_steps: 16, ..SolverSettings::default() };
    let mut stage = Stage::of(Config { solver, ..Config::default() });
    let mut before = stage.spawn(BodyDef::fixed(), &[]);
    let mut anchor = Vec2::ZERO;
    let mut sliders = Vec::new();
    for i in 0..6 {
        let body = stage.add(Vec2::new(Fx::ZERO, fx!(0.6) + fx!(1.2) * i64::from(i)), square(fx!(0.5)));
        let kind = Prismatic::new().limit(fx!(-6), fx!(6));
        let def = JointDef::new(before, body, kind).anchor_a(anchor).anchor_b(at!(0, -0.6));
        sliders.push(stage.join(def.softness(fx!(240), fx!(2))));
        (before, anchor) = (body, at!(0, 0.6));
    }
    for _ in 0..60 {
        stage.world.apply_force_to_centre(before, at!(3000, 400)).expect("valid");
        stage.world.step();
    }
    stage.run(1200);
    for id in sliders {
        let translation = stage.world.joint_translation(id).expect("there");
        assert!(translation.x.abs() < fx!(6.05) && translation.y.abs() < fx!(0.02), "{translation:?}");
    }
}

/// Sample "Bad Steiner". The shape is a few centimetres in size, 78 m from the origin of its body.
#[test]
fn a_sliver_far_from_its_origin_has_a_mass() {
    let mut stage = Stage::new();
    stage.fixed(Vec2::ZERO, line(at!(-100, 0), at!(100, 0)));
    let sliver = hull(&[at!(48.76, -60.57), at!(48.74, -60.54), at!(48.68, -60.56)]);
    let body = stage.add(at!(-48, 62), sliver);
    // Half the cross product of two sides: (-0.02 * 0.01 + 0.08 * 0.03) / 2.
    near(stage.body(body).mass(), fx!(0.0011), fx!(0.00001));
    assert!(stage.body(body).radius_of_gyration() < fx!(0.05));
    stage.run(300);
    let centre = stage.body(body).centre_of_mass();
    assert!(centre.y > fx!(0) && centre.y < fx!(0.03) && stage.fastest() < fx!(0.05), "{centre:?}");
}

/// Samples "Disable" and "Crash01".
#[test]
fn jointed_bodies_bear_every_change() {
    let mut stage = Stage::new();
    let ground = stage.floor();
    let attachment = stage.add(at!(-2, 3), rect(fx!(0.5), fx!(2)));
    let platform = stage.add(at!(0, 5), rect(fx!(4), fx!(0.5)).density(fx!(2)));
    stage.join_at(attachment, platform, Revolute::new().motor(fx!(0), fx!(50)), at!(-2, 5));
    let slider = Prismatic::new().limit(fx!(-10), fx!(10)).motor(fx!(0), fx!(1000));
    stage.join_at(ground, platform, slider, at!(0, 5));
    for round in 0..27 {
        let kind = [BodyKind::Fixed, BodyKind::Kinematic, BodyKind::Dynamic][round % 3];
        stage.world.set_kind(platform, kind).expect("there");
        let id = if round % 2 == 0 { attachment } else { platform };
        stage.world.disable(id).expect("there");
        stage.run(5);
        assert_eq!(stage.world.joint_count(), 2);
        stage.world.enable(id).expect("there");
        stage.run(5);
    }
    stage.world.set_kind(platform, BodyKind::Dynamic).expect("there");
    stage.run(300);
    near(stage.place(platform).y, fx!(5), fx!(0.02));
    assert!(stage.world.widest_joint_gap() < fx!(0.01));
}

/// Sample "StaticVsBulletBug": a bullet of 300 m/s.
#[test]
fn a_body_that_became_fixed_stops_a_bullet() {
    let corners = [
        at!(48.8525391, 68.1518555),
        at!(49.1821289, 68.1152344),
        at!(68.8476562, 68.1152344),
        at!(68.8476562, 70.2392578),
        at!(48.8525391, 70.2392578),
    ];
    for share in [1, 2] {
        let mut stage = Stage::weightless();
        let slab = hull(&corners).friction(fx!(0.5)).restitution(fx!(0.1));
        let slab = stage.add(Vec2::ZERO, slab);
        stage.world.set_kind(slab, BodyKind::Fixed).expect("there");
        let velocity = Vec2::new(fx!(104.868881) / share, fx!(-281.073883) / share);
        let def = BodyDef::dynamic().position(at!(58.9243050, 77.5401459)).velocity(velocity);
        let shape = ball(fx!(0.3)).density(fx!(3)).friction(fx!(0.2)).restitution(fx!(0.9));
        let bullet = stage.spawn(def.bullet().lock_rotation(), &[shape]);
        for _ in 0..8 {
            stage.world.step();
            assert!(stage.place(bullet).y > fx!(70.2), "{:?}", stage.place(bullet));
        }
        near(stage.velocity(bullet).y, velocity.y * -9 / 10, fx!(0.1));
        assert_eq!(stage.world.faults(), 0);
    }
}

/// Sample "Unstable Prismatic Joints", also with the radius of 0.1 m, at which Box2D crashes according to a comment in
/// the sample.
#[test]
fn a_light_ball_between_heavy_ones_is_stable() {
    for radius in [fx!(0.5), fx!(0.1)] {
        let mut stage = Stage::new();
        stage.fixed(Vec2::ZERO, line(at!(-100, 0), at!(100, 0)));
        let middle = stage.add(at!(0, 3), ball(radius));
        for side in [-1, 1] {
            let heavy = stage.add(Vec2::new(fx!(3.5) * side, fx!(3)), ball(fx!(2)));
            let kind = Prismatic::new().spring(fx!(10), fx!(2), fx!(3) * side);
            stage.join(JointDef::new(middle, heavy, kind));
        }
        stage.run_and(900, |stage| {
            assert!(stage.fastest() < fx!(20), "radius {radius}: {} m/s", stage.fastest())
        });
        assert!(stage.fastest() < fx!(0.5), "radius {radius}: still {} m/s", stage.fastest());
    }
}

/// Sample "Unstable Windmill".
#[test]
fn a_welded_windmill_gains_no_energy() {
    let mut stage = Stage::weightless();
    let hub = stage.add(at!(10, 10), ball(fx!(5)).friction(fx!(0.1)));
    for (arm, axis) in [(at!(0, -1), false), (at!(1, 0), true), (at!(0, 1), false), (at!(-1, 0), true)] {
        let shape = if axis { rect(fx!(5), fx!(4)) } else { rect(fx!(4), fx!(5)) };
        let body = stage.add(at!(10, 10) + arm.scale(fx!(10)), shape.friction(fx!(0.1)));
        let weld =
            JointDef::new(hub, body, Weld::rigid()).anchor_a(arm.scale(fx!(5))).anchor_b(arm.scale(fx!(-5)));
        stage.join(weld.softness(fx!(30), fx!(2)));
        if arm.y > 0 {
            stage.world.apply_impulse(body, at!(2000, 0), at!(10, 24)).expect("valid");
        }
    }
    let start = stage.energy();
    stage.run_and(600, |stage| {
        assert!(stage.energy() < start + start / 1000, "{} of {start} J", stage.energy())
    });
}

/// A triangle with angles of 0.1 to 6 degrees either is refused or has the mass that follows from its area.
#[test]
fn slivers_have_a_mass_or_are_refused() {
    for thousandths in [1, 2, 5, 10, 50] {
        let height = num(thousandths) / 1000;
        let points = [at!(0, 0), at!(1, 0), Vec2::new(fx!(0.5), height)];
        let mut stage = Stage::with_floor();
        let Ok(polygon) = Polygon::hull(&points) else { continue };
        let body = stage.add(at!(0, 2), ShapeDef::new(polygon));
        near(stage.body(body).mass(), height / 2, height / 100);
        stage.run(300);
        assert!(stage.body(body).centre_of_mass().y > fx!(0));
    }
    let upright = capsule(at!(0, -0.5), at!(0, 0.5), fx!(0.01));
    let mut stage = Stage::with_floor();
    let pole = stage.add(at!(0, 3), upright);
    stage.run(300);
    assert!(stage.place(pole).y > fx!(0));
}
