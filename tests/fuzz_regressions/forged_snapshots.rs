//! Snapshots that have a correct hash, but contain an impossible state, are refused.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx};
use lockstep2d::world::World;

use super::weightless;

/// The bytes of a world after an edit, with the hash repaired.
fn forged(world: &World, edit: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = world.to_bytes();
    edit(&mut bytes);
    let end = bytes.len() - 16;
    let hash = lockstep2d::hash::StateHash::of_bytes(&bytes[..end]);
    bytes[end..].copy_from_slice(&hash.0.to_le_bytes());
    bytes
}

/// Overwrites the first occurrence of `old`.
fn overwrite(bytes: &mut [u8], old: Fx, new: Fx) {
    let old = old.to_bits().to_le_bytes();
    let at = bytes.windows(8).position(|window| window == old).expect("the number occurs");
    bytes[at..at + 8].copy_from_slice(&new.to_bits().to_le_bytes());
}

#[test]
fn a_snapshot_with_an_impossible_shape_is_refused_before_its_mass_is_summed() {
    let mut world = weightless();
    let ball =
        ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap()).offset((fx!(3.25), fx!(0))).density(fx!(7.125));
    world.spawn(&BodyDef::dynamic(), &[ball, ball]).unwrap();
    for (old, new) in [(fx!(3.25), Fx::MAX), (fx!(3.25), Fx::MIN), (fx!(7.125), Fx::MAX)] {
        assert!(World::from_bytes(&forged(&world, |bytes| overwrite(bytes, old, new))).is_err());
    }
}

#[test]
fn a_snapshot_that_hides_the_floor_from_the_broad_phase_is_refused() {
    let mut world = weightless();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1.5)).unwrap());
    let id = world.spawn(&BodyDef::fixed(), &[floor]).unwrap();
    let shape = world.body(id).unwrap().shapes()[0];
    let lower = world.shape(shape).unwrap().fat_aabb().lower.x;
    assert!(World::from_bytes(&forged(&world, |bytes| overwrite(bytes, lower, lower - fx!(100)))).is_err());
    assert!(World::from_bytes(&forged(&world, |_| ())).is_ok());
}

#[test]
fn a_snapshot_of_a_kinematic_body_that_rests_and_moves_is_refused() {
    // The forged body is marked as settled, but has a velocity. If it were accepted, a world with caches would keep the
    // body's contacts a tick longer after the body stops than a world without caches.
    let mut world = weightless();
    world.spawn(&BodyDef::kinematic().position((fx!(3.25), fx!(0))), &[]).unwrap();
    world.step();
    let push = |bytes: &mut Vec<u8>| {
        let place = fx!(3.25).to_bits().to_le_bytes();
        let body = bytes.windows(8).position(|window| window == place).expect("the body is there");
        // In the bytes of a body, the velocity follows the position (2 x 8 bytes) and the angle (4 bytes).
        bytes[body + 20..body + 24].copy_from_slice(&1000i32.to_le_bytes());
    };
    let refusal = World::from_bytes(&forged(&world, push)).unwrap_err().to_string();
    assert!(refusal.ends_with("settled with a velocity"), "{refusal}");
    assert!(World::from_bytes(&forged(&world, |_| ())).is_ok());
}

#[test]
fn a_snapshot_of_a_kinematic_body_that_rests_and_has_a_target_is_refused() {
    // The forged body is marked as settled, but has a target. If it were accepted, the body would become active too
    // late in a world without caches: only after the tick in which it reaches the target.
    let mut world = weightless();
    let body = world.spawn(&BodyDef::kinematic().position((fx!(3.25), fx!(0))), &[]).unwrap();
    world.move_to(body, (fx!(4.25), fx!(0)), Angle::ZERO).unwrap();
    let mut settings = *world.body(body).unwrap().settings();
    settings.locks.x = true;
    world.set_body(body, &settings).unwrap();
    let settle = |bytes: &mut Vec<u8>| {
        let place = fx!(3.25).to_bits().to_le_bytes();
        let target = bytes.windows(8).rposition(|window| window == place).expect("the target is there");
        // In the bytes, the ticks at rest, the tag of the island and the tag of the target come before the target.
        assert_eq!(bytes[target - 6..target], [0, 0, 0, 0, 0, 1]);
        bytes[target - 6] = 1;
    };
    let refusal = World::from_bytes(&forged(&world, settle)).unwrap_err().to_string();
    assert!(refusal.ends_with("settled with a target"), "{refusal}");
    assert!(World::from_bytes(&forged(&world, |_| ())).is_ok());
}

#[test]
fn a_snapshot_of_a_fat_box_that_covers_all_numbers_is_refused() {
    // A box from the smallest to the largest number overlaps `Aabb::NOWHERE`, which stands for a shape without a box.
    // If it were accepted, a pair could be missed when bodies wake.
    let mut world = weightless();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let body = world.spawn(&BodyDef::dynamic().position((fx!(3.25), fx!(7.5))), &[ball]).unwrap();
    let fat = world.shape(world.shapes_of(body)[0]).unwrap().fat_aabb();
    let widen = |bytes: &mut Vec<u8>| {
        for corner in [fat.lower.x, fat.lower.y] {
            overwrite(bytes, corner, Fx::MIN);
        }
        for corner in [fat.upper.x, fat.upper.y] {
            overwrite(bytes, corner, Fx::MAX);
        }
    };
    let refusal = World::from_bytes(&forged(&world, widen)).unwrap_err().to_string();
    assert!(refusal.ends_with("a corner of its fat box is off the grid"), "{refusal}");
    assert!(World::from_bytes(&forged(&world, |_| ())).is_ok());
}

#[test]
fn a_snapshot_of_a_contact_whose_points_have_one_feature_is_refused() {
    // If the contact were accepted, both points would start the next tick with the impulse of the first one, but only
    // if the solver does not reuse its cached rows.
    let mut world = weightless();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let square = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.5)).unwrap());
    world.spawn(&BodyDef::fixed(), &[square]).unwrap();
    world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(1))), &[ball]).unwrap();
    world.step();
    let add_point = |bytes: &mut Vec<u8>| {
        // The contact of shapes 0 and 1 touches, does not pass through, and has one point.
        let contact = [0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1];
        let at =
            bytes.windows(contact.len()).position(|window| window == contact).expect("the contact is there");
        bytes[at + 10] = 2;
    };
    let refusal = World::from_bytes(&forged(&world, add_point)).unwrap_err().to_string();
    assert!(refusal.ends_with("two points with one feature"), "{refusal}");
    assert!(World::from_bytes(&forged(&world, |_| ())).is_ok());
}
