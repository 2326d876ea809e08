//! Thousands of bodies that wake in one tick wake alike in all copies of a world.

use lockstep2d::body::BodyDef;
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{BodyPose, World};

use super::{ball, run, spawn, square, weightless};

/// A row of boxes that sleep one by one is hit at one end. Each round of waking reaches the next box.
#[test]
fn a_row_of_sleepers_wakes_alike_after_a_restore() {
    let mut world = weightless();
    let poses: Vec<_> = (0..5000i32)
        .map(|x| BodyPose { position: Vec2::new(Fx::from(x) - fx!(2500), Fx::ZERO), angle: Angle::ZERO })
        .collect();
    world.spawn_each(&BodyDef::dynamic().asleep(), &[square(fx!(0.5))], &poses).expect("valid");
    // The last box is hit first, so that the boxes do not wake in the order of their slots.
    let thrown = BodyDef::dynamic().position((fx!(2501), fx!(0))).velocity((fx!(-100), fx!(0)));
    spawn(&mut world, thrown, ball(fx!(0.5)));
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
