//! Each contact, however short, has exactly one begin event when it begins, and one end event when it ends.

use std::collections::BTreeSet;

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::world::{Config, ContactEvent, World};
use lockstep2d_scenes::Scene;

fn follow(world: &World, touching: &mut BTreeSet<ContactEvent>) {
    for event in &world.events().contact_end {
        assert!(touching.remove(event), "{event:?} ended without having begun");
    }
    for event in &world.events().contact_begin {
        assert!(touching.insert(*event), "{event:?} began twice");
    }
    assert!(world.events().contact_begin.is_sorted() && world.events().contact_end.is_sorted());
}

#[test]
fn begins_and_ends_are_balanced_and_sorted() {
    for name in ["drum", "spawning", "hundred_polygons"] {
        let scene = Scene::find(name).expect("there");
        let mut game = Sandbox::new(&scene.setup(1)).expect("valid");
        let mut touching = BTreeSet::new();
        for tick in 0..300 {
            let commands = scene.commands(tick, &game);
            game.step(&[commands]);
            follow(game.world(), &mut touching);
            let told = game.world().contacts().filter(|contact| contact.touching);
            let now: BTreeSet<_> =
                told.map(|c| ContactEvent { shape_a: c.shape_a, shape_b: c.shape_b }).collect();
            assert!(now.is_subset(&touching), "{name}, tick {tick}: a touching contact has no begin event");
        }
        assert!(
            touching.len() > 20,
            "{name}: expected more than 20 touching pairs, found {}",
            touching.len()
        );
    }
}

/// A ball hits another one off centre and separates before the next tick.
#[test]
fn a_touch_between_two_ticks_is_told() {
    let mut rng = Rng::new(1);
    let mut hits = 0;
    for case in 0..200 {
        let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).restitution(fx!(0.5));
        let speed = rng.range(fx!(5), fx!(80));
        let thrown =
            BodyDef::dynamic().position((fx!(-5), rng.range(fx!(-0.9), fx!(0.9)))).velocity((speed, fx!(0)));
        let a = world.spawn(&thrown, &[ball]).expect("valid");
        world.spawn(&BodyDef::dynamic(), &[ball]).expect("valid");
        let mut told = 0;
        for _ in 0..120 {
            world.step();
            told += world.events().contact_begin.len();
        }
        let deflected = world.body(a).expect("there").velocity() != Vec2::new(speed, Fx::ZERO);
        hits += usize::from(deflected);
        assert_eq!(told, usize::from(deflected), "case {case}: {told} begin events at {speed} m/s");
    }
    assert!(hits > 150, "expected more than 150 hits, found {hits}");
}

#[test]
fn a_removed_shape_ends_its_touches_at_the_next_tick() {
    let mut world = World::default();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(5), fx!(1)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
    let body = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square]).expect("valid");
    let mut touching = BTreeSet::new();
    for _ in 0..30 {
        world.step();
        follow(&world, &mut touching);
    }
    assert_eq!(touching.len(), 1);
    world.despawn(body).expect("there");
    let restored = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    for mut world in [world, restored] {
        let mut touching = touching.clone();
        world.step();
        follow(&world, &mut touching);
        assert!(touching.is_empty(), "expected the end event, also after a restore");
    }
}
