use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::body::{BodyDef, BodyId, Geometry, Handle, ShapeDef};
use crate::collision::{Contact, KeptManifold, PointImpulse};
use crate::fx;
use crate::math::{Aabb, Fx, Speed, Vec2};
use crate::solver::{JointDef, Revolute};
use crate::world::World;
use crate::world::state::State;

fn chain(count: u32) -> (World, Vec<BodyId>) {
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.4)).expect("valid"));
    let bodies: Vec<BodyId> = (0..count)
        .map(|i| {
            let def = BodyDef::dynamic().position((Fx::from_num(i), fx!(0)));
            world.spawn(&def, &[ball]).expect("valid")
        })
        .collect();
    for pair in bodies.windows(2) {
        world.add_joint(&JointDef::new(pair[0], pair[1], Revolute::default())).expect("valid");
    }
    (world, bodies)
}

fn state_of(world: &World) -> State {
    world.state.get().clone()
}

fn there_and_back(world: &mut World) {
    let (before, snapshot) = (state_of(world), world.save());
    (0..3).for_each(|_| world.step());
    assert_ne!(state_of(world), before);
    world.restore(&snapshot);
    assert_eq!(state_of(world), before);
}

#[test]
fn boxes_that_are_far_away_or_off_the_grid_come_back() {
    let (mut world, _) = chain(6);
    let far = fx!(100000);
    let odd = |x| Aabb::new(Vec2::new(x - Fx::DELTA, -far), Vec2::new(x + fx!(1), far));
    let boxes = [odd(fx!(0)), odd(far), Aabb::new(Vec2::new(Fx::MIN, Fx::MIN), Vec2::new(Fx::MAX, Fx::MAX))];
    for (slot, fat) in (1..).zip(boxes) {
        world.state.shapes.at_mut(slot).fat = fat;
    }
    there_and_back(&mut world);
}

#[test]
fn joints_with_any_impulses_and_turns_come_back() {
    let (mut world, _) = chain(40);
    let ends = [0, 1, -1, i64::from(i32::MAX) + 1, i64::from(i32::MIN), i64::MIN, i64::MAX, -(1 << 40) - 5];
    for (_, joint) in world.state.joints.iter_mut() {
        let number = joint.def.bodies().0.slot();
        joint.turns = ends[number as usize % ends.len()];
        for (place, impulse) in (0..6).zip(&mut joint.impulses.0) {
            if number >> place & 1 != 0 {
                *impulse = [Speed::MIN, Speed::DELTA, Speed::MAX][number as usize % 3];
            }
        }
    }
    there_and_back(&mut world);
}

#[test]
fn contacts_of_every_kind_come_back() {
    let (mut world, _) = chain(60);
    let state = &mut *world.state;
    let point = |feature, normal| PointImpulse { feature, normal, tangent: Speed::MIN };
    for slot in 0..30 {
        let mut contact = Contact::new((slot, slot + 30));
        contact.touching = slot & 1 != 0;
        contact.passing = slot & 2 != 0;
        let rolling = if slot % 5 == 0 { Speed::MIN } else { Speed::ZERO };
        let points = [point(0xffff, Speed::MAX), point(7, Speed::DELTA)];
        match slot % 3 {
            0 => contact.rolling = rolling,
            1 => {
                contact.store_impulses([points[0], PointImpulse::default()], 1, rolling);
                contact.kept = KeptManifold::from_words([1, -1, -1, i32::MIN, 0, 0, 3, 4, -5, 6, 7, 0, 1, 2]);
            }
            _ => {
                contact.store_impulses(points, 2, rolling);
                contact.kept =
                    KeptManifold::from_words([1, 2, 3, 4, 5, i32::MAX, 7, 8, 9, 10, 11, -12, 13, 14]);
            }
        }
        if slot % 2 == 0 { &mut state.contacts } else { &mut *state.sleeping_contacts }.push(contact);
    }
    there_and_back(&mut world);
}

#[test]
fn forces_targets_and_sleepers_come_back() {
    let (mut world, bodies) = chain(40);
    world.sleep(bodies[3]).expect("dynamic");
    let lift = world.spawn(&BodyDef::kinematic().position((fx!(0), fx!(5))), &[]).expect("valid");
    let thrown = world.spawn(&BodyDef::dynamic().position((fx!(9), fx!(9))), &[ball()]).expect("valid");
    world.move_to(lift, Vec2::new(fx!(0), fx!(5.1)), crate::math::Angle::EIGHTH).expect("near");
    world.apply_force(thrown, Vec2::new(fx!(3), fx!(4)), Vec2::new(fx!(9), fx!(10))).expect("dynamic");
    there_and_back(&mut world);
    assert!(world.body(bodies[0]).expect("there").is_asleep());
}

fn ball() -> ShapeDef {
    ShapeDef::new(Geometry::circle(fx!(0.4)).expect("valid"))
}

#[test]
fn snapshots_share_what_does_not_change() {
    let (mut world, bodies) = chain(200);
    let first = world.save();
    world.step();
    let second = world.save();
    assert!(first.bodies.shared_with(&second.bodies) == 7 && first.joints.shared_with(&second.joints) == 7);
    world.set_user_data(bodies[40], 1).expect("there");
    let third = world.save();
    assert_eq!(third.bodies.shared_with(&second.bodies), 6, "one page has changed");
    assert_eq!(third.shapes.shared_with(&second.shapes), 7);
    world.restore(&first);
    assert_eq!(world.save().bodies.shared_with(&first.bodies), 7, "the restored world shares its pages");
}

#[test]
fn reused_snapshots_equal_new_ones() {
    let (mut world, bodies) = chain(40);
    let mut ring = [world.save(), world.save(), world.save()];
    for tick in 0..12 {
        world.step();
        world.save_into(&mut ring[tick % 3]);
        assert_eq!(ring[tick % 3], world.save());
    }
    let before = ring[2].clone();
    world.set_velocity(bodies[7], Vec2::new(fx!(3), fx!(-1)), fx!(0)).expect("dynamic");
    let after = world.save();
    assert_ne!(before.packed.bodies, after.packed.bodies);
    assert_eq!(after.state_hash(), World::from_bytes(&after.to_bytes()).expect("valid").state_hash());
    world.restore(&before);
    assert_eq!(world.state_hash(), before.state_hash());
    assert_eq!(ring[2], before, "a snapshot does not change with the world");
}

/// Removing a body beside sleeping contacts leaves their packed form as it is.
#[test]
fn snapshots_share_sleeping_contacts_until_these_change() {
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let at = |world: &mut World, def: BodyDef, x: Fx| {
        world.spawn(&def.position((x, fx!(0))), &[ball]).expect("valid")
    };
    at(&mut world, BodyDef::fixed(), fx!(0));
    let asleep = at(&mut world, BodyDef::dynamic(), fx!(0.99));
    let lone = at(&mut world, BodyDef::dynamic(), fx!(50));
    world.step();
    world.sleep(asleep).expect("there");
    world.step();
    let before = world.save();
    world.despawn(lone).expect("there");
    let after = world.save();
    assert!(!world.state.sleeping_contacts.is_empty());
    assert!(Arc::ptr_eq(&before.sleeping_contacts, &after.sleeping_contacts));
    world.despawn(asleep).expect("there");
    assert!(!Arc::ptr_eq(&before.sleeping_contacts, &world.save().sleeping_contacts));
}
