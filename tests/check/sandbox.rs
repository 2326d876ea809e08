//! The sandbox passes `lockstep2d::check`.

use lockstep2d::check::{CheckError, CheckOptions, Phases, Variant, check, check_replay, random_inputs};
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::Rng;
use lockstep2d::replay::{LimitKind, Limits, Step, Verdict, VerifiedReplay, verify};
use lockstep2d::report::{CompareError, Evidence, bisect};

/// Scenes with more shapes are not tested, because all variants of a scene together take as long as twenty runs of it.
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

/// `tick_work` also limits work that is counted during a tick, because it is not known before the tick.
#[test]
fn the_work_within_a_tick_is_limited_for_checks_and_comparisons() {
    let file = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../replays/game.replay")).unwrap();
    let mut replay = VerifiedReplay::<Sandbox>::open(&file, &Limits::default()).unwrap();
    // The largest work of a tick in units, and the part of it that is known before the tick.
    let (mut largest, mut known) = (0, 0);
    loop {
        let before = replay.work();
        let world_work = replay.game().work(&[vec![]]);
        if replay.step().unwrap() == Step::Ended {
            break;
        }
        if replay.work() - before > largest {
            (largest, known) = (replay.work() - before, world_work);
        }
    }
    assert!(largest > known, "expected work within a tick: {known} of {largest} units");
    let limits = Limits { tick_work: largest - 1, ..Limits::default() };
    let verdict = verify::<Sandbox>(&file, &limits);
    assert!(matches!(verdict, Verdict::LimitExceeded { limit: LimitKind::TickWork, .. }), "{verdict}");
    let options = CheckOptions { limits: limits.clone(), ..CheckOptions::default() };
    let options = options.only(&[Variant::Again]);
    match check_replay::<Sandbox>(&file, &options) {
        Err(CheckError::Replay(found)) => assert_eq!(found, verdict),
        other => panic!("{other:?}"),
    }
    let evidence = Evidence::Replay(file);
    match bisect::<Sandbox>(&evidence, None, &limits) {
        Err(CompareError::Replay { verdict: found, .. }) => assert_eq!(found, verdict),
        other => panic!("{other:?}"),
    }
}
