//! Bodies held in an overlap do not shake.

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::solver::{JointKind, Revolute, Weld};
use lockstep2d::world::{Config, World};

use crate::sweep;

fn world_with_floor(tick_rate: u32) -> World {
    let mut world = World::new(Config { tick_rate, ..Config::default() }).expect("valid");
    let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    world
}

fn position(world: &World, body: BodyId) -> Vec2<Fx> {
    world.body(body).expect("there").position()
}

/// The joint and the contact contradict each other, and both yield. If the contact were rigid in every sub-step in
/// which the joint pushes the wheel into the ground at more than 1 m/s, wheels would jump by 0.2 to 1.7 m.
#[test]
fn a_wheel_on_a_fixed_axle_in_the_ground_is_still() {
    let radii = [fx!(0.3), fx!(0.5), fx!(0.77), fx!(1.2)];
    let overlaps = [fx!(0.02), fx!(0.1), fx!(0.17), fx!(0.25)];
    let cases = radii.into_iter().flat_map(|radius| overlaps.map(|overlap| (radius, overlap)));
    let kinds: [JointKind; 2] = [Revolute::new().into(), Weld::rigid().into()];
    let cases = cases.flat_map(|case| kinds.map(|kind| (kind, case)));
    let cases = cases.flat_map(|case| [30, 60, 120, 240].map(|rate| (rate, case)));
    sweep::for_each(sweep::sample(cases, 5), |(rate, (kind, (radius, overlap)))| {
        let mut world = world_with_floor(rate);
        let post = world.spawn(&BodyDef::fixed().position((fx!(0), fx!(30))), &[]).expect("valid");
        let wheel = ShapeDef::new(Geometry::circle(radius).expect("valid"));
        let place = Vec2::new(fx!(0), radius - overlap);
        let wheel = world.spawn(&BodyDef::dynamic().position(place), &[wheel]).expect("valid");
        let axle = world.joint_at(post, wheel, kind, place).expect("valid");
        world.add_joint(&axle).expect("valid");
        let (mut low, mut high) = (Fx::MAX, Fx::MIN);
        for tick in 0..5 * rate {
            world.step();
            if tick >= 3 * rate {
                let y = position(&world, wheel).y;
                (low, high) = (low.min(y), high.max(y));
            }
        }
        let case = format!("{kind:?}, radius {radius} m, {overlap} m deep, {rate} Hz");
        assert!(high - low < fx!(0.001), "{case}: moves by {} m", high - low);
        assert_eq!(world.faults(), 0, "{case}: expected no clamped value");
    });
}

/// The press stops about 0.8 m above the floor. The ball has a diameter of 1 m.
#[test]
fn a_press_does_not_shake_what_it_squeezes() {
    for speed in [fx!(0.2), fx!(0.9), fx!(1.2), fx!(3)] {
        let mut world = world_with_floor(60);
        let press = ShapeDef::new(Polygon::rectangle(fx!(3), fx!(0.5)).expect("valid"));
        let def = BodyDef::kinematic().position((fx!(0), fx!(3))).velocity((fx!(0), -speed));
        let press = world.spawn(&def, &[press]).expect("valid");
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
        let ball = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[ball]).expect("valid");
        for tick in 0..900 {
            if position(&world, press).y < fx!(1.3) + speed / 60 {
                world.set_velocity(press, Vec2::ZERO, fx!(0)).expect("there");
            }
            let last = position(&world, ball);
            world.step();
            // If the ball stays on the floor, its centre moves at most half as fast as the press. The bound is the
            // speed of the press plus 5 mm in a tick.
            let moved = position(&world, ball).distance(last);
            assert!(moved < speed / 60 + fx!(0.005), "{speed} m/s, tick {tick}: {moved} m");
        }
        assert_eq!(world.faults(), 0, "{speed} m/s: expected no clamped value");
    }
}
