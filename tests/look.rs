//! Forces, islands, solver colours, joint errors and other inspection functions return what theory predicts.
#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::fx;
use lockstep2d::math::{Aabb, Fx};
use lockstep2d::solver::{Distance, JointDef, JointKind, Prismatic, Revolute};
use lockstep2d::world::{Config, SolverColour, World};

fn empty() -> World {
    World::new(Config { sleeping: false, ..Config::default() }).unwrap()
}

fn slab(world: &mut World) -> BodyId {
    let slab = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(1)).unwrap());
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[slab]).unwrap()
}

fn square(world: &mut World, x: Fx, y: Fx) -> BodyId {
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap());
    world.spawn(&BodyDef::dynamic().position((x, y)), &[square]).unwrap()
}

fn run(world: &mut World, ticks: u32) {
    (0..ticks).for_each(|_| world.step());
}

/// The sum of the normal forces of all contact points in N, and the sum of their friction forces in N.
fn sum_of_forces(world: &World) -> (Fx, Fx) {
    let forces = world.contacts().flat_map(|contact| contact.forces().map(|(_, f)| f).collect::<Vec<_>>());
    forces.fold((Fx::ZERO, Fx::ZERO), |(normal, friction), f| (normal + f.normal, friction + f.friction))
}

fn assert_near(found: Fx, expected: Fx, relative: Fx) {
    let error = (found - expected).abs();
    assert!(error <= expected.abs().saturating_mul(relative), "{found}, expected {expected}");
}

#[test]
fn the_ground_bears_the_weight() {
    let mut world = empty();
    slab(&mut world);
    let body = square(&mut world, fx!(0), fx!(0.5));
    run(&mut world, 120);
    let weight = world.body(body).unwrap().mass() * -world.config().gravity.y;
    let (normal, friction) = sum_of_forces(&world);
    assert_near(normal, weight, fx!(0.001));
    assert!(friction.abs() < weight / 100, "{friction}");
}

#[test]
fn a_contact_is_printed_without_its_world() {
    let mut world = empty();
    slab(&mut world);
    square(&mut world, fx!(0), fx!(0.5));
    run(&mut world, 2);
    let printed = format!("{:?}", world.contacts().next().unwrap());
    assert!(printed.contains("touching: true") && printed.len() < 500, "{printed}");
}

#[test]
fn each_box_of_a_stack_bears_those_above() {
    let mut world = empty();
    slab(&mut world);
    let boxes: Vec<BodyId> = (0..5).map(|i| square(&mut world, fx!(0), fx!(0.5) + Fx::from_num(i))).collect();
    run(&mut world, 240);
    let weight = world.body(boxes[0]).unwrap().mass() * -world.config().gravity.y;
    let mut contacts: Vec<_> = world.contacts().collect();
    assert_eq!(contacts.len(), 5);
    contacts.sort_by_key(|contact| contact.manifold.origin.y);
    for (below, contact) in (0..).zip(&contacts) {
        let normal = contact.forces().fold(Fx::ZERO, |sum, (_, force)| sum + force.normal);
        assert_near(normal, weight * (5 - below), fx!(0.01));
    }
}

/// On a box that slides to the right, friction acts to the left.
#[test]
fn friction_is_what_slows_a_sliding_box() {
    let mut world = empty();
    slab(&mut world);
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap());
    let def = BodyDef::dynamic().position((fx!(0), fx!(0.5))).velocity((fx!(10), fx!(0)));
    let body = world.spawn(&def, &[square]).unwrap();
    run(&mut world, 20);
    let (before, mass) = (world.body(body).unwrap().velocity().x, world.body(body).unwrap().mass());
    world.step();
    let slowed = (world.body(body).unwrap().velocity().x - before) * 60;
    assert!(slowed < fx!(-1), "expected the box to be slowed by friction");
    let contact = world.contacts().next().unwrap();
    // The normal points up, to the box. Friction is measured along the normal rotated counter-clockwise, to the left.
    assert!(contact.manifold.normal.y > 0);
    let (_, friction) = sum_of_forces(&world);
    assert_near(friction, -mass * slowed, fx!(0.001));
}

#[test]
fn of_two_bodies_the_reduced_mass_is_accelerated() {
    let mut world = empty();
    let light = square(&mut world, fx!(0), fx!(0));
    square(&mut world, fx!(0.999), fx!(0));
    run(&mut world, 1);
    let mass = world.body(light).unwrap().mass();
    assert_near(world.contacts().next().unwrap().reduced_mass(), mass / 2, fx!(0.000001));
}

#[test]
fn islands_are_what_touches_or_is_joined_awake_and_asleep() {
    let mut world = World::default();
    slab(&mut world);
    let stack = [square(&mut world, fx!(0), fx!(0.5)), square(&mut world, fx!(0), fx!(1.5))];
    let alone = square(&mut world, fx!(5), fx!(0.5));
    let joined = [square(&mut world, fx!(-5), fx!(0.5)), square(&mut world, fx!(-8), fx!(0.5))];
    world.add_joint(&JointDef::new(joined[0], joined[1], Distance::rod(fx!(3)))).unwrap();
    let expected = vec![stack.to_vec(), vec![alone], joined.to_vec()];
    world.step();
    assert_eq!(world.islands(), expected);
    run(&mut world, 300);
    assert_eq!(world.awake_body_count(), 0);
    assert_eq!(world.islands(), expected);
    world.wake(alone).unwrap();
    world.step();
    assert_eq!(world.islands(), expected);
}

#[test]
fn the_solver_has_touching_contacts_in_independent_groups() {
    let mut world = empty();
    slab(&mut world);
    for i in 0..40 {
        square(&mut world, Fx::from_num(i % 8) - fx!(4), Fx::from_num(i / 8) + fx!(0.5));
    }
    run(&mut world, 60);
    let mut taken = std::collections::BTreeSet::new();
    let mut groups = std::collections::BTreeSet::new();
    for contact in world.contacts() {
        let Some(SolverColour::Group(group)) = contact.solver_colour() else { panic!("no colour") };
        groups.insert(group);
        for shape in [contact.shape_a, contact.shape_b] {
            let body = world.shape(shape).unwrap().body();
            let dynamic = world.body(body).unwrap().is_dynamic();
            assert!(!dynamic || taken.insert((group, body)), "{body} occurs twice in group {group}");
        }
    }
    assert!(groups.len() >= 3, "{groups:?}");
}

#[test]
fn a_body_with_too_many_contacts_overflows() {
    let mut world = empty();
    let plate = ShapeDef::new(Polygon::rectangle(fx!(40), fx!(0.5)).unwrap());
    world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(-0.5))), &[plate]).unwrap();
    for i in 0..30 {
        square(&mut world, Fx::from_num(i * 2) - fx!(30), fx!(0.49));
    }
    world.step();
    let overflowing = world.contacts().filter(|c| c.solver_colour() == Some(SolverColour::Overflow));
    assert_eq!(overflowing.count(), 30 - 24);
}

#[test]
fn sensors_have_no_contacts() {
    let mut world = empty();
    slab(&mut world);
    let ghost = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap()).sensor();
    world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.4))), &[ghost]).unwrap();
    world.step();
    assert_eq!(world.events().sensor_begin.len(), 1, "it overlaps the slab");
    assert_eq!(world.contacts().count(), 0);
}

#[test]
fn the_error_of_a_joint_is_what_it_would_not_have() {
    let error = |x: Fx, y: Fx, joint: fn(BodyId, BodyId) -> JointDef| {
        let mut world = empty();
        let post = world.spawn(&BodyDef::fixed(), &[]).unwrap();
        let body = square(&mut world, x, y);
        let id = world.add_joint(&joint(post, body)).unwrap();
        world.joint_error(id)
    };
    let (x, y) = (fx!(3), fx!(4));
    assert_eq!(error(x, y, |a, b| JointDef::new(a, b, Revolute::new())), Some(fx!(5)));
    assert_eq!(error(x, y, |a, b| JointDef::new(a, b, Prismatic::new())), Some(fx!(4)));
    assert_eq!(error(x, y, |a, b| JointDef::new(a, b, Distance::rod(fx!(4.5)))), Some(fx!(0.5)));
    assert_eq!(error(x, y, |a, b| JointDef::new(a, b, Distance::rope(fx!(6)))), Some(fx!(0)));
    assert_eq!(error(x, y, |a, b| JointDef::new(a, b, Distance::rope(fx!(2)))), Some(fx!(3)));
    assert_eq!(error(x, y, |a, b| JointDef::new(a, b, JointKind::Filter)), None);
}

#[test]
fn the_broad_phase_has_boxes_around_all_of_what_they_hold() {
    let mut world = empty();
    for i in 0..50 {
        square(&mut world, Fx::from_num(i % 10) * 3, Fx::from_num(i / 10) * 3);
    }
    let boxes = world.broad_phase_boxes();
    assert_eq!(boxes.len(), 49, "expected the inner nodes of a binary tree");
    let (root, 0) = boxes[0] else { panic!("the root comes first") };
    let all = world.shapes().map(|(_, shape)| shape.fat_aabb()).reduce(Aabb::union).unwrap();
    assert!(root.contains(all));
    assert!(boxes.iter().all(|&(inner, _)| root.contains(inner)));
    world.set_broad_phase(BroadPhaseKind::BruteForce);
    assert_eq!(world.broad_phase_boxes(), []);
}

/// Two squares lie on a slab and are welded to each other. A filter joint connects a distant square to the upper one.
#[test]
fn the_contacts_and_joints_of_a_body_are_those_of_the_world_that_name_it() {
    let mut world = empty();
    slab(&mut world);
    let [lower, upper, far] =
        [(fx!(0), fx!(0.5)), (fx!(0), fx!(1.5)), (fx!(9), fx!(900))].map(|(x, y)| square(&mut world, x, y));
    let weld = JointDef::new(lower, upper, lockstep2d::solver::Weld::rigid());
    let weld = weld.anchor_a((fx!(0), fx!(1))).colliding();
    let joints =
        [weld, JointDef::new(far, upper, JointKind::Filter)].map(|def| world.add_joint(&def).unwrap());
    run(&mut world, 120);
    let slab = world.bodies().next().unwrap().0;
    for body in [slab, lower, upper, far] {
        let own = |shape: lockstep2d::body::ShapeId| world.shapes_of(body).contains(&shape);
        let named = world.contacts().filter(|contact| own(contact.shape_a) || own(contact.shape_b));
        let pairs = |contact: lockstep2d::world::ContactView<'_>| (contact.shape_a, contact.shape_b);
        let listed: Vec<_> = world.contacts_of(body).map(pairs).collect();
        assert_eq!(listed, named.map(pairs).collect::<Vec<_>>());
    }
    let counts = [slab, lower, upper, far].map(|body| world.contacts_of(body).count());
    assert_eq!(counts, [1, 2, 1, 0]);
    let load: Fx = world
        .contacts_of(slab)
        .flat_map(|contact| contact.forces().map(|(_, force)| force.normal).collect::<Vec<_>>())
        .sum();
    let weight = (world.body(lower).unwrap().mass() + world.body(upper).unwrap().mass()) * 10;
    assert!((load - weight).abs() < weight / 50, "{load} N instead of {weight} N");
    assert_eq!(world.joints_of(lower), joints[..1]);
    assert_eq!(world.joints_of(upper), joints);
    assert_eq!(world.joints_of(far), joints[1..]);
    world.despawn(far).unwrap();
    assert!(world.joints_of(far).is_empty() && world.shapes_of(far).is_empty());
    assert_eq!((world.joints_of(upper), world.contacts_of(far).count()), (joints[..1].to_vec(), 0));
}
