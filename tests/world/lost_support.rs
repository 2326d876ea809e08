//! Bodies at rest that lose a joint or an area that held them fall, instead of falling asleep.

use lockstep2d::body::{Area, BodyDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{Config, World};

use super::{rectangle, run, spawn, square};

/// A body that was held must not fall asleep before it begins to fall. At a high tick rate and in low gravity, it is
/// still slower than the sleep speed after its first tick.
#[test]
fn a_body_that_loses_its_joint_falls() {
    let config = Config { tick_rate: 240, gravity: Vec2::new(fx!(0), fx!(-3)), ..Config::default() };
    for removes in [false, true] {
        let mut world = World::new(config).expect("valid");
        let drone = BodyDef::dynamic().gravity_scale(fx!(0)).never_sleeps();
        let drone = spawn(&mut world, drone, square(fx!(0.5)));
        let held = BodyDef::dynamic().position((fx!(0), fx!(-2)));
        let held = spawn(&mut world, held, square(fx!(0.1)).density(fx!(0.001)));
        let hinge = Revolute::new();
        let hinge = JointDef::new(drone, held, hinge).anchor_a((fx!(0), fx!(-2)));
        let hinge = world.add_joint(&hinge).expect("valid");
        run(&mut world, 600);
        if removes {
            world.remove_joint(hinge).expect("there");
        } else {
            world.disable(drone).expect("there");
        }
        let before = world.body(held).expect("there").position().y;
        run(&mut world, 240);
        let fallen = before - world.body(held).expect("there").position().y;
        assert!(fallen > fx!(1.4), "{fallen} m in a second");
    }
}

/// A body is held by an area that moves away.
#[test]
fn a_body_that_an_area_leaves_falls() {
    for phase in 0..20i64 {
        let mut world = World::default();
        let field = Area::new().acceleration((fx!(0), fx!(10)));
        let ship = BodyDef::dynamic().gravity_scale(fx!(0)).never_sleeps();
        let ship = world
            .spawn(
                &ship,
                &[rectangle(fx!(1), fx!(1)).sensor().area(field), square(fx!(0.1)).offset((fx!(0), fx!(5)))],
            )
            .expect("valid");
        let held = BodyDef::dynamic().position((fx!(0.01) * phase, fx!(0)));
        let held = spawn(&mut world, held, square(fx!(0.05)));
        run(&mut world, 60);
        world.set_velocity(ship, (fx!(12), fx!(0)), Fx::ZERO).expect("in range");
        let before = world.body(held).expect("there").position().y;
        run(&mut world, 60);
        let fallen = before - world.body(held).expect("there").position().y;
        assert!(fallen > fx!(2), "phase {phase}: {fallen} m in a second");
    }
}

/// The area of a ship is switched off.
#[test]
fn a_body_whose_area_ends_falls() {
    let config = Config { tick_rate: 240, gravity: Vec2::new(fx!(0), fx!(-3)), ..Config::default() };
    let mut world = World::new(config).expect("valid");
    let field = Area::new().acceleration((fx!(0), fx!(3)));
    let ship = BodyDef::dynamic().gravity_scale(fx!(0)).never_sleeps();
    let shapes = [rectangle(fx!(1), fx!(1)).sensor().area(field), square(fx!(0.1)).offset((fx!(0), fx!(5)))];
    let ship = world.spawn(&ship, &shapes).expect("valid");
    let held = spawn(&mut world, BodyDef::dynamic(), square(fx!(0.05)));
    run(&mut world, 600);
    let area = world.shapes_of(ship)[0];
    world.set_area(area, None).expect("there");
    let before = world.body(held).expect("there").position().y;
    run(&mut world, 240);
    let fallen = before - world.body(held).expect("there").position().y;
    assert!(fallen > fx!(1.4), "{fallen} m in a second");
}
