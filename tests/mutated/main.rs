//! Thousands of damaged or forged files. Readers answer in bounded time and memory, and accept no replay that differs
//! from the originals in setup, inputs or verdict.
//!
//! `MUTATIONS=100000 cargo test --release --test mutated -- --nocapture` prints figures.
#![expect(clippy::unwrap_used, reason = "the files of this repository are valid")]

mod judge;
mod memory;
mod mutation;

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::Rng;
use lockstep2d::world::{SnapshotError, World};
use lockstep2d_scenes::Scene;

use judge::{Figures, check_replays, files_wanted, mutated};

/// Default number of files per test.
const FILES: u64 = 2000;
/// Largest size in bytes of the originals. Larger files are left out, because they take longer.
const LARGEST: usize = 60_000;
/// Number of ticks that an accepted world is simulated.
const TICKS: u32 = 3;
/// Largest allowed memory use while a snapshot is read, as a multiple of its size.
const SNAPSHOT_MULTIPLE: usize = 100;

#[test]
fn a_mutated_replay_is_never_another_match() {
    let paths = std::fs::read_dir(lockstep2d_tests::root().join("replays"))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|extension| extension == "replay")).collect();
    paths.sort();
    let mut originals: Vec<_> = paths.iter().map(|path| std::fs::read(path).unwrap()).collect();
    originals.retain(|file| file.len() <= LARGEST);
    check_replays::<Sandbox>(&originals, FILES);
}

/// An empty world, and each scene's world after 40 ticks, unless it is too large.
fn snapshots() -> Vec<Vec<u8>> {
    let mut snapshots = vec![World::default().to_bytes()];
    for scene in lockstep2d_scenes::ALL {
        let mut game = Sandbox::new(&scene.setup(lockstep2d_tests::SEED)).unwrap();
        for tick in 0..40 {
            let commands = Scene::commands(scene, tick, &game);
            game.step(&[commands]);
        }
        snapshots.push(game.world().to_bytes());
    }
    snapshots.retain(|file| file.len() <= LARGEST);
    snapshots
}

#[test]
fn a_mutated_snapshot_is_refused_or_a_world() {
    let originals = snapshots();
    let (mut rng, mut figures) = (Rng::new(2), Figures::default());
    for number in 0..files_wanted(FILES) {
        let file = mutated(&mut rng, &originals);
        let name = |world: &Result<World, SnapshotError>| match world {
            Ok(_) => "accepted".into(),
            Err(error) => format!("{error:?}").split([' ', '(']).next().unwrap_or_default().to_string(),
        };
        let Ok(mut world) = figures.count(&file, || World::from_bytes(&file), name) else { continue };
        assert!(world.to_bytes() == file, "file {number} is accepted, but encodes differently");
        let live = || {
            for _ in 0..TICKS {
                world.step();
                assert_eq!(world.validate(), Ok(()), "file {number}, tick {}", world.tick());
            }
        };
        figures.count(&file, live, |()| "lived".into());
    }
    figures.print("snapshots");
    assert!(figures.answers.len() >= 6, "{:?}", figures.answers);
    for answer in ["accepted", "lived"] {
        assert!(figures.answers.contains_key(answer), "{:?}", figures.answers);
    }
}

/// The worst case is a snapshot of vacant slots: in the file, each takes only the bytes of its generation, but in
/// memory it takes as much as a body.
#[test]
fn what_a_snapshot_takes_is_bounded_by_its_bytes() {
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.1)).unwrap());
    let bodies: Vec<_> = (0..20_000).map(|_| world.spawn(&BodyDef::fixed(), &[ball]).unwrap()).collect();
    bodies.into_iter().for_each(|body| world.despawn(body).unwrap());
    let vacant = world.to_bytes();
    let (read, peak) = memory::peak_of(|| World::from_bytes(&vacant));
    assert!(read.is_ok());
    println!("{peak} bytes for {} bytes of vacant slots", vacant.len());
    assert!(peak <= SNAPSHOT_MULTIPLE * vacant.len(), "{peak} bytes for {}", vacant.len());
}
