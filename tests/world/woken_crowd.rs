//! After thousands of bodies have woken in one tick, all copies of a world have equal states.

use lockstep2d::body::BodyDef;
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{BodyPose, World};

use super::{rectangle, run, spawn, square, weightless};

/// Three rows of boxes, each box asleep in its own island, are hit at one end. Each round of waking reaches the next
/// box of each row.
#[test]
fn rows_of_sleepers_wake_alike_after_a_restore() {
    let mut world = weightless();
    let place = |number: i32| Vec2::new(Fx::from(number % 1800 - 900), Fx::from(3 * (number / 1800) - 3));
    let pose = |number| BodyPose { position: place(number), angle: Angle::ZERO };
    let poses: Vec<_> = (0..3 * 1800).map(pose).collect();
    world.spawn_each(&BodyDef::dynamic().asleep(), &[square(fx!(0.5))], &poses).expect("valid");
    // The last boxes are hit first, so that they do not wake in the order of their slots.
    let thrown = BodyDef::dynamic().position((fx!(900.5), fx!(0))).velocity((fx!(-100), fx!(0)));
    spawn(&mut world, thrown, rectangle(fx!(0.5), fx!(4)));
    let start = world.save();
    let mut decoded = World::from_bytes(&world.to_bytes()).expect("a snapshot");
    let mut hashes = Vec::new();
    for _ in 0..4 {
        run(&mut world, 1);
        run(&mut decoded, 1);
        assert_eq!(decoded.state_hash(), world.state_hash(), "tick {}", world.tick());
        hashes.push(world.state_hash());
    }
    assert!(world.awake_body_count() > 4500, "{} are awake", world.awake_body_count());
    world.restore(&start);
    for hash in hashes {
        run(&mut world, 1);
        assert_eq!(world.state_hash(), hash, "again tick {}", world.tick());
    }
}
