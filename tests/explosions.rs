//! The impulse of an explosion on a shape is proportional to the width that the shape shows to the explosion, decreases
//! with the distance, and acts at the nearest point of the shape.

use lockstep2d::body::{BodyDef, BodyId, Filter, Geometry, MassSource, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::world::{Config, Explosion, World};

fn at(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

fn weightless() -> World {
    World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid")
}

/// Adds a body of 2 kg with a radius of gyration of 1 m.
fn spawn(world: &mut World, shape: impl Into<Geometry>, x: Fx, y: Fx) -> BodyId {
    let mass = MassSource::Given { mass: fx!(2), centre: Vec2::ZERO, gyration: fx!(1) };
    world.spawn(&BodyDef::dynamic().position((x, y)).mass(mass), &[ShapeDef::new(shape)]).expect("valid")
}

fn velocity(world: &World, id: BodyId) -> Vec2<Fx> {
    world.body(id).expect("there").velocity()
}

fn near(a: Vec2<Fx>, b: Vec2<Fx>) -> bool {
    a.distance(b) < fx!(0.00001)
}

#[test]
fn a_ball_is_pushed_by_its_diameter_and_its_distance() {
    let explosion = Explosion { radius: fx!(3), falloff: fx!(2), ..Explosion::new(Vec2::ZERO, fx!(10)) };
    let ball = Geometry::circle(fx!(0.5)).expect("valid");
    // Distances are of the ball's centre; its surface is half a metre nearer. Up to 3 m from the surface, there is no
    // falloff, and the speed is 10 N s/m * 1 m / 2 kg.
    for (distance, speed) in [
        (fx!(1), fx!(5)),
        (fx!(3.5), fx!(5)),
        (fx!(4.5), fx!(2.5)),
        (fx!(5), fx!(1.25)),
        (fx!(5.5), fx!(0)),
        (fx!(9), fx!(0)),
    ] {
        let mut world = weightless();
        let (right, below) =
            (spawn(&mut world, ball, distance, fx!(0)), spawn(&mut world, ball, fx!(0), -distance));
        world.explode(&explosion).expect("valid");
        assert!(
            near(velocity(&world, right), at(speed, fx!(0))),
            "{distance}: {:?}",
            velocity(&world, right)
        );
        assert!(
            near(velocity(&world, below), at(fx!(0), -speed)),
            "{distance}: {:?}",
            velocity(&world, below)
        );
        let pull = Explosion { impulse_per_length: fx!(-10), ..explosion };
        world.explode(&pull).expect("valid");
        assert!(near(velocity(&world, right), Vec2::ZERO));
    }
}

#[test]
fn the_push_is_as_wide_as_the_shape_and_meets_the_nearest_point() {
    let mut world = weightless();
    let plank = Polygon::rectangle(fx!(0.1), fx!(1)).expect("valid");
    // The nearest point is straight to the right of the explosion, half a metre below the plank's centre.
    let high = spawn(&mut world, plank, fx!(2.1), fx!(0.5));
    let capsule = Geometry::capsule(at(fx!(0), fx!(-1)), at(fx!(0), fx!(1)), fx!(0.25)).expect("valid");
    let pill = spawn(&mut world, capsule, fx!(-2.25), fx!(0));
    let line = spawn(
        &mut world,
        Geometry::segment(at(fx!(-1), fx!(0)), at(fx!(1), fx!(0))).expect("valid"),
        fx!(0),
        fx!(2),
    );
    world.explode(&Explosion { radius: fx!(2.5), ..Explosion::new(Vec2::ZERO, fx!(10)) }).expect("valid");
    // The plank is 2 m high, so its impulse is P = 20 N s to the right. It acts half a metre below the centre, which
    // gives the angular velocity w = r x P / (m k²) = -(-0.5) * 20 / 2.
    assert!(near(velocity(&world, high), at(fx!(10), fx!(0))), "{:?}", velocity(&world, high));
    let spin = world.body(high).expect("there").angular_velocity();
    assert!((spin - fx!(5)).abs() < fx!(0.00001), "{spin}");
    assert!(near(velocity(&world, pill), at(fx!(-12.5), fx!(0))), "{:?}", velocity(&world, pill));
    assert!(near(velocity(&world, line), at(fx!(0), fx!(10))), "{:?}", velocity(&world, line));
}

#[test]
fn from_within_a_shape_it_pushes_towards_its_middle() {
    let mut world = weightless();
    let id = spawn(&mut world, Polygon::square(fx!(1)).expect("valid"), fx!(0.5), fx!(0));
    world.explode(&Explosion::new(Vec2::ZERO, fx!(10))).expect("valid");
    assert!(near(velocity(&world, id), at(fx!(10), fx!(0))), "{:?}", velocity(&world, id));
    assert_eq!(world.body(id).expect("there").angular_velocity(), 0);
    // At the exact centre the direction is arbitrary, but fixed.
    let mut world = weightless();
    let id = spawn(&mut world, Geometry::circle(fx!(1)).expect("valid"), fx!(0), fx!(0));
    world.explode(&Explosion::new(Vec2::ZERO, fx!(10))).expect("valid");
    assert!(near(velocity(&world, id), at(fx!(10), fx!(0))));
}

#[test]
fn only_enabled_dynamic_bodies_of_the_mask_are_pushed_and_they_wake() {
    let mut world = weightless();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.25)).expect("valid"));
    let mut spawn = |def: BodyDef, shape: ShapeDef| {
        world.spawn(&def.position((fx!(1), fx!(0))), &[shape]).expect("valid")
    };
    let other = Filter { category: 2, mask: 0, group: 0 };
    let fixed = spawn(BodyDef::fixed(), ball);
    let kinematic = spawn(BodyDef::kinematic(), ball);
    let disabled = spawn(BodyDef::dynamic().disabled(), ball);
    let masked = spawn(BodyDef::dynamic(), ball.filter(Filter { category: 1, ..other }));
    let sleeping = spawn(BodyDef::dynamic().asleep(), ball.filter(other));
    let locked = spawn(BodyDef::dynamic().lock_x(), ball.filter(other));
    world.add_shape(masked, &ball.filter(other).sensor()).expect("valid");
    world.explode(&Explosion { mask: 2, ..Explosion::new(Vec2::ZERO, fx!(1)) }).expect("valid");
    for id in [fixed, kinematic, disabled, masked, locked] {
        assert_eq!(velocity(&world, id), Vec2::ZERO);
    }
    assert!(velocity(&world, sleeping).x > 0 && !world.body(sleeping).expect("there").is_asleep());
    world.validate().expect("valid");
}

#[test]
fn what_is_out_of_range_is_refused_and_extremes_stay_in_range() {
    let mut world = weightless();
    let explosion = Explosion::new(Vec2::ZERO, fx!(1));
    for (wrong, number) in [
        (Explosion { radius: fx!(-0.1), ..explosion }, fx!(-0.1)),
        (Explosion { falloff: fx!(1000.1), ..explosion }, fx!(1000.1)),
        (Explosion { impulse_per_length: fx!(1048576.1), ..explosion }, fx!(1048576.1)),
    ] {
        let error = world.explode(&wrong).expect_err("refused");
        assert!(
            matches!(error, WorldError::ExplosionOutOfRange { value, .. } if value == number),
            "{error:?}"
        );
    }
    let far = Explosion { centre: at(Fx::MAX, fx!(0)), ..explosion };
    assert!(matches!(world.explode(&far), Err(WorldError::PositionOutOfRange { .. })));

    let mut rng = Rng::new(1);
    for i in 0..200 {
        let mass = MassSource::Given { mass: fx!(0.00001), centre: Vec2::ZERO, gyration: fx!(0.002) };
        let place = |rng: &mut Rng| rng.range(fx!(-100), fx!(100));
        let shape = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(0.01)).expect("valid"));
        let def = BodyDef::dynamic().position((place(&mut rng), place(&mut rng))).angle(rng.angle());
        let def = if i % 2 == 0 { def.mass(mass) } else { def };
        world.spawn(&def, &[shape]).expect("valid");
    }
    for falloff in [fx!(0), fx!(1000), Fx::DELTA] {
        let strongest = Explosion { radius: fx!(1000), falloff, ..Explosion::new(Vec2::ZERO, fx!(1048576)) };
        world.explode(&strongest).expect("valid");
        assert_eq!(world.validate(), Ok(()));
    }
}
