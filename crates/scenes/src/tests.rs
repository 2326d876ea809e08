//! Tests that the scenes start and have their documented sizes.

use super::{ALL, Scene};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::world::World;

fn open(name: &str) -> Sandbox {
    Sandbox::new(&Scene::find(name).unwrap().setup(1)).unwrap()
}

fn counts(world: &World) -> (usize, usize, usize) {
    (world.body_count(), world.shape_count(), world.joint_count())
}

#[test]
fn every_scene_starts_and_has_a_setup_that_fits_a_replay() {
    for scene in ALL {
        let setup = scene.setup(1);
        let bytes = lockstep2d::codec::encode(&setup).len();
        assert!(bytes < 1 << 20, "{}: a setup of {bytes} bytes", scene.name);
        assert!(Sandbox::new(&setup).is_ok(), "{}", scene.name);
        assert_eq!(Scene::find(scene.name).map(|found| found.about), Some(scene.about), "names are unique");
    }
}

#[test]
fn benchmarks_have_the_size_that_they_have_elsewhere() {
    for (name, size) in [
        ("large_pyramid", (5051, 5051, 0)),
        ("many_pyramids", (22001, 22020, 0)),
        ("joint_grid", (10000, 10000, 19794)),
        ("smash", (9601, 9601, 0)),
        ("spinner", (6078, 6437, 1)),
        ("tumbler", (2027, 2029, 1)),
        ("washer", (8101, 8140, 0)),
        ("junkyard", (8002, 8262, 0)),
        ("compounds", (3001, 6282, 0)),
    ] {
        assert_eq!(counts(open(name).world()), size, "{name}");
    }
    let about = Scene::find("joint_grid").unwrap().about;
    assert!(about.contains("19 794 hinges"), "{about}");
}

/// Executes the commands of the script without stepping the world.
#[test]
fn forty_columns_of_ragdolls_stand_at_a_time() {
    let mut game = open("rain");
    let scene = Scene::find("rain").unwrap();
    for tick in 0..=8 * 42 {
        for command in scene.commands(tick, &game) {
            game.world_mut().execute(&command).unwrap();
        }
        let world = game.world();
        let columns = usize::try_from(tick / 8 + 1).unwrap().min(40);
        if tick % 8 == 0 {
            assert_eq!(counts(world), (1 + 275 * columns, 2505 + 325 * columns, 250 * columns));
            assert!(world.bodies().all(|(_, body)| body.is_enabled()));
        }
    }
    let world = game.world();
    for (id, _) in world.joints() {
        let (a, b) = world.joint_anchors(id).unwrap();
        assert!(a.distance(b) < fx!(0.000001), "joint {id}: {a:?} {b:?}");
    }
    assert_eq!(world.faults(), 0);
}
