//! On a plane or a level chain, rolling balls keep their speed at any tick rate. On flush blocks they lose a part of
//! their speed.

use lockstep2d::body::{BodyDef, Chain, Geometry, MassSource, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{Config, World};

const RATES: [u32; 3] = [60, 120, 240];

/// Speed of a ball of radius 0.5 m after 16 seconds.
fn speed_after(rate: u32, speed: Fx, start: Fx, spawn_ground: impl FnOnce(&mut World)) -> Fx {
    let config = Config { tick_rate: rate, sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    spawn_ground(&mut world);
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let def = BodyDef::dynamic().position((start, fx!(0.5))).velocity((speed, fx!(0)));
    let ball = world.spawn(&def.angular_velocity(-speed * 2), &[ball]).expect("valid");
    (0..rate * 16).for_each(|_| world.step());
    world.body(ball).expect("there").velocity().x
}

fn spawn_blocks(world: &mut World, centres: impl Iterator<Item = i32>, half_width: Fx) {
    let block = ShapeDef::new(Polygon::rectangle(half_width, fx!(0.5)).expect("valid"));
    for x in centres {
        world.spawn(&BodyDef::fixed().position((Fx::from(x), fx!(-0.5))), &[block]).expect("valid");
    }
}

#[test]
fn a_ball_keeps_its_speed_on_a_plane_and_on_a_chain() {
    for rate in RATES {
        for speed in [fx!(0.02), fx!(0.2), fx!(1.6), fx!(5)] {
            let plane = speed_after(rate, speed, fx!(0), |world| spawn_blocks(world, 0..1, fx!(100)));
            let chain = speed_after(rate, speed, fx!(0), |world| {
                let points: Vec<_> = (-5..100).rev().map(|x| Vec2::new(Fx::from(x), fx!(0))).collect();
                let links = Chain::new(&points).links().expect("valid");
                world.spawn(&BodyDef::fixed(), &links).expect("valid");
            });
            for (name, end) in [("plane", plane), ("chain", chain)] {
                assert!((end - speed).abs() <= speed / 500, "{name}, {rate} Hz: {end} of {speed} m/s");
            }
        }
    }
}

/// At a seam the corner of the block ahead takes over the weight, which costs some speed.
#[test]
fn a_ball_rolls_over_flush_blocks() {
    for rate in RATES {
        for (speed, rest) in
            [(fx!(0.02), fx!(0.6)), (fx!(0.06), fx!(0.9)), (fx!(0.2), fx!(0.94)), (fx!(1.6), fx!(0.99))]
        {
            let end = speed_after(rate, speed, fx!(0.45), |world| spawn_blocks(world, -2..40, fx!(0.5)));
            assert!(end >= speed * rest && end <= speed * fx!(1.01), "{rate} Hz: {end} of {speed} m/s");
        }
    }
}

/// Largest tilt in radians of a roly-poly toy during the last 5 s of 30 s. The toy starts on a slab, at a tilt of 0.05
/// rad.
fn tilt_after_30_s(slab: BodyDef) -> Fx {
    let mut world = World::new(Config { sleeping: false, ..Config::default() }).expect("valid");
    spawn_blocks(&mut world, 0..1, fx!(10));
    let block = ShapeDef::new(Polygon::rectangle(fx!(4), fx!(0.5)).expect("valid"));
    world.spawn(&slab.position((fx!(0), fx!(0.5))), &[block]).expect("valid");
    let mass = MassSource::Given { mass: fx!(1), centre: Vec2::new(fx!(0), fx!(-0.5)), gyration: fx!(0.9) };
    let tilt = fx!(0.05);
    let def = BodyDef::dynamic().mass(mass).position((fx!(0), fx!(2))).angle(Angle::from_radians(tilt));
    let toy = world.spawn(&def, &[ShapeDef::new(Geometry::circle(fx!(1)).expect("valid"))]).expect("valid");
    let mut largest = fx!(0);
    for tick in 0..1800 {
        world.step();
        if tick >= 1500 {
            largest = largest.max(world.body(toy).expect("there").angle().to_radians().abs());
        }
    }
    largest
}

/// A toy of radius `r` has its centre of mass `d` below its middle, and the radius of gyration `k`. The angular
/// frequency `w` of small oscillations is given by `w^2 = g d / (k^2 + (r - d)^2)`, here 4.7 / s². During a tick `T`
/// with sub-steps `h`, contacts act where they are at the start of the tick. This makes the oscillations grow by
/// `exp(w^2 (T - h) t / 4)`, which is a factor of 1.56 in 30 s.
#[test]
fn a_roly_poly_toy_swings_on_a_loose_slab_as_on_a_fixed_one() {
    for slab in [BodyDef::fixed(), BodyDef::dynamic()] {
        let tilt = tilt_after_30_s(slab);
        assert!((fx!(0.06)..=fx!(0.085)).contains(&tilt), "{tilt} rad");
    }
}
