//! The sandbox passes the check.

use lockstep2d::check::{CheckOptions, Phases, Variant, check, random_inputs};
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::Rng;

/// Largest number of shapes of a scene in this test: all variants together take as long as twenty runs.
const SHAPES_MAX: usize = 300;

#[test]
fn every_scene_passes() {
    let mut passed = 0;
    for scene in lockstep2d_scenes::ALL {
        let setup = scene.setup(1);
        let mut game = Sandbox::new(&setup).unwrap();
        if game.world().shape_count() > SHAPES_MAX {
            continue;
        }
        let mut inputs = Vec::new();
        for tick in 0..30 {
            let commands = scene.commands(tick, &game);
            game.step(std::slice::from_ref(&commands));
            inputs.push(vec![commands]);
        }
        let options = CheckOptions { phases: Phases::Compared, ..CheckOptions::default() };
        let checked = check::<Sandbox>(&setup, &inputs, &options);
        let checked = checked.unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        assert_eq!(checked.hash, game.state_hash(), "{}", scene.name);
        assert!(checked.variants.contains(&Variant::ClearedScratch));
        passed += 1;
    }
    assert!(passed > 12, "expected more than 12 small scenes, found {passed}");
}

#[test]
fn random_commands_pass() {
    let mut rng = Rng::new(5);
    for _ in 0..10 {
        let inputs = random_inputs::<Sandbox>(1, 60, &mut rng);
        check::<Sandbox>(&SandboxSetup::default(), &inputs, &CheckOptions::default()).unwrap();
    }
}
