//! Random heaps of shapes that fall into a pit.

use std::sync::atomic::{AtomicU32, Ordering};

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2, fx_mul};
use lockstep2d::world::World;

use crate::sweep;

fn random_shape(rng: &mut Rng) -> ShapeDef {
    let size = rng.range(fx!(0.2), fx!(0.5));
    let end = Vec2::new(size * 3 / 5, fx!(0));
    let shape = match rng.below(5) {
        0 => Polygon::rectangle(size, fx_mul(size, rng.range(fx!(0.3), fx!(1)))).map(Geometry::from),
        1 => Geometry::circle(size),
        2 => Geometry::capsule(-end, end, size / 2),
        3 => Polygon::regular(3 + rng.below(4), size).map(Geometry::from),
        _ => Polygon::rectangle(size * 7 / 10, size * 3 / 5)
            .and_then(|shape| shape.rounded(size / 5))
            .map(Geometry::from),
    };
    let restitution = if rng.chance(1, 4) { rng.range(fx!(0), fx!(0.6)) } else { Fx::ZERO };
    ShapeDef::new(shape.expect("valid")).restitution(restitution)
}

/// A pit that is 3 to 8 m wide, with 5 to 24 bodies above it.
fn heap(seed: u64, rolling_resistance: Fx) -> World {
    let mut rng = Rng::new(seed);
    let mut world = World::default();
    let half = rng.range(fx!(1.5), fx!(4));
    let friction = rng.range(fx!(0.1), fx!(0.9));
    let material = |shape: ShapeDef| shape.friction(friction).rolling_resistance(rolling_resistance);
    let side = half + Fx::ONE;
    for (place, [half_width, half_height]) in [
        ((fx!(0), fx!(-1)), [fx!(10), fx!(1)]),
        ((-side, fx!(5)), [fx!(1), fx!(10)]),
        ((side, fx!(5)), [fx!(1), fx!(10)]),
    ] {
        let wall = ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("valid"));
        world.spawn(&BodyDef::fixed().position(place), &[material(wall)]).expect("valid");
    }
    for i in 0..5 + rng.below(20) {
        let shape = random_shape(&mut rng);
        let x = rng.range(-half + fx!(0.6), half - fx!(0.6));
        let def = BodyDef::dynamic().position((x, fx!(1) + fx!(0.6) * i64::from(i))).angle(rng.angle());
        let def = def.angular_velocity(rng.range(fx!(-3), fx!(3)));
        world.spawn(&def, &[material(shape)]).expect("valid");
    }
    world
}

/// Steps until all bodies sleep, but at most for `seconds`. Returns the largest kinetic energy on the way in J.
fn settle(world: &mut World, seconds: u32) -> Fx {
    let mut largest = Fx::ZERO;
    for _ in 0..seconds * 60 {
        world.step();
        if world.awake_body_count() == 0 {
            break;
        }
        largest = largest.max(world.bodies().fold(Fx::ZERO, |sum, (_, body)| sum + body.kinetic_energy()));
    }
    largest
}

/// Without rolling resistance, round bodies may roll to and fro for ever.
#[test]
fn every_heap_whose_bodies_resist_rolling_comes_to_rest() {
    sweep::for_each((0..sweep::size(2400, 60)).collect(), |seed: u64| {
        let mut world = heap(seed, fx!(0.02));
        settle(&mut world, 60);
        assert_eq!((world.awake_body_count(), world.faults()), (0, 0), "heap {seed}");
        for (id, body) in world.bodies().filter(|(_, body)| body.is_dynamic()) {
            assert!(body.position().y > 0, "heap {seed}: body {id} has left the pit");
        }
    });
}

/// At most one heap in forty is awake after 40 s. The largest kinetic energy of such a heap in the next 10 s is less
/// than twice that of the 10 s before, plus 0.01 J.
#[test]
fn few_heaps_are_restless_and_none_gathers_energy() {
    let count = sweep::size(2400, 120);
    let restless = AtomicU32::new(0);
    sweep::for_each((0..count).collect(), |seed: u64| {
        let mut world = heap(seed, fx!(0));
        settle(&mut world, 30);
        let before = settle(&mut world, 10);
        if world.awake_body_count() > 0 {
            restless.fetch_add(1, Ordering::Relaxed);
            let after = settle(&mut world, 10);
            assert!(after < before * 2 + fx!(0.01), "heap {seed}: {before} J, 10 s later {after} J");
        }
    });
    let restless = restless.into_inner();
    assert!(u64::from(restless) * 40 <= count, "{restless} of {count} heaps do not rest");
}
