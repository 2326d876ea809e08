//! The sandbox is a good game.

use lockstep2d::check::{Options, Way, check, random_inputs};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::Rng;
use lockstep2d::scenes;

#[test]
fn every_scene_passes() {
    for scene in scenes::ALL {
        let start = std::time::Instant::now();
        let setup = scene.setup(1);
        let mut game = Sandbox::new(&setup).unwrap();
        let large = game.world().shape_count() > 300;
        let mut inputs = Vec::new();
        for tick in 0..if large { 3 } else { 30 } {
            let commands = scene.commands(tick, &game);
            game.step(std::slice::from_ref(&commands));
            inputs.push(vec![commands]);
        }
        // That compares every shape with every other.
        let brute_force = Way::BroadPhase(BroadPhaseKind::BruteForce);
        let options = if large { Options::default().without(brute_force) } else { Options::default() };
        let checked = check::<Sandbox>(&setup, &inputs, &options);
        let checked = checked.unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        assert_eq!(checked.hash, game.state_hash(), "{}", scene.name);
        assert!(checked.ways.contains(&Way::ClearedScratch));
        println!("{} {:?}", scene.name, start.elapsed());
    }
}

#[test]
fn random_commands_pass() {
    let mut rng = Rng::new(5);
    for _ in 0..10 {
        let inputs = random_inputs::<Sandbox>(1, 60, &mut rng);
        check::<Sandbox>(&SandboxSetup::default(), &inputs, &Options::default()).unwrap();
    }
}
