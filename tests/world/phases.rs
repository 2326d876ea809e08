//! Digests after each phase of a tick do not affect the simulation.

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::world::{BodyField, World};
use lockstep2d_scenes::Scene;

fn pile() -> World {
    let setup = Scene::find("pyramid").expect("a scene").setup(0);
    let mut world = Sandbox::new(&setup).expect("its setup").world().clone();
    (0..10).for_each(|_| world.step());
    world.log_phases();
    world
}

#[test]
fn equal_worlds_have_equal_phases_whatever_their_caches() {
    let mut world = pile();
    let mut other = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    other.log_phases();
    for tick in 1..=20 {
        world.step();
        other.step();
        assert_eq!(world.phase_digests(), other.phase_digests());
        assert_eq!(world.phase_digests().len(), 8 * tick);
        assert_eq!(world.state_hash(), other.state_hash());
        other.clear_scratch();
    }
}

#[test]
fn worlds_that_differ_before_a_tick_differ_in_all_its_phases() {
    let (mut world, mut other) = (pile(), pile());
    let top = world.bodies().last().expect("a body").0;
    other.flip_bit(top, BodyField::VelocityX, 3).expect("it is awake");
    world.step();
    other.step();
    let mut both = world.phase_digests().iter().zip(other.phase_digests());
    assert!(both.all(|(a, b)| a.phase == b.phase && a.digest != b.digest));
}

#[test]
fn logging_phases_changes_no_result_and_can_be_ended() {
    let (mut world, mut other) = (pile(), pile());
    other.stop_logging_phases();
    for _ in 0..5 {
        world.step();
        other.step();
        assert_eq!(world.state_hash(), other.state_hash());
    }
    assert!(other.phase_digests().is_empty());
    world.log_phases();
    assert!(world.phase_digests().is_empty());
}
