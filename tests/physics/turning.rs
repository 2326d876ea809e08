//! A body on the middle of a turning floor feels no force along the floor, in the frame of the floor.

use lockstep2d::body::{Area, BodyDef, BodyId, Falloff, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2, fx_mul};
use lockstep2d::world::{Config, World};

use crate::sweep;

fn rectangle(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid"))
}

/// Distance in metres of `body` from the y axis of `ground`, which is at the origin.
fn drift(world: &World, ground: BodyId, body: BodyId) -> Fx {
    let [ground, body] = [ground, body].map(|id| world.body(id).expect("there"));
    ground.angle().direction().widen().dot(body.position()).abs()
}

/// If lever arms lagged behind the rotation, a crate of 4 m x 2 m would creep by 0.5 m in 30 s at 0.5 rad/s.
#[test]
fn a_crate_does_not_creep_in_a_centrifuge() {
    let sizes = [(fx!(0.5), fx!(0.25)), (fx!(2), fx!(1)), (fx!(4), fx!(4))];
    let cases = sizes.into_iter().flat_map(|size| [fx!(-0.5), fx!(0.2), fx!(0.5)].map(|omega| (size, omega)));
    let cases = cases.flat_map(|case| [30, 60, 120, 240].map(|rate| (rate, case)));
    sweep::for_each(sweep::sample(cases, 5), |(tick_rate, ((half_width, half_height), omega))| {
        let config = Config { gravity: Vec2::ZERO, tick_rate, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        let floor = rectangle(fx!(8), fx!(1)).offset((fx!(0), fx!(-11)));
        let ring = world.spawn(&BodyDef::kinematic().angular_velocity(omega), &[floor]).expect("valid");
        let height = half_height - fx!(10);
        let def = BodyDef::dynamic().position((fx!(0), height)).velocity((-fx_mul(omega, height), fx!(0)));
        let cargo = rectangle(half_width, half_height);
        let cargo = world.spawn(&def.angular_velocity(omega), &[cargo]).expect("valid");
        (0..30 * tick_rate).for_each(|_| world.step());
        let drift = drift(&world, ring, cargo);
        assert!(
            drift < fx!(0.01),
            "{half_width} m x {half_height} m, {omega} rad/s, {tick_rate} Hz: {drift} m"
        );
    });
}

#[test]
fn a_crate_does_not_creep_on_a_planet() {
    let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
    let field = Area::new().attraction(fx!(10), fx!(20), Falloff::InverseSquare);
    let field = ShapeDef::new(Geometry::circle(fx!(60)).expect("valid")).area(field);
    world.spawn(&BodyDef::fixed(), &[field]).expect("valid");
    let planet = rectangle(fx!(20), fx!(20));
    let planet = world.spawn(&BodyDef::kinematic().angular_velocity(fx!(0.2)), &[planet]).expect("valid");
    let def = BodyDef::dynamic().position((fx!(0), fx!(21))).velocity((fx!(-4.2), fx!(0)));
    let crate_ = rectangle(fx!(1), fx!(1));
    let crate_ = world.spawn(&def.angular_velocity(fx!(0.2)), &[crate_]).expect("valid");
    (0..7200).for_each(|_| world.step());
    assert!(drift(&world, planet, crate_) < fx!(0.01));
}
