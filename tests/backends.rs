//! On every backend of this machine and on 1, 2, 4 and 8 threads, the large scenes end in the hashes of
//! `tests/backends.txt`.

use core::fmt::Debug;
use std::sync::Mutex;

use lockstep2d::body::{BodyDef, Geometry, MassSource, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Angle, Rng, Vec2};
use lockstep2d::solver::Revolute;
use lockstep2d::world::{Backend, StepStats, World};
use lockstep2d_scenes::Scene;
use lockstep2d_tests::sweep;

const HASHES: &str = "tests/backends.txt";

/// Scenes and numbers of ticks. `smash` gets more ticks, because its heavy box needs a while to reach the block of
/// small boxes.
const SCENES: [(&str, u64); 10] = [
    ("large_pyramid", 60),
    ("many_pyramids", 60),
    ("joint_grid", 60),
    ("rain", 60),
    ("smash", 120),
    ("spinner", 60),
    ("tumbler", 60),
    ("washer", 60),
    ("junkyard", 60),
    ("compounds", 60),
];

/// The hash of a scene after `ticks` ticks, and the statistics of its last tick. `choose` sets the backend or the
/// number of threads, and returns whether this machine supports it.
fn end_of(name: &str, ticks: u64, choose: impl FnOnce(&mut World) -> bool) -> (String, StepStats) {
    let scene = Scene::find(name).expect("a scene of this crate");
    let mut game =
        Sandbox::new(&scene.setup(lockstep2d_tests::SEED)).expect("the scenes of this crate are valid");
    assert!(choose(game.world_mut()), "this machine does not support the requested backend or thread count");
    for tick in 0..ticks {
        let commands = scene.commands(tick, &game);
        game.step(&[commands]);
    }
    assert_eq!(game.world().faults(), 0, "{name}");
    (game.state_hash().to_string(), *game.world().stats())
}

/// Expects that the scenes end in the hashes of the file with each variant: a backend or a number of threads. `choose`
/// applies a variant to a world.
fn all_end_in_their_hashes<Variant: Copy + Debug + Sync>(
    variants: &[Variant],
    choose: fn(&mut World, Variant) -> bool,
) {
    let known = lockstep2d_tests::goldens_of(HASHES);
    let wrong = Mutex::new(Vec::new());
    sweep::for_each(SCENES.to_vec(), |(name, ticks)| {
        let end_of = |variant| end_of(name, ticks, |world| choose(world, variant));
        let end = end_of(variants[0]);
        for &variant in &variants[1..] {
            assert_eq!(
                end,
                end_of(variant),
                "{name}: {:?} and {variant:?} differ after {ticks} ticks",
                variants[0]
            );
        }
        let (hash, _) = end;
        let line = known.iter().find(|line| (line.scene.as_str(), line.ticks) == (name, ticks));
        if line.is_none_or(|line| line.hash != hash) {
            let mut wrong = wrong.lock().expect("no check holds the lock");
            wrong.push(format!("{} {name} {ticks} {hash}", lockstep2d::SEMANTICS));
        }
    });
    let wrong = wrong.into_inner().expect("no check holds the lock");
    assert!(
        wrong.is_empty(),
        "the arithmetic has changed, equally in all variants. If this is intended, raise lockstep2d::SEMANTICS and \
         add these lines to {HASHES}.\n{}",
        wrong.join("\n")
    );
    assert_eq!(known.len(), SCENES.len(), "expected a line for each scene in {HASHES}");
}

#[test]
fn every_backend_ends_in_the_same_hashes() {
    let backends: Vec<Backend> = Backend::available().collect();
    all_end_in_their_hashes(&backends, World::set_backend);
}

/// The preceding test runs on one thread. This test runs on several, with the default backend.
#[test]
#[cfg(feature = "parallel")]
fn any_number_of_threads_ends_in_the_same_hashes() {
    all_end_in_their_hashes(&[2, 4, 8], World::force_threads);
}

/// In a game the number of threads changes from tick to tick, because a world compares times, and uses several
/// threads only in ticks that these make shorter.
#[test]
#[cfg(feature = "parallel")]
fn the_number_of_threads_may_change_between_ticks() {
    sweep::for_each(SCENES.to_vec(), |(name, _)| {
        let scene = Scene::find(name).expect("a scene of this crate");
        let new = || Sandbox::new(&scene.setup(lockstep2d_tests::SEED)).expect("valid");
        let (mut alone, mut changing) = (new(), new());
        for (tick, count) in (0..12).zip([1, 2, 3, 1, 4, 2].into_iter().cycle()) {
            assert!(changing.world_mut().force_threads(count));
            for game in [&mut alone, &mut changing] {
                let commands = scene.commands(tick, game);
                game.step(&[commands]);
            }
            assert_eq!(alone.state_hash(), changing.state_hash(), "{name}, tick {tick}, {count} threads");
        }
    });
}

/// Fast rods, wheels with heavy hubs, boxes, bouncing balls and a chain: bodies that exceed the speed limit, and slower
/// bodies in the same batches.
fn faulty_world(seed: u64) -> World {
    let mut world = World::default();
    let mut rng = Rng::new(seed);
    let rectangle =
        |width, height| ShapeDef::new(Polygon::rectangle(width, height).expect("a rectangle of this size"));
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("a valid radius"));
    let hub = MassSource::Given { mass: fx!(3), centre: Vec2::ZERO, gyration: fx!(0.1) };
    for row in 0..10 {
        let mut last = None;
        let floor = fx!(10) * row;
        let ground = BodyDef::fixed().position((fx!(0), floor - fx!(1)));
        // Bodies of up to 395 m/s bounce on every other floor.
        let floor_shape =
            rectangle(fx!(100), fx!(1)).restitution(if row % 2 == 0 { fx!(0.8) } else { fx!(0) });
        world.spawn(&ground, &[floor_shape]).expect("a valid body");
        for column in 0..38 {
            let x = fx!(5) * column - fx!(95);
            let body = BodyDef::dynamic().angle(Angle::from_radians(rng.range(fx!(-0.01), fx!(0.01))));
            let at = |y| (x, floor + y);
            let falling = (fx!(0), rng.range(fx!(-5), fx!(0)));
            let fast = (rng.range(fx!(-20), fx!(20)), rng.range(fx!(-395), fx!(395)));
            let (body, shape) = match column % 5 {
                0 if rng.below(3) == 0 => {
                    let body = body.velocity(fast).angular_velocity(rng.range(fx!(-1300), fx!(1300)));
                    (body.position(at(fx!(0.045))), rectangle(fx!(0.5), fx!(0.05)))
                }
                1 if rng.below(3) == 0 => {
                    (body.mass(hub).position(at(fx!(0.5))).angular_velocity(fx!(3000)), ball)
                }
                2 => (body.position(at(fx!(0.6))).velocity(falling), ball.restitution(fx!(0.5))),
                _ => (body.position(at(fx!(0.495))).velocity(falling), rectangle(fx!(0.5), fx!(0.5))),
            };
            let body = world.spawn(&body, &[shape]).expect("a valid body");
            let limit = Revolute::new().limit(fx!(-0.5), fx!(0.5));
            if let Some(last) = last.replace(body).filter(|_| column % 4 == 0) {
                let hinge = if row % 2 == 0 { limit } else { Revolute::new() };
                let hinge = world.joint_at(last, body, hinge, (x, floor)).expect("both bodies are there");
                world.add_joint(&hinge).expect("a valid joint");
            }
        }
    }
    world
}

/// The grouping of contacts and hinges into batches depends on the backend and on the number of threads.
#[test]
fn faults_are_counted_equally_on_every_backend_and_number_of_threads() {
    sweep::for_each((0..8).collect(), |seed| {
        let mut alone = faulty_world(seed);
        alone.set_backend(Backend::Scalar);
        let mut others: Vec<(String, World)> = Vec::new();
        for backend in Backend::available() {
            let mut world = alone.clone();
            assert!(world.set_backend(backend));
            others.push((format!("{backend:?}"), world));
        }
        #[cfg(feature = "parallel")]
        for count in [2, 3] {
            let mut world = World::clone(&alone);
            assert!(world.set_backend(Backend::best()) && world.force_threads(count));
            others.push((format!("{count} threads"), world));
        }
        for tick in 1..=4 {
            alone.step();
            for (name, world) in &mut others {
                world.step();
                assert_eq!(world.faults(), alone.faults(), "seed {seed}, tick {tick}, {name}");
                assert_eq!(world.state_hash(), alone.state_hash(), "seed {seed}, tick {tick}, {name}");
            }
        }
        assert!(alone.faults() > 50, "seed {seed}: only {} faults", alone.faults());
    });
}

/// A sample includes the first and the last case. A sweep checks every case, and fails if one of them fails.
#[test]
fn a_sweep_checks_its_ends_and_fails_with_any_case() {
    let sampled = sweep::sample(0..100, 7);
    assert!(sampled.starts_with(&[0]) && sampled.ends_with(&[99]), "{sampled:?}");
    let seen = Mutex::new(Vec::new());
    sweep::for_each(sampled.clone(), |case| seen.lock().expect("no check fails").push(case));
    let mut seen = seen.into_inner().expect("no check fails");
    seen.sort_unstable();
    assert_eq!(seen, sampled);
    let fails = |case: i32| assert_ne!(case, 99, "this failure is expected");
    assert!(std::panic::catch_unwind(|| sweep::for_each(sampled.clone(), fails)).is_err());
    assert!(std::panic::catch_unwind(|| sweep::at_once(sampled.clone(), fails)).is_err());
}
